"""Fast reading of large tables: the same numbers and the same errors as cell by cell."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from hilc_cli.errors import UsageError
from hilc_cli.numba_loading import DISABLED
from hilc_cli.reference.sampled import Reference
from hilc_cli.results import plain_tables
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.plain_tables import plain_table
from hilc_cli.results.reading import Numbers, read_numbers
from hilc_cli.results.tables import read_samples, write_samples
from hilc_cli.results.trial import Trial
from hilc_cli.sweeps.case_table import read_cases, write_cases
from hilc_cli.variation import Axis, Cases, Choices, Range

pytestmark = pytest.mark.skipif(DISABLED, reason="machine code is switched off")

NEVER = sys.maxsize
IN_A_TEST = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


@pytest.fixture(autouse=True)
def any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_tables, "_LARGE", 0)


def parsed(cells: list[str]) -> list[float] | None:
    """The numbers of a table with one column, if it is plain."""
    found = plain_table("\n".join(["a", *cells, ""]).encode(), ["a"])
    return None if found is None else found.numbers[:, 0].tolist()


usual = st.floats(allow_nan=False, allow_infinity=False).filter(
    lambda number: number == 0 or 1e-250 < abs(number) < 1e250
)


@given(st.lists(usual, max_size=50))
def test_every_float_reads_back(numbers: list[float]) -> None:
    found = parsed(list(map(repr, numbers)))
    assert found == numbers
    assert list(map(math.copysign, [1.0] * len(numbers), found)) == [
        math.copysign(1.0, number) for number in numbers
    ]


@given(st.integers(0, 10**18), st.integers(-270, 250), st.sampled_from(["", "-"]))
def test_any_decimal_number_is_rounded_as_python_does(digits: int, power: int, sign: str) -> None:
    cell = f"{sign}{digits}e{power}"
    assert parsed([cell]) in (None, [float(cell)])


@given(st.integers(2**53, 2**59).map(lambda half: 2 * half + 1), st.integers(-1, 1))
def test_what_lies_in_the_middle_is_left_to_others(middle: int, beside: int) -> None:
    digits = middle // 2**5 * 2**5 + 2**4 + beside
    found = parsed([str(digits)])
    assert found in (None, [float(digits)])


@pytest.mark.parametrize(
    "cell",
    [
        *(
            "nan",
            "inf",
            "-inf",
            "",
            "-",
            "--1",
            "+1",
            ".5",
            "5.",
            "1.5.2",
            "0x1",
            "1_0",
            " 1",
            "1 ",
        ),
        *("1e", "1e+", "1e5.0", "1e99999", "1e-400", "9" * 19, '"1"', "1,2", "1\r", "1\n"),
        "\N{ARABIC-INDIC DIGIT TWO}",
    ],
)
def test_other_cells_are_not_plain(cell: str) -> None:
    assert parsed(["1", cell, "2"]) is None


def test_whole_columns_and_empty_cells() -> None:
    found = plain_table(b"a,b,c\n1,1.0,\n-2,2,3\n3,3e1,4\n", ["a", "b", "c"])
    assert found is not None
    assert found.whole.tolist() == [True, False, True]
    np.testing.assert_array_equal(found.numbers, [[1, 1, np.nan], [-2, 2, 3], [3, 30, 4]])
    assert not found.is_full


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"a",
        b"b\n1\n",
        b"a\n1",
        b"a,b\n1,2\n",
        b"a\n1\n\n2\n",
        b"a\n1\n2,\n",
        b"\xef\xbb\xbfa\n1\n",
    ],
)
def test_other_tables_are_not_plain(content: bytes) -> None:
    assert plain_table(content, ["a"]) is None


def test_small_tables_are_left_to_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_tables, "_LARGE", 5)
    assert plain_table(b"a\n1\n", ["a"]) is None
    assert plain_table(b"a\n12\n", ["a"]) is not None


# --- As strict as reading cell by cell

KINDS = [("a", Numbers(0, 9, whole=True)), ("b", Numbers(empty=True)), ("c", Numbers(-5, 5))]
FULL = [("a", Numbers(0, 9, whole=True)), ("b", Numbers(0)), ("c", Numbers(-5, 5))]
NUMBERS = "a,b,c\n1,2.5,3\n4,,-0.5\n7,1e-05,0.1\n"
AXES: dict[str, Axis] = {"x": Range(0.0, 1.0, "linear", 2), "n": Choices((1, 3))}


def samples(folder: Path) -> Path:
    ahead = np.array([0.0, 0.1, 0.2])
    reference = Reference("path", 0.1, ahead, 5 * ahead, 0 * ahead)
    one = np.array([0.25, 1 / 3])
    x, y, heading = reference.poses.T
    trials = [Trial(i, x + i, y + i, heading + i, one, -one) for i in range(2)]
    write_samples(folder / "samples.csv", reference, trials)
    return folder / "samples.csv"


def cases(folder: Path) -> Path:
    columns = {name: np.arange(4.0) / 2 for name in CASE_COLUMNS}
    columns |= {name: np.array([1.0, np.nan, 0, 1]) for name in CASE_COLUMNS if "d" in name}
    columns |= {name: np.array([1.0, 0, 0, 1]) for name, what in CASE_COLUMNS.items() if what.whole}
    values = {key: Cases(AXES).column(key) for key in AXES}
    write_cases(folder / "cases.csv", values, columns)
    return folder / "cases.csv"


def numbers(folder: Path) -> Path:
    (folder / "numbers.csv").write_text(NUMBERS)
    return folder / "numbers.csv"


def arrays(found: object) -> list[object]:
    """Whatever a reader returns as types and lists that can be compared."""
    if isinstance(found, np.ndarray):
        return [str(found.dtype), np.nan_to_num(found, nan=-77.0).tolist()]
    if isinstance(found, dict):
        return [[key, arrays(value)] for key, value in found.items()]
    if isinstance(found, tuple | list):
        return [arrays(part) for part in found]
    if isinstance(found, Trial | Reference):
        return [arrays(getattr(found, name)) for name in ("x", "y", "heading")]
    return [found]


Reader = Callable[[Path], object]
READERS: dict[str, tuple[Callable[[Path], Path], Reader]] = {
    "samples": (samples, lambda path: read_samples(path, "path")),
    "cases": (cases, lambda path: read_cases(path, AXES)),
    "grid": (cases, lambda path: read_cases(path, AXES, is_grid=True)),
    "numbers": (numbers, lambda path: read_numbers(path, KINDS)),
    "full": (numbers, lambda path: read_numbers(path, FULL)),
}
PIECES = ["", *',,,\n\n\r"-+.eE0123456789 _\0naif', ",,", "1e400", "1e-300", "nan", "-0", "\xa0"]


def outcome(read: Reader, path: Path) -> list[object] | str:
    try:
        return arrays(read(path))
    except UsageError as error:
        return str(error)


@pytest.mark.parametrize("kind", READERS)
@settings(IN_A_TEST, max_examples=60)
@given(data=st.data())
def test_damage_is_told_as_ever(
    kind: str, data: st.DataObject, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, read = READERS[kind]
    path = write(tmp_path)
    content = path.read_bytes()
    for _ in range(data.draw(st.integers(0, 2))):
        at = data.draw(st.integers(0, len(content)))
        removed = data.draw(st.integers(0, 3))
        content = (
            content[:at] + data.draw(st.sampled_from(PIECES)).encode() + content[at + removed :]
        )
    path.write_bytes(content)
    fast = outcome(read, path)
    with monkeypatch.context() as patch:
        patch.setattr(plain_tables, "_LARGE", NEVER)
        assert outcome(read, path) == fast


@pytest.mark.parametrize("kind", ["samples", "cases", "grid", "numbers"])
def test_undamaged_tables_are_read_fast(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, read = READERS[kind]
    path = write(tmp_path)
    for slow in ("csv.reader", "numpy.loadtxt"):
        monkeypatch.setattr(slow, lambda *_: pytest.fail("is read cell by cell"))
    assert isinstance(outcome(read, path), list)
