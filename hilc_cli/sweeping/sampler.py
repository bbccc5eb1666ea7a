"""What a search tries next: points that are drawn, and those that Optuna expects much of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.variation.axes import Axis, Choices, Value
from hilc_cli.variation.cases import Cases

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution
    from optuna.trial import Trial

SAMPLER = "TPE"
"""As the manifest of a search names it."""

Values = tuple[Value, ...]


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
            cases: Drawn from the ranges; of these it takes as many as it is asked for.

        Raises:
            UsageError: The package for that is not installed.
        """
        optuna = require_optuna()
        self._axes = cases.axes
        self._drawn = iter(cases.values(0, len(cases)))
        self._optuna = optuna
        self._space = {key: _distribution(axis, optuna) for key, axis in cases.axes.items()}
        self._params: list[dict[str, Any]] = []
        self._asked: list[Trial] = []
        # Its generator takes 32 bits, a seed of ours has 64.
        seed = int(np.random.SeedSequence(cases.seed).generate_state(1)[0])
        with _quietly(optuna):
            sampler = optuna.samplers.TPESampler(
                seed=seed, n_startup_trials=1, multivariate=True, constant_liar=False
            )
            self._study = optuna.create_study(sampler=sampler)

    def ask(self, count: int, drawn: int) -> tuple[Values, ...]:
        """The next cases.

        Args:
            count: How many.
            drawn: So many of them, the first, are drawn, whatever is known.

        Returns:
            What each key is in each of them.
        """
        with _quietly(self._optuna):
            points = [next(self._drawn) for _ in range(drawn)]
            self._asked = [self._study.ask(self._space) for _ in range(count - drawn)]
        self._params = [
            {key: _param(self._axes[key], value) for key, value in point.items()}
            for point in points
        ]
        params = [*self._params, *(trial.params for trial in self._asked)]
        return tuple(
            tuple(_value(axis, of_case[key]) for key, axis in self._axes.items())
            for of_case in params
        )

    def tell(self, costs: Floats | Sequence[float]) -> None:
        """How good the cases were that it was asked for last.

        Args:
            costs: The smaller the better; only their order counts. Infinite is the worst.
        """
        found = map(float, costs)
        with _quietly(self._optuna):
            for params in self._params:
                self._study.add_trial(
                    self._optuna.trial.create_trial(
                        params=params, distributions=self._space, value=next(found)
                    )
                )
            for trial in self._asked:
                self._study.tell(trial, next(found))


def require_optuna() -> Any:
    """The package that thinks of the next case.

    Raises:
        UsageError: It is not installed.
    """
    try:
        import optuna
    except ImportError:
        raise UsageError("--minimise needs the package optuna; install hilc-cli[tune]") from None
    return optuna


@contextmanager
def _quietly(optuna: Any) -> Iterator[None]:
    """Keeps Optuna's messages from the terminal."""
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.CRITICAL)
    try:
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
