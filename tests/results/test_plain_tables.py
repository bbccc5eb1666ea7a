"""Fast reading of large tables: the same numbers and the same errors as cell by cell."""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from hilc_cli.errors import UsageError
from hilc_cli.numba_loading import DISABLED
from hilc_cli.reference.sampled import Reference
from hilc_cli.results import plain_tables
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.plain_tables import plain_file, plain_table
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


def each_parsed(cells: list[str]) -> list[float | None]:
    """The number of each cell in a table of its own; None where it is not plain."""
    found = map(parsed, ([cell] for cell in cells))
    return [None if numbers is None else numbers[0] for numbers in found]


def is_middle(cell: str) -> bool:
    """Whether a number lies in the middle between two floats."""
    exact, near = Fraction(cell), float(cell)
    beside = math.nextafter(near, math.inf if exact > near else -math.inf)
    return exact == (Fraction(near) + Fraction(beside)) / 2


@pytest.mark.parametrize("form", ["{!r}", "{:.16e}", "{:.17e}", "{:.0e}", "{:.15G}"])
def test_floats_of_every_size_read_as_python_does(form: str) -> None:
    words = np.random.default_rng(1).integers(0, 2**64, 5000, np.uint64).view(np.float64)
    cells = [form.format(number) for number in words[np.isfinite(words)].tolist()]
    found = each_parsed(cells)
    for cell, number in zip(cells, found, strict=True):
        assert number in (None, float(cell)), cell
        if 1e-250 < abs(float(cell)) < 1e250 and not is_middle(cell):
            assert number is not None, cell


@pytest.mark.parametrize("after", range(18))
@pytest.mark.parametrize("before", range(1, 19))
def test_any_number_of_digits_stands_before_and_after_the_point(before: int, after: int) -> None:
    cells = []
    for digits in ("9876543210" * 4, "1" + "0" * 40, "0" * 40, "9" * 40):
        point = f".{digits[before : before + after]}" if after else ""
        cells += [f"{sign}{digits[:before]}{point}" for sign in ("", "-")]
    for cell, number in zip(cells, each_parsed(cells), strict=True):
        assert number in (None, float(cell)), cell
        few = before + after <= 18 or int(cell.replace(".", "")) == 0
        if few and not is_middle(cell):
            assert number is not None, cell


@pytest.mark.parametrize(
    "cell",
    [
        *("0", "-0", "0.0", "-0.0", "0e0", "0.000000000000000000000", "0e-270", "00012", "1e22"),
        *("9007199254740991", "9007199254740992", "9007199254740992.0", "4503599627370495.5"),
        *("999999999999999999", "123456789.123456789", "0.1", "1e21", "8.5e22", "1E-5", "1e+05"),
    ],
)
def test_particular_numbers_are_plain(cell: str) -> None:
    (number,) = each_parsed([cell])
    assert number is not None
    assert (number, math.copysign(1, number)) == (float(cell), math.copysign(1, float(cell)))


@pytest.mark.parametrize(
    "cell", ["5e-324", "2.2250738585072014e-308", "1.7976931348623157e308", "1e309", "1e-9999"]
)
def test_numbers_at_the_ends_of_floats_are_left_to_others(cell: str) -> None:
    assert parsed([cell]) is None


@given(st.integers(0, 10**18), st.integers(-270, 250), st.sampled_from(["", "-"]))
def test_any_decimal_number_is_rounded_as_python_does(digits: int, power: int, sign: str) -> None:
    cell = f"{sign}{digits}e{power}"
    assert parsed([cell]) in (None, [float(cell)])


@given(st.integers(2**52, 2**53 - 1), st.integers(1, 6), st.integers(-1, 1))
def test_what_lies_in_the_middle_is_left_to_others(
    float_bits: int, power: int, beside: int
) -> None:
    middle = (2 * float_bits + 1) * 2 ** (power - 1)
    found = parsed([str(middle + beside)])
    if beside == 0:
        assert found is None
    else:
        assert found in (None, [float(middle + beside)])


@given(st.integers(2**52, 2**53 - 1))
def test_middles_with_a_point_are_left_to_others(float_bits: int) -> None:
    whole, rest = divmod(2 * float_bits + 1, 4)
    cell = f"{whole}.{25 * rest}"
    assert is_middle(cell)
    assert parsed([cell]) is None


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
        *("1/2", "1:2", "/1", ":1", "1.:", "1./", "1.2:", "1e:", "12345678:", "1.12345678/"),
        *("1234567\N{DEGREE SIGN}", "\N{LATIN SMALL LETTER Y WITH DIAERESIS}", "1\0", "1;2"),
    ],
)
def test_other_cells_are_not_plain(cell: str) -> None:
    assert parsed(["1", cell, "2"]) is None


@pytest.mark.parametrize("digits", range(9))
def test_no_other_byte_is_a_digit(digits: int) -> None:
    for byte in set(range(256)) - set(b'0123456789,\n\r+-.eE"'):
        cell = b"1" * digits + bytes([byte]) + b"2" * (8 - digits)
        assert plain_table(b"a\n" + cell + b"\n", ["a"]) is None, byte


@pytest.mark.parametrize("piece", [20, 21, 33, 64, 1000])
def test_a_table_is_read_in_pieces(piece: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_tables, "_PIECE", piece)
    numbers = (
        np.random.default_rng(2).integers(-(10**8), 10**8, (50, 2))
        // 10 ** np.arange(8, -1, -1).repeat(6)[:50, None]
    )
    lines = "".join(f"{a},{b}\n" for a, b in numbers.tolist())
    found = plain_table(f"a,b\n{lines}".encode(), ["a", "b"])
    assert found is not None
    np.testing.assert_array_equal(found.numbers, numbers)
    assert plain_table(f"a,b\n{lines}{'1' * 17},{'1' * 1000}\n".encode(), ["a", "b"]) is None


def test_rows_of_numbers_that_become_shorter_have_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plain_tables, "_PIECE", 40)
    cells = ["1.2345678901234567", "2.3456789012345678"] + [str(n % 10) for n in range(500)]
    assert parsed(cells) == list(map(float, cells))


def test_a_file_that_changes_is_left_to_others(tmp_path: Path) -> None:
    content = b"a\n1\n2\n"
    (tmp_path / "a.csv").write_bytes(content)
    assert plain_file(tmp_path / "a.csv", 100, ["a"]) is not None
    for size in (len(content) - 1, len(content) + 1):
        assert plain_tables._plain(io.BytesIO(content), size, ["a"]) is None


def test_whole_columns_and_empty_cells() -> None:
    found = plain_table(b"a,b,c\n1,1.0,\n-2,2,3\n3,3e1,4\n", ["a", "b", "c"])
    assert found is not None
    assert found.whole.tolist() == [True, False, True]
    np.testing.assert_array_equal(found.numbers, [[1, 1, np.nan], [-2, 2, 3], [3, 30, 4]])
    assert found.full.tolist() == [True, True, False]


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
