"""Choices judged by all that happens to them, against the same by hand."""

from __future__ import annotations

import itertools
import math
import random
import statistics
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.results.metrics import DIVERGED
from hilc_cli.scenario.sweep_section import Robust
from hilc_cli.sweeps.choices import (
    FIGURES,
    as_sweep_of_choices,
    best_case,
    choices_of,
    quantiles,
    robust_figure,
)
from hilc_cli.sweeps.data import SweepData
from hilc_cli.variation import Axis, Choices, Range
from tests.made_up_sweeps import FAILED, L1, L2, SEED, numbers, sweep

METRIC = "max_position_error_m"
GAINS = numbers(1.0, 2.0, 4.0)


def happening(metric: list[float], axes: dict[str, Axis] | None = None) -> SweepData:
    """A sweep over seeds of a gain with three values."""
    axes = axes or {L1: GAINS, SEED: Range(1, len(metric) // 3, "integer")}
    return replace(sweep(axes, np.array(metric)), over=(SEED,))


@pytest.mark.parametrize("order", ["choice first", "happening first", "mixed"])
@pytest.mark.parametrize("robust", ["worst", "q95", "mean"])
def test_minimax_by_hand(order: str, robust: Robust) -> None:
    """Whichever key changes fastest, and with words and numbers among what is chosen."""
    words = Choices(("a", None, True, 1))
    axes: dict[str, Axis] = {L1: GAINS, "word": words, SEED: Range(1, 7, "integer")}
    if order == "happening first":
        axes = {key: axes[key] for key in (SEED, L1, "word")}
    if order == "mixed":
        axes = {key: axes[key] for key in (L1, SEED, "word")}
    draw = random.Random(7)
    metric = [draw.uniform(0.1, 9.0) for _ in range(3 * 4 * 7)]
    data = replace(sweep(axes, np.array(metric)), over=(SEED,), robust=robust)

    cases: dict[tuple[object, ...], list[float]] = {}
    for number, error in enumerate(metric):
        values = data.case(number)
        key = (values[L1], repr(values["word"]))
        cases.setdefault(key, []).append(error)
    by_name: dict[str, Callable[[list[float]], float]] = {
        "worst": max,
        "q95": lambda errors: float(np.quantile(errors, 0.95)),
        "mean": statistics.fmean,
    }
    figure = by_name[robust]
    by_hand = [figure(errors) for errors in cases.values()]

    table = choices_of(data)
    found = [(values[L1], repr(values["word"])) for values in map(table.choice, range(len(table)))]
    assert found == list(cases)  # in the order in which they come first
    np.testing.assert_allclose(table.figures[robust], by_hand, rtol=1e-15)
    assert table.ranked() == sorted(range(len(by_hand)), key=by_hand.__getitem__)
    assert [metric[case] for case in table.worst_case] == list(map(max, cases.values()))
    assert set(table.cases.tolist()) == {7}
    best = best_case(data)
    assert best is not None
    assert table.choice_of[best] == table.ranked()[0]
    if robust == "worst":
        assert metric[best] == min(by_hand)


def test_diverged_cases_count_as_infinite() -> None:
    """Of 20 cases one makes the 95 % quantile infinite, of 21 it does not."""
    twenty = happening([*[1.0] * 19, math.inf, *[2.0] * 20, *[3.0] * 20])
    table = choices_of(twenty)
    for figure in ("worst", "q95", "mean"):
        assert table.figures[figure].tolist() == [math.inf, 2, 3]
    assert table.figures["median"].tolist() == [1, 2, 3]
    assert table.diverged.tolist() == [1, 0, 0]
    assert table.worst_case.tolist() == [19, 20, 40]  # of equal ones the first
    assert table.rank.tolist() == [0, 1, 2]

    of_21 = choices_of(happening([*[1.0] * 20, math.inf, *[2.0] * 21, *[3.0] * 21]))
    assert of_21.figures["q95"].tolist() == [1, 2, 3]
    assert of_21.figures["worst"].tolist() == [math.inf, 2, 3]


def test_failed_cases_are_not_judged() -> None:
    table = choices_of(happening([1.0, FAILED, 2.0, 2.0, 3.0, math.inf]))
    for figure in FIGURES:
        assert math.isnan(table.figures[figure][0])
    assert table.failed.tolist() == [1, 0, 0]
    assert table.worst_case.tolist() == [-1, 2, 5]
    assert table.rank.tolist() == [0, 1, 0]


def test_never_reached_counts_as_infinite() -> None:
    data = happening([1.0, math.nan, 2.0, 2.0, 3.0, 3.0])
    table = choices_of(data)
    assert table.figures["worst"].tolist() == [math.inf, 2, 3]
    assert table.diverged.tolist() == [0, 0, 0]
    assert best_case(replace(data, columns={**data.columns, METRIC: np.full(6, math.nan)})) is None


@pytest.mark.parametrize("percent", [0, 5, 50, 95, 100])
@pytest.mark.parametrize("size", [1, 2, 3, 20, 21, 40, 41, 101, 181])
def test_quantiles_are_those_of_numpy(percent: int, size: int) -> None:
    values = np.sort(np.random.default_rng(size).normal(size=2 * size).reshape(2, size), axis=1)
    found = quantiles(
        values.ravel(), np.array([0, size]), np.array([size, size], dtype=np.int64), percent
    )
    expected = np.quantile(values, percent / 100, axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-15)


def test_figures_of_a_search_are_those_of_the_table() -> None:
    metric = np.random.default_rng(1).uniform(size=(3, 9))
    metric[1, 4] = math.inf
    names: tuple[Robust, ...] = ("worst", "q95", "mean")
    for robust in names:
        table = choices_of(replace(happening(metric.ravel().tolist()), robust=robust))
        assert robust_figure(metric, robust).tolist() == table.figures[robust].tolist()


def test_best_case_of_a_mean_is_the_nearest_to_it() -> None:
    data = replace(happening([1.0, 5.0, 3.5, 9.0, 9.0, 9.0, 8.0, 8.0, 8.0]), robust="mean")
    assert best_case(data) == 2  # the mean is 3.17


def test_choices_as_a_sweep_of_their_own() -> None:
    axes: dict[str, Axis] = {L1: GAINS, SEED: Range(1, 2, "integer"), L2: numbers(0.0, 1.0)}
    metric = [1.0, 2, 3, 4, 5, math.inf, 7, 8, FAILED, 10, 11, 12]
    data = replace(sweep(axes, np.array(metric)), over=(SEED,))
    shown = as_sweep_of_choices(data)
    assert (shown.row, shown.is_grid, list(shown.axes)) == ("choice", True, [L1, L2])
    pairs = itertools.product((1.0, 2.0, 4.0), (0.0, 1.0))
    assert [tuple(shown.case(number).values()) for number in range(6)] == list(pairs)
    np.testing.assert_array_equal(shown.columns[METRIC], [3, 4, 7, math.nan, math.nan, 12])
    np.testing.assert_array_equal(shown.columns[DIVERGED], [0, 0, 0, 1, math.nan, 0])
    assert shown.ranked() == [0, 1, 2, 5]


def test_drawn_choices_are_no_grid() -> None:
    data = sweep({L1: Range(0.0, 1.0, "linear", 4), L2: GAINS}, np.arange(8.0), "random", 8)
    assert not as_sweep_of_choices(replace(data, over=(L2,))).is_grid
