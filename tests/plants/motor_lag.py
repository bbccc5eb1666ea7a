"""A plant of the tests: wheels that follow what they are told with a lag of first order."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hilc_cli.plants.kinematic import Robot, euler_step, step_gains
from hilc_cli.plants.parameters import RobotSpec
from hilc_cli.plants.plant import Plant, Pose, Step
from hilc_cli.yaml_input.quantities import Duration


@dataclass(frozen=True)
class MotorLag(Plant):
    robot: Robot
    lag: float  # [s]

    def start(self, pose: Pose, sample_time: float) -> Step:
        gains = step_gains(self.robot.wheel_radius, self.robot.signed_half_track, sample_time)
        kept = math.exp(-sample_time / self.lag) if self.lag else 0.0
        wheels = [0.0, 0.0]

        def step(pose: Pose, left: float, right: float) -> Pose:
            cos, sin = math.cos(pose[2]), math.sin(pose[2])
            # The wheels turn as fast as they have become by the end of the sample.
            wheels[:] = (
                kept * wheel + (1 - kept) * told
                for wheel, told in zip(wheels, (left, right), strict=True)
            )
            return euler_step(*pose, cos, sin, wheels[0], wheels[1], *gains)

        return step


class MotorLagSpec(RobotSpec):
    lag: Duration = 0.05

    def as_plant(self) -> MotorLag:
        return MotorLag(self.robot(), self.lag)
