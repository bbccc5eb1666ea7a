"""What stands between the wheel speeds that a robot is told and its motion on the floor."""

from __future__ import annotations

from dataclasses import dataclass

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

    def effective_limit(self, speed_limit: float, wheel_radius: float) -> float:
        """Returns the effective speed [rad/s] that either wheel can have within a speed limit."""
        return max(speed_limit - self.motor.dead_zone, 0.0) * min(self.shares(wheel_radius))
