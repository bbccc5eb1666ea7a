"""A plant whose motors and wheels are those of real robots."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.kinematic import Robot, drifting_step
from hilc_cli.plants.plant import Plant, Pose, Step


@dataclass(frozen=True)
class ImperfectPlant(Plant):
    """A platform with wheels of their own sizes, motors that are not at once, and slip.

    Its state is the pose, the speeds of both wheels and the inputs under way; each pass begins
    with the wheels at rest.

    Attributes:
        robot: The platform; its wheel radius is not used here.
        drivetrain: Its wheels, motors and tyres.
        exact: Whether the platform moves on the arc between two samples, instead of straight ahead
            and then turning (Eq. 8).
    """

    robot: Robot
    drivetrain: Drivetrain
    exact: bool

    def start(self, pose: Pose, sample_time: float) -> Step:
        """Starts a pass with both wheels at rest and no input under way."""
        drivetrain = self.drivetrain
        motor, slip = drivetrain.motor, drivetrain.slip
        left_wheel, right_wheel = motor.wheel(sample_time), motor.wheel(sample_time)
        half = (1 - slip.longitudinal) / 2
        left_gain, right_gain = half * drivetrain.left_radius, half * drivetrain.right_radius
        half_track, exact = self.robot.signed_half_track, self.exact
        drift_gain = slip.lateral / sample_time

        def step(pose: Pose, left: float, right: float) -> Pose:
            x, y, heading = pose
            left_way, right_way = left_gain * left_wheel(left), right_gain * right_wheel(right)
            distance, turn = left_way + right_way, (left_way - right_way) / half_track
            drift_left = -drift_gain * distance * turn
            # On an arc the platform moves along its chord, which is shorter and turned half way.
            middle = turn / 2 if exact else 0.0
            if not math.isfinite(heading + middle):
                middle = 0.0  # the pose is infinite in any case
            chord = math.sin(middle) / middle if middle else 1.0
            cos, sin = math.cos(heading + middle), math.sin(heading + middle)
            ahead, left_over = chord * distance, chord * drift_left
            return drifting_step(x, y, heading, cos, sin, ahead, turn, 0.0, left_over, 0.0)

        return step
