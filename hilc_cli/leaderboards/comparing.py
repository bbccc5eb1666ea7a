"""A leaderboard: laws side by side in many cases, in tables of several formats and one picture."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.comparisons.formats import csv_text, latex_text, markdown_text
from hilc_cli.comparisons.table import ComparisonTable, Value
from hilc_cli.errors import UsageError
from hilc_cli.files import merge_folder
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.folder import LEADERBOARD_FOLDER, TABLES, read_leaderboard
from hilc_cli.leaderboards.plan import Leaderboard, load_leaderboard
from hilc_cli.leaderboards.tables import (
    cases_table,
    entries_table,
    laws_table,
    settings_records,
    settings_table,
)
from hilc_cli.results.folder import COMPILED_WITH, origin
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.look import USUAL, Look
from hilc_cli.wording import suggestion
from hilc_cli.workers.crews import available_cores

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LawComparison(InNotebooks):
    """Laws, and what became of each in each case.

    Attributes:
        data: All entries.
        checksum: Of all that the results depend on.
        how: What the manifest tells of the computation.
    """

    data: LeaderboardData
    checksum: str
    how: Mapping[str, Any]

    def __repr__(self) -> str:
        return repr(self.data).replace("LeaderboardData", "LawComparison", 1)

    @property
    def laws(self) -> dict[str, ComparisonTable]:
        """The laws over all cases and beliefs, by disturbance."""
        return {each: laws_table(self.data, each) for each in self.data.disturbances}

    @property
    def settings(self) -> ComparisonTable:
        """The worst error of each law by belief and disturbance."""
        return settings_table(self.data)

    @property
    def cases(self) -> ComparisonTable:
        """The error of each law, case by case."""
        return cases_table(self.data)

    @property
    def settings_records(self) -> list[dict[str, Value]]:
        """The worst error of each law, a record for each belief and disturbance."""
        return settings_records(self.data)

    @property
    def entries(self) -> ComparisonTable:
        """All runs."""
        return entries_table(self.data)

    def to_pandas(self) -> DataFrame:
        """A data frame of pandas with a row per run and the columns of leaderboard.csv.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        return self.data.to_pandas()

    def printed(self, *, everything: bool = False) -> list[ComparisonTable]:
        """The tables that are printed; with everything that of all runs, too."""
        tables = [*self.laws.values(), self.settings, self.cases]
        return [*tables, self.entries] if everything else tables

    def document(self) -> dict[str, Any]:
        """All tables as plain data."""
        return {
            "laws": {name: table.records() for name, table in self.laws.items()},
            "worst": self.settings_records,
            "runs": self.entries.records(),
        }

    def text(self, kind: str) -> str:
        """The tables as they stand in a file.

        Args:
            kind: csv, all runs; markdown or latex, the laws.

        Raises:
            UsageError: There is no such kind.
        """
        if kind == "csv":
            return csv_text(self.entries)
        if kind not in TABLES:
            raise UsageError(f"unknown kind of table '{kind}'; {suggestion(kind, TABLES)}")
        if kind == "latex":
            labels = [*self.data.disturbances, "worst", "cases"]
            tables = zip(self.printed(), labels, strict=True)
            return "\n".join(
                latex_text(each, f"{self.data.name}-{label}") for each, label in tables
            )
        return "\n".join(f"## {table.title}\n\n{markdown_text(table)}" for table in self.printed())

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        plots: bool = True,
        look: Look = USUAL,
        command: Sequence[str] = (),
    ) -> list[Path]:
        """Writes the folder: leaderboard.csv, leaderboard.md, leaderboard.tex and the picture.

        Args:
            folder: The very folder that is written; it is there as a whole or not at all.
            force: Replace the folder of another leaderboard.
            formats: Of the picture: png, svg, pdf.
            plots: Whether to draw it.
            look: How it is to look, from `picture_look`.
            command: Command line to note in the manifest.

        Returns:
            The files.

        Raises:
            ExistingResultsError: The folder holds another leaderboard, or is no leaderboard
                folder.
            FileAccessError: It cannot be written.
            UsageError: There is no such picture format.
        """

        def fill(into: Path) -> None:
            for kind, name in TABLES.items():
                (into / name).write_text(self.text(kind), encoding="utf-8", newline="")
            if plots:
                from hilc_cli.leaderboards.picture import save_leaderboard  # it starts slowly

                save_leaderboard(self.data, into, formats, look=look)

        def manifest() -> Mapping[str, Any]:
            return {
                "name": self.data.name,
                "checksum": self.checksum,
                "after": list(self.data.after),
                "tolerance_m": self.data.tolerance,
                **self.how,
                "command": list(command),
            }

        return LEADERBOARD_FOLDER.write(
            Path(folder),
            fill,
            manifest,
            lambda there: LEADERBOARD_FOLDER.check_checksum(there, self.checksum, force=force),
        )


def check_leaderboard_output(
    leaderboard: Leaderboard, folder: str | Path, *, force: bool = False
) -> None:
    """Whether the results may be written to a folder, before minutes are spent on them.

    Raises:
        ExistingResultsError: The folder holds another leaderboard, or is no leaderboard folder.
    """
    LEADERBOARD_FOLDER.check_checksum(Path(folder), leaderboard.checksum(), force=force)


def compare_laws(
    leaderboard: Leaderboard | str | Path | Mapping[str, object],
    *,
    workers: int | None = None,
    on_runs: Callable[[int], None] = lambda runs: None,
    go_on: Callable[[], None] = lambda: None,
) -> LawComparison:
    """Runs each law in each case with each belief and disturbance.

    Args:
        leaderboard: From `load_leaderboard`, or what it takes.
        workers: Processes on this machine; None: as many as it has cores. Nothing but the times
            depends on it.
        on_runs: Told how many runs are done.
        go_on: Called now and then; may raise to stop.

    Raises:
        FailedContestError: A run cannot be computed.
        WorkersError: Processes cannot be started.
    """
    # The compiler starts slowly.
    from hilc_cli.leaderboards.contests import compute_entries, run_heat

    if not isinstance(leaderboard, Leaderboard):
        leaderboard = load_leaderboard(leaderboard)
    started, clock = datetime.now(UTC), time.perf_counter()
    spec = leaderboard.spec
    contests = list(leaderboard.contests())
    work = partial(run_heat, after=spec.after, tolerance=spec.tolerance)
    entries = compute_entries(contests, work, workers or available_cores(), on_runs, go_on)
    return LawComparison(
        LeaderboardData(spec.name, spec.after, spec.tolerance, entries),
        leaderboard.checksum(),
        {
            **origin(started, COMPILED_WITH, leaderboard.plug_ins),
            "timings_s": {"computation": time.perf_counter() - clock},
            "inputs_sha256": dict(leaderboard.checksums),
        },
    )


def plot_leaderboard(
    data: LeaderboardData | LawComparison | str | Path,
    folder: str | Path,
    *,
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    look: Look = USUAL,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws the picture of a leaderboard.

    Args:
        data: From `compare_laws` or `read_leaderboard`, or the folder of a leaderboard.
        folder: Where to put leaderboard.FORMAT; made if it is not there.
        formats: png, svg, pdf.
        dpi: Resolution of png.
        look: How the picture is to look, from `picture_look`.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such format.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    from hilc_cli.leaderboards.picture import save_leaderboard  # Matplotlib starts slowly

    drawn = _entries_of(data)
    return merge_folder(
        Path(folder), lambda into: save_leaderboard(drawn, into, formats, dpi, look), may_replace
    )


def _entries_of(source: LeaderboardData | LawComparison | str | Path) -> LeaderboardData:
    """The entries that something has, those of a folder read."""
    if isinstance(source, LawComparison):
        return source.data
    return source if isinstance(source, LeaderboardData) else read_leaderboard(source)
