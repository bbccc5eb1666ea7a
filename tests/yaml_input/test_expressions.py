"""Numbers as people write them, against numbers by hand and Python's own arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress

import pytest
from hypothesis import assume, example, given, strategies as st

from hilc_cli.yaml_input.expressions import Affine, ExpressionError, Unit, evaluate

LENGTH, TIME, ANGLE = Unit(length=1), Unit(time=1), Unit(angle=1)
SPEED = Unit(length=1, time=-1)
TURNING = Unit(angle=1, time=-1)
PLAIN = Unit()

VALUES = [
    ("14*pi/15", 2.9321531433504737, PLAIN),
    ("31*pi/30", 3.246312408709453, PLAIN),
    ("-pi", -3.141592653589793, PLAIN),
    ("+-+-pi", 3.141592653589793, PLAIN),
    ("2*-3", -6.0, PLAIN),
    ("2--3", 5.0, PLAIN),
    ("2.5e-1", 0.25, PLAIN),
    (".5e1", 5.0, PLAIN),
    ("5.", 5.0, PLAIN),
    ("1E3", 1000.0, PLAIN),
    ("7-2-1", 4.0, PLAIN),
    ("16/4/2", 2.0, PLAIN),
    ("2+3*4", 14.0, PLAIN),
    ("(2+3)*4", 20.0, PLAIN),
    (" ( 1 ) ", 1.0, PLAIN),
    ("017", 17.0, PLAIN),
    ("90 deg", 1.5707963267948966, ANGLE),
    ("90deg", 1.5707963267948966, ANGLE),
    ("-90 deg", -1.5707963267948966, ANGLE),
    ("360/4 deg", 1.5707963267948966, ANGLE),
    ("pi/2 rad", 1.5707963267948966, ANGLE),
    ("20 cm", 0.2, LENGTH),
    ("33 mm", 0.033, LENGTH),
    ("1/2 m", 0.5, LENGTH),
    ("(1 + 2) m", 3.0, LENGTH),
    ("1 m + 20 cm", 1.2, LENGTH),
    ("2 m * 3", 6.0, LENGTH),
    ("3 * 2 m", 6.0, LENGTH),
    ("6 m / 3", 2.0, LENGTH),
    ("6 m / 3 m", 2.0, PLAIN),
    ("100 ms", 0.1, TIME),
    ("1e3ms", 1.0, TIME),
    ("1e3 s", 1000.0, TIME),
    ("10 m/s", 10.0, SPEED),
    ("36 km/h", 10.0, SPEED),
    ("1.8km/h + 1 m/s", 1.5, SPEED),
    ("9 km/h/s", 2.5, Unit(length=1, time=-2)),
    ("3 m/s^2", 3.0, Unit(length=1, time=-2)),
    ("3 m/s^2 * 2 s", 6.0, SPEED),
    ("50 cm^2", 0.005, Unit(length=2)),
    ("8 rad/m^2", 8.0, Unit(angle=1, length=-2)),
    ("6 m^3 / 3 m^2", 2.0, LENGTH),
    ("10 m / s", 10.0, SPEED),
    ("10 m / 2 s", 5.0, SPEED),
    ("10 m / 500 ms", 20.0, SPEED),
    ("10 m / (2 s)", 5.0, SPEED),
    ("1 m / (1 s + 1000 ms)", 0.5, SPEED),
    ("600 rpm", 62.83185307179586, TURNING),
    ("180 rad/s", 180.0, TURNING),
    ("360 deg/s", 6.283185307179586, TURNING),
    ("2*pi rad / 2 s", 3.141592653589793, TURNING),
    ("9.81 m/s/s", 9.81, Unit(length=1, time=-2)),
    ("2 s * 3 m/s", 6.0, LENGTH),
]


@pytest.mark.parametrize(("text", "value", "unit"), VALUES, ids=[text for text, _, _ in VALUES])
def test_value_and_unit(text: str, value: float, unit: Unit) -> None:
    found = evaluate(text)
    assert found.number.constant == pytest.approx(value, rel=1e-15)
    assert found.unit == unit
    assert found.is_constant


Built = tuple[str, Callable[[], float]]


def _number(value: float) -> Built:
    return repr(value), lambda: value


def _joined(first: Built, rest: list[tuple[str, Built]]) -> Built:
    """Operands from left to right, as text and as Python computes it."""
    operations: dict[str, Callable[[float, float], float]] = {
        "+": lambda a, b: a + b,
        "-": lambda a, b: a - b,
        "*": lambda a, b: a * b,
        "/": lambda a, b: a / b,
    }

    def value() -> float:
        total = first[1]()
        for operator, (_, operand) in rest:
            total = operations[operator](total, operand())
        return total

    return first[0] + "".join(f" {operator}{text}" for operator, (text, _) in rest), value


def _grown(inner: st.SearchStrategy[Built]) -> st.SearchStrategy[Built]:
    bracketed = inner.map(lambda built: (f"({built[0]})", built[1]))
    negated = bracketed.map(lambda built: (f"-{built[0]}", lambda: -built[1]()))
    factor = st.one_of(ATOMS, bracketed, negated)
    product = st.builds(
        _joined, factor, st.lists(st.tuples(st.sampled_from("*/"), factor), max_size=3)
    )
    return st.builds(
        _joined, product, st.lists(st.tuples(st.sampled_from("+-"), product), max_size=3)
    )


ATOMS: st.SearchStrategy[Built] = st.one_of(
    st.floats(0, 1e6, allow_subnormal=False).map(_number),
    st.integers(0, 10**9).map(lambda value: (str(value), lambda: float(value))),
    st.just(("pi", lambda: math.pi)),
)
ARITHMETIC = st.recursive(ATOMS, _grown, max_leaves=12)


@given(ARITHMETIC)
def test_arithmetic_agrees_with_python(built: Built) -> None:
    text, compute = built
    assume(len(text) <= 120)
    try:
        expected = compute()
    except ZeroDivisionError:
        with pytest.raises(ExpressionError, match="divides by zero"):
            evaluate(text)
        return
    assume(math.isfinite(expected))
    assert evaluate(text).number == Affine(expected)


@given(st.text(max_size=130))
@example("²")
@example("2*①")
@example("1 ²")
def test_any_text_is_a_value_or_an_expression_error(text: str) -> None:
    with suppress(ExpressionError):
        evaluate(text)


@given(st.text(alphabet="0123456789.eE+-*/() pimscodegrad", max_size=40))
def test_any_formula_is_a_value_or_an_expression_error(text: str) -> None:
    with suppress(ExpressionError):
        evaluate(text)


HEADING = {"cos": Affine(cos=1.0), "sin": Affine(sin=1.0), "R": Affine(0.2), "B": Affine(0.5)}
AFFINE = [
    ("cos", Affine(0, 1, 0)),
    ("cos/R", Affine(0, 5, 0)),
    ("-B/R", Affine(-2.5, 0, 0)),
    ("2*(cos - 3*sin)/4 + 1", Affine(1, 0.5, -1.5)),
    ("(cos + sin) * R", Affine(0, 0.2, 0.2)),
    ("cos*sin - cos*sin", None),
    ("sin*(cos-cos)", Affine(0, 0, 0)),
]


@pytest.mark.parametrize(("text", "expected"), AFFINE, ids=[text for text, _ in AFFINE])
def test_entry_of_a_gain_matrix_is_affine(text: str, expected: Affine | None) -> None:
    if expected is None:
        with pytest.raises(ExpressionError, match="multiplies cos and sin"):
            evaluate(text, HEADING, units=False)
        return
    number = evaluate(text, HEADING, units=False).number
    assert (number.constant, number.cos, number.sin) == pytest.approx(
        (expected.constant, expected.cos, expected.sin)
    )


def test_overflow_is_not_taken_for_a_dependence_on_the_heading() -> None:
    assert evaluate("1/(1*1e999)").number.constant == 0
