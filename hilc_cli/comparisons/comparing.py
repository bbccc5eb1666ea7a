"""Runs side by side: a table of them in several formats, and one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hilc_cli.comparisons.comparison import ComparisonTable, compare_runs
from hilc_cli.comparisons.tables import FILES, WRITERS
from hilc_cli.errors import UsageError, suggestion
from hilc_cli.files import merge_folder
from hilc_cli.names import listed
from hilc_cli.results.run import RunData
from hilc_cli.runs.running import RunSource, as_runs


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Comparison:
    """Several runs, and what tells them apart.

    Attributes:
        runs: The runs, in the order of the rows.
        table: Their figures.
    """

    runs: tuple[RunData, ...]
    table: ComparisonTable

    def __repr__(self) -> str:
        return f"Comparison of {len(self.runs)} runs: {listed(run.name for run in self.runs)}"

    def printed(self, *, everything: bool = False) -> list[ComparisonTable]:
        """The tables that are printed.

        Args:
            everything: Makes no difference: there is one.
        """
        return [self.table]

    def document(self) -> dict[str, Any]:
        """The rows as plain data, and the runs that are the best in each column that ranks them."""
        table = self.table
        titles = [str(row.values[0]) for row in table.rows]
        return {
            "runs": table.records(),
            "best": {
                column.name: [titles[number] for number in sorted(table.best(place))]
                for place, column in enumerate(table.columns)
                if column.is_ranked
            },
        }

    def text(self, kind: str) -> str:
        """The table as it stands in a file.

        Args:
            kind: csv, markdown or latex.

        Raises:
            UsageError: There is no such kind.
        """
        if kind not in WRITERS:
            raise UsageError(f"unknown kind of table '{kind}'; {suggestion(kind, WRITERS)}")
        return WRITERS[kind](self.table)

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        plots: bool = True,
    ) -> list[Path]:
        """Writes comparison.csv, comparison.md, comparison.tex and the picture.

        Args:
            folder: Where to put them; made if it is not there.
            force: Replace files of the same name and other content.
            formats: Of the picture: png, svg, pdf.
            plots: Whether to draw it.

        Returns:
            The files.

        Raises:
            ExistingResultsError: A file of other content stands there; nothing is written then.
            FileAccessError: They cannot be written.
            UsageError: There is no such picture format.
        """

        def fill(into: Path) -> list[Path]:
            files = [into / name for name in FILES.values()]
            for kind, file in zip(FILES, files, strict=True):
                file.write_text(self.text(kind), encoding="utf-8", newline="")
            if plots:
                from hilc_cli.comparisons.picture import save_comparison  # Matplotlib starts slowly

                files += save_comparison(self.runs, into, formats)
            return files

        return merge_folder(Path(folder), fill, lambda file: force, or_same=True)


def compare(runs: Sequence[RunSource]) -> Comparison:
    """Puts runs side by side; nothing is simulated.

    Args:
        runs: At least two, from `run` or `read_run`, or the folders of runs.

    Raises:
        UsageError: There are fewer, or one has no completed iteration.
    """
    found = as_runs(runs)
    return Comparison(tuple(found), compare_runs(found))
