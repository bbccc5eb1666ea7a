"""Values of one key: spread as asked for, exact at the ends and at the decimals in between."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.variation.axes import Axis, Choices, Range, Spacing, axis_from_data, axis_to_data

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
    assert Range(0.05, 1.0, "linear", 20).ladder() == [round(0.05 * k, 2) for k in range(1, 21)]
    assert Range(-1.0, 1.0, "linear", 5).ladder() == [-1, -0.5, 0, 0.5, 1]
    assert Range(0.1, 0.7, "linear", 7).ladder() == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]


def test_logarithmic_range_has_the_powers_of_ten() -> None:
    assert Range(1e-3, 1e3, "log", 7).ladder() == [1e-3, 1e-2, 0.1, 1, 10, 100, 1000]


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
    assert [axis.at(index) for index in range(len(ladder))] == ladder


@given(whole_ranges())
def test_whole_numbers_are_rounded_and_taken_once(axis: Range) -> None:
    ladder = axis.ladder()
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
    assert axis.ladder() == [1, 2, 3, 4, 5, 7, 10]
    assert axis.count == 7


@given(st.integers(-(10**9), 10**9), st.integers(0, 300))
def test_integers_are_all_there(low: int, more: int) -> None:
    axis = Range(low, low + more, "integer")
    assert axis.ladder() == list(range(low, low + more + 1))
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
    for ask in (axis.ladder, lambda: axis.at(0)):
        with pytest.raises(ValueError, match="without a count"):
            ask()


def test_values_one_by_one_keep_their_order() -> None:
    axis = Choices((3, 1, 2))
    assert (axis.ladder(), axis.count, axis.ends) == ([3, 1, 2], 3, (1, 3))
    words = Choices(("b", None, "a"))
    assert (words.ladder(), words.is_numeric, words.ends) == (["b", None, "a"], False, words.values)


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
