"""What becomes of learning after an experiment, without driving the input of every iteration."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.learning.kinematic_iteration import Pass
from hilc_cli.theory.learning.outcome import CLEARLY
from hilc_cli.theory.learning.transient import ExactErrors, Transient, largest, predict_transient
from hilc_cli.theory.matrices import linearise

_ROUNDING = 1e-9
"""Share of errors and of the path's size that is far more than rounding makes of them."""


def glance_ahead(
    experiment: Experiment, levels: tuple[float, ...], small: float
) -> Transient | None:
    """Returns the errors of the experiment's iterations, and of later ones as much as matters.

    Later ones may be those of the linear theory. Of them it is certain on which side of each level
    they are, and that none of them is CLEARLY larger than one before it, unless it is small.

    Args:
        experiment: The experiment.
        levels: Position errors [m].
        small: Up to where an error is small [m].

    Returns:
        The errors; None if later ones grow, leave the finite numbers, or may do so.
    """
    errors = _GlancedErrors(experiment, levels, small)
    found = predict_transient(experiment, measure=errors)
    return None if errors.grow else found


class _GlancedErrors:
    """Position errors as `glance_ahead` gives them.

    Attributes:
        grow: Whether one was found to be larger than it may be.
    """

    def __init__(self, experiment: Experiment, levels: tuple[float, ...], small: float) -> None:
        self._exact, self._bounds = ExactErrors(experiment), ErrorBounds(experiment)
        self._exact_until, self._levels, self._small = experiment.iterations, levels, small
        self._least, self.grow = math.inf, False

    def __call__(self, iteration: int, passed: Pass) -> float:
        """The error of an iteration [m]; infinite if it is larger than it may be."""
        if iteration <= self._exact_until:
            self._least = error = self._exact(iteration, passed)
            self.grow = not math.isfinite(error)
            return error
        for bounds in (self._bounds.of, self._bounds.closer):
            error, off = bounds(passed)
            if self._is_told_by(error - off, error + off):
                break
        else:
            error, off = self._exact(iteration, passed), 0.0
        self.grow = not error + off <= max(CLEARLY * self._least, self._small)
        self._least = min(self._least, error - off)
        return math.inf if self.grow else error

    def _is_told_by(self, low: float, high: float) -> bool:
        """Whether no more needs to be known of an error than what it lies between."""
        # A loose lower bound would let later errors seem to have grown.
        calm = high <= max(CLEARLY * min(self._least, low), self._small)
        return calm and not any(low <= level < high for level in self._levels)


class ErrorBounds:
    """What is known of a pass without driving it, and how far the exact plant may be from that.

    In a sample it drives exp(j heading) [v_d (1 - exp(-j e) - j e) - w (exp(-j e) - 1)] less than
    the linear one, with v_d the distance of the feedforward, w what the input changes of it, and e
    the error of the heading, which is linear in the input. That is |v_d| e^2 / 2 + |w e| at most;
    of second order it is exp(j heading) (v_d e^2 / 2 + j w e), and what is left of the exact one
    is |v_d| |e|^3 / 6 + |w| e^2 / 2 at most.
    """

    def __init__(self, experiment: Experiment) -> None:
        """Takes the experiment."""
        plant, self._size = linearise(experiment), experiment.reference.size
        self._steps = plant.inputs[:, 0, 0] + 1j * plant.inputs[:, 1, 0]
        self._distance = np.abs(self._steps)
        self._speeds = plant.feedforward.sum(axis=1)
        self._desired = self._distance * np.abs(self._speeds)

    def of(self, passed: Pass) -> tuple[float, float]:
        """The largest position error by the linear theory, and how much it may be off [m]."""
        x, y, turned, changed = passed.x, passed.y, passed.heading[:-1], passed.sums
        off = self._desired @ (turned * turned) / 2 + self._distance @ np.abs(changed * turned)
        return self._with_rounding(largest(x, y), float(off))

    def closer(self, passed: Pass) -> tuple[float, float]:
        """The same to second order, which takes longer [m]."""
        x, y, turned, changed = passed.x, passed.y, passed.heading[:-1], passed.sums
        squared = turned * turned
        less = np.empty(len(turned), np.complex128)
        np.multiply(self._speeds / 2, squared, out=less.real)
        np.multiply(changed, turned, out=less.imag)
        less *= self._steps
        np.add.accumulate(less, out=less)
        error = max(math.hypot(x[0], y[0]), largest(x[1:] + less.real, y[1:] + less.imag))
        off = self._desired @ np.abs(squared * turned) / 6
        off += self._distance @ np.abs(changed * squared) / 2
        return self._with_rounding(error, float(off))

    def _with_rounding(self, error: float, off: float) -> tuple[float, float]:
        return error, off + _ROUNDING * (error + self._size)
