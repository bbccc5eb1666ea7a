"""The motion at which learning stands still, exactly and without linearising.

In equilibrium the law adds nothing: at each sample k the gain matrix, taken at the heading there,
sends its sum of errors to zero. These are two equations for the three errors of the next sample.
The third is the plant's: whatever the wheels do, the platform does not move sideways. Together
they give the error of sample k + 1 from what is known at sample k, so that one pass over the
trajectory is the solution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.compensation import compensation_gain
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.reference.sampled import Floats

Triple = tuple[float, float, float]

_LARGEST = 1e140  # errors beyond this count as not finite, as in a simulation


@dataclass(frozen=True, slots=True, eq=False)
class Equilibrium:
    """What remains when an experiment without limit and disturbance learns nothing any more.

    Attributes:
        error: Errors in x [m], y [m] and heading [rad] at each sample, shape (n + 1, 3).
        sideways: Error to the left of the reference's heading [m], shape (n + 1,).
        along: Error ahead along it [m], shape (n + 1,).
    """

    error: Floats
    sideways: Floats
    along: Floats

    @property
    def position_error(self) -> Floats:
        """Distance from the reference at each sample [m], shape (n + 1,)."""
        return np.hypot(self.error[:, 0], self.error[:, 1])


def equilibrium(experiment: Experiment) -> Equilibrium | None:
    """The equilibrium of an experiment's law.

    It is the one motion that the law leaves as it is; whether learning gets there is another
    question. Disturbances and the speed limit are left out.

    Args:
        experiment: With the hybrid law, its gain matrix taken at the running iteration's heading.

    Returns:
        The equilibrium; None if there is none within the finite numbers, such as with l1 = 0, or
        with so much feedback that its errors grow from sample to sample.

    Raises:
        UsageError: The law is none that this is known for.

    Source:
        Qiao et al. 2021, Eqs. 8, 17 and 21 with u_{i+1} = u_i.
    """
    law, reference = experiment.law, experiment.reference
    if not isinstance(law, HybridLaw) or law.gain_heading == "reference":
        raise UsageError("the equilibrium is known for the hybrid law's measured heading only")
    if law.l1 == 0:
        return None
    x, y, heading = (values.tolist() for values in (reference.x, reference.y, reference.heading))
    start = (
        x[0] - experiment.initial_pose[0],
        y[0] - experiment.initial_pose[1],
        heading[0] - experiment.initial_pose[2],
    )
    errors = [start]
    before: Triple = (0.0, 0.0, 0.0)  # e(-1) = 0
    for k in range(reference.samples):
        now = errors[k]
        if law.compensation:
            weight = compensation_gain(k, law.h, reference.sample_time)
            known = tuple(weight * error for error in start)  # Eq. 21
        else:
            known = tuple(  # Eq. 17
                (law.l2 * error + law.l3 * earlier) / law.l1
                for error, earlier in zip(now, before, strict=True)
            )
        turned = heading[k] - now[2]
        # The reference's own step, seen from the side of the platform.
        beside = -math.sin(turned), math.cos(turned)
        drift = beside[0] * (now[0] + x[k + 1] - x[k]) + beside[1] * (now[1] + y[k + 1] - y[k])
        following = _next_error(law.matrix, turned, known, beside, drift)
        if following is None:
            return None
        before = now
        errors.append(following)
    error = np.array(errors)
    cos, sin = np.cos(reference.heading), np.sin(reference.heading)
    return Equilibrium(
        error,
        sideways=cos * error[:, 1] - sin * error[:, 0],
        along=cos * error[:, 0] + sin * error[:, 1],
    )


def _next_error(
    matrix: GainMatrix,
    heading: float,
    known: tuple[float, ...],
    beside: tuple[float, float],
    drift: float,
) -> Triple | None:
    """Solves G [e(k+1) + known] = 0 and beside . e(k+1) = drift for e(k+1)."""
    left, right = matrix.at(math.cos(heading), math.sin(heading))
    # What G sends to zero are the multiples of the cross product of its rows.
    free = (
        left[1] * right[2] - left[2] * right[1],
        left[2] * right[0] - left[0] * right[2],
        left[0] * right[1] - left[1] * right[0],
    )
    across = beside[0] * free[0] + beside[1] * free[1]
    if across == 0:
        return None
    multiple = (drift + beside[0] * known[0] + beside[1] * known[1]) / across
    error = (
        multiple * free[0] - known[0],
        multiple * free[1] - known[1],
        multiple * free[2] - known[2],
    )
    return error if all(abs(part) <= _LARGEST for part in error) else None
