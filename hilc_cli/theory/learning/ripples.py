"""What an iteration does to ripples of the wheel speeds, by their frequency.

Over a few samples the plant is an integrator, whatever the path. Along an eigenvector of the gain
matrix times the control matrix, with eigenvalue c d_k, an iteration of Eq. 17 then multiplies a
ripple z^k by

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

from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.learning.gains import loop_gains
from hilc_cli.theory.linear_law import linear_law

LONGEST_PERIOD = 20  # samples
_LEAST_PERIODS = 5  # of a ripple along the path: fewer are none
_FREQUENCIES = 200


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
    """The largest factor by which an iteration multiplies a ripple of the wheel speeds.

    Args:
        experiment: With a law of which the linear theory speaks; the speed limit is left out.

    Raises:
        UsageError: It does not speak of the law.
    """
    law, reference = linear_law(experiment), experiment.reference
    eigenvalues = loop_gains(law.matrix, experiment.robot, reference.heading[:-1])
    # The same ones over and over, but for rounding, if the matrix has the form of Eq. 45.
    gains = np.unique(eigenvalues.round(12))[:, None]
    longest = min(LONGEST_PERIOD, max(2, reference.samples / _LEAST_PERIODS))
    frequencies = np.linspace(2 * np.pi / longest, np.pi, _FREQUENCIES)
    factors = law.ripple_factors(gains, frequencies).max(axis=0)
    worst = int(factors.argmax())
    return RippleGrowth(float(factors[worst]), float(2 * np.pi / frequencies[worst]))
