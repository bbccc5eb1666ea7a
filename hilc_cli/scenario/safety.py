"""What a scenario says of the safety of a robot: limits of every plan that leaves hilc."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import ClassVar

from pydantic import Field

from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.yaml_input.model import Flag, Model
from hilc_cli.yaml_input.quantities import PositiveLength, PositiveWheelSpeed, WheelAcceleration

_OF_WHEELS = "wheels are limited; it is wheel_speed, a speed over the ground by the wheel radius"


class SafetySpec(Model):
    """Limits for a robot; what is left out is not limited by this section."""

    other_names: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("speed", "maxspeed", "velocity", "maxvelocity"), _OF_WHEELS),
        **dict.fromkeys(("acceleration", "maxacceleration"), "it is wheel_acceleration"),
        **dict.fromkeys(("change", "inputchange", "maxinputchange"), "it is max_change"),
        **dict.fromkeys(("error", "maxpositionerror", "tolerance"), "it is max_error"),
    }

    wheel_speed: PositiveWheelSpeed | None = Field(None, description="of either wheel [rad/s]")
    wheel_acceleration: WheelAcceleration | None = Field(
        None, description="the most that either wheel's speed changes [rad/s^2]"
    )
    max_change: PositiveWheelSpeed | None = Field(
        None,
        description="the most that either wheel's speed at a sample changes from plan to plan "
        "[rad/s]",
    )
    stop_at_end: Flag = Field(True, description="a plan ends with standstill")
    max_error: PositiveLength | None = Field(
        None,
        description="a trial that is further off the path [m] is refused; default: half the "
        "path's size",
    )

    def limits(
        self, speeds: Iterable[float | None], accelerations: Iterable[float | None] = ()
    ) -> SafetyLimits:
        """Returns the limits, of each the smallest that is given.

        Args:
            speeds: Other limits of a wheel's speed [rad/s]; None for one that is not given.
            accelerations: Likewise of its acceleration [rad/s^2].
        """
        return SafetyLimits(
            _least(self.wheel_speed, *speeds),
            _least(self.wheel_acceleration, *accelerations),
            _least(self.max_change),
            self.stop_at_end,
        )


def _least(*limits: float | None) -> float:
    return min((limit for limit in limits if limit is not None), default=math.inf)
