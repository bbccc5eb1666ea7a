"""What the linear theory predicts of the error of each iteration."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import first_within, settled_at
from hilc_cli.theory.learning.kinematic_iteration import Pass, passes
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.matrices import driven_errors, linearise

ITERATIONS = 5000
SAMPLES_OF_ALL_ITERATIONS = 12_000_000
"""So far is looked ahead if the experiment is shorter, whichever is less: a second at most."""
RANGE = 2.0
"""Times the path's size: larger predicted errors are out of the linear theory's range."""
MOST_SAMPLES = 36_000_000
"""No more samples of all iterations are followed of a longer experiment: a few seconds."""
SAMPLES_AS_LONG_AS_A_CALL = 1000
"""What an iteration costs beside its samples, counted in samples."""
FAR_HEADING = 1.0
"""Heading errors beyond which sines and cosines are no longer linear [rad]."""
ROUNDING = 1e-14
"""Wheel speeds that an iteration changes by no larger a share have come to rest."""

Measure = Callable[[int, Pass], float]
"""The largest position error of an iteration [m]; if it is not finite, the look ahead ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Transient:
    """The predicted errors.

    Attributes:
        path_size_m: Longer side of the trajectory's bounding box.
        max_position_error_m: Predicted for iterations 0..N, shape (N + 1,); infinite from the
            iteration on that left the finite numbers.
        max_heading_error_rad: Likewise.
    """

    path_size_m: float
    max_position_error_m: Floats
    max_heading_error_rad: Floats

    @property
    def iterations(self) -> int:
        """The horizon N."""
        return len(self.max_position_error_m) - 1

    @property
    def peak_iteration(self) -> int:
        """The iteration with the largest error, the first of them."""
        return int(self.max_position_error_m.argmax())

    @property
    def peak_growth(self) -> float:
        """The largest error as a multiple of that of iteration 0: 1 if it never grows."""
        peak, first = float(self.max_position_error_m.max()), float(self.max_position_error_m[0])
        if first == 0 or math.isinf(first):
            return 1.0 if peak == first else math.inf
        return peak / first

    def settled_at(self, share: float) -> int | None:
        """Returns `settled_at` of the errors, for a share of the path's size such as 0.01."""
        return settled_at(self.max_position_error_m, share * self.path_size_m)

    def first_within(self, share: float) -> int | None:
        """Returns `first_within` likewise; ripples that grow may come through later."""
        return first_within(self.max_position_error_m, share * self.path_size_m)

    def spell_within(self, share: float, iterations: int) -> tuple[int, int] | None:
        """Returns from when to when the error is at or below a share of the path's size.

        Args:
            share: Such as 0.01.
            iterations: Of the experiment.

        Returns:
            First and last iteration of the spell that holds the experiment's last iteration, of
            the first spell if none does; None if the error is never so small. A spell may end with
            the horizon.
        """
        within = self.max_position_error_m <= share * self.path_size_m
        if not within.any():
            return None
        iterations = min(iterations, self.iterations)
        inside = iterations if within[iterations] else int(within.argmax())
        before, after = np.flatnonzero(~within[:inside]), np.flatnonzero(~within[inside:])
        first = int(before[-1]) + 1 if len(before) else 0
        return first, inside + int(after[0]) - 1 if len(after) else self.iterations

    @property
    def range_m(self) -> float:
        """The largest error that the linear theory may tell of [m].

        That is RANGE times the path's size, or the error of iteration 0 if that is larger.
        """
        return RANGE * max(self.path_size_m, float(self.max_position_error_m[0]))

    @property
    def rough_from(self) -> int | None:
        """The first iteration that is out of the linear theory's range; None if there is none.

        Its position error is above `range_m`, and its heading is off by more than FAR_HEADING:
        so far away, the products of errors that a linear theory leaves out are as large as what
        it keeps. What is predicted of this iteration, and of all later ones, is rough. Without
        heading errors, as on a line, no position error is too large.
        """
        beyond = np.flatnonzero(
            (self.max_position_error_m > self.range_m) & (self.max_heading_error_rad > FAR_HEADING)
        )
        return int(beyond[0]) if len(beyond) else None

    def at(self, iteration: int) -> float | None:
        """Returns the predicted error of an iteration [m]; None beyond the horizon."""
        if iteration > self.iterations:
            return None
        return float(self.max_position_error_m[iteration])


def horizon(experiment: Experiment) -> int:
    """Returns how far to look ahead at a bounded cost: as far as the experiment goes, if it can be.

    The prediction of a very long experiment ends before it, at `Transient.iterations`.
    """
    samples = experiment.reference.samples
    beyond = min(ITERATIONS, SAMPLES_OF_ALL_ITERATIONS // samples)
    within = min(experiment.iterations, MOST_SAMPLES // (samples + SAMPLES_AS_LONG_AS_A_CALL))
    return max(beyond, within)


class ExactErrors:
    """The largest position errors of the exact plant, when it drives the inputs of passes [m]."""

    def __init__(self, experiment: Experiment) -> None:
        """Takes the experiment."""
        self._experiment = experiment
        self._feedforward = linearise(experiment).feedforward

    def __call__(self, iteration: int, passed: Pass) -> float:
        """Drives the input of a pass."""
        return largest(*driven_errors(self._experiment, *(passed.inputs + self._feedforward).T))


def largest(x: Floats, y: Floats) -> float:
    """The largest of errors in x and in y together."""
    squares = x * x
    squares += y * y
    return math.sqrt(squares.max())


def predict_transient(
    experiment: Experiment, iterations: int | None = None, measure: Measure | None = None
) -> Transient:
    """Returns the errors that follow from the experiment's first input by the linear theory.

    What is learned is predicted by the linear map of `LiftedIteration`, which holds to first order
    in the errors. The position error is then that of the exact plant when it drives the predicted
    input. The first iteration is thus exact if it learns nothing; the following ones are rough
    while the heading is off by a radian and more, as from an input of zero.

    Args:
        experiment: The experiment; its speed limit and its disturbances are left out.
        iterations: How far to look; `horizon` if not given.
        measure: What tells position errors; `ExactErrors` if not given.

    Raises:
        UsageError: The experiment's law is neither the hybrid law nor law pid.
    """
    last = horizon(experiment) if iterations is None else iterations
    measure = measure or ExactErrors(experiment)
    lifted, size = LiftedIteration(experiment), experiment.reference.size
    errors, headings = np.full((2, last + 1), math.inf)
    with np.errstate(over="ignore", invalid="ignore"):
        upcoming = passes(lifted)
        current = next(upcoming)
        for iteration in range(last + 1):
            error = measure(iteration, current)
            if not math.isfinite(error):
                break
            errors[iteration] = error
            headings[iteration] = np.abs(current.heading).max()
            previous, current = current, next(upcoming)
            # Errors are compared first since that costs nothing.
            changed = abs(error - errors[iteration - 1]) if iteration else math.inf
            if changed > 100 * ROUNDING * (error + size):
                continue
            speeds = current.inputs + lifted.plant.feedforward
            change = np.abs(current.inputs - previous.inputs).max()
            if change <= ROUNDING * np.abs(speeds).max():  # nothing changes from here on
                errors[iteration + 1 :] = error
                headings[iteration + 1 :] = headings[iteration]
                break
    return Transient(size, errors, headings)
