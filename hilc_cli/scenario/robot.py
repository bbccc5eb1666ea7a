"""What a scenario says that the controller believes of the platform."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.parameters import OTHER_KEYS, half_track_of
from hilc_cli.yaml_input.model import Model, wrong_at
from hilc_cli.yaml_input.quantities import RobotLength, WheelSeparation


class ModelSpec(Model):
    """What the controller believes; what is left out is as the robot really is."""

    other_names = OTHER_KEYS

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
        half_track = half_track_of(self.half_track, self.wheel_separation)
        return Robot(
            robot.wheel_radius if self.wheel_radius is None else self.wheel_radius,
            robot.half_track if half_track is None else half_track,
            robot.turn_convention,
        )
