"""What stands between the wheel speeds that a robot is told and its motion on the floor."""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.plants.motor import Motor


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
