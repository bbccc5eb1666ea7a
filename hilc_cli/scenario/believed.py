"""What a scenario says of the robot that its controller believes in."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, ClassVar, Self

from pydantic import Field, create_model, model_validator

from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfections import (
    MOTOR,
    SLIP,
    BelievedRadii,
    BelievedRadius,
    MotorSpec,
    SlipSpec,
    imperfections_of,
)
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.parameters import OTHER_KEYS, TurnConventionName, half_track_of
from hilc_cli.scenario.identified import FROM
from hilc_cli.yaml_input.model import Model, Text, wrong_at
from hilc_cli.yaml_input.quantities import RobotLength, WheelSeparation

# A key that Python has another use for.
_FROM: dict[str, Any] = {
    FROM: (
        Text | None,
        Field(None, description="folder of a run: what that identified, in place of the rest"),
    )
}
_WithFrom = create_model("_WithFrom", __base__=Model, **_FROM)


class ModelSpec(_WithFrom):
    """What the controller believes.

    What is left out is as the robot really is; motors and tyres are then ideal.
    """

    other_names = OTHER_KEYS

    only_if_given: ClassVar[tuple[str, ...]] = ("turn_convention", "motor", "slip")
    """Keys that a resolved scenario has only where they are not as in every model."""

    wheel_radius: BelievedRadius | None = Field(None, description="R_rs [m]")
    half_track: RobotLength | None = Field(None, description="B_rs [m]")
    wheel_separation: WheelSeparation | None = Field(
        None, description="distance between the wheels [m], instead of half_track"
    )
    turn_convention: TurnConventionName | None = Field(
        None, description="another than the robot's: left and right wheel are believed swapped"
    )
    motor: MotorSpec = Field(MOTOR, description="what motors make of their inputs")
    slip: SlipSpec = Field(SLIP, description="what tyres lose")

    @model_validator(mode="after")
    def _one_track(self) -> Self:
        if self.half_track is not None and self.wheel_separation is not None:
            raise wrong_at((), "has both half_track and wheel_separation", "give one of them")
        return self

    def model(self, robot: Robot) -> Robot:
        """The platform as the controller believes it to be."""
        half_track = half_track_of(self.half_track, self.wheel_separation)
        return Robot(
            sum(self._radii(robot)) / 2,
            robot.half_track if half_track is None else half_track,
            self.turn_convention or robot.turn_convention,
        )

    def drivetrain(self, robot: Robot) -> Drivetrain | None:
        """The wheels, motors and tyres that the controller believes in; None for the paper's."""
        left, right = self._radii(robot)
        # What is left out is the very default, which makes the cases of a large sweep fast.
        if left == right and self.motor is MOTOR and self.slip is SLIP:
            return None
        found = Drivetrain(left, right, self.motor.motor(), self.slip.slip())
        return None if found.is_ideal else found

    def imperfections(self, robot: Robot) -> dict[str, float | str]:
        """What is believed beyond the paper's robot, by dotted key."""
        return imperfections_of(self._radii(robot), self.motor, self.slip)

    def with_keys(self, keys: Iterable[str]) -> ModelSpec:
        """Returns the same model, with a radius for each wheel if a key leads to one."""
        if not any(key.startswith("wheel_radius.") for key in keys):
            return self
        radius: float | BelievedRadii | None = self.wheel_radius
        if not isinstance(radius, BelievedRadii):
            radius = BelievedRadii(left=radius, right=radius)
        return self.model_copy(update={"wheel_radius": radius})

    def _radii(self, robot: Robot) -> tuple[float, float]:
        """The radius [m] of the left and of the right wheel."""
        radius: float | BelievedRadii | None = self.wheel_radius
        if radius is None:
            radius = robot.wheel_radius
        if not isinstance(radius, BelievedRadii):
            return radius, radius
        left = robot.wheel_radius if radius.left is None else radius.left
        right = robot.wheel_radius if radius.right is None else radius.right
        return left, right
