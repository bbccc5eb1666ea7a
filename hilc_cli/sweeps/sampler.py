"""What a search tries next: points that are drawn, and those that Optuna expects much of."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.errors import MissingPackageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.sweeps.chunks import Chunk
from hilc_cli.variation import Axis, Cases, Choices, Value

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution
    from optuna.trial import Trial

SAMPLER = "TPE"
"""Name of the sampler in the manifest of a search."""

Values = tuple[Value, ...]
_Params = dict[str, Any]
"""Optuna's parameters for the values of a case."""

_BLOCK = 256
_MOST_DRAWS = 100
"""After so many that have been tried there may be no others."""


# docs/sweeps.md has what these were chosen by.
_FIRST = 12
"""Cases that are drawn before there is anything to learn from."""
_LEAST, _SHARE = 4, 4
"""Size of a batch: at least so many, at most a quarter of what is known; a quarter is drawn."""


def batches(cases: int) -> Iterator[tuple[Chunk, int]]:
    """The cases of a search in batches that grow with what is known.

    Args:
        cases: How many there are; with more of them those before are the same.

    Yields:
        A batch, and how many of its cases are drawn: of the first all.
    """
    size = drawn = _FIRST
    first = 0
    while first < cases:
        last = min(first + size, cases)
        yield Chunk(first, last), min(drawn, last - first)
        first = last
        size = min(max(_LEAST, first // _SHARE), LANES)
        drawn = size // _SHARE


class Sampler:
    """Suggests cases, and learns how good they were.

    All suggestions follow from the ranges, the seed, and what has been told so far.

    Source:
        Tree-structured Parzen estimator of Bergstra, Bardenet, Bengio and Kegl 2011, over all keys
        together as in Falkner, Klein and Hutter 2018.
    """

    def __init__(self, cases: Cases) -> None:
        """Prepares a search.

        Args:
            cases: Drawn from the ranges; it takes as many of them as it needs.

        Raises:
            MissingPackageError: The package for that is not installed.
        """
        self._optuna = require_optuna()
        self._axes = cases.axes
        self._drawn = _points(cases)
        self._space = {key: _distribution(axis, self._optuna) for key, axis in cases.axes.items()}
        self._batch: list[tuple[_Params, Trial | None]] = []
        self._tried: set[tuple[Any, ...]] = set()
        # Its generator takes 32 bits, a seed of ours has 64.
        seed = int(np.random.SeedSequence(cases.seed).generate_state(1)[0])
        with _quietly(self._optuna):
            sampler = self._optuna.samplers.TPESampler(
                seed=seed, n_startup_trials=1, multivariate=True, constant_liar=False
            )
            self._study = self._optuna.create_study(sampler=sampler)

    def ask(self, count: int, drawn: int) -> tuple[Values, ...]:
        """The next cases.

        Args:
            count: How many.
            drawn: So many of them, the first, are drawn, whatever is known.

        Returns:
            What each key is in each of them; a case that has been there only where it is hard to
            find another one.
        """
        self._batch = []
        with _quietly(self._optuna):
            for number in range(count):
                trial = None if number < drawn else self._study.ask(self._space)
                params = self._new_point() if trial is None else trial.params
                if trial is not None and tuple(params.values()) in self._tried:
                    self._study.tell(trial, state=self._optuna.trial.TrialState.FAIL)
                    params, trial = self._new_point(), None
                self._tried.add(tuple(params.values()))
                self._batch.append((params, trial))
        return tuple(
            tuple(_value(axis, params[key]) for key, axis in self._axes.items())
            for params, _ in self._batch
        )

    def tell(self, costs: Floats | Sequence[float]) -> None:
        """How good the cases were that it was asked for last.

        Args:
            costs: The smaller the better; only their order counts. Infinite is the worst.
        """
        with _quietly(self._optuna):
            for (params, trial), cost in zip(self._batch, map(float, costs), strict=True):
                if trial is not None:
                    self._study.tell(trial, cost)
                    continue
                finished = self._optuna.trial.create_trial(
                    params=params, distributions=self._space, value=cost
                )
                self._study.add_trial(finished)

    def _new_point(self) -> _Params:
        """The next point that is drawn and has not been tried, if there is one soon."""
        for _ in range(_MOST_DRAWS):
            point = next(self._drawn)
            params = {key: _param(self._axes[key], value) for key, value in point.items()}
            if tuple(params.values()) not in self._tried:
                break
        return params


def _points(cases: Cases) -> Iterator[dict[str, Value]]:
    """Points drawn one after the other, without end."""
    for first in itertools.count(0, _BLOCK):
        yield from cases.values(first, first + _BLOCK)


def require_optuna() -> Any:
    """The package that thinks of the next case.

    Raises:
        MissingPackageError: It is not installed.
    """
    try:
        import optuna
    except ImportError:
        raise MissingPackageError("--minimise", "optuna", "tune") from None
    return optuna


@contextmanager
def _quietly(optuna: Any) -> Iterator[None]:
    """Keeps Optuna's messages from the terminal."""
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            # Versions before 5 warn that options may change.
            warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
            yield
    finally:
        optuna.logging.set_verbosity(before)


def _distribution(axis: Axis, optuna: Any) -> BaseDistribution:
    """The range in which Optuna is to look; for lists that of the number of a value."""
    distributions = optuna.distributions
    if isinstance(axis, Choices):
        numbers = range(axis.count)
        found = (
            distributions.IntDistribution(0, axis.count - 1)
            if axis.is_numeric
            else distributions.CategoricalDistribution(list(numbers))
        )
    elif axis.whole or axis.spacing == "integer":
        is_log = axis.spacing == "log"
        found = distributions.IntDistribution(int(axis.low), int(axis.high), log=is_log)
    else:
        found = distributions.FloatDistribution(axis.low, axis.high, log=axis.spacing == "log")
    return found  # type: ignore[no-any-return]


def _ordered(axis: Choices) -> list[Value]:
    """The values of a list so that neighbours are near each other, if they are numbers."""
    return sorted(axis.values) if axis.is_numeric else list(axis.values)  # type: ignore[type-var]


def _value(axis: Axis, param: Any) -> Value:
    """The value of a key that Optuna's parameter stands for."""
    value: Value = _ordered(axis)[param] if isinstance(axis, Choices) else param
    return value


def _param(axis: Axis, value: Value) -> Any:
    """Optuna's parameter that stands for a value."""
    return _ordered(axis).index(value) if isinstance(axis, Choices) else value
