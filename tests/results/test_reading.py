"""Strict reading: what stands there instead is one line that shows nothing of it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.results.reading import (
    Count,
    Document,
    Name,
    Numbers,
    Pair,
    check_counted,
    parse_document,
    read_document,
    read_numbers,
)

FILE = Path("x.json")


class Shape(Document):
    """A document of each type."""

    name: Name
    count: Count
    size: float
    pair: Pair
    maybe: float | None = None


GOOD = '{"name": "a", "count": 1, "size": 2, "pair": [1, 2.5], "more": "x"}'


def test_what_fits_is_read(tmp_path: Path) -> None:
    (tmp_path / "x.json").write_text(GOOD)
    found = read_document(tmp_path / "x.json", Shape)
    assert found == Shape(name="a", count=1, size=2.0, pair=(1.0, 2.5))
    with pytest.raises(UsageError, match=r"y\.json: there is no such file"):
        read_document(tmp_path / "y.json", Shape)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (GOOD, "", "is no JSON"),
        (GOOD, "[" * 100_000, "is no JSON"),
        (GOOD, "\0" * 9, "is no JSON"),
        (GOOD, GOOD[:-3], "is no JSON"),
        (GOOD, "[" + "[]," * 600_000 + "[]]", "has too many values"),
        (GOOD, "[]", "should be a mapping"),
        ('"count": 1,', "", "count: field required"),
        ("1,", "1.0,", "count: should be a valid integer"),
        ("1,", "true,", "count: should be a valid integer"),
        ("1,", "null,", "count: should be a valid integer"),
        ("1,", "-1,", "count: should be greater than or equal to 0"),
        ("1,", f"{10**400},", "count: should be less than or equal to 1000000000"),
        ("1,", f"{'9' * 5000},", "is no JSON"),
        ("2,", "1e309,", "numbers must be finite"),
        ("2,", "NaN,", "numbers must be finite"),
        ("2,", "-Infinity,", "numbers must be finite"),
        ("2,", f"{10**400},", "size: should be a valid number"),
        ("2,", '"2",', "size: should be a valid number"),
        ("[1, 2.5]", "[1]", "pair.1: field required"),
        ("[1, 2.5]", "{}", "pair: should be a valid tuple"),
        ('"a"', '""', "name: is no name; use letters, digits, '.', '_' and '-'"),
        ('"a"', '"\\u001b[31m"', "name: is no name; use letters, digits, '.', '_' and '-'"),
        ('"a"', '"a\\n"', "name: is no name; use letters, digits, '.', '_' and '-'"),
        ('"a"', '"-a"', "name: is no name; begin with a letter or digit: options and formulas"),
        ('"x"', '"\\ud800"', "holds half a character"),
        ('"more"', '"name"', "has a key twice"),
    ],
)
def test_what_does_not_fit(old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(UsageError) as caught:
        parse_document(FILE, GOOD.replace(old, new, 1).encode(), Shape)
    assert str(caught.value).startswith(f"x.json: is damaged: {message}")
    assert len(str(caught.value)) < 120


def test_line_of_a_file_of_many_documents() -> None:
    with pytest.raises(UsageError, match=r"^x\.json:7: is damaged: is no JSON$"):
        parse_document(FILE, b"{", Shape, 7)


COLUMNS = [("k", Numbers(0, whole=True)), ("a", Numbers(0, 9)), ("b", Numbers(-1, empty=True))]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("1,2", "3 cells should stand here"),
        ("1,2,3,4", "3 cells should stand here"),
        ("", "3 cells should stand here"),
        ("1,x,3", "holds something that is no number"),
        ("1,\x1b[31m,3", "holds something that is no number"),
        ("1,nan,3", "numbers must be finite"),
        ("1,,3", "numbers must be finite"),
        ("1,1e309,3", "numbers must be finite"),
        ("1,10,3", "a must be a number from 0 to 9"),
        ("1,2,-2", "b must be a number from -1 on"),
        ("1.5,2,3", "k must be a whole number from 0 on"),
        (f"1,2,1{'0' * 400}", "numbers must be finite"),
    ],
)
def test_cells_that_do_not_fit(tmp_path: Path, row: str, message: str) -> None:
    (tmp_path / "x.csv").write_text(f"k,a,b\n0,9,\n{row}\n1,1,1\n")
    with pytest.raises(UsageError) as caught:
        read_numbers(tmp_path / "x.csv", COLUMNS)
    assert str(caught.value) == f"{tmp_path}/x.csv:3: is damaged: {message}"


def test_cells_that_fit(tmp_path: Path) -> None:
    (tmp_path / "x.csv").write_bytes(b"\xef\xbb\xbfk,a,b\r\n0,9,\r\n1,0.5,-1\r\n")
    found = read_numbers(tmp_path / "x.csv", COLUMNS)
    np.testing.assert_array_equal(found, [[0, 9, math.nan], [1, 0.5, -1]])
    check_counted(tmp_path / "x.csv", "row", found[:, 0])
    with pytest.raises(UsageError, match=r"x\.csv:3: is damaged: row 1 should stand here"):
        check_counted(tmp_path / "x.csv", "row", np.array([0.0, 2.0]))
