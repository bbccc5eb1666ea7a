"""The folder of a leaderboard: what is in it, and how it is read back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, Strict

from hilc_cli.errors import UsageError
from hilc_cli.leaderboards.entries import Entry, LeaderboardData
from hilc_cli.leaderboards.tables import ERRORS, NAMES, OTHERS, error_name
from hilc_cli.names import check_name
from hilc_cli.results.folder import ResultFolder
from hilc_cli.results.reading import (
    Document,
    Length,
    Name,
    Numbers,
    damaged,
    parse_numbers,
    table_rows,
)
from hilc_cli.results.trial import LARGEST

TABLES = {"csv": "leaderboard.csv", "markdown": "leaderboard.md", "latex": "leaderboard.tex"}
"""The file that holds a kind of table."""

LEADERBOARD_PICTURE = "leaderboard"

LEADERBOARD_FOLDER = ResultFolder(
    what="leaderboard",
    kind="hilc compare --laws",
    other="another leaderboard",
    files=frozenset(TABLES.values()),
    pictures=(LEADERBOARD_PICTURE,),
)


class _Manifest(Document):
    """What is read of the manifest of a leaderboard."""

    name: Name
    after: Annotated[
        tuple[Annotated[int, Field(ge=0, le=10_000_000)], ...],
        Field(min_length=1, max_length=20),
        Strict(False),
    ]
    tolerance_m: Length


_ERROR = Numbers(0, LARGEST, infinite=True)
_ITERATION = Numbers(0, 1e9, whole=True, empty=True)
_OTHERS = {
    "within_at": _ITERATION,
    "within_share": Numbers(0, 1, empty=True),
    "settled_at": _ITERATION,
    "peak_m": Numbers(0, LARGEST, empty=True, infinite=True),
    "fastest_wheel_rad_s": Numbers(0),
    "speed_limit_rad_s": Numbers(0, empty=True),
    "diverged_at": _ITERATION,
    "seconds_per_iteration": Numbers(0, 1e9),
}
"""What stands in the columns behind the errors; whether the limit is kept follows from others."""


def _read_entries(path: Path, after: Sequence[int]) -> tuple[Entry, ...]:
    """Returns the entries of ``leaderboard.csv``, at least one, each as it was written.

    Raises:
        UsageError: It is no such table, or damaged.
    """
    errors = [error_name(what, count) for what in ERRORS for count in after]
    columns = [*NAMES, *errors, *OTHERS.values()]
    left_out = columns.index(OTHERS["keeps_limit"])
    rows = table_rows(path)
    if next(rows) != columns:
        raise UsageError(f"{path}: is no table of these runs; its first line does not fit")
    names: list[list[str]] = []

    def numbers_of_rows() -> Iterator[list[str]]:
        for line, row in enumerate(rows, 2):
            for column, cell in zip(NAMES, row, strict=False):
                try:
                    check_name(cell)
                except ValueError as error:
                    raise damaged(path, f"{column} {error}", line) from None
            names.append(row[: len(NAMES)])
            del row[left_out], row[: len(NAMES)]
            yield row

    kinds = [*((name, _ERROR) for name in errors), *((OTHERS[w], k) for w, k in _OTHERS.items())]
    numbers = parse_numbers(path, kinds, numbers_of_rows())
    if not names:
        raise UsageError(f"{path}: has no runs")
    # Cases in their order; of each the beliefs, the disturbances, and the laws.
    every = product(*(dict.fromkeys(column) for column in zip(*names, strict=True)))
    if names != list(map(list, every)):
        raise damaged(path, "it has not each law once in each case")
    return tuple(_entry(n, row, len(after)) for n, row in zip(names, numbers.tolist(), strict=True))


def _entry(names: Sequence[str], numbers: Sequence[float], counts: int) -> Entry:
    """The entry of a row."""
    found: dict[str, Any] = dict(zip(NAMES, names, strict=True))
    for place, what in enumerate(ERRORS):
        found[what] = tuple(numbers[place * counts : (place + 1) * counts])
    for (what, kind), number in zip(_OTHERS.items(), numbers[-len(_OTHERS) :], strict=True):
        found[what] = None if number != number else int(number) if kind.whole else number
    return Entry(**found)


def is_leaderboard(folder: str | Path) -> bool:
    """Whether a folder holds the results of a leaderboard."""
    return LEADERBOARD_FOLDER.is_at(folder)


def read_leaderboard(folder: str | Path) -> LeaderboardData:
    """The results in the folder of a leaderboard, from its table of all runs and its manifest.

    Raises:
        HilcError: There is no such folder, or a file is missing or damaged.
    """
    manifest = LEADERBOARD_FOLDER.read(Path(folder), _Manifest)
    entries = _read_entries(Path(folder) / TABLES["csv"], manifest.after)
    return LeaderboardData(manifest.name, manifest.after, manifest.tolerance_m, entries)
