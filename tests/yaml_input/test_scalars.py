"""What unquoted words mean: YAML 1.2, not 1.1."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from hilc_cli.yaml_input.nodes import Scalar, Source
from hilc_cli.yaml_input.tree import parse_yaml

SOURCE = Source("file.yaml", Path())


def value_of(text: str) -> str | int | float | bool | None:
    node = parse_yaml(text.encode(), SOURCE)
    assert isinstance(node, Scalar)
    return node.value


VALUES: list[tuple[str, str | float | bool | None]] = [
    ("1e3", 1000.0),
    ("1E+3", 1000.0),
    ("-1.5e-2", -0.015),
    (".5", 0.5),
    ("-.5", -0.5),
    ("5.", 5.0),
    ("+1", 1),
    ("-1", -1),
    ("0", 0),
    ("017", 17),
    ("-017", -17),
    ("0o17", 15),
    ("0x1F", 31),
    ("0xdead", 57005),
    ("~", None),
    ("null", None),
    ("Null", None),
    ("NULL", None),
    ("true", True),
    ("True", True),
    ("FALSE", False),
    ("false", False),
    (".inf", math.inf),
    ("+.Inf", math.inf),
    ("-.INF", -math.inf),
    # Text, where YAML 1.1 or Python would see something else.
    ("no", "no"),
    ("yes", "yes"),
    ("on", "on"),
    ("off", "off"),
    ("y", "y"),
    ("n", "n"),
    ("tRUE", "tRUE"),
    ("nULL", "nULL"),
    ("1_000", "1_000"),
    ("0b11", "0b11"),
    ("0o8", "0o8"),
    ("0X1F", "0X1F"),
    ("-0x1F", "-0x1F"),
    ("-0o17", "-0o17"),
    ("12:30:45", "12:30:45"),
    ("2026-11-22", "2026-11-22"),
    ("1e", "1e"),
    ("e3", "e3"),
    (".", "."),
    ("1.2.3", "1.2.3"),
    ("inf", "inf"),
    ("nan", "nan"),
    ("infinity", "infinity"),
    ("=", "="),
    ("<<", "<<"),
    ("+", "+"),
    ("٣", "٣"),  # an Arabic three
    ("１", "１"),  # noqa: RUF001 # a full-width one
    ("1 ", 1),
    ("pi/2", "pi/2"),
    # Quotes and block styles make text of anything.
    ("'1'", "1"),
    ('"1e3"', "1e3"),
    ('"true"', "true"),
    ("'~'", "~"),
    ("''", ""),
    ("|\n  12\n", "12\n"),
    (">-\n  1\n  2\n", "1 2"),
]


@pytest.mark.parametrize(("text", "value"), VALUES, ids=[repr(text) for text, _ in VALUES])
def test_scalar_has_the_value_of_yaml_1_2(text: str, value: str | float | bool | None) -> None:
    found = value_of(text)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize("text", [".nan", ".NaN", ".NAN"])
def test_not_a_number_is_one(text: str) -> None:
    value = value_of(text)
    assert isinstance(value, float) and math.isnan(value)


def test_whole_numbers_are_exact_beyond_the_floats() -> None:
    assert value_of("18446744073709551615") == 2**64 - 1


def test_digits_without_end_stay_text() -> None:
    assert value_of("9" * 5000) == "9" * 5000
