"""Picks from a sweep what its pictures show: keys, outcomes, groups of cases and their spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats
from hilc_cli.sweeps.data import QUANTILES, SEED_KEY, SweepData
from hilc_cli.variation import Axis, Choices

Integers = NDArray[np.int64]

MOST_DOTS = 5000
"""The most dots of a picture: more cannot be told apart, and make files large."""

MOST_CURVES = 8
"""The most words of a key that have a curve each."""

MEDIAN = QUANTILES.index(0.5)


class Outcome(IntEnum):
    """What became of a case, or of most of a group."""

    DONE = 0
    NEVER = 1  # finished, but without this metric: the tolerance was not reached
    DIVERGED = 2
    FAILED = 3


@dataclass(frozen=True, eq=False)
class Results:
    """The metric of all cases.

    Attributes:
        metric: Shape (cases,); infinite for a case that diverged or has no such metric, and
            not-a-number for one that failed.
        outcomes: Of Outcome, shape (cases,).
    """

    metric: Floats
    outcomes: Integers

    @cached_property
    def order(self) -> Integers:
        """Numbers of the cases, the smallest metric first, failed ones last."""
        return np.argsort(self.metric)

    def of(self, cases: Integers) -> Results:
        """The results of some cases."""
        if len(cases) == len(self.metric):
            return self
        return Results(self.metric[cases], self.outcomes[cases])


@dataclass(frozen=True, slots=True, eq=False)
class Groups:
    """The metric of groups of cases, such as those with one value of a key.

    Attributes:
        counts: Cases that did not fail, shape (groups,).
        quantiles: Shape (groups, quantiles), in the order of QUANTILES; infinite where cases
            without a metric make them so, not-a-number where all cases failed.
        outcomes: Of Outcome, shape (groups,): DONE where the median is finite.
    """

    counts: Integers
    quantiles: Floats
    outcomes: Integers

    @property
    def medians(self) -> Floats:
        """Shape (groups,)."""
        return self.quantiles[:, MEDIAN]

    @property
    def drawable(self) -> Floats:
        """Medians with gaps instead of infinite ones, shape (groups,)."""
        return np.where(np.isfinite(self.medians), self.medians, np.nan)


@dataclass(frozen=True, slots=True, eq=False)
class Combinations:
    """The metric of all combinations of the varied keys, whatever the seed.

    Attributes:
        cases: One case of each, rising, shape (combinations,).
        metric: Its metric, or the median over its seeds, as in Results.
        outcomes: Of Outcome.
        is_median: Whether combinations have several cases.
    """

    cases: Integers
    metric: Floats
    outcomes: Integers
    is_median: bool

    def best(self, most: int) -> Integers:
        """At most so many combinations that have a metric, the smallest first."""
        done = np.flatnonzero(self.outcomes == Outcome.DONE)
        if len(done) > 10 * most:  # a million need not be sorted for the first ten
            last = np.partition(self.metric[done], most - 1)[most - 1]
            done = done[self.metric[done] <= last]
        return done[np.argsort(self.metric[done], kind="stable")][:most]


def is_constant(axis: Axis) -> bool:
    """Whether an axis has one value only."""
    if isinstance(axis, Choices):
        return all(value == axis.values[0] for value in axis.values)
    return axis.low == axis.high


def varied_keys(data: SweepData) -> list[str]:
    """The keys that pictures have axes for: those with several values, but not the seed.

    There is at least one if the sweep has keys at all: a single case lies somewhere too.
    """
    keys = [key for key, axis in data.axes.items() if not is_constant(axis)]
    return [key for key in keys if key != SEED_KEY] or keys[:1] or list(data.axes)[:1]


def curve_keys(data: SweepData) -> tuple[str, str | None] | None:
    """The key along the axis and the key of which each word has a curve, if a curve fits."""
    keys = varied_keys(data)
    if len(keys) == 1:
        return keys[0], None
    if len(keys) != 2:
        return None
    # The one with the fewer words gives the curves.
    words = [key for key in keys if not data.axes[key].is_numeric]
    counts = {key: data.axes[key].count or 0 for key in words}
    fitting = [key for key in reversed(words) if counts[key] <= MOST_CURVES]
    if not fitting:
        return None
    series = min(fitting, key=lambda key: counts[key])
    return next(key for key in keys if key != series), series


def varies_seed(data: SweepData) -> bool:
    """Whether cases are repeated with other disturbances."""
    return SEED_KEY in data.axes and not is_constant(data.axes[SEED_KEY])


def results_of(data: SweepData) -> Results:
    """The metric of all cases, and what became of them."""
    metric = np.asarray(data.columns[data.metric], dtype=np.float64)
    failed, diverged = data.failed, data.diverged | np.isinf(metric)
    outcomes = np.full(len(data), Outcome.DONE, dtype=np.int64)
    outcomes[np.isnan(metric)] = Outcome.NEVER
    outcomes[diverged] = Outcome.DIVERGED
    outcomes[failed] = Outcome.FAILED
    finite = np.where(outcomes == Outcome.DONE, metric, np.inf)
    return Results(np.where(failed, np.nan, finite), outcomes)


def grouped(results: Results, group_of: Integers, groups: int) -> Groups:
    """Quantiles of the metric of groups of cases.

    Args:
        results: Of all cases.
        group_of: The group of each case, 0 .. groups - 1, shape (cases,).
        groups: How many there are; some may be empty.
    """
    order = results.order  # failed cases are the last of their group
    # Short numbers are sorted by their digits, which is much faster: the low ones come first.
    for digits in range(0, (groups - 1).bit_length(), 16):
        short = (group_of >> digits).astype(np.uint16)
        order = order[np.argsort(short[order], kind="stable")]
    metric = np.append(results.metric[order], np.nan)
    sizes = np.bincount(group_of, minlength=groups)
    starts = np.cumsum(sizes) - sizes
    tally = np.bincount(group_of * len(Outcome) + results.outcomes, minlength=groups * len(Outcome))
    tally = tally.reshape(groups, len(Outcome))
    counts = sizes - tally[:, Outcome.FAILED]
    place = np.maximum(counts - 1, 0)[:, np.newaxis] * np.asarray(QUANTILES)
    below = np.floor(place).astype(np.int64)
    share = place - below
    start = starts[:, np.newaxis]
    low, high = metric[start + below], metric[start + np.where(share > 0, below + 1, below)]
    with np.errstate(invalid="ignore", over="ignore"):
        quantiles = low + share * (high - low)
    quantiles[np.isinf(high)] = np.inf
    quantiles[counts == 0] = np.nan
    worst = np.where(
        tally[:, Outcome.DIVERGED] >= tally[:, Outcome.NEVER], Outcome.DIVERGED, Outcome.NEVER
    )
    outcomes = np.where(np.isfinite(quantiles[:, MEDIAN]), Outcome.DONE, worst)
    return Groups(counts, quantiles, np.where(counts == 0, Outcome.FAILED, outcomes))


def combined(data: SweepData, results: Results, positions: Sequence[Floats]) -> Combinations:
    """Takes cases together that are the same but for their seed.

    Args:
        data: The sweep.
        results: Of all cases.
        positions: Where each case lies on the axis of each varied key, shape (cases,) each.
    """
    every = Combinations(np.arange(len(data)), results.metric, results.outcomes, is_median=False)
    if not varies_seed(data):
        return every
    code = np.zeros(len(data), dtype=np.int64)
    for column in positions:
        values, place = np.unique(column, return_inverse=True)
        # Compressed each time: the product of all counts may not fit an integer.
        _, code = np.unique(code * len(values) + place, return_inverse=True)
    _, first, group_of = np.unique(code, return_index=True, return_inverse=True)
    if len(first) == len(data):
        return every
    groups = grouped(results, group_of, len(first))
    order = np.argsort(first)
    return Combinations(first[order], groups.medians[order], groups.outcomes[order], is_median=True)


def distinct(positions: Floats, most: int) -> Floats | None:
    """The values among positions, rising; None if there are more than so many."""
    if len(np.unique(positions[: 10 * most])) > most:  # tells it fast of most long columns
        return None
    values = np.unique(positions)
    return values if len(values) <= most else None


def thinned(cases: Integers, most: int = MOST_DOTS) -> Integers:
    """At most so many of some cases, always the same ones and without a beat with the grid."""
    if len(cases) <= most:
        return cases
    return np.sort(np.random.default_rng(0).choice(cases, most, replace=False))
