"""The bounds of the convergence proof in the lambda-norm, Eqs. 35 to 43: printed and corrected.

The lambda-norm is sup_k lambda**-k ||.(k)||. A bound in it says of sample k that ||.(k)|| is at
most lambda**k times as large. Numbers are kept as logarithms: lambda**k soon is too large for one.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.linear_law import paper_law
from hilc_cli.theory.matrices import desired_motion
from hilc_cli.theory.proof.constants import (
    ALL,
    PRINTED,
    Constants,
    Correction,
    constants,
    constants_within_limit,
    limited_inputs,
)
from hilc_cli.theory.proof.norms import input_norm, log_lambda_norm

AS_PRINTED = "as printed"
WITH_SAMPLE_TIME = "as printed, with the sample time"
CORRECTED = "corrected"
WITHIN_LIMIT = "corrected, within the speed limit"


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of input, state and output error, as decimal logarithms of lambda-norms.

    Attributes:
        constants: What they are made of.
        lambda_: lambda.
        A: Factor from iteration to iteration, Eq. 37.
        B: What is added in each, Eq. 37.
        start: log10 of the bound of ||du_0||, exact where u_0 is applied as it is.
    """

    constants: Constants
    lambda_: float
    A: float
    B: float
    start: float

    @property
    def has_limit(self) -> bool:
        """Whether the bounds stay finite over all iterations: A < 1."""
        return self.A < 1

    def input(self, iterations: ArrayLike) -> Floats:
        """Bound of ||du_i||, A^i ||du_0|| + B (1 - A^i) / (1 - A), Eq. 38.

        Args:
            iterations: Numbers i >= 0, any shape.

        Returns:
            log10 of the bound, of that shape.
        """
        count = np.asarray(iterations, dtype=np.float64)
        return _log10_sum(self.transient(count), _log10(self.B) + _log10_series(self.A, count))

    def state(self, iterations: ArrayLike) -> Floats:
        """Bound of ||dq_i||, Eq. 40; arguments and result as of `input`."""
        return self._state_after(self.input(iterations))

    def output(self, iterations: ArrayLike) -> Floats:
        """Bound of ||dy_i||, Eq. 42; minus infinity where the print bounds it by 0 or less."""
        return self._output_after(self.state(iterations))

    def transient(self, iterations: ArrayLike) -> Floats:
        """A^i ||du_0||, the part of Eq. 38 that the limit leaves out; as `input`."""
        count = np.asarray(iterations, dtype=np.float64)
        with np.errstate(invalid="ignore"):  # 0 times minus infinity
            power = np.where(count == 0, 0.0, count * _log10(self.A))
        total: Floats = power + self.start
        return total

    @property
    def input_limit(self) -> float:
        """log10 of the bound of lim sup ||du_i||, B / (1 - A), Eq. 39; infinite if A >= 1."""
        return float(_log10(self.B) - _log10(1 - self.A)) if self.has_limit else math.inf

    @property
    def state_limit(self) -> float:
        """log10 of the bound of lim sup ||dq_i||, Eq. 41."""
        return float(self._state_after(np.array(self.input_limit)))

    @property
    def output_limit(self) -> float:
        """log10 of the bound of lim sup ||dy_i||, Eq. 43."""
        return float(self._output_after(np.array(self.state_limit)))

    def at_sample(self, bound: float, k: int) -> float:
        """Returns log10 of what a bound says of ||.(k)|| at one sample."""
        return bound + k * math.log10(self.lambda_)

    def _state_after(self, inputs: Floats) -> Floats:
        c, series = self.constants, state_series(self.constants, self.lambda_)
        return _log10_sum(
            _log10(c.b_B * series) + inputs, _log10(c.b_beta * series), _log10(c.b_q0)
        )

    def _output_after(self, states: Floats) -> Floats:
        offset = self.constants.output_offset
        if offset >= 0:
            return _log10_sum(states, _log10(offset))
        with np.errstate(over="ignore", divide="ignore"):
            share = np.minimum(-offset * 10.0**-states, 1.0)
            less: Floats = states + np.log10(1 - share)
        return less


def bounds(experiment: Experiment, constants: Constants, lambda_: float | None = None) -> Bounds:
    """Returns the bounds of an experiment.

    Args:
        experiment: The experiment.
        constants: Its constants.
        lambda_: lambda; `suitable_lambda` by default.

    Raises:
        UsageError: lambda is not large enough.

    Source:
        Qiao et al. 2021, Eq. 37.
    """
    c = constants
    value = suitable_lambda(c, experiment.iterations) if lambda_ is None else lambda_
    least = smallest_lambda(c)
    if not value > least:
        raise UsageError(f"lambda must be above {least:.6g}, got {value:.6g}")
    series, feedback = state_series(c, value), c.h3 + c.b_L3
    rest = 1 - c.b_B * feedback * series
    A = (c.rho + c.b_B * c.h1 / (value - c.h2)) / rest  # Eq. 37
    B = ((c.h1 + feedback) * (c.b_q0 + c.b_beta * series) + c.b_1) / rest  # Eq. 37
    return Bounds(c, value, A, B, _start(experiment, c, value))


def theories(experiment: Experiment) -> dict[str, Bounds]:
    """Returns all bounds that can be given before a run, by name.

    Returns:
        ``as printed``: every equation as it stands; no bound of the simulated system.
        ``as printed, with the sample time``: with d_k B for B, else the same.
        ``corrected``: all corrections; holds in every iteration, and has a limit only where rho < 1
        for every heading that the law may use.
        ``corrected, within the speed limit``: all corrections, with rho on the reference; only with
        a speed limit.
        The first two are missing for a law with a derivative, of which nothing is printed; and
        those whose constants leave the range of floating point.

    Raises:
        UsageError: The law is not the hybrid law.
    """
    found = {}
    if paper_law(experiment).derivative == 0:
        found[AS_PRINTED] = constants(experiment, PRINTED)
        found[WITH_SAMPLE_TIME] = constants(experiment, {Correction.SAMPLE_TIME})
    found[CORRECTED] = constants(experiment, ALL)
    if math.isfinite(experiment.speed_limit):
        found[WITHIN_LIMIT] = constants_within_limit(experiment)
    all_bounds = {name: _bounds(experiment, each) for name, each in found.items()}
    return {name: each for name, each in all_bounds.items() if each is not None}


def _bounds(experiment: Experiment, found: Constants) -> Bounds | None:
    """Returns the bounds; None if there are no numbers for them."""
    numbers = [value for value in asdict(found).values() if not isinstance(value, str)]
    if not all(map(math.isfinite, [*numbers, smallest_lambda(found)])):
        return None
    made = bounds(experiment, found)
    return made if all(map(math.isfinite, (made.lambda_, made.A, made.B))) else None


def smallest_lambda(constants: Constants) -> float:
    """Returns h2 + b_B (b_L2 + b_L3), which lambda must exceed.

    The print wants lambda > max(1, h2, b_B (b_L2 + b_L3)) and concludes this from it, which does
    not follow: with less, the denominator of Eq. 37 can be negative.

    Source:
        Qiao et al. 2021, Eq. 35, the second line of its conclusion.
    """
    c = constants
    return c.h2 + c.b_B * (c.h3 + c.b_L3)


def suitable_lambda(constants: Constants, iterations: int) -> float:
    """Returns a lambda for Eq. 37, neither too small for A nor larger than need be.

    With rho < 1, A < 1 needs lambda > h2 + b_B (h1 + b_L2 + b_L3) / (1 - rho). Twice that distance
    from h2 is taken: then 1 - A is at least (1 - rho) / 2, half of what any lambda can give. With
    rho >= 1 there is no limit; the distance is as many times b_B (h1 + b_L2 + b_L3) as there are
    iterations, so that A^i grows little more than rho^i.

    Args:
        constants: The constants.
        iterations: N, the number of learning updates.

    Source:
        Qiao et al. 2021, Eqs. 35 and 39, which leave lambda open.
    """
    c = constants
    coupling = c.b_B * (c.h1 + c.h3 + c.b_L3)
    if coupling == 0:
        return 2 * c.h2
    found = c.h2 + coupling * (2 / (1 - c.rho) if c.rho < 1 else max(2, iterations))
    return max(found, smallest_lambda(c) * (1 + 1e-9))  # tiny gains are lost beside h2


def state_series(constants: Constants, lambda_: float) -> float:
    """(1 - (h2 / lambda)^n) / (lambda - h2), what an input error leaves in the state, Eq. 40."""
    c = constants
    # log(h2 / lambda) by their difference, which keeps its digits where lambda is next to h2.
    falls = -math.log1p((lambda_ - c.h2) / c.h2)
    return -math.expm1(c.samples * falls) / (lambda_ - c.h2)


def _start(experiment: Experiment, c: Constants, lambda_: float) -> float:
    """Returns log10 of the bound of ||du_0||."""
    initial = np.column_stack([experiment.initial_left, experiment.initial_right])
    if not experiment.learn_in_first:
        initial = limited_inputs(experiment, initial)
    difference = input_norm(desired_motion(experiment).inputs - initial, c.wheels)
    start = log_lambda_norm(difference, lambda_) / math.log(10)
    if not experiment.learn_in_first:
        return start
    # Eqs. 28 and 32 for u_0 = limited(u + L2 e_0(k) + L3 e_0(k-1)): no error has been learned from.
    series, feedback = state_series(c, lambda_), c.b_L2 + c.b_L3
    added = feedback * (c.b_q0 + c.b_alpha + c.b_beta * series) + c.b_s
    rest = 1 - c.b_B * feedback * series
    return float(_log10_sum(np.array(start), _log10(added)) - math.log10(rest))


def _log10(value: ArrayLike) -> Floats:
    """Returns log10, minus infinity for 0."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.log10(value))


def _log10_sum(*logarithms: Floats) -> Floats:
    """Returns log10 of a sum from the log10 of its terms."""
    terms = [np.asarray(term) * math.log(10) for term in logarithms]
    total = terms[0]
    for term in terms[1:]:
        total = np.logaddexp(total, term)
    result: Floats = total / math.log(10)
    return result


def _log10_series(A: float, count: Floats) -> Floats:
    """Returns log10 of (1 - A^i) / (1 - A) = 1 + A + ... + A^(i-1)."""
    if A in (0.0, 1.0):
        return _log10(np.minimum(count, 1.0) if A == 0 else count)
    # One minus the smaller of A^i and A^-i, and, where that was A^-i, A^i itself.
    growth = count * math.log(A)
    with np.errstate(divide="ignore"):
        sums = np.log(-np.expm1(-np.abs(growth))) + np.maximum(growth, 0.0) - math.log(abs(1 - A))
    series: Floats = sums / math.log(10)
    return series
