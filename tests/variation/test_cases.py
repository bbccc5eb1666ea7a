"""Cases from values: a grid in order, random and Sobol points that any worker can make."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.stats import chi2, qmc

from hilc_cli.variation.axes import Axis, Choices, Range, Value
from hilc_cli.variation.cases import Cases, Sampling

UNIT = Range(0.0, 1.0)


def unit_axes(count: int) -> dict[str, Axis]:
    return {f"k{number}": UNIT for number in range(count)}


def points(
    cases: Cases, first: int, last: int
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array([list(case.values()) for case in cases.values(first, last)], dtype=np.float64)


axes = st.dictionaries(
    st.text("abc", min_size=1, max_size=3),
    st.one_of(
        st.lists(st.integers(0, 9), min_size=1, max_size=4, unique=True).map(
            lambda values: Choices(tuple(values))
        ),
        st.integers(2, 4).map(lambda count: Range(0.5, 2.0, "log", count)),
        st.integers(0, 3).map(lambda high: Range(0, high, "integer")),
    ),
    min_size=1,
    max_size=5,
)


@given(axes)
def test_grid_is_every_combination_the_last_key_fastest(axes: Mapping[str, Axis]) -> None:
    cases = Cases(axes)
    expected = [
        dict(zip(axes, combination, strict=True))
        for combination in itertools.product(*(axis.ladder() for axis in axes.values()))
    ]
    assert cases.values(0, len(cases)) == expected
    assert len(cases) == math.prod(cases.shape) == len(expected)
    assert [list(case) for case in expected] == [list(axes)] * len(expected)


@pytest.mark.parametrize("sampling", ["grid", "random", "sobol"])
@given(cuts=st.lists(st.integers(0, 60), max_size=6))
@settings(max_examples=25)
def test_cases_do_not_depend_on_how_they_are_split(sampling: Sampling, cuts: list[int]) -> None:
    mixed: dict[str, Axis] = {
        "a": Range(0.1, 10.0, "log", 3),
        "b": Choices(("x", None, 2)),
        "c": Range(1, 4, "integer"),
        "d": Range(1.0, 9.0, "linear", 2, whole=True),
    }
    cases = Cases(mixed, sampling, drawn=60, seed=7)
    every = cases.values(0, len(cases))
    edges = [0, *sorted(min(cut, len(cases)) for cut in cuts), len(cases)]
    parts: list[dict[str, Value]] = []
    for first, last in itertools.pairwise(edges):
        parts += cases.values(first, last) if last > first else []
    assert parts == every
    for key in mixed:
        assert cases.column(key) == [case[key] for case in every]


@pytest.mark.parametrize("sampling", ["random", "sobol"])
def test_drawn_cases_are_reproducible_and_differ_by_seed(sampling: Sampling) -> None:
    seeds = [0, 1, 2, 2**32, 2**64 - 1]
    drawn = [Cases(unit_axes(6), sampling, 64, seed).values(0, 64) for seed in seeds]
    assert drawn == [Cases(unit_axes(6), sampling, 64, seed).values(0, 64) for seed in seeds]
    for one, other in itertools.combinations(drawn, 2):
        assert not any(a == b for a, b in zip(one, other, strict=True))


def test_more_cases_leave_the_first_ones_as_they_are() -> None:
    few, many = (Cases(unit_axes(2), "random", count, 3) for count in (10, 1000))
    assert many.values(0, 10) == few.values(0, 10)


def test_random_points_are_uniform() -> None:
    drawn = points(Cases(unit_axes(6), "random", 20_000, 1), 0, 20_000)
    bins = 50
    for column in drawn.T:
        counts, _ = np.histogram(column, bins, (0, 1))
        expected = len(column) / bins
        statistic = float(((counts - expected) ** 2 / expected).sum())
        assert chi2.ppf(1e-5, bins - 1) < statistic < chi2.ppf(1 - 1e-5, bins - 1)
        # Kolmogorov's bound at 1e-5: sqrt(ln(2 / alpha) / 2) / sqrt(n).
        ordered = np.sort(column)
        gap = np.abs(ordered - (np.arange(len(ordered)) + 0.5) / len(ordered)).max()
        assert gap < math.sqrt(math.log(2e5) / 2 / len(ordered))


def test_random_columns_are_uncorrelated() -> None:
    drawn = points(Cases(unit_axes(9), "random", 10_000, 5), 0, 10_000)
    correlation = np.asarray(np.corrcoef(drawn.T))
    assert np.abs(correlation[~np.eye(9, dtype=bool)]).max() < 5 / math.sqrt(10_000)
    lagged = np.asarray(np.corrcoef(drawn[1:, 0], drawn[:-1, 0]))
    assert abs(lagged[0, 1]) < 5 / math.sqrt(10_000)


def test_random_cases_beyond_32_bits_are_other_cases() -> None:
    cases = Cases(unit_axes(5), "random", 2**40, 0)
    far = cases.values(2**32 - 2, 2**32 + 2)
    assert len({tuple(case.values()) for case in far}) == 4
    assert far[2:] == cases.values(2**32, 2**32 + 2)
    assert far[2] != cases.values(0, 1)[0]
    assert all(0 < value < 1 for case in far for value in case.values())  # type: ignore[operator]


@pytest.mark.parametrize(("axes", "first"), [(1, 0), (3, 37), (21, 5)])
def test_sobol_points_are_those_of_scipy(axes: int, first: int) -> None:
    expected = qmc.Sobol(axes, scramble=True, rng=np.random.default_rng(11)).random(64)
    drawn = points(Cases(unit_axes(axes), "sobol", 64, 11), first, 64)
    np.testing.assert_allclose(drawn, expected[first:], rtol=0, atol=2.0**-32)


def test_sobol_points_cover_the_ranges_more_evenly_than_random_ones() -> None:
    sobol, random = (
        qmc.discrepancy(points(Cases(unit_axes(3), sampling, 256, 2), 0, 256))
        for sampling in ("sobol", "random")
    )
    assert sobol < random / 5


def test_grid_of_a_range_without_a_count_is_refused() -> None:
    with pytest.raises(ValueError, match="number of values"):
        len(Cases({"a": UNIT}))
