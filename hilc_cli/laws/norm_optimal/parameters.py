"""The parameters of the norm-optimal law, each with a meaning on the floor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class NormOptimalParameters:
    """What the norm-optimal law is told.

    An error is weighted by what counts as one: the cost of an iteration is half the sum, over all
    samples, of (position error / position)^2 + (heading error / heading)^2 + (change of each
    wheel's speed / input_change)^2. Only the ratios matter.

    Attributes:
        position: A position error that counts as one [m], > 0.
        heading: A heading error that counts as one [rad], > 0. Large against position / step
            length, or the heading's own samples, tangents of the path, keep the platform off it.
        input_change: A change of a wheel speed from one iteration to the next that counts as one
            [rad/s], > 0. Smaller: slower learning, less of one iteration's noise in the next.
        feedback: lqr: the regulator about the planned motion runs in the iteration; none: the
            learned wheel speeds alone.
        feedback_position: As `position`, for the regulator [m]. Smaller: stiffer, and more of the
            measured output's noise on the wheels.
        feedback_heading: As `heading`, for the regulator [rad].
        identify: Whether wheel radius and half track are estimated anew after each iteration.
        h: Samples within which the platform shall be on the trajectory after an initial error,
            where the speed limit allows it, >= 1.
        memory: Number of iterations over which motion that the model does not explain is
            averaged, >= 1; without identification always the last one alone.
    """

    position: float = 1e-3
    heading: float = 0.05
    input_change: float = 10.0
    feedback: Literal["lqr", "none"] = "lqr"
    feedback_position: float = 1e-2
    feedback_heading: float = 0.1
    identify: bool = True
    h: int = 200
    memory: int = 4

    @property
    def squared_weights(self) -> tuple[float, float, float]:
        """The weights of a squared position error, heading error and wheel speed in learning."""
        return self.position**-2, self.heading**-2, self.input_change**-2
