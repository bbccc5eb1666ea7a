"""A search for the case in which a metric is smallest: each batch follows from those before it.

Its points are drawn, or are those that Optuna expects much of.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.errors import needed
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, ITERATIONS_TO_TOLERANCE, MAX_ERROR
from hilc_cli.sweeps.cases import parts
from hilc_cli.sweeps.changes import TRAJECTORY
from hilc_cli.sweeps.choices import robust_figure
from hilc_cli.sweeps.chunks import Chunk, Store
from hilc_cli.sweeps.compute import (
    Execution,
    cases_per_chunk,
    compile_for,
    compute_chunks,
    crew_for,
    run_chunk,
)
from hilc_cli.sweeps.data import OwnValues
from hilc_cli.sweeps.happenings import CrossedCases
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.refinement import Refinement, Values, refined_cases
from hilc_cli.variation import Axis, Cases, Choices, ListedCases, Value

if TYPE_CHECKING:
    from optuna.distributions import BaseDistribution
    from optuna.trial import Trial

SAMPLER = "TPE"
"""Name of the sampler in the manifest of a search."""

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
_COLUMNS = list(CASE_COLUMNS)


@dataclass(frozen=True, slots=True)
class Found:
    """What a search has tried.

    Attributes:
        cases: All its cases.
        how: What the manifest tells of how it was done.
    """

    cases: ListedCases
    how: Mapping[str, Any]


def search(plan: Plan, store: Store, how: Execution) -> Found:
    """Computes the cases of a search, of which a store may have some.

    A batch follows from the results of the batches before it, not from who computed them, so that
    a search that goes on after a stop thinks of the same cases again and finds them in the store.

    Raises:
        UsageError: The package for that is not installed.
        HilcError: As for `compute`.
    """
    made, every = plan.cases, plan.happenings
    choices = made.choices if isinstance(made, CrossedCases) else made
    sampler, total = Sampler(choices), plan.choices
    refined = refined_cases(choices.axes, total)
    compile_for(plan, how.on_compile)
    listed: list[Values] = []
    figures: list[float] = []
    crew = crew_for(plan, LANES * every, how)

    def compute_batch(values: Sequence[Values]) -> Floats:
        """The costs of the next choices."""
        first = len(listed)
        listed.extend(values)
        rows = tuple(made.searched(values).rows if isinstance(made, CrossedCases) else values)
        batch = Chunk(first * every, len(listed) * every, rows)
        store.forget_others(batch)
        compute_chunks(plan, store, crew, _missing(plan, store, batch, crew.workers), how)
        found = costs(plan, store.rows(batch)).reshape(-1, every)
        figures.extend(robust_figure(found, plan.robust).tolist())
        return np.array(figures[first:])

    try:
        for cases, drawn in batches(total - refined):
            how.go_on()
            sampler.tell(compute_batch(sampler.ask(len(cases), drawn)))
        refinement = Refinement(choices.axes, listed, figures, sampler.draw)
        while len(listed) < total:
            how.go_on()
            refinement.tell(compute_batch([refinement.ask()]))
    finally:
        crew.dismiss()
    told = {
        "minimise": plan.spec.minimise,
        "seed": plan.spec.seed,
        "sampler": SAMPLER,
        "optuna": version("optuna"),
        "refinement": {"method": refinement.method, "cases": refined, "first_case": total - refined}
        if refined
        else None,
    }
    return Found(
        made.searched(listed) if isinstance(made, CrossedCases) else ListedCases(plan.axes, listed),
        told,
    )


def costs(plan: Plan, rows: Floats) -> Floats:
    """How good cases are, the smaller the better.

    Where the metric counts iterations to a tolerance, a case that never reaches it is worse than
    any that does, and among those of its kind as good as its last maximum error is small. One
    that diverged or failed is worse than all others.

    Args:
        plan: The search.
        rows: Of the cases, in the order of CASE_COLUMNS.

    Returns:
        Shape (cases,), infinite for the worst; only the order counts.
    """
    found = _metric(plan, rows)
    if plan.spec.metric == ITERATIONS_TO_TOLERANCE:
        error = rows[:, _COLUMNS.index(MAX_ERROR)]
        never = plan.most_iterations + 1 + error / (1 + error)
        finished = rows[:, _COLUMNS.index(DIVERGED)] == 0
        found = np.where(np.isnan(found) & finished, never, found)
    return np.where(np.isfinite(found), found, np.inf)


def _metric(plan: Plan, rows: Floats) -> Floats:
    """What is minimised, not-a-number for cases that diverged, failed or have no such number."""
    finished = rows[:, _COLUMNS.index(DIVERGED)] == 0
    return np.where(finished, rows[:, _COLUMNS.index(plan.spec.metric)], np.nan)


def _missing(plan: Plan, store: Store, batch: Chunk, workers: int) -> list[Chunk]:
    """What is missing of a batch, in chunks that keep workers busy."""
    size = cases_per_chunk(plan, len(batch), workers)
    pieces = []
    for gap in store.missing():
        last = min(gap.last, batch.last)
        for first in range(max(gap.first, batch.first), last, size):
            pieces.append(batch.part(first, min(first + size, last)))
    return pieces


def own_metric(plan: Plan) -> float:
    """The metric of the scenario with its own values, not-a-number if it has none.

    Where keys happen it is the figure of the metric over all happenings.
    """
    happen = {key: axis for key, axis in plan.axes.items() if key in plan.over}
    own = replace(plan, spec=plan.spec.model_copy(update={"vary": happen, "over": None}))
    rows = tuple(plan.cases.happened()) if isinstance(plan.cases, CrossedCases) else ((),)
    found = _metric(plan, run_chunk(own, Chunk(0, len(rows), rows)).rows)
    figure = float(robust_figure(np.where(np.isnan(found), np.inf, found)[None], plan.robust)[0])
    return figure if math.isfinite(figure) else math.nan


def own_values(plan: Plan) -> OwnValues:
    """The scenario as it is, to be put beside the cases of a search."""
    own = plan.scenario.resolved()
    return OwnValues({key: value_of(own, key) for key in plan.chosen}, own_metric(plan))


def value_of(resolved: Mapping[str, Any], key: str) -> Value:
    """What a resolved scenario has at a dotted key; None for what is no single value.

    Args:
        resolved: The scenario; of the names that a platform's width goes by it has one.
        key: The key, with whichever of them.
    """
    if key == TRAJECTORY:
        return str(resolved[TRAJECTORY]["name"])
    platform, _, field = key.partition(".")
    if field == "wheel_separation":
        return 2 * float(resolved[platform]["half_track"])
    found: Any = resolved
    for part in parts(key):
        is_place = isinstance(found, list) and isinstance(part, int) and part < len(found)
        if not is_place and not (isinstance(found, Mapping) and part in found):
            return None
        found = found[part]
    return found if isinstance(found, bool | int | float | str) else None


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
        blocks = itertools.count(0, _BLOCK)
        self._drawn = (point for at in blocks for point in cases.values(at, at + _BLOCK))
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
        return tuple(self._values(params) for params, _ in self._batch)

    def draw(self) -> Values:
        """The next case that is drawn, whatever is known: of it nothing need be told."""
        params = self._new_point()
        self._tried.add(tuple(params.values()))
        return self._values(params)

    def _values(self, params: _Params) -> Values:
        """What each key is at Optuna's parameters."""
        return tuple(
            _ordered(axis)[params[key]] if isinstance(axis, Choices) else params[key]
            for key, axis in self._axes.items()
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
            params = {
                key: _ordered(axis).index(point[key]) if isinstance(axis, Choices) else point[key]
                for key, axis in self._axes.items()
            }
            if tuple(params.values()) not in self._tried:
                break
        return params


def require_optuna() -> Any:
    """The package that thinks of the next case.

    Raises:
        MissingPackageError: It is not installed.
    """
    return needed("--minimise", "optuna", "tune")


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
    """The values of a list by Optuna's parameter: neighbours are near each other, if numbers."""
    return sorted(axis.values) if axis.is_numeric else list(axis.values)  # type: ignore[type-var]
