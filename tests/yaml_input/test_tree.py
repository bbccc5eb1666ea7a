"""Where each value of a YAML file stands, what of YAML is read, and what is written."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from hilc_cli.errors import InvalidInputError
from hilc_cli.yaml_input.nodes import ListNode, MapNode, Node, Scalar, Source, to_data
from hilc_cli.yaml_input.tree import parse_yaml, to_yaml

SOURCE = Source("f", Path())


def parse(text: str) -> Node:
    return parse_yaml(text.encode(), SOURCE)


def places(node: Node, path: str = "") -> dict[str, str]:
    """``LINE:COLUMN`` of each value by its dotted path; ``path=`` is the place of the key."""
    found = {path: str(node.place).removeprefix("f:")}
    if isinstance(node, ListNode):
        for index, item in enumerate(node.items):
            found |= places(item, f"{path}.{index}".lstrip("."))
    if isinstance(node, MapNode):
        for key, value in node.entries.items():
            inner = f"{path}.{key}".lstrip(".")
            found[f"{inner}="] = str(node.key_places[key]).removeprefix("f:")
            found |= places(value, inner)
    return found


def test_places_in_block_style() -> None:
    text = "# comment\nrobot:\n  radius:   0.2\n\n  track:\n    - 1\n    -  two\n"
    assert places(parse(text)) == {
        "": "2:1",
        "robot=": "2:1",
        "robot": "3:3",
        "robot.radius=": "3:3",
        "robot.radius": "3:13",
        "robot.track=": "5:3",
        "robot.track": "6:5",
        "robot.track.0": "6:7",
        "robot.track.1": "7:8",
    }


def test_places_in_flow_style_over_several_lines() -> None:
    text = "start: {x: 1,\n  y: [2,\n 3], z: {w: 4}}\n"
    assert places(parse(text)) == {
        "": "1:1",
        "start=": "1:1",
        "start": "1:8",
        "start.x=": "1:9",
        "start.x": "1:12",
        "start.y=": "2:3",
        "start.y": "2:6",
        "start.y.0": "2:7",
        "start.y.1": "3:2",
        "start.z=": "3:6",
        "start.z": "3:9",
        "start.z.w=": "3:10",
        "start.z.w": "3:13",
    }


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("a:\r\n  b: 1\r\n  c: 2\r\n", "3:6"),
        ("\ufeffa:\n  b: 1\n  c: 2\n", "3:6"),
        ("a: # note: here\n  b: 1 # and: here\n  c: 2\n", "3:6"),
        ("---\na:\n  b: 1\n  c: 2\n...\n", "4:6"),
        ("%YAML 1.2\n---\na: {b: 1,\n c: 2}\n", "4:5"),
        ("a: {b: äöü, c: 2}", "1:16"),
        ("a: {b: 😀, c: 2}", "1:14"),
        ("a: {b: 'x', c: 2}", "1:16"),
        ('a: {"b": 1, "c": 2}', "1:18"),
        ("a:\n  b: |\n    text\n    more\n  c: 2\n", "5:6"),
    ],
)
def test_place_of_a_value(text: str, place: str) -> None:
    assert places(parse(text))["a.c"] == place


def test_byte_order_mark_does_not_shift_the_first_line() -> None:
    assert places(parse("\ufeffa: 1"))["a"] == "1:4"


def test_windows_line_ends_leave_no_trace_in_values() -> None:
    assert to_data(parse("a: text\r\nb: 'x'\r\n")) == {"a": "text", "b": "x"}


def test_value_that_is_not_there_stands_behind_its_colon() -> None:
    tree = parse("a:\nb: 1\n")
    assert to_data(tree) == {"a": None, "b": 1}
    assert places(tree)["a"] == "1:3"


def test_alias_stands_for_the_anchored_value() -> None:
    tree = parse("a: &pose {x: 1, y: [2]}\nb: *pose\nc: [*pose, *pose]\n")
    pose = {"x": 1, "y": [2]}
    assert to_data(tree) == {"a": pose, "b": pose, "c": [pose, pose]}


def test_anchor_may_be_given_anew() -> None:
    assert to_data(parse("a: &n 1\nb: *n\nc: &n 2\nd: *n\n")) == {"a": 1, "b": 1, "c": 2, "d": 2}


def test_depth_of_twenty_is_read() -> None:
    text = "[" * 20 + "1" + "]" * 20
    node = parse(text)
    for _ in range(20):
        assert isinstance(node, ListNode)
        node = node.items[0]
    assert to_data(node) == 1


def test_quoted_merge_key_is_a_plain_key() -> None:
    assert to_data(parse("'<<': 1")) == {"<<": 1}


def test_keys_are_words_as_they_are_written() -> None:
    assert to_data(parse("1: a\n1.0: b\ntrue: c\nnull: d\n")) == {
        "1": "a",
        "1.0": "b",
        "true": "c",
        "null": "d",
    }


def problems(content: bytes) -> list[str]:
    with pytest.raises(InvalidInputError) as error:
        parse_yaml(content, SOURCE)
    return [str(problem) for problem in error.value.problems]


def test_all_duplicate_keys_are_told_at_once_in_order() -> None:
    assert problems(b"a: 1\nb: {c: 1, c: 2}\na: 3\na: 4\n") == [
        "f:2:11: b.c: is given twice, first in line 2; keep one of them",
        "f:3:1: a: is given twice, first in line 1; keep one of them",
        "f:4:1: a: is given twice, first in line 1; keep one of them",
    ]


def test_column_of_invalid_utf8_counts_characters() -> None:
    assert problems("a: 1\nb: ä".encode() + b"\xff") == [
        "f:2:5: is not UTF-8 text, got byte 0xff; save the file as UTF-8"
    ]


def test_second_document_is_an_error_even_if_empty() -> None:
    assert problems(b"a: 1\n---\n") == [
        "f:2:1: holds a second YAML document; keep one document in a file"
    ]


def test_alias_that_contains_itself_deep_down_is_an_error() -> None:
    assert problems(b"a: &x [{b: [*x]}]") == [
        "f:1:13: alias *x contains itself; write the value out"
    ]


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


TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=40) | st.sampled_from(
    ["", "1e3", "017", "0o17", "0x1F", "no", "true", "null", "~", ".5", "1_0", ".inf", "<<", "="]
)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**64), 2**64)
LEAVES = TEXTS | NUMBERS | st.booleans() | st.none()
KEYS = st.from_regex(r"[a-z_]{1,8}", fullmatch=True)
DATA = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=15,
)


def read_back(text: str) -> object:
    return to_data(parse_yaml(text.encode(), SOURCE))


@given(st.dictionaries(KEYS, DATA, min_size=1, max_size=4))
def test_written_data_reads_back_equal(data: dict[str, object]) -> None:
    found = read_back(to_yaml(data))
    assert found == data
    assert repr(found) == repr(data)  # types, the sign of zero and the order of keys


@pytest.mark.parametrize("text", ["a\u0085b", "a\u2028b", "\x07", "tab\there", "\ufeff", "  x  "])
def test_odd_characters_survive(text: str) -> None:
    assert read_back(to_yaml({"description": text})) == {"description": text}
