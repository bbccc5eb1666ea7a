"""What stands between the wheel speeds that a robot is told and its motion on the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hilc_cli.plants.motor import Motor
from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True)
class Slip:
    """What the tyres lose.

    Attributes:
        longitudinal: Share of each wheel's way that is lost, from 0 to below 1.
        lateral: Drift to the outside of a bend, by forward speed and yaw rate [s], >= 0.
    """

    longitudinal: float = 0.0
    lateral: float = 0.0


IDEAL_MOTOR, NO_SLIP = Motor(), Slip()


class LaneWheels(NamedTuple):
    """What the batch engine runs between the wheel speeds that are sent and the motion.

    Attributes:
        left_gain: What the left wheel's turn moves the wheel midpoint [m/rad].
        right_gain: Likewise the right wheel's.
        per_half_track: By which the difference of both ways turns the platform [rad/m].
        drift_gain: See `drift_out_of_bend`; 0 for none.
        exact: Whether the platform moves on an arc in each sample.
        whole: Samples until an input begins to arrive.
        fraction: Share of a sample that it arrives later.
        dead_zone: See `wheel_turn`, as the next ones.
        followed: Likewise.
        most: Likewise.
        lag: Likewise.
    """

    left_gain: float
    right_gain: float
    per_half_track: float
    drift_gain: float
    exact: bool
    whole: int
    fraction: float
    dead_zone: float
    followed: float
    most: float
    lag: float

    @property
    def is_late(self) -> bool:
        """Whether inputs arrive late."""
        return self.whole > 0 or self.fraction > 0

    @property
    def has_motors(self) -> bool:
        """Whether wheels do not turn at once as fast as what has arrived."""
        return self.lag > 0 or self.dead_zone > 0 or math.isfinite(self.most)

    @property
    def is_bent(self) -> bool:
        """Whether the platform moves otherwise than straight ahead in each sample."""
        return self.exact or self.drift_gain > 0


@dataclass(frozen=True, slots=True)
class Drivetrain:
    """Wheels, motors and tyres: those that a robot has, or those that a controller believes in.

    What they make of wheel speeds is told by *effective* speeds: those of the paper's equal wheels,
    which go as far in each sample.

    Attributes:
        left_radius: Of the left wheel [m].
        right_radius: Of the right wheel [m].
        motor: That of either wheel.
        slip: What the tyres lose.
    """

    left_radius: float
    right_radius: float
    motor: Motor = IDEAL_MOTOR
    slip: Slip = NO_SLIP

    @property
    def is_ideal(self) -> bool:
        """Whether equal wheels do at once what they are told and never slip, as in the paper."""
        return (
            self.left_radius == self.right_radius
            and self.motor == IDEAL_MOTOR
            and self.slip == NO_SLIP
        )

    @property
    def figures(self) -> dict[str, float]:
        """What wheels and motors are like, by the columns of ``learning.csv``."""
        motor = self.motor
        return {
            "left_per_right_radius": self.left_radius / self.right_radius,
            "delay_and_lag_s": motor.delay + motor.lag,
            "delay_s": motor.delay,
            "lag_s": motor.lag,
            "friction_rad_s": motor.dead_zone,
        }

    def shares(self, wheel_radius: float) -> tuple[float, float]:
        """Returns effective speed by wheel speed, left and right, for equal wheels' radius [m]."""
        kept = (1 - self.slip.longitudinal) / wheel_radius
        return kept * self.left_radius, kept * self.right_radius

    def effective(
        self, left: Floats, right: Floats, wheel_radius: float, sample_time: float
    ) -> tuple[Floats, Floats]:
        """Returns the effective speeds that arrive when wheel speeds are sent to wheels at rest.

        Args:
            left: Sent to the left wheel [rad/s], shape (n,).
            right: Sent to the right wheel [rad/s], shape (n,).
            wheel_radius: Of equal wheels [m].
            sample_time: d_t [s].
        """
        left_share, right_share = self.shares(wheel_radius)
        turned = [
            np.fromiter(map(self.motor.wheel(sample_time), sent.tolist()), float, len(sent))
            for sent in (left, right)
        ]
        return left_share / sample_time * turned[0], right_share / sample_time * turned[1]

    def inputs_for(
        self, left: Floats, right: Floats, wheel_radius: float, sample_time: float
    ) -> tuple[Floats, Floats]:
        """Returns what to send so that effective speeds arrive, but for what friction takes.

        The inverse of `effective`, as far as there is one: see `Motor.inputs_for`.
        """
        left_share, right_share = self.shares(wheel_radius)
        motor = self.motor
        return (
            motor.inputs_for(left / left_share, sample_time),
            motor.inputs_for(right / right_share, sample_time),
        )

    def sent_for(
        self, left: Floats, right: Floats, wheel_radius: float, sample_time: float
    ) -> tuple[Floats, Floats]:
        """Returns what to send so that effective speeds arrive, friction included."""
        wheels = self.inputs_for(left, right, wheel_radius, sample_time)
        left, right = map(self.motor.against_friction, wheels)
        return left, right

    def lane_wheels(self, signed_half_track: float, exact: bool, sample_time: float) -> LaneWheels:
        """Returns the wheels of a platform for the batch engine.

        Args:
            signed_half_track: B_c [m].
            exact: Whether it moves on an arc in each sample.
            sample_time: d_t [s].
        """
        motor, slip = self.motor, self.slip
        half = (1 - slip.longitudinal) / 2
        return LaneWheels(
            half * self.left_radius,
            half * self.right_radius,
            1 / signed_half_track,
            slip.lateral / sample_time,
            exact,
            *motor.samples_late(sample_time),
            motor.dead_zone,
            motor.followed(sample_time),
            motor.acceleration * sample_time,
            motor.lag,
        )

    def effective_limit(self, speed_limit: float, wheel_radius: float) -> float:
        """Returns the effective speed [rad/s] that either wheel can have within a speed limit."""
        return max(speed_limit - self.motor.dead_zone, 0.0) * min(self.shares(wheel_radius))
