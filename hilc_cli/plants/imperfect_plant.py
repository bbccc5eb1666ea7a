"""A plant whose motors and wheels are those of real robots."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hilc_cli.plants.kinematic import Robot, drifting_step
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.plant import Plant, Pose, Step


@dataclass(frozen=True, slots=True)
class Slip:
    """What the tyres lose.

    Attributes:
        longitudinal: Share of each wheel's way that is lost, from 0 to below 1.
        lateral: Drift to the outside of a bend, by forward speed and yaw rate [s], >= 0.
    """

    longitudinal: float = 0.0
    lateral: float = 0.0


@dataclass(frozen=True)
class ImperfectPlant(Plant):
    """A platform with wheels of their own sizes, motors that are not at once, and slip.

    Its state is the pose, the speeds of both wheels and the inputs under way; each pass begins
    with the wheels at rest.

    Attributes:
        robot: The platform; its wheel radius is not used here.
        left_radius: Of the left wheel [m].
        right_radius: Of the right wheel [m].
        motor: That of either wheel.
        slip: What the tyres lose.
        exact: Whether the platform moves on the arc between two samples, instead of straight ahead
            and then turning (Eq. 8).
    """

    robot: Robot
    left_radius: float
    right_radius: float
    motor: Motor
    slip: Slip
    exact: bool

    def start(self, pose: Pose, sample_time: float) -> Step:
        """Starts a pass with both wheels at rest and no input under way."""
        left_wheel, right_wheel = self.motor.wheel(sample_time), self.motor.wheel(sample_time)
        half = (1 - self.slip.longitudinal) / 2
        left_gain, right_gain = half * self.left_radius, half * self.right_radius
        half_track, exact = self.robot.signed_half_track, self.exact
        drift_gain = self.slip.lateral / sample_time

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
