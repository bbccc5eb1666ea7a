"""Strict reading of what hilc has written, in a folder that may come from anybody.

Whatever else stands there is told in one line, ``FILE: is damaged: ...``, which says what is wrong
and where, but shows nothing of the content.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import sys
from array import array
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NoReturn, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, Strict, ValidationError

from hilc_cli.errors import UsageError
from hilc_cli.files import read_file
from hilc_cli.names import check_name
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.plain_tables import plain_file, plain_table

MAX_CSV_BYTES = 2_000_000_000
MAX_JSON_BYTES = 100_000_000
_MOST_JSON_VALUES = 5_000_000
"""A document has no more: a few keys of a sweep may have lists of a million values."""
_MOST_JSON_LISTS = 500_000
"""Lists and mappings, of which each takes many times the memory that it takes on the disk."""

_Document = TypeVar("_Document", bound="Document")
_KNOWN_PLACE = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]{0,199}")


def damaged(path: Path, what: str, line: int | None = None) -> UsageError:
    """The error that tells of damage.

    Args:
        path: The damaged file.
        what: What is wrong, without anything of the content.
        line: Where, from 1; None for the whole file.
    """
    return UsageError(f"{path}{'' if line is None else f':{line}'}: is damaged: {what}")


# --- JSON documents


class Document(BaseModel):
    """What must stand in a JSON document; what else stands there does not matter.

    Nothing is converted, and all numbers are finite.
    """

    model_config = ConfigDict(strict=True, allow_inf_nan=False, frozen=True, defer_build=True)


Name = Annotated[str, AfterValidator(check_name)]
Count = Annotated[int, Field(ge=0, le=1_000_000_000)]
Length = Annotated[float, Field(ge=0, le=1e9)]
"""A tolerance [m]."""
Pair = Annotated[tuple[float, float], Strict(False)]


def one_of(names: Collection[str]) -> AfterValidator:
    """What lets a text of a document be nothing but one of some names."""

    def check(text: str) -> str:
        if text not in names:
            raise ValueError("has no such name")
        return text

    return AfterValidator(check)


def read_document(path: Path, shape: type[_Document]) -> _Document:
    """Reads a JSON file.

    Args:
        path: The file.
        shape: What must stand in it.

    Raises:
        UsageError: Something else does.
        HilcError: There is no such file, or it cannot be read.
    """
    return parse_document(path, read_file(path, MAX_JSON_BYTES), shape)


def parse_document(
    path: Path, content: bytes, shape: type[_Document], line: int | None = None
) -> _Document:
    """The document that a text of JSON holds.

    Args:
        path: The file that the text comes from.
        content: The text.
        shape: What must stand in it.
        line: Of the file, if each line is a document of its own.

    Raises:
        UsageError: Something else stands in it.
    """
    try:
        return shape.model_validate(_parse_json(content))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        message = first["msg"].removeprefix("Value error, ").removeprefix("Input ")
        where = ".".join(_known_places(first["loc"]))
        if first["type"] == "model_type":  # whose name says nothing to whoever has no sources
            message = "should be a mapping"
        text = f"{message[:1].lower()}{message[1:]}"
        raise damaged(path, f"{where}: {text}" if where else text, line) from None
    except _NotJsonError as error:
        raise damaged(path, str(error), line) from None
    except (ValueError, RecursionError):
        raise damaged(path, "is no JSON", line) from None


def _known_places(places: Sequence[int | str]) -> Iterator[str]:
    """The keys down to a value, as far as they are no texts of somebody's own."""
    for place in places:
        if isinstance(place, str) and not _KNOWN_PLACE.fullmatch(place):
            return
        yield str(place)


class _NotJsonError(ValueError):
    """JSON that is not to be read, with what is wrong in words."""


def _parse_json(content: bytes) -> Any:
    if content.count(b",") > _MOST_JSON_VALUES or (
        content.count(b"[") + content.count(b"{") > _MOST_JSON_LISTS
    ):
        raise _NotJsonError("has too many values")
    data = json.loads(
        content,
        parse_constant=_no_number,
        parse_float=_finite,
        object_pairs_hook=_without_repeats,
    )
    if rb"\ud" in content.lower():
        try:  # halves of a character, which no file and no terminal takes
            json.dumps(data, ensure_ascii=False).encode()
        except UnicodeEncodeError:
            raise _NotJsonError("holds half a character") from None
    return data


def _no_number(text: str) -> NoReturn:
    raise _NotJsonError("numbers must be finite")


def _finite(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _no_number(text)


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise _NotJsonError("has a key twice")
    return found


# --- CSV tables


@dataclass(frozen=True, slots=True)
class Numbers:
    """What the cells of a column may be.

    Attributes:
        low: The smallest number.
        high: The largest one.
        whole: Whether numbers are whole.
        empty: Whether a cell may be empty, which reads as not-a-number.
        infinite: Whether a number may be infinite, beyond the largest one.
    """

    low: float = -sys.float_info.max
    high: float = sys.float_info.max
    whole: bool = False
    empty: bool = False
    infinite: bool = False

    def check(self, values: Floats, tell: Callable[[int, str], Exception]) -> None:
        """Makes sure that numbers are as they may be.

        Args:
            values: The numbers.
            tell: Makes the error of the place of a wrong number and what is wrong with it.
        """
        # Most often all fit, which takes less to tell; what is not-a-number fails here.
        within = len(values) > 0 and self.low <= values.min() and values.max() <= self.high
        if within and not self.whole:
            return
        fits = (values >= self.low) & (values <= self.high)
        if self.whole:
            fits &= values == np.floor(values)
        if self.infinite:
            fits |= values == np.inf
        if self.empty:
            fits |= np.isnan(values)
        if fits.all():
            return
        place = int(np.argmin(fits))
        if not math.isfinite(values[place]) and not self.infinite:
            raise tell(place, "numbers must be finite")
        raise tell(place, f"must be a {'whole ' if self.whole else ''}number{self._range}")

    @property
    def _range(self) -> str:
        if self.high < sys.float_info.max:
            return f" from {self.low:g} to {self.high:g}"
        return f" from {self.low:g} on" if self.low > -sys.float_info.max else ""


def check_columns(
    path: Path, columns: Sequence[tuple[str, Numbers]], numbers: Floats, first_line: int = 2
) -> None:
    """Makes sure that all columns of a table are as they may be.

    Args:
        path: The file that the table comes from.
        columns: Names and what may stand in them.
        numbers: Shape (rows, columns).
        first_line: The line of the first row.

    Raises:
        UsageError: One is not; names it and the line.
    """
    for (name, kind), values in zip(columns, numbers.T, strict=True):

        def tell(row: int, what: str, name: str = name) -> UsageError:
            # Names of columns come from a header that has been checked.
            text = what if what.startswith("numbers") else f"{name} {what}"
            return damaged(path, text, first_line + row)

        kind.check(values, tell)


def table_rows(
    path: Path, header: Sequence[str] | None = None, content: bytes | None = None
) -> Iterator[list[str]]:
    """The rows of a CSV file as texts: first its header, then rows of as many cells.

    Args:
        path: The file.
        header: What the first line must be; None for anything.
        content: What stands in the file, if that is known.

    Raises:
        UsageError: It is no such table, or a row has another number of cells.
        HilcError: It cannot be read.
    """
    binary = io.BytesIO(read_file(path, MAX_CSV_BYTES) if content is None else content)
    # utf-8-sig: spreadsheets put a mark in front.
    rows = csv.reader(io.TextIOWrapper(binary, "utf-8-sig", "replace", newline=""))
    line = 1
    try:
        first = next(rows, [])
        if header is not None and first != list(header):
            raise no_such_table(path, header)
        yield first
        for line, row in enumerate(rows, 2):
            if len(row) != len(first):
                raise damaged(path, f"{len(first)} cells should stand here", line)
            yield row
    except csv.Error:
        raise damaged(path, "is no line of a table", line + 1) from None


def no_such_table(path: Path, header: Sequence[str]) -> UsageError:
    """The error that tells of a table of something else."""
    return UsageError(f"{path}: is no such table; its first line must be {','.join(header)}")


def read_numbers(
    path: Path, columns: Sequence[tuple[str, Numbers]], content: bytes | None = None
) -> Floats:
    """Reads a CSV file of numbers.

    Args:
        path: The file.
        columns: Names and what may stand in them.
        content: What stands in the file, if that is known.

    Returns:
        The numbers, shape (rows, columns).

    Raises:
        UsageError: It is no such table, or damaged.
        HilcError: It cannot be read.
    """
    header = [name for name, _ in columns]
    plain = (
        plain_file(path, MAX_CSV_BYTES, header) if content is None else plain_table(content, header)
    )
    if plain is not None and (plain.full.all() or _may_be_empty(columns)):
        check_columns(path, columns, plain.numbers)
        return plain.numbers
    rows = table_rows(path, header, content)
    next(rows)
    return parse_numbers(path, columns, rows)


def _may_be_empty(columns: Sequence[tuple[str, Numbers]]) -> bool:
    """Whether some cells of a table may be empty."""
    return any(kind.empty for _, kind in columns)


def parse_numbers(
    path: Path, columns: Sequence[tuple[str, Numbers]], rows: Iterator[list[str]]
) -> Floats:
    """The numbers of a table's rows, shape (rows, columns).

    Raises:
        UsageError: A cell is none of its column.
    """
    numbers, may_be_empty = array("d"), _may_be_empty(columns)
    try:
        for row in rows:
            numbers.extend(
                [float(cell) if cell else math.nan for cell in row]
                if may_be_empty
                else map(float, row)
            )
    except ValueError:
        line = len(numbers) // len(columns) + 2
        raise damaged(path, "holds something that is no number", line) from None
    table: Floats = np.asarray(numbers, dtype=np.float64).reshape(-1, len(columns))
    check_columns(path, columns, table)
    return table


def check_counted(path: Path, what: str, numbers: Floats, first: int = 0) -> None:
    """Makes sure that the first column of a table counts its rows.

    Args:
        path: The file that the table comes from.
        what: What is counted.
        numbers: The column.
        first: From where on.

    Raises:
        UsageError: It does not; names the line.
    """
    wrong = np.flatnonzero(numbers != np.arange(first, first + len(numbers)))
    if len(wrong):
        row = int(wrong[0])
        raise damaged(path, f"{what} {first + row} should stand here", row + 2)
