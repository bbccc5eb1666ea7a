"""The cells of the lines of a table, whatever parts them."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from itertools import zip_longest

from hilc_cli.reference.columns import is_unit


def separator_of(line: str) -> str | None:
    """What parts the cells of a line; None for white space."""
    line = re.sub(r"\"[^\"]*\"|[\[(][^\])]*[\])]", "", line)  # what is within a name parts none
    return next((sign for sign in ";," if sign in line), None)


def separator_below(header: str, first: str) -> str | None:
    """What parts the cells of the lines below a header, by the first of them."""
    separator = separator_of(first)
    both_have_tabs = "\t" in first and "\t" in header.strip()
    return "\t" if separator is None and both_have_tabs else separator


def names_of(header: str) -> list[str]:
    """The names of columns in a header; those in white space may have blanks between tabs."""
    separator = separator_of(header) or ("\t" if "\t" in header.strip() else None)
    if separator is None:  # a unit belongs to its name
        header = re.sub(
            r"\s*[\[(][^\])]*[\])]",
            lambda found: "".join(found[0].split()) if is_unit(found[0]) else found[0],
            header,
        )
    return cells_of(header, separator)


def are_units(line: str) -> bool:
    """Whether a line below a header tells the units of its columns."""
    cells = cells_of(line)
    return any(cells) and all(map(is_unit, cells))


def with_units(names: Sequence[str], units: Sequence[str]) -> list[str]:
    """The names of columns with the units that stand in a line below them."""
    named = zip_longest(names, units, fillvalue="")
    return [f"{name} [{bare}]" if (bare := unit.strip("[]() -")) else name for name, unit in named]


def cells_of(line: str, separator: str | None = None) -> list[str]:
    """The cells of a line; without a separator by what the line has."""
    separator = separator or separator_of(line)
    if separator is None:
        cells: Iterator[str] = iter(line.split())
    else:
        cells = iter(next(csv.reader([line], delimiter=separator, skipinitialspace=True)))
    return [cell.strip().strip("\"'") for cell in cells]


def has_decimal_commas(line: str) -> bool:
    """Whether commas stand within numbers that something else parts."""
    return re.search(r"\d,\d+[;\t ]\s*[-+]?\d+,\d", line) is not None


def is_number(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True
