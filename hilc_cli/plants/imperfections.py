"""What a scenario says of the motors, tyres and wheels of a robot as it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field, WrapValidator

from hilc_cli.plants.drivetrain import Slip
from hilc_cli.plants.motor import Motor
from hilc_cli.yaml_input.model import Model
from hilc_cli.yaml_input.quantities import (
    Duration,
    RobotLength,
    SlipShare,
    WheelAcceleration,
    WheelSpeedLoss,
    such_as,
)

_DELAY, _LAG = such_as(Duration, "0.08 or 80 ms"), such_as(Duration, "0.05 or 50 ms")
_DRIFT = such_as(Duration, "0.02 or 20 ms")


class MotorSpec(Model):
    """The motor of either wheel; what is left out is ideal."""

    other_names: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("latency", "deadtime", "transportdelay"), "it is delay"),
        **dict.fromkeys(("timeconstant", "tau"), "it is lag"),
        **dict.fromkeys(("deadband", "stiction"), "it is dead_zone"),
    }

    delay: Annotated[float, _DELAY] = Field(0.0, description="until an input arrives [s]")
    lag: Annotated[float, _LAG] = Field(
        0.0, description="time constant with which a wheel follows [s]"
    )
    acceleration: WheelAcceleration | None = Field(
        None, description="the most that a wheel's speed changes [rad/s^2]; null: no limit"
    )
    dead_zone: WheelSpeedLoss = Field(
        0.0, description="what friction takes of every wheel speed [rad/s]"
    )

    def motor(self) -> Motor:
        """Returns the motor for the engines."""
        most = math.inf if self.acceleration is None else self.acceleration
        return Motor(self.delay, self.lag, most, self.dead_zone)


class SlipSpec(Model):
    """The tyres; what is left out does not slip."""

    longitudinal: SlipShare = Field(0.0, description="share of each wheel's way that is lost")
    lateral: Annotated[float, _DRIFT] = Field(
        0.0, description="drift out of a bend, by speed and yaw rate: c v yaw_rate [m/s], c in s"
    )

    def slip(self) -> Slip:
        """Returns the slip for the engines."""
        return Slip(self.longitudinal, self.lateral)


class WheelRadii(Model):
    """The radius of each wheel."""

    left: RobotLength = Field(description="R_c of the left wheel [m]")
    right: RobotLength = Field(description="R_c of the right wheel [m]")


class BelievedRadii(Model):
    """The radius that the controller believes of each wheel."""

    left: RobotLength | None = Field(None, description="R_rs of the left wheel [m]")
    right: RobotLength | None = Field(None, description="R_rs of the right wheel [m]")


(_RADIUS,) = RobotLength.__metadata__  # type: ignore[attr-defined]


def _one_or(radii: type[Model]) -> WrapValidator:
    """Validates a radius against what it seems to be, so that only that is told of."""

    def validated(value: object, handler: object) -> Any:
        is_both = isinstance(value, Mapping | radii)
        return radii.model_validate(value) if is_both else _RADIUS(value)

    return WrapValidator(validated)


WheelRadius = Annotated[RobotLength | WheelRadii, _one_or(WheelRadii)]
BelievedRadius = Annotated[RobotLength | BelievedRadii, _one_or(BelievedRadii)]

MOTOR, SLIP = MotorSpec(), SlipSpec()
"""What is left out: the very defaults, which makes the cases of a large sweep fast."""


def imperfections_of(
    radii: tuple[float, float], motor: MotorSpec, slip: SlipSpec
) -> dict[str, float | str]:
    """Returns by dotted key what of wheels [m], motors and tyres the paper's robot has not."""
    found: dict[str, float | str] = {}
    left, right = radii
    if left != right:
        found |= {"wheel_radius.left": left, "wheel_radius.right": right}
    for name, section, ideal in (("motor", motor, MOTOR), ("slip", slip, SLIP)):
        if section is not ideal:
            given = section.model_dump(exclude_defaults=True)
            found |= {f"{name}.{key}": value for key, value in given.items()}
    return found
