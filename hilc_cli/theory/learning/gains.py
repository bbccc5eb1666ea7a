"""What law pid makes of the error that a sample's wheel speeds cause: its condition to converge."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.pid import PidLaw, next_error_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.yaml_input.expressions import Affine

MARGIN = 1e-9
"""Beyond what rounding may make of a limiting case."""
_FACTOR = 10.0  # a gain matrix that is off by more hardly is so on purpose


def loop_gains(matrix: GainMatrix, robot: Robot, heading: Floats) -> NDArray[np.complex128]:
    """Eigenvalues of L(k) B(q_k), the gain matrix times the control matrix of Eq. 9.

    With Eq. 45 and the true parameters both are 1: the correction of a sample's wheel speeds then
    moves the robot one sample time times the error. An iteration of Eq. 17 multiplies the part of
    the error at k + 1 that the wheel speeds at k cause by 1 - d_k l1 times the eigenvalue.

    Args:
        matrix: Before its scalar gain.
        robot: The platform as it really is.
        heading: At which both matrices are taken [rad], shape (n,).

    Returns:
        Shape (n, 2), dimensionless.

    Source:
        Qiao et al. 2021, Eqs. 9, 17 and 45.
    """
    cos, sin = np.cos(heading), np.sin(heading)

    def row(entries: tuple[Affine, Affine, Affine]) -> tuple[Floats, Floats]:
        """What a wheel gets of an error of 1 ahead, and of 1 in heading."""
        x, y, turn = (entry.constant + entry.cos * cos + entry.sin * sin for entry in entries)
        return x * cos + y * sin, turn

    (left_ahead, left_turn), (right_ahead, right_turn) = row(matrix.left), row(matrix.right)
    forward, turning = robot.wheel_radius / 2, robot.wheel_radius / (2 * robot.signed_half_track)
    # The product the other way round: what the platform does of an error ahead and in heading.
    left_ahead, right_ahead = forward * left_ahead, forward * right_ahead
    left_turn, right_turn = turning * left_turn, turning * right_turn
    half_trace = (left_ahead + right_ahead + left_turn - right_turn) / 2
    # Of two products of 2x2 matrices: the determinants' product.
    determinant = -2 * (left_ahead * right_turn - left_turn * right_ahead)
    root = np.sqrt(np.asarray(half_trace**2 - determinant, dtype=np.complex128))
    return np.stack([half_trace + root, half_trace - root], axis=-1)


def loop_gains_of(experiment: Experiment, matrix: GainMatrix) -> NDArray[np.complex128]:
    """Returns the loop gains of a gain matrix along an experiment's reference, shape (n, 2)."""
    return loop_gains(matrix, experiment.robot, experiment.reference.heading[:-1])


def wrong_way(gains: NDArray[np.complex128]) -> str:
    """What to say of a gain matrix that turns errors the wrong way; empty if it does not."""
    wrong = (gains.real <= MARGIN * np.abs(gains).max()).any(axis=1)
    if not wrong.any():
        return ""
    return (
        "controller.gain_matrix corrects some errors the wrong way, or not at all, at "
        f"{np.count_nonzero(wrong)} of {len(wrong)} samples, at first at sample "
        f"{int(wrong.argmax())}; its first row is the left wheel, its second the right one"
    )


def unseen(matrix: GainMatrix) -> str:
    """Of the component of an error of which the wheels hear nothing."""
    if matrix.is_kinematic:
        return "the law sees no error across the heading"
    return "the law does not see what controller.gain_matrix turns to zero"


def strength_findings(experiment: Experiment, matrix: GainMatrix) -> list[str]:
    """Returns what is to be said of how strongly a gain matrix acts on the true platform."""
    strength = np.abs(loop_gains_of(experiment, matrix))
    weakest, strongest = float(strength.min()), float(strength.max())
    if not matrix.is_kinematic or (weakest >= 1 / _FACTOR and strongest <= _FACTOR):
        return []
    if not math.isfinite(strongest):
        return []  # told of learning
    least, most = f"{weakest:.3g}", f"{strongest:.3g}"
    return [
        "controller.gain_matrix acts on the true robot with "
        f"{least if least == most else f'{least} to {most}'} times the strength "
        "of Eq. 45 with its true R and B; check the units of robot and model, or make up for it in "
        "controller.gains"
    ]


@dataclass(frozen=True, slots=True, eq=False)
class StepGain:
    """The numbers s of each sample: an iteration leaves kept - s of what is wrong with its speeds.

    Learning without a Q-filter converges where all |kept - s| are below 1. With D-type learning,
    Eq. 45 and nothing forgotten s is kd R / R_b along the path and kd R B_b / (R_b B) in turning.

    Attributes:
        kept: 1 - gamma.
        time: kd + kp d_t + ki d_t^2 [s]: what multiplies the loop gains.
        loop: Eigenvalues g of the gain matrix times the true control matrix, dimension of 1/s,
            shape (n, 2); s is their product with the time.
        along: s along the path, of a matrix of the form of Eq. 45; None for another one.
        turning: Likewise in turning.
        is_filtered: Whether the law has a Q-filter: then they tell of what passes it along a line.
    """

    kept: float
    time: float
    loop: NDArray[np.complex128]
    along: float | None
    turning: float | None
    is_filtered: bool

    @property
    def left(self) -> float:
        """The largest |kept - s|: below 1 each sample converges."""
        return float(np.abs(self.kept - self.time * self.loop).max())

    @property
    def bounds(self) -> tuple[float, float]:
        """Between these a real s must be."""
        return self.kept - 1, self.kept + 1

    @property
    def largest_time(self) -> float:
        """The time up to which all |kept - s| are below 1 [s]; 0 if there is none."""
        real, size = self.loop.real, np.abs(self.loop)
        # t^2 |g|^2 - 2 t kept Re g + kept^2 = 1; where nothing is kept back, t = 2 Re g / |g|^2.
        root = np.sqrt((self.kept * real) ** 2 + size**2 * (1 - self.kept) * (1 + self.kept))
        with np.errstate(divide="ignore", invalid="ignore"):
            largest = (self.kept * real + root) / size**2
        return float(np.where(size > 0, largest, 0.0 if self.kept == 1 else np.inf).min())


def step_gain(experiment: Experiment, law: PidLaw) -> StepGain:
    """The step gains of law pid on an experiment, along its reference."""
    robot, sample_time = experiment.robot, experiment.reference.sample_time
    time = sample_time * next_error_gain(law.gains, sample_time)
    loop = loop_gains_of(experiment, law.matrix)
    along, turning = None, None
    if law.matrix.is_kinematic:
        coefficients = law.matrix.coefficients
        along = time * robot.wheel_radius * coefficients[1]
        turning = time * robot.wheel_radius * coefficients[6] / robot.signed_half_track
    return StepGain(1 - law.forgetting, time, loop, along, turning, law.cutoff is not None)


def step_gain_row(found: StepGain) -> tuple[str, str]:
    """The condition of law pid."""
    low, high = found.bounds
    needed = f"{low:.4g} < s < {high:.4g}"
    if found.along is not None and found.turning is not None:
        text = f"{found.along:.4g} along the path, {found.turning:.4g} in turning"
    else:
        sizes = np.abs(found.time * found.loop)
        text = f"of absolute value {sizes.min():.4g} to {sizes.max():.4g}"
        needed = f"|{found.kept:.4g} - s| < 1"
    violated = "" if found.left < 1 else ", violated"
    return "Step gain s", f"{text}; needed: {needed}{violated}"


def step_gain_document(found: StepGain) -> dict[str, object]:
    """Returns the condition of law pid as JSON."""
    low, high = found.bounds
    return {
        "step_gain_along": found.along,
        "step_gain_turning": found.turning,
        "step_gain_above": low,
        "step_gain_below": high,
        "step_gain_leaves": found.left,
        "condition_holds": found.left < 1,
    }
