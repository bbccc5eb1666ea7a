"""A tracking controller without learning: what a robot reaches in its first pass."""

from __future__ import annotations

import math
from dataclasses import dataclass

from hilc_cli.laws.feedforward import reference_twist
from hilc_cli.laws.law import LastIteration, Learner, Task, WheelController
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Robot, wheel_speeds_from_twist


def tracking_twist(
    speed: float,
    yaw_rate: float,
    ahead: float,
    aside: float,
    error_heading: float,
    gains: tuple[float, float, float],
) -> tuple[float, float]:
    """Forward speed [m/s] and yaw rate [rad/s] that bring a platform back to its reference.

    Args:
        speed: v_r of the reference [m/s].
        yaw_rate: omega_r of the reference [rad/s].
        ahead: Error along the platform's heading [m].
        aside: Error to its left [m].
        error_heading: Error of the heading [rad].
        gains: K_x [1/s], K_y [rad/m^2] and K_theta [rad/m].

    Source:
        Kanayama, Kimura, Miyazaki and Noguchi 1990, A stable tracking control method for an
        autonomous mobile robot.
    """
    k_x, k_y, k_theta = gains
    return (
        speed * math.cos(error_heading) + k_x * ahead,
        yaw_rate + speed * (k_y * aside + k_theta * math.sin(error_heading)),
    )


@dataclass(frozen=True, slots=True)
class FeedbackLaw:
    """The tracking controller of Kanayama et al. 1990; iterations do not depend on each other.

    The reference's speeds are those of its next step; the wheels follow by the believed kinematics.

    Attributes:
        k_x: Gain of the error ahead [1/s], >= 0.
        k_y: Gain of the error aside [rad/m^2], >= 0.
        k_theta: Gain of the error of the heading [rad/m], >= 0.
        model: The platform as the controller believes it to be.
    """

    k_x: float
    k_y: float
    k_theta: float
    model: Robot

    def learner(self, task: Task) -> Learner:
        """The law, which will learn nothing."""
        return LastIteration(task, lambda last: self.controller(task.reference))

    def controller(self, reference: Reference) -> WheelController:
        """The controller of every iteration."""
        forward, turning = reference_twist(reference)
        speeds, yaw_rates = forward.tolist(), turning.tolist()
        gains = self.k_x, self.k_y, self.k_theta
        wheel_radius, half_track = self.model.wheel_radius, self.model.signed_half_track

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            speed, yaw_rate = tracking_twist(
                speeds[k],
                yaw_rates[k],
                cos * error_x + sin * error_y,
                cos * error_y - sin * error_x,
                error_heading,
                gains,
            )
            return wheel_speeds_from_twist(speed, yaw_rate, wheel_radius, half_track)

        return wheel_speeds
