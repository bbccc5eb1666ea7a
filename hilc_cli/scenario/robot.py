"""What a scenario says of the platform, and of what the controller believes of it."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from hilc_cli.plants.kinematic import Robot, TurnConvention
from hilc_cli.yaml_input.model import Model, wrong_at
from hilc_cli.yaml_input.quantities import Coordinate, PositiveNumber, RobotLength, WheelSeparation

_OTHER_NAMES = {"ros": "rep103"}


def _usual_name(value: object) -> object:
    """The name by which results call a convention."""
    return _OTHER_NAMES.get(value.lower(), value) if isinstance(value, str) else value


TurnConventionName = Annotated[
    TurnConvention,
    BeforeValidator(_usual_name),
    WithJsonSchema({"enum": ["paper", "rep103", "ros"], "type": "string"}),
]


_SEPARATION = "the distance between the left and the right wheel is wheel_separation"
_OTHER_KEYS = {
    **dict.fromkeys(("wheeldiameter", "diameter"), "half of it is wheel_radius"),
    **dict.fromkeys(
        (
            "track", "trackwidth", "trackgauge", "wheeltrack", "axletrack", "axlewidth",
            "axlelength", "base", "baseline", "wheelbase", "wheelwidth", "wheeldistance",
            "wheelspacing", "wheelsdistance", "wheelseparationm", "distancebetweenwheels",
            "tread",
        ),
        _SEPARATION,
    ),
}  # fmt: skip


class RobotSpec(Model):
    """The plant as it really is."""

    other_names = _OTHER_KEYS

    exactly_one = (("half_track", "wheel_separation"),)

    wheel_radius: RobotLength = Field(description="R_c [m]")
    half_track: RobotLength | None = Field(
        None, description="B_c [m] as Eq. 2 uses it: half the distance between the wheels"
    )
    wheel_separation: WheelSeparation | None = Field(
        None, description="distance between the wheels [m], instead of half_track"
    )
    turn_convention: TurnConventionName = Field(
        description="paper: left wheel faster turns left; "
        "rep103 or ros: right wheel faster turns left"
    )
    gravity_center: tuple[Coordinate, Coordinate] = Field(
        (0.0, 0.0), description="D_cx, D_cy [m] in the platform's frame; only reported"
    )
    friction: PositiveNumber | None = Field(
        None,
        description="coefficient mu of the tyres, which hold a lateral acceleration of "
        "mu * 9.80665 m/s^2; used by 'hilc check' only",
    )

    def robot(self) -> Robot:
        """The platform."""
        half_track = _half_track(self.half_track, self.wheel_separation)
        assert half_track is not None  # exactly_one
        return Robot(self.wheel_radius, half_track, self.turn_convention, self.gravity_center)


class ModelSpec(Model):
    """What the controller believes; what is left out is as the robot really is."""

    other_names = _OTHER_KEYS

    wheel_radius: RobotLength | None = Field(None, description="R_rs [m]")
    half_track: RobotLength | None = Field(None, description="B_rs [m]")
    wheel_separation: WheelSeparation | None = Field(
        None, description="distance between the wheels [m], instead of half_track"
    )

    @model_validator(mode="after")
    def _one_track(self) -> Self:
        if self.half_track is not None and self.wheel_separation is not None:
            raise wrong_at((), "has both half_track and wheel_separation", "give one of them")
        return self

    def model(self, robot: Robot) -> Robot:
        """The platform as the controller believes it to be."""
        half_track = _half_track(self.half_track, self.wheel_separation)
        return Robot(
            robot.wheel_radius if self.wheel_radius is None else self.wheel_radius,
            robot.half_track if half_track is None else half_track,
            robot.turn_convention,
        )


def _half_track(half_track: float | None, wheel_separation: float | None) -> float | None:
    return half_track if wheel_separation is None else wheel_separation / 2
