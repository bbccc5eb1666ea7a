"""What hilc's own plants share below ``robot:``: wheels of their own sizes, and their motors."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import Field

from hilc_cli.plants.imperfections import MOTOR, MotorSpec, WheelRadii, WheelRadius
from hilc_cli.plants.parameters import RobotSpec


class WheeledSpec(RobotSpec):
    """A robot whose wheels may differ, and whose motors may be late."""

    wheel_radius: WheelRadius = Field(description="R_c [m]")  # type: ignore[assignment]  # or two
    motor: MotorSpec = Field(MOTOR, description="what the motors make of their inputs")

    def with_keys(self, keys: Iterable[str]) -> WheeledSpec:
        """Returns the same robot, with a radius for each wheel if a key leads to one."""
        if not any(key.startswith("wheel_radius.") for key in keys):
            return self
        left, right = self.wheel_radii
        return self.model_copy(update={"wheel_radius": WheelRadii(left=left, right=right)})

    @property
    def wheel_radii(self) -> tuple[float, float]:
        """Radius of the left and of the right wheel [m]."""
        radius: float | WheelRadii = self.wheel_radius
        return (radius.left, radius.right) if isinstance(radius, WheelRadii) else (radius, radius)

    @property
    def mean_wheel_radius(self) -> float:
        """The radius [m] of equal wheels that drive as far."""
        return sum(self.wheel_radii) / 2

    @property
    def wheel_acceleration(self) -> float:
        """The most that the speed of a wheel changes [rad/s^2]."""
        return self.motor.motor().acceleration

    def figures(self) -> dict[str, float]:
        """Returns what the wheels are like."""
        left, right = self.wheel_radii
        return {"left_per_right_radius": left / right}
