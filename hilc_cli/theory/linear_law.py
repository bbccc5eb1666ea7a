"""What the linear theory asks of a law that learns from the last iteration by a gain matrix."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, GainsAlong
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.matrices import GainParts, known_plant, knows_plant

WeighedError = Callable[[int, Triple, Triple], Triple]
"""The errors before the gain matrix at sample k, from an e(k+1) and e(k) [m, m, rad].

Called once for each sample in order; what is weighed of e(k+1) is next_gain times it.
"""


class LinearLaw(ABC):
    """A law in an experiment, as the linear theory sees it: inputs are u - u_d, errors e.

    What is worded is part of sentences that name the law's keys.

    Attributes:
        matrix: The gain matrix, without a lateral gain, which no wheel speed answers at once.
        along: The gain matrix at each sample, with it.
        gain_heading: The heading at which it is taken.
        next_gain: What e(k+1) is multiplied by before G_k; none of w(k) depends on later errors.
        forgotten: gamma: how much of u(k) - u_0(k) the law takes away.
        learns_ahead: Whether what a sample learns is next_gain G_k e(k+1), but for what each
            iteration learns alike: of the initial error, or from nothing.
        smooths: Whether samples are mixed by a filter, so that the two numbers above do not tell
            what becomes of a single one.
        feedback: Gains l2 of the running iteration's error, and l3 of that a sample before.
        rest_from: The first sample at which an initial error should be gone where learning rests.
        compensated_until: The length of a compensation in samples; None without one.
        paper: The law of Qiao et al. 2021 that it is the same as, but for a derivative; None if it
            is the same as none.
        less_noise: What makes it learn less of the noise.
        for_the_start: What gets it onto the trajectory from a start that is far off; empty for
            nothing.
    """

    next_gain: float
    forgotten = 0.0
    learns_ahead: bool
    smooths = False
    feedback = (0.0, 0.0)
    rest_from = 1
    compensated_until: int | None = None
    paper: HybridLaw | None
    less_noise = "lower controller.gains"
    for_the_start = ""

    def __init__(
        self,
        experiment: Experiment,
        matrix: GainMatrix,
        gain_heading: GainHeading,
        along: GainsAlong | None = None,
    ) -> None:
        reference = experiment.reference
        self._experiment, self._sample_time = experiment, reference.sample_time
        self.matrix, self.gain_heading = matrix, gain_heading
        self.along = along or GainsAlong.same(matrix, reference.samples)

    @property
    def kept(self) -> float:
        """What is left of an input where there is no error."""
        return 1 - self.forgotten

    @cached_property
    def gains(self) -> Floats:
        """G_k, the gain matrix along the reference, shape (n, 2, 3)."""
        headings = self._experiment.reference.heading[:-1]
        gains = np.empty((len(headings), 2, 3), order="F")
        for matrix, here in self.along.parts():
            gains[here] = GainParts.of(matrix).at(headings[here])
        return gains

    @abstractmethod
    def learned(self, inputs: Floats, errors: Floats) -> Floats:
        """Returns what is learned of an input, shape (n, 2), and its errors, shape (n + 1, 3).

        Further axes stand for seeds, side by side.
        """

    @abstractmethod
    def transposed(self, inputs: Floats) -> tuple[Floats, Floats]:
        """Returns the transpose of `learned`: shares of an input, shape (n, 2), and of errors."""

    def constant(self, first: Floats, feedforward: Floats) -> Floats | None:
        """Returns what is added in every iteration, from u_0 - u_d and u_d; None for nothing."""
        return None

    @abstractmethod
    def weighed_errors(self, start: Triple) -> WeighedError | None:
        """Returns what the law weighs along a motion from e(0); None if a filter mixes samples."""

    @abstractmethod
    def ripple_factors(self, gains: NDArray[np.complex128], frequencies: Floats) -> Floats:
        """Returns what an iteration multiplies ripples by.

        Args:
            gains: Loop gains, shape (m, 1).
            frequencies: In radians per sample, shape (p,).
        """

    @abstractmethod
    def not_settling(self) -> str:
        """Returns why the spectral radius is 1 or more, and a remedy."""

    @abstractmethod
    def against_ripples(self) -> str:
        """Returns what keeps ripples of the wheel speeds from growing."""

    @abstractmethod
    def rest_off(self) -> str:
        """Returns why learning does not rest on the reference."""

    @abstractmethod
    def advice(self) -> list[str]:
        """Returns what is legal but unwise about its gains, in sentences with their remedies."""


def theory_class(experiment: Experiment) -> Any:
    """Returns what a law names as its theory, see `LawTheory`.

    Returns:
        The class; None if the law names nothing, or if theory does not speak of the plant.
    """
    place = getattr(experiment.law, "theory", None)
    if place is None or not knows_plant(experiment):
        return None
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def linear_law(experiment: Experiment) -> LinearLaw:
    """Returns the experiment's law.

    Raises:
        UsageError: The linear theory does not speak of it, or not of its plant.
    """
    law = _linear(experiment)
    if law is None:
        raise UsageError("the convergence theory is that of the laws hybrid and pid only")
    return law


def paper_law(experiment: Experiment) -> HybridLaw:
    """Returns the experiment's law as Eq. 17 or 21, with its derivative, which the paper has not.

    Law pid with kp alone is Eq. 17 with l1 = kp.

    Raises:
        UsageError: The paper does not speak of it, or not of its plant.
    """
    law = _linear(experiment)
    if law is None or law.paper is None:
        raise UsageError("the paper's theory is that of the hybrid law only")
    return law.paper


def _linear(experiment: Experiment) -> LinearLaw | None:
    known_plant(experiment)
    theory = theory_class(experiment)
    law: LinearLaw | None = None if theory is None else theory(experiment).linear
    return law
