"""The paper's ideal plant: wheels turn as they are told, and roll without slip."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

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
    """The plant as it really is."""

    plant: Literal["kinematic"] = "kinematic"

    def as_plant(self) -> KinematicPlant:
        """Returns the plant for the engines."""
        return KinematicPlant(self.robot())
