"""What the gain matrix makes of errors on the true platform: of a sample's own, and of ripples.

A ripple is told by its frequency. Over a few samples the plant is an integrator, whatever the path.
Along an eigenvector of the gain matrix times the control matrix, with eigenvalue c d_k, an
iteration of Eq. 17 then multiplies a ripple z^k by

    (1 - 1/z - l1 c d_k) / (1 - 1/z + c d_k (l2 / z + l3 / z^2)),   z = exp(i phi),

which for small gains is 1 - c d_k (l1 - l2 - l3 (1 + 2 cos phi)) / 2. So feedback and learning do
not add up, as Eq. 19 has it: where l2 + 3 l3 > l1 slow ripples grow from iteration to iteration,
and where l2 > l1 + l3 the fastest do. All eigenvalues of the iteration may well lie within one
then: they tell of the limit only, ripples of the many iterations before it.

An iteration of law pid, which has no feedback, multiplies it by

    Q(phi) [1 - gamma - c (kp d_k / (1 - 1/z) + ki d_k^2 / (1 - 1/z)^2 + kd)].

Only periods up to LONGEST_PERIOD samples are looked at. At longer ones the factor is above 1 even
for learning that goes well: without feedback it is about 1 - l1 c d_k + (l1 c d_k / phi)^2 when
squared, so that at a period of 1000 samples l1 = 1 and d_k = 1 ms give 1.012. There the integrator
adds up what is left along the path: a growth that ends with the path, which the largest singular
value and the predicted errors tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.linear_law import linear_law
from hilc_cli.theory.plain_arrays import distinct
from hilc_cli.yaml_input.expressions import Affine

MARGIN = 1e-9
"""Beyond what rounding may make of a limiting case."""
_FACTOR = 10.0  # a gain matrix that is off by more hardly is so on purpose
LONGEST_PERIOD = 20  # samples
_LEAST_PERIODS = 5  # of a ripple along the path: fewer are none
_FREQUENCIES = 200


def loop_gains(matrix: GainMatrix, robot: Robot, heading: Floats) -> NDArray[np.complex128]:
    """Returns the eigenvalues of L(k) B(q_k), the gain matrix times the control matrix of Eq. 9.

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
        """Returns what a wheel gets of an error of 1 ahead, and of 1 in heading."""
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
    """Tells which component of an error the wheels hear nothing of."""
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


@dataclass(frozen=True, slots=True)
class RippleGrowth:
    """The ripple that fares worst.

    Attributes:
        factor: What an iteration multiplies it by.
        period: Its period in samples, from 2 to LONGEST_PERIOD, on a short path to a fifth of it.
    """

    factor: float
    period: float


def ripple_growth(experiment: Experiment) -> RippleGrowth:
    """Returns the largest factor by which an iteration multiplies a ripple of the wheel speeds.

    The speed limit is left out.

    Raises:
        UsageError: The linear theory does not speak of the law.
    """
    law, reference = linear_law(experiment), experiment.reference
    eigenvalues = loop_gains_of(experiment, law.matrix)
    # The same ones over and over, but for rounding, if the matrix has the form of Eq. 45.
    gains = distinct(eigenvalues.round(12))[:, None]
    longest = min(LONGEST_PERIOD, max(2, reference.samples / _LEAST_PERIODS))
    frequencies = np.linspace(2 * np.pi / longest, np.pi, _FREQUENCIES)
    factors = law.ripple_factors(gains, frequencies).max(axis=0)
    worst = int(factors.argmax())
    return RippleGrowth(float(factors[worst]), float(2 * np.pi / frequencies[worst]))
