from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.sweeps.data import QUANTILES
from hilc_cli.sweeps.pictures.key_axis import key_axis
from hilc_cli.sweeps.pictures.metric_axis import metric_scale
from hilc_cli.sweeps.pictures.picking import (
    Outcome,
    Results,
    combined,
    distinct,
    grouped,
    results_of,
    thinned,
    varied_keys,
    varies_seed,
)
from hilc_cli.variation import Choices
from tests.made_up_sweeps import (
    FAILED,
    HEADING,
    L1,
    L2,
    RATES,
    SEED,
    SEEDS,
    SPEED,
    WORDS,
    bowl,
    numbers,
    sweep,
)

D, N, X, F = Outcome.DONE, Outcome.NEVER, Outcome.DIVERGED, Outcome.FAILED


def test_outcomes_and_what_they_count_as() -> None:
    results = results_of(sweep({L1: RATES}, np.array([1.0, math.nan, math.inf, FAILED, 2.0])))
    assert results.outcomes.tolist() == [D, N, X, F, D]
    np.testing.assert_array_equal(results.metric, [1, math.inf, math.inf, math.nan, 2])


def test_quantiles_are_those_of_numpy() -> None:
    drawn = np.random.default_rng(3).lognormal(size=97)
    group_of = np.random.default_rng(4).integers(0, 5, 97)
    found = grouped(Results(drawn, np.zeros(97, dtype=np.int64)), group_of, 5)
    expected = [np.quantile(drawn[group_of == group], QUANTILES) for group in range(5)]
    np.testing.assert_allclose(found.quantiles, expected, rtol=1e-13)
    assert found.counts.tolist() == np.bincount(group_of).tolist()


def test_groups_with_cases_that_have_no_metric() -> None:
    inf, nan = math.inf, math.nan
    metric = np.array([1.0, 3, inf, 1, inf, inf, nan, nan, nan, 5, inf])
    outcomes = np.array([D, D, X, D, N, X, F, F, F, D, N])
    group_of = np.array([0, 0, 0, 1, 1, 1, 2, 2, 3, 3, 5])
    found = grouped(Results(metric, outcomes), group_of, 6)
    np.testing.assert_array_equal(found.medians, [3, inf, nan, 5, nan, inf])
    assert found.counts.tolist() == [3, 3, 0, 1, 0, 1]
    assert found.outcomes.tolist() == [D, X, F, D, F, N]
    # Between a finite case and an infinite one there is no number.
    assert found.quantiles[0].tolist() == [pytest.approx(1.2), 2.0, 3.0, inf, inf]


def test_seeds_and_constant_keys_are_not_varied() -> None:
    assert varied_keys(sweep({L1: RATES, SEED: SEEDS, L2: numbers(3, 3)}, bowl)) == [L1]
    assert varied_keys(sweep({SEED: SEEDS}, bowl)) == [SEED]
    assert varied_keys(sweep({L1: numbers(2)}, bowl)) == [L1]
    assert varies_seed(sweep({SEED: SEEDS}, bowl))
    assert not varies_seed(sweep({SEED: numbers(4), L1: RATES}, bowl))


@pytest.mark.parametrize("axes", [{L1: RATES, SEED: SEEDS}, {SEED: SEEDS, L1: RATES}])
def test_combinations_are_medians_over_the_seeds(axes: dict[str, Choices]) -> None:
    data = sweep(axes, lambda case: 10 * float(case[L1] or 0) + float(case[SEED] or 0))
    where = key_axis(data, L1)
    found = combined(data, results_of(data), [where.positions])
    assert found.is_median
    np.testing.assert_allclose(found.metric, 10 * where.positions[found.cases] + 5)
    assert len(found.cases) == 5
    assert where.positions[found.cases[found.best(1)[0]]] == 0.1


def test_best_are_sorted_and_stable() -> None:
    metric = np.array([5.0, 1, math.inf, 1, 0.5, *range(2, 60)])
    data = sweep({L1: Choices(tuple(range(len(metric))))}, metric)
    found = combined(data, results_of(data), [])
    assert found.best(4).tolist() == [4, 1, 3, 5]
    assert not found.is_median
    assert len(found.best(1000)) == len(metric) - 1


def test_thinning_is_the_same_each_time() -> None:
    cases = np.arange(20_000)
    kept = thinned(cases, 100)
    assert len(np.unique(kept)) == 100
    np.testing.assert_array_equal(kept, thinned(cases, 100))
    assert len(np.unique(kept % 10)) == 10  # of a grid with ten values of the last key: all
    assert thinned(cases[:50], 100).tolist() == list(range(50))


def test_distinct_values() -> None:
    few = distinct(np.repeat([2.0, 1.0], 500), 2)
    assert few is not None
    assert few.tolist() == [1, 2]
    assert distinct(np.array([1.0] * 100 + [2.0, 3.0]), 2) is None
    assert distinct(np.arange(1000.0), 5) is None


def test_positions_of_numbers_and_words() -> None:
    data = sweep({HEADING: WORDS, L1: RATES}, bowl)
    words, rates = key_axis(data, HEADING), key_axis(data, L1)
    assert words.words == ("measured", "previous", "reference")
    assert words.positions.tolist() == [0] * 5 + [1] * 5 + [2] * 5
    assert rates.is_logarithmic
    np.testing.assert_allclose(rates.positions[:5], 10.0 ** np.linspace(-1, 1, 5))
    mixed = key_axis(sweep({SPEED: Choices((None, True, 1, "a"))}, np.ones(4)), SPEED)
    assert mixed.words == ("null", "true", "1", "a")
    assert mixed.positions.tolist() == [0, 1, 2, 3]


def test_cells_end_halfway_between_values() -> None:
    data = sweep({L1: numbers(1, 10, 100), L2: numbers(1, 2, 5)}, bowl)
    np.testing.assert_allclose(
        key_axis(data, L1).edges(np.array([1.0, 10, 100])), 10 ** np.array([-0.5, 0.5, 1.5, 2.5])
    )
    edges = key_axis(data, L2).edges(np.array([1.0, 2, 5]))
    assert edges.tolist() == [0.5, 1.5, 3.5, 6.5]
    single = key_axis(sweep({L1: numbers(0)}, bowl), L1).edges(np.array([0.0]))
    assert single[0] < 0 < single[1]


def test_scale_is_logarithmic_where_a_linear_one_hides_most() -> None:
    assert metric_scale(np.array([1.0, 31])).is_logarithmic
    assert not metric_scale(np.array([1.0, 29])).is_logarithmic
    assert not metric_scale(np.array([-1.0, 1, 1e6])).is_logarithmic
    assert not metric_scale(np.array([0.0, 0.0])).is_logarithmic


def test_scale_leaves_out_what_it_has_no_place_for() -> None:
    scale = metric_scale(np.array([0.0, 1e-3, 1, math.inf, math.nan]))
    assert (scale.low, scale.high, scale.is_logarithmic, scale.zeros) == (1e-3, 1, True, 1)
    np.testing.assert_array_equal(
        scale.in_place(np.array([0, 1, math.inf])), [math.nan, 1, math.nan]
    )
    assert metric_scale(np.array([math.nan, math.inf])).is_empty
    counts = metric_scale(np.array([0.0, 1, 5000]), whole=True)
    assert (counts.low, counts.is_logarithmic, counts.zeros) == (0, False, 0)


def test_scale_is_not_squashed_by_what_is_about_to_diverge() -> None:
    scale = metric_scale(np.array([0.1, 1, 1, 1, 1e140]))
    assert (scale.high, scale.beyond) == (1e6, 1)
    assert replace(scale, unit="m").notes() == ["1 value is above 1e6 m"]
    assert metric_scale(np.array([1e-12, 1e-9, 0.1])).notes() == []


def test_numbers_listed_unevenly_get_cells_of_one_size() -> None:
    def places(*values: float) -> list[float]:
        data = sweep({L1: Choices(values)}, np.ones(len(values)))
        return list(key_axis(data, L1, cells=True).positions)

    assert places(10, 0, 1) == [2, 0, 1]
    assert places(0, 1, 2, 4) == [0, 1, 2, 4]
    assert places(0.01, 0.1, 1, 10) == [0.01, 0.1, 1, 10]
    assert places(5, 7) == [5, 7]
