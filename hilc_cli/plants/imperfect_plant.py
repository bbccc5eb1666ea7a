"""A plant whose motors and wheels are those of real robots."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hilc_cli.plants.drivetrain import Drivetrain, LaneWheels
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
        motor = self.drivetrain.motor
        left_wheel, right_wheel = motor.wheel(sample_time), motor.wheel(sample_time)
        left_gain, right_gain, half_track, drift_gain, exact = self.moves(sample_time)

        def step(pose: Pose, left: float, right: float) -> Pose:
            x, y, heading = pose
            return rolling_step(
                x, y, heading, left_wheel(left), right_wheel(right),
                left_gain, right_gain, half_track, drift_gain, exact,
            )  # fmt: skip

        return step

    def moves(self, sample_time: float) -> tuple[float, float, float, float, bool]:
        """Returns what `rolling_step` takes of the platform."""
        drivetrain = self.drivetrain
        slip, half = drivetrain.slip, (1 - drivetrain.slip.longitudinal) / 2
        return (
            half * drivetrain.left_radius,
            half * drivetrain.right_radius,
            self.robot.signed_half_track,
            slip.lateral / sample_time,
            self.exact,
        )

    def lane_wheels(self, sample_time: float) -> LaneWheels:
        """Returns all that there is of wheels, motors and tyres."""
        return self.drivetrain.lane_wheels(self.robot.signed_half_track, self.exact, sample_time)


def rolling_step(
    x: float,
    y: float,
    heading: float,
    left_turn: float,
    right_turn: float,
    left_gain: float,
    right_gain: float,
    half_track: float,
    drift_gain: float,
    exact: bool,
) -> Pose:
    """Pose one sample later.

    Args:
        x: Of the wheel midpoint [m].
        y: Likewise [m].
        heading: [rad].
        left_turn: By which the left wheel turns [rad].
        right_turn: Likewise the right wheel.
        left_gain: What a turn of the left wheel moves the midpoint [m/rad].
        right_gain: Likewise of the right wheel.
        half_track: With its sign [m].
        drift_gain: See `drift_out_of_bend`.
        exact: Whether it moves on an arc.
    """
    left_way, right_way = left_gain * left_turn, right_gain * right_turn
    distance, turn = left_way + right_way, (left_way - right_way) / half_track
    drift_left = drift_out_of_bend(distance, turn, drift_gain)
    # On an arc the platform moves along its chord, which is shorter and turned half way.
    middle = turn / 2 if exact else 0.0
    if not math.isfinite(heading + middle):
        middle = 0.0  # the pose is infinite in any case
    chord = chord_per_arc(middle, math.sin(middle))
    cos, sin = math.cos(heading + middle), math.sin(heading + middle)
    ahead, left_over = chord * distance, chord * drift_left
    return drifting_step(x, y, heading, cos, sin, ahead, turn, 0.0, left_over, 0.0)


def drift_out_of_bend(distance: float, turn: float, drift_gain: float) -> float:
    """How far the platform slides to its left in a sample [m].

    Args:
        distance: That it rolls ahead [m].
        turn: By which it turns [rad].
        drift_gain: Lateral slip by the sample time [1/rad].
    """
    return -drift_gain * distance * turn


def chord_per_arc(half_turn: float, sin_half_turn: float) -> float:
    """Length of an arc's chord by that of the arc.

    Args:
        half_turn: Half the angle by which the arc turns [rad].
        sin_half_turn: Its sine, computed by the caller its own way.
    """
    return sin_half_turn / half_turn if half_turn else 1.0
