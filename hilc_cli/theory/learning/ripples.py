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
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.pid import LowPass, PidLaw
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.gains import loop_gains
from hilc_cli.theory.matrices import learning_law

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
        experiment: With the hybrid law or law pid; the speed limit is left out.

    Raises:
        UsageError: The law is another one.
    """
    law, reference = learning_law(experiment), experiment.reference
    eigenvalues = loop_gains(law.matrix, experiment.robot, reference.heading[:-1])
    # The same ones over and over, but for rounding, if the matrix has the form of Eq. 45.
    gains = np.unique(eigenvalues.round(12))[:, None]
    longest = min(LONGEST_PERIOD, max(2, reference.samples / _LEAST_PERIODS))
    frequencies = np.linspace(2 * np.pi / longest, np.pi, _FREQUENCIES)
    if isinstance(law, PidLaw):
        all_factors = _pid_factors(law, gains, frequencies, reference.sample_time)
    else:
        all_factors = _hybrid_factors(law, gains, frequencies, reference.sample_time)
    factors = all_factors.max(axis=0)
    worst = int(factors.argmax())
    return RippleGrowth(float(factors[worst]), float(2 * np.pi / frequencies[worst]))


def _hybrid_factors(
    law: HybridLaw, gains: NDArray[np.complex128], frequencies: Floats, sample_time: float
) -> Floats:
    """Of loop gains, shape (m, 1), and frequencies in radians per sample, shape (p,)."""
    l2, l3 = (0.0, 0.0) if law.compensation else (law.l2, law.l3)  # Eq. 21 has neither
    back, gains = np.exp(-1j * frequencies), sample_time * gains  # 1 / z
    learned = np.abs(1 - back - law.l1 * gains)
    fed_back = np.abs(1 - back + gains * (l2 * back + l3 * back**2))
    factors: Floats = learned / fed_back
    return factors


def _pid_factors(
    law: PidLaw, gains: NDArray[np.complex128], frequencies: Floats, sample_time: float
) -> Floats:
    """The same of law pid."""
    summed = sample_time / (1 - np.exp(-1j * frequencies))
    time = law.kp * summed + law.ki * summed**2 + law.kd
    factors: Floats = np.abs(1 - law.forgetting - gains * time)
    if law.cutoff is None:
        return factors
    return factors * LowPass(law.cutoff, sample_time).factors(frequencies)
