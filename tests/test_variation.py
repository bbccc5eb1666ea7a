"""Values of one key, exact at the ends and at the decimals in between, and cases made of them."""

from __future__ import annotations

import itertools
import json
import math
import pickle
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.stats import chi2, qmc

from hilc_cli.variation import (
    Axis,
    Cases,
    Choices,
    Range,
    Sampling,
    Spacing,
    Value,
    axis_from_data,
    axis_to_data,
)

numbers = st.floats(-1e9, 1e9)
positive = st.floats(1e-9, 1e9)


@st.composite
def ranges(draw: st.DrawFn, spacing: Spacing) -> Range:
    low = draw(positive if spacing == "log" else numbers)
    width = draw(st.floats(1e-3, 1e6))
    high = low * (1 + width) if spacing == "log" else low + width
    return Range(low, high, spacing, draw(st.integers(2, 60)))


@st.composite
def whole_ranges(draw: st.DrawFn) -> Range:
    spacing: Spacing = draw(st.sampled_from(("linear", "log")))
    low = draw(st.integers(1, 1000))
    high = low + draw(st.integers(1, 1000))
    return Range(float(low), float(high), spacing, draw(st.integers(2, 60)), whole=True)


def test_linear_range_has_the_decimals_that_people_write() -> None:
    assert _ladder(Range(0.05, 1.0, "linear", 20)) == [round(0.05 * k, 2) for k in range(1, 21)]
    assert _ladder(Range(-1.0, 1.0, "linear", 5)) == [-1, -0.5, 0, 0.5, 1]
    assert _ladder(Range(0.1, 0.7, "linear", 7)) == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]


def _ladder(axis: Axis) -> list[Value]:
    return list(axis.ladder())


@given(ranges("linear"))
def test_values_of_a_linear_range_are_rounded_once(axis: Range) -> None:
    low, high = Fraction(repr(axis.low)), Fraction(repr(axis.high))
    last = len(axis.ladder()) - 1
    exact = [float(low + (high - low) * Fraction(index, last)) for index in range(1, last)]
    assert _ladder(axis)[1:-1] == exact


def test_values_of_a_large_range_are_made_once_and_stay_where_they_are() -> None:
    axis = Range(1.0, 1e6, "linear", 10**6, whole=True)
    assert axis.ladder() is axis.ladder()
    assert axis.count == 10**6
    elsewhere = pickle.dumps(axis)
    assert len(elsewhere) < 1000
    assert pickle.loads(elsewhere).ladder() == axis.ladder() == tuple(range(1, 10**6 + 1))


def test_logarithmic_range_has_the_powers_of_ten() -> None:
    assert _ladder(Range(1e-3, 1e3, "log", 7)) == [1e-3, 1e-2, 0.1, 1, 10, 100, 1000]


@given(ranges("linear"))
def test_steps_of_a_linear_range_are_equal(axis: Range) -> None:
    ladder = np.array(axis.ladder())
    step = (axis.high - axis.low) / (len(ladder) - 1)
    expected = axis.low + step * np.arange(len(ladder))
    np.testing.assert_allclose(ladder, expected, rtol=1e-12, atol=1e-12 * (1 + abs(axis.low)))


@given(ranges("log"))
def test_ratios_of_a_logarithmic_range_are_equal(axis: Range) -> None:
    ladder = np.array(axis.ladder())
    ratio = (axis.high / axis.low) ** (1 / (len(ladder) - 1))
    np.testing.assert_allclose(ladder[1:] / ladder[:-1], ratio, rtol=1e-12)


@given(st.one_of(ranges("linear"), ranges("log")))
def test_range_rises_from_end_to_end(axis: Range) -> None:
    ladder = axis.ladder()
    assert len(ladder) == axis.count == axis.values_asked
    assert (ladder[0], ladder[-1]) == axis.ends == (axis.low, axis.high)
    assert np.all(np.diff(np.array(ladder, float)) > 0)


@given(whole_ranges())
def test_whole_numbers_are_rounded_and_taken_once(axis: Range) -> None:
    ladder = _ladder(axis)
    assert all(isinstance(value, int) for value in ladder)
    assert ladder == sorted({round(float(v)) for v in _spread(axis)})
    assert axis.count == len(ladder) <= (axis.values_asked or 0)
    assert (ladder[0], ladder[-1]) == axis.ends == (int(axis.low), int(axis.high))


def _spread(axis: Range) -> list[float]:
    return [
        float(value)  # type: ignore[arg-type]
        for value in Range(axis.low, axis.high, axis.spacing, axis.values_asked).ladder()
    ]


def test_whole_numbers_of_a_logarithmic_range() -> None:
    axis = Range(1.0, 10.0, "log", 8, whole=True)
    assert _ladder(axis) == [1, 2, 3, 4, 5, 7, 10]
    assert axis.count == 7


@given(st.integers(-(10**9), 10**9), st.integers(0, 300))
def test_integers_are_all_there(low: int, more: int) -> None:
    axis = Range(low, low + more, "integer")
    assert _ladder(axis) == list(range(low, low + more + 1))
    assert axis.count == more + 1


@given(st.one_of(ranges("linear"), ranges("log"), whole_ranges()), st.floats(0, 1))
def test_drawn_values_lie_in_the_range(axis: Range, unit: float) -> None:
    unit = min(max(unit, 2.0**-33), 1 - 2.0**-33)
    value = axis.drawn(unit)
    assert axis.low <= float(value) <= axis.high  # type: ignore[arg-type]
    assert isinstance(value, int) is axis.whole


def test_drawing_follows_the_spacing() -> None:
    assert Range(2.0, 4.0).drawn(0.25) == 2.5
    assert Range(1.0, 100.0, "log").drawn(0.5) == pytest.approx(10)
    assert Range(1.0, 100.0, "log", whole=True).drawn(0.5) == 10


def test_whole_numbers_and_words_have_equal_shares() -> None:
    units = (np.arange(1200) + 0.5) / 1200
    axes: list[Axis] = [
        Range(3, 6, "integer"),
        Range(3.0, 6.0, whole=True),
        Choices(("a", None, True, 4)),
    ]
    for axis in axes:
        drawn = [axis.drawn(unit) for unit in units]
        assert [drawn.count(value) for value in dict.fromkeys(drawn)] == [300] * 4


def test_range_without_a_count_is_only_drawn_from() -> None:
    axis = Range(0.0, 1.0)
    assert axis.count is None
    with pytest.raises(ValueError, match="without a count"):
        axis.ladder()


def test_values_one_by_one_keep_their_order() -> None:
    axis = Choices((3, 1, 2))
    assert (_ladder(axis), axis.count, axis.ends) == ([3, 1, 2], 3, (1, 3))
    words = Choices(("b", None, "a"))
    assert (_ladder(words), words.is_numeric, words.ends) == (["b", None, "a"], False, words.values)


@pytest.mark.parametrize(
    ("axis", "is_logarithmic"),
    [
        (Choices((1, 10, 100)), True),
        (Choices((1, 2, 3)), False),
        (Choices((0, 10, 1000)), False),
        (Choices((1, 1000)), False),
        (Choices(("a", "b", "c")), False),
        (Range(1, 10, "log", 3), True),
        (Range(1, 1000, "linear", 3), False),
    ],
)
def test_axis_knows_whether_it_is_logarithmic(axis: Axis, is_logarithmic: bool) -> None:
    assert axis.is_logarithmic is is_logarithmic


values = st.one_of(
    st.none(), st.booleans(), st.integers(0, 2**64 - 1), numbers, st.text(max_size=5)
)


@given(
    st.one_of(
        ranges("linear"),
        ranges("log"),
        whole_ranges(),
        st.builds(lambda low: Range(low, low + 5, "integer"), st.integers(0, 10**6)),
        st.builds(Range, st.just(math.pi), st.just(4.0)),
        st.builds(Choices, st.lists(values, min_size=1, max_size=5).map(tuple)),
    )
)
def test_axis_survives_a_json_document(axis: Axis) -> None:
    back = axis_from_data(json.loads(json.dumps(axis_to_data(axis))))
    assert back == axis
    if axis.count is not None:
        assert list(map(repr, back.ladder())) == list(map(repr, axis.ladder()))


UNIT = Range(0.0, 1.0)


def unit_axes(count: int) -> dict[str, Axis]:
    return {f"k{number}": UNIT for number in range(count)}


def points(
    cases: Cases, first: int, last: int
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.array([list(case.values()) for case in cases.values(first, last)], dtype=np.float64)


grids = st.dictionaries(
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


@given(grids)
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
        if sampling == "grid" and mixed[key].is_numeric:
            assert cases.numbers(key).tolist() == cases.column(key)


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


@given(st.one_of(ranges("linear"), ranges("log"), whole_ranges()), st.floats(0.001, 0.999))
def test_place_is_where_a_value_is_drawn(axis: Range, unit: float) -> None:
    value = axis.drawn(unit)
    place = axis.place(value)
    assert 0 <= place <= 1
    # The same value again, and of numbers that are not rounded the same place.
    assert axis.drawn(place) == pytest.approx(value, rel=1e-6, abs=1e-6)
    if not axis.whole:
        assert place == pytest.approx(unit, abs=1e-3)


@given(st.integers(-50, 50), st.integers(0, 40), st.floats(0.001, 0.999))
def test_place_of_whole_numbers(low: int, width: int, unit: float) -> None:
    axis = Range(low, low + width, "integer")
    value = axis.drawn(unit)
    assert axis.drawn(axis.place(value)) == value
