"""Values of one key as people write them, on the command line and in YAML."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given, strategies as st

from hilc_cli.scenario.sweep_section import axis_text, read_axis, shown_axis
from hilc_cli.variation import Axis, Choices, Range, Spacing, axis_from_data, axis_to_data


@pytest.mark.parametrize(
    ("written", "axis"),
    [
        ("0.1,1,10", Choices((0.1, 1, 10))),
        (" 0.1 , 1e1 ", Choices((0.1, 10.0))),
        ("180,null", Choices((180, None))),
        ("measured,reference", Choices(("measured", "reference"))),
        ("true,false", Choices((True, False))),
        ("0x10,017,no", Choices((16, 17, "no"))),
        ("20 cm,pi/2", Choices(("20 cm", "pi/2"))),
        ("example:circle,example:spiral", Choices(("example:circle", "example:spiral"))),
        ("-1", Choices((-1,))),
        ([0.1, None, "a:b"], Choices((0.1, None, "a:b"))),
        ((1, 2), Choices((1, 2))),
        (0.5, Choices((0.5,))),
        (None, Choices((None,))),
        ([{"name": "x"}], Choices(({"name": "x"},))),  # type: ignore[arg-type]
        ("0:1:11", Range(0.0, 1.0, "linear", 11)),
        ("0:1:11:linear", Range(0.0, 1.0, "linear", 11)),
        (" 0.1 : 10 : 20 : log ", Range(0.1, 10.0, "log", 20)),
        ("0.1:10", Range(0.1, 10.0)),
        ("0.1:10:log", Range(0.1, 10.0, "log")),
        ("20 cm:50 cm:4", Range(0.2, 0.5, "linear", 4)),
        ("-pi:pi:5", Range(-math.pi, math.pi, "linear", 5)),
        ("80 deg:100 deg:3", Range(math.radians(80), math.radians(100), "linear", 3)),
        ("1/4:(1+1)/4:2", Range(0.25, 0.5, "linear", 2)),
        ("1..30", Range(1, 30, "integer")),
        (" -3 .. 3 ", Range(-3, 3, "integer")),
        ("7..7", Range(7, 7, "integer")),
    ],
)
def test_values_are_read(written: object, axis: Axis) -> None:
    assert read_axis(written) == axis


@pytest.mark.parametrize(
    ("written", "problem"),
    [
        ("", "has an empty value"),
        ("1,,2", "has an empty value"),
        ([], "has no values"),
        ([[1]], "must hold single values"),
        ({"a": 1}, "must hold values, not keys"),
        ("1:0:3", "must rise"),
        ("1:1:3", "must rise"),
        ("3..1", "must rise"),
        ("0:1:1", "needs 2 or more values"),
        ("0:1:-3", "needs 2 or more values"),
        ("0:1:2.0", "needs 2 or more values"),
        ("0:1:3:4", "is no range"),
        ("0:log", "is no range"),
        ("0:1:3:log", "has no logarithm"),
        ("0:1e999:3", "must be finite"),
        ("1e999:2:3", "must be finite"),
        ("a:1:3", "holds 'a', which has the unknown name 'a'"),
        ("1;2:3:3", "holds '1;2', which has ';', which is no part of it"),
        ("0:1:1000001", "has 1000001 values"),
        ("0..1000000", "has 1000001 values"),
    ],
)
def test_what_stands_for_no_values_is_refused(written: object, problem: str) -> None:
    with pytest.raises(ValueError) as caught:
        read_axis(written)
    assert str(caught.value) == problem


def test_values_that_have_been_read_stay_as_they_are() -> None:
    axis = Range(1.0, 2.0)
    assert read_axis(axis) is axis


@st.composite
def ranges(draw: st.DrawFn) -> Range:
    spacing: Spacing = draw(st.sampled_from(("linear", "log")))
    low = draw(st.floats(1e-300, 1e6) if spacing == "log" else st.floats(-1e6, 1e6))
    high = draw(st.floats(low, 1e9, exclude_min=True))
    return Range(low, high, spacing, draw(st.none() | st.integers(2, 10**6)))


integers = st.integers(-(10**6), 10**6).map(lambda low: Range(low, low + 9, "integer"))
numbers = st.integers(-(10**100), 10**100) | st.floats(-1e100, 1e100)  # larger than any key takes
choices = st.lists(
    st.none() | st.booleans() | numbers | st.text(min_size=1),
    min_size=1,
    max_size=5,
).map(lambda values: Choices(tuple(values)))


@given(st.one_of(ranges(), integers, choices))
def test_text_of_an_axis_reads_back(axis: Axis) -> None:
    text = axis_text(axis)
    assert read_axis(json.loads(json.dumps(text))) == axis
    assert axis_from_data(json.loads(json.dumps(axis_to_data(axis)))) == axis


@pytest.mark.parametrize(
    "written", ["true,false,null,180", "0.1,1", "a,b", "0.1:10:3:log", "20 cm:50 cm:4", "1..30"]
)
def test_messages_show_values_as_they_are_written(written: str) -> None:
    assert shown_axis(read_axis(written)) == written
