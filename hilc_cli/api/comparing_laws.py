"""A leaderboard: laws side by side in many cases, in tables of several formats and one picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hilc_cli.errors import ExistingResultsError, UsageError, suggestion
from hilc_cli.files import merge_folder
from hilc_cli.results.comparison import ComparisonTable
from hilc_cli.results.comparison_tables import csv_text, latex_text, markdown_text
from hilc_cli.results.leaderboard import (
    LeaderboardData,
    entries_table,
    laws_table,
    settings_table,
)
from hilc_cli.spec.leaderboard import Leaderboard, load_leaderboard
from hilc_cli.sweeping.contests import Contests, hold
from hilc_cli.sweeping.crew import available_cores

__all__ = [
    "LawComparison",
    "Leaderboard",
    "check_leaderboard_output",
    "compare_laws",
    "load_leaderboard",
]

FILES = {"csv": "leaderboard.csv", "markdown": "leaderboard.md", "latex": "leaderboard.tex"}


@dataclass(frozen=True, slots=True, eq=False)
class LawComparison:
    """Laws, and what became of each in each case.

    Attributes:
        data: All entries.
    """

    data: LeaderboardData

    @property
    def laws(self) -> dict[str, ComparisonTable]:
        """The laws over all cases and beliefs, by disturbance."""
        return {each: laws_table(self.data, each) for each in self.data.disturbances}

    @property
    def settings(self) -> ComparisonTable:
        """The worst error of each law by belief and disturbance."""
        return settings_table(self.data)

    @property
    def entries(self) -> ComparisonTable:
        """All runs."""
        return entries_table(self.data)

    def text(self, kind: str) -> str:
        """The tables as they stand in a file.

        Args:
            kind: csv, all runs; markdown or latex, the laws.

        Raises:
            UsageError: There is no such kind.
        """
        if kind == "csv":
            return csv_text(self.entries)
        if kind not in FILES:
            raise UsageError(f"unknown kind of table '{kind}'; {suggestion(kind, FILES)}")
        tables = [*self.laws.values(), self.settings]
        if kind == "latex":
            return "\n".join(map(latex_text, tables))
        return "\n".join(f"## {table.title}\n\n{markdown_text(table)}" for table in tables)

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        plots: bool = True,
    ) -> list[Path]:
        """Writes leaderboard.csv, leaderboard.md, leaderboard.tex and the picture.

        Args:
            folder: Where to put them; made if it is not there.
            force: Replace files of the same name.
            formats: Of the picture: png, svg, pdf.
            plots: Whether to draw it.

        Returns:
            The files.

        Raises:
            ExistingResultsError: A file of that name stands there; nothing is written then.
            FileAccessError: They cannot be written.
            UsageError: There is no such picture format.
        """
        names: list[str] = []

        def fill(into: Path) -> None:
            for kind, name in FILES.items():
                (into / name).write_text(self.text(kind), encoding="utf-8", newline="")
                names.append(name)
            if plots:
                from hilc_cli.figures.leaderboard import (
                    save_leaderboard,
                )  # Matplotlib starts slowly

                names.extend(path.name for path in save_leaderboard(self.data, into, formats))

        merge_folder(Path(folder), fill, lambda file: force, or_same=True)
        return [Path(folder) / name for name in names]


def check_leaderboard_output(folder: str | Path, *, force: bool = False) -> None:
    """Whether the results may be written to a folder, before minutes are spent on them.

    Raises:
        ExistingResultsError: Results of another leaderboard stand there.
    """
    there = [Path(folder) / name for name in FILES.values() if (Path(folder) / name).exists()]
    if there and not force:
        raise ExistingResultsError(
            f"{there[0]}: exists; choose another folder with --out, or replace it with --force"
        )


def compare_laws(
    leaderboard: Leaderboard,
    *,
    workers: int | None = None,
    on_runs: Callable[[int], None] = lambda runs: None,
    go_on: Callable[[], None] = lambda: None,
) -> LawComparison:
    """Runs each law in each case with each belief and disturbance.

    Args:
        leaderboard: From `load_leaderboard`.
        workers: Processes on this machine; None: as many as it has cores. Nothing but the times
            depends on it.
        on_runs: Told how many runs are done.
        go_on: Called now and then; may raise to stop.

    Raises:
        FailedContestError: A run cannot be computed.
        WorkersError: Processes cannot be started.
    """
    spec = leaderboard.spec
    contests = Contests(tuple(leaderboard.contests()), spec.after, spec.tolerance)
    entries = hold(contests, workers or available_cores(), on_runs, go_on)
    return LawComparison(LeaderboardData(spec.name, spec.after, spec.tolerance, entries))
