"""The paper's ideal plant: wheels turn as they are told, and roll without slip."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.imperfections import (
    MOTOR,
    SLIP,
    MotorSpec,
    SlipSpec,
    WheelRadii,
    WheelRadius,
    imperfections_of,
)
from hilc_cli.plants.kinematic import (
    Linearisation,
    Robot,
    control_matrices,
    euler_step,
    step_gains,
)
from hilc_cli.plants.parameters import RobotSpec
from hilc_cli.plants.plant import Plant, Pose, Step
from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True)
class KinematicPlant(Plant):
    """A platform that moves as Eq. 8 says, and offers all that there is to offer.

    Attributes:
        robot: The platform.

    Source:
        Qiao et al. 2021, Eqs. 6 and 8.
    """

    robot: Robot

    def start(self, pose: Pose, sample_time: float) -> Step:
        """Starts a pass; there is nothing to keep from step to step."""
        distance_gain, turn_gain = self.lane_gains(sample_time)
        cos, sin = math.cos, math.sin

        def step(pose: Pose, left: float, right: float) -> Pose:
            x, y, heading = pose
            return euler_step(
                x, y, heading, cos(heading), sin(heading), left, right, distance_gain, turn_gain
            )

        return step

    def linearisation(
        self, headings: Floats, left: Floats, right: Floats, sample_time: float
    ) -> Linearisation:
        """Returns A_k and d_k B_k of Eq. 8; a change of the heading turns the step."""
        distance_gain, _ = self.lane_gains(sample_time)
        distance = distance_gain * (left + right)  # d v_k [m]
        # Sample next to sample: products over all of them are several times as fast then.
        states = np.zeros((len(headings), 3, 3), order="F")
        states[:] = np.eye(3)
        states[:, 0, 2] = -distance * np.sin(headings)
        states[:, 1, 2] = distance * np.cos(headings)
        inputs = sample_time * control_matrices(self.robot, headings)
        return Linearisation(states, np.asfortranarray(inputs))

    def lane_gains(self, sample_time: float) -> tuple[float, float]:
        """Returns `step_gains` of the platform."""
        robot = self.robot
        return step_gains(robot.wheel_radius, robot.signed_half_track, sample_time)


class KinematicSpec(RobotSpec):
    """The plant as it really is: the paper's, unless something of a real robot is given."""

    only_if_given: ClassVar[tuple[str, ...]] = ("plant", "motor", "slip", "integration")

    wheel_radius: WheelRadius = Field(description="R_c [m]")  # type: ignore[assignment]  # or two
    plant: Literal["kinematic"] = "kinematic"
    motor: MotorSpec = Field(MOTOR, description="what the motors make of their inputs")
    slip: SlipSpec = Field(SLIP, description="what the tyres lose")
    integration: Literal["euler", "exact"] = Field(
        "euler", description="euler: Eq. 8; exact: the arc between two samples"
    )

    def as_plant(self) -> Plant:
        """Returns the plant for the engines: the paper's, if nothing keeps it from being that."""
        if not self.imperfections():
            return KinematicPlant(self.robot())
        drivetrain = Drivetrain(*self._radii, self.motor.motor(), self.slip.slip())
        return ImperfectPlant(self.robot(), drivetrain, self.integration == "exact")

    def imperfections(self) -> dict[str, float | str]:
        """Returns what the paper's plant has not."""
        found = imperfections_of(self._radii, self.motor, self.slip)
        if self.integration != "euler":
            found["integration"] = self.integration
        return found

    def figures(self) -> dict[str, float]:
        """Returns what wheels and motors are like."""
        return Drivetrain(*self._radii, self.motor.motor()).figures

    def with_keys(self, keys: Iterable[str]) -> KinematicSpec:
        """Returns the same robot, with a radius for each wheel if a key leads to one."""
        if not any(key.startswith("wheel_radius.") for key in keys):
            return self
        left, right = self._radii
        return self.model_copy(update={"wheel_radius": WheelRadii(left=left, right=right)})

    @property
    def _radii(self) -> tuple[float, float]:
        radius: float | WheelRadii = self.wheel_radius
        return (radius.left, radius.right) if isinstance(radius, WheelRadii) else (radius, radius)

    @property
    def wheel_acceleration(self) -> float:
        """The most that the speed of a wheel changes [rad/s^2]."""
        return self.motor.motor().acceleration

    @property
    def lead(self) -> float:
        """Share of a sample's turn after which its way is gone."""
        return 0.0 if self.integration == "euler" else 0.5

    @property
    def mean_wheel_radius(self) -> float:
        """The radius [m] of equal wheels that drive as far."""
        return sum(self._radii) / 2
