"""The bounds beside what a simulated or logged run did.

What is compared, exactly: for every iteration i that is given, the lambda-norms of u_d - u_i,
q_d - q_i and y_d - y_i with the bounds for that iteration, Eqs. 38, 40 and 42. The limits of
Eqs. 39, 41 and 43 speak of infinitely many iterations; after finitely many the transient
A^i ||du_0||, carried through Eq. 40 for the state, is added to them, and the sum is compared with
the last iterations.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.theory.matrices import Desired, desired_motion
from hilc_cli.theory.proof.bounds import Bounds, state_series
from hilc_cli.theory.proof.norms import input_norm, log_lambda_norm, pose_norm

ROUNDING = 1e-9
"""Errors below this part of the reference or of u_d are rounding: they violate no bound."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One quantity beside its bounds; decimal logarithms of lambda-norms.

    Attributes:
        measured: Of each iteration, shape (iterations,); minus infinity for no error at all.
        bound: For each iteration, shape (iterations,).
        transient: What is to be added to the limit in each iteration, shape (iterations,).
        limit: Of the lim sup; infinite if there is none.
        rounding: Errors up to here are rounding.
    """

    measured: Floats
    bound: Floats
    transient: Floats
    limit: float
    rounding: float

    @property
    def looseness(self) -> Floats:
        """log10(bound / measured) of each iteration: below 0 where the bound is violated."""
        with np.errstate(invalid="ignore"):  # no error, and a bound that says so
            loose = self.bound - self.measured
        return np.where(np.isnan(loose), 0.0, loose)

    @property
    def violated(self) -> NDArray[np.int64]:
        """Positions of the iterations that exceed their bound."""
        return self._above(self.bound)

    def over_last(self, count: int) -> float:
        """The largest over the last iterations, the nearest that a run comes to a lim sup."""
        return float(self.measured[-count:].max())

    def limit_looseness(self, count: int) -> float:
        """log10(limit / measured) over the last iterations, without the transient."""
        last = self.over_last(count)
        return 0.0 if last == self.limit else self.limit - last

    def limit_violated(self, count: int) -> bool:
        """Whether one of the last iterations exceeds the limit and the transient together."""
        allowed = np.logaddexp(self.limit * math.log(10), self.transient * math.log(10))
        above = self._above(allowed / math.log(10))
        return bool((above >= len(self.measured) - count).any())

    def _above(self, bound: Floats) -> NDArray[np.int64]:
        # A bound that is attained may be missed by its own rounding.
        exceeds = (self.measured > bound + ROUNDING) & (self.measured > self.rounding)
        return np.flatnonzero(exceeds)


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """A run beside one set of bounds.

    Attributes:
        bounds: The bounds.
        input: ||u_d - u_i|| with Eqs. 38 and 39.
        state: ||q_d - q_i|| with Eqs. 40 and 41.
        output: ||y_d - y_i|| with Eqs. 42 and 43; y is what the controller sees.
    """

    bounds: Bounds
    input: Measured
    state: Measured
    output: Measured

    @property
    def parts(self) -> Mapping[str, Measured]:
        """The three by name."""
        return {"input": self.input, "state": self.state, "output": self.output}


def compare(
    experiment: Experiment, theories: Mapping[str, Bounds], trials: Iterable[Trial]
) -> dict[str, Comparison]:
    """Measures a run in the norms of each set of bounds.

    Args:
        experiment: What was run; its disturbance gives the measured outputs.
        theories: Bounds by name.
        trials: Iterations of the run, at least one; they are gone through once, and not kept.

    Returns:
        The comparisons by the same names.
    """
    desired, poses = desired_motion(experiment), experiment.reference.poses
    numbers: list[int] = []
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in theories}
    for trial in trials:
        numbers.append(trial.iteration)
        inputs = desired.inputs - np.column_stack([trial.left, trial.right])
        states = poses - np.column_stack([trial.x, trial.y, trial.heading])
        alpha = experiment.disturbance.of_output(trial.iteration, len(states))
        outputs = states if alpha is None else states - alpha  # Eq. 42
        errors = pose_norm(states), pose_norm(outputs)
        for name, theory in theories.items():
            norms = (input_norm(inputs, theory.constants.wheels), *errors)
            rows[name].append(tuple(log_lambda_norm(norm, theory.lambda_) for norm in norms))
    return {
        name: _beside(theory, desired, poses, np.array(numbers), np.array(rows[name]))
        for name, theory in theories.items()
    }


def _beside(
    theory: Bounds, desired: Desired, poses: Floats, numbers: NDArray[np.int64], norms: Floats
) -> Comparison:
    """Returns one set of bounds beside natural logarithms of norms, a column for each quantity."""
    c = theory.constants
    transient = theory.transient(numbers)
    in_state = transient + math.log10(c.b_B * state_series(c, theory.lambda_))
    input_rounding = _rounding(input_norm(desired.inputs, c.wheels))
    pose_rounding = _rounding(pose_norm(poses))
    measured = norms.T / math.log(10)
    return Comparison(
        theory,
        Measured(measured[0], theory.input(numbers), transient, theory.input_limit, input_rounding),
        Measured(measured[1], theory.state(numbers), in_state, theory.state_limit, pose_rounding),
        Measured(measured[2], theory.output(numbers), in_state, theory.output_limit, pose_rounding),
    )


def _rounding(norms: Floats) -> float:
    return math.log10(ROUNDING * max(1.0, float(norms.max())))
