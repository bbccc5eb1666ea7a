"""Runs side by side: a table of them in several formats, and one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hilc_cli.comparisons.formats import FILES, WRITERS
from hilc_cli.comparisons.table import Column, ComparisonTable, Row, Value
from hilc_cli.errors import UsageError
from hilc_cli.files import merge_folder
from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF, METRICS
from hilc_cli.results.run import RunData, distinct_names
from hilc_cli.results.summary import summarise
from hilc_cli.runs.running import RunSource, as_runs
from hilc_cli.wording import listed, suggestion

SETTINGS = "Settings"
ERRORS, LEARNING = "Errors of the last iteration", "Wheel speeds and learning"


def _of_metric(name: str, section: str, *, is_ranked: bool = False) -> Column:
    """The column of a metric of the last iteration."""
    metric = METRICS[name]
    return Column(
        name, metric.title, metric.heading, metric.unit, section=section, is_ranked=is_ranked
    )


RUN_COLUMNS = (
    Column("run", "Run", "Run"),
    Column("law", "Learning law", "Law", section=SETTINGS, is_optional=True),
    Column("gains", "Gains", "Gains", section=SETTINGS, is_optional=True),
    Column("compensation", "Compensation", "Compensation", section=SETTINGS, is_optional=True),
    Column("start_offset", "Start offset", "Start offset", section=SETTINGS, is_optional=True),
    Column("trajectory", "Trajectory", "Trajectory", section=ERRORS),
    Column("path_size_m", "Path size", "Size", "m", section=ERRORS),
    Column("iterations", "Iterations", "Iterations", section=LEARNING),
    *(
        _of_metric(name, ERRORS, is_ranked=True)
        for name in (
            MAX_ERROR,
            MAX_ERROR_SECOND_HALF,
            "mean_position_error_m",
            "rms_position_error_m",
            "final_position_error_m",
            "max_abs_error_heading_rad",
        )
    ),
    _of_metric("max_wheel_speed_rad_s", LEARNING),
    Column(
        "speed_limit_rad_s", "Speed limit", "Speed limit", "rad/s",
        absent="none", section=LEARNING,
    ),
    Column(
        "iterations_to_1_percent", "Within 1 % of path size from iteration", "Within 1 %",
        absent="never", section=LEARNING, is_ranked=True,
    ),
    Column(
        "iterations_to_0_1_percent", "Within 0.1 % of path size from iteration", "Within 0.1 %",
        absent="never", section=LEARNING, is_ranked=True,
    ),
    Column(
        "peak_max_position_error_m", "Largest maximum error on the way", "Peak error", "m",
        section=LEARNING,  # mostly that of iteration 0, before anything is learned: no merit
    ),
    Column("peak_iteration", "Largest in iteration", "Peak at", section=LEARNING),
    Column(
        "saturated_share", "Samples at the speed limit", "At limit", "%",
        digits=3, scale=100.0, section=LEARNING,
    ),
    Column("diverged_at", "Diverged in iteration", "Diverged", absent="no", section=LEARNING),
)  # fmt: skip
"""What a table of runs tells of each."""

_SETTINGS = tuple(column.name for column in RUN_COLUMNS if column.section == SETTINGS)

RUN_NOTE = (
    "Errors and the fastest wheel are those of the last iteration. "
    "From the iteration given for 1 % and 0.1 % on, the maximum error stays within that share of "
    "the path's size. Samples at the speed limit are counted over all iterations."
)
RUN_MARK_NOTE = "the best of the runs on the same trajectory"


def compare_runs(runs: Sequence[RunData]) -> ComparisonTable:
    """A table of runs, in the order in which they are given.

    Runs on the very same reference are of one group. One that has diverged is not the best in
    anything: its figures are of the last iteration that could be completed.

    Args:
        runs: At least two; equal names are told apart by a number.

    Raises:
        UsageError: There are fewer, or one has no completed iteration.
    """
    if len(runs) < 2:
        raise UsageError(f"a comparison needs at least two runs, got {len(runs)}")
    groups: dict[tuple[float, bytes], int] = {}  # of what is asked of a robot, sample by sample
    rows = []
    for run, name in zip(runs, distinct_names([run.name for run in runs]), strict=True):
        if len(run.metrics) == 0:
            raise UsageError(f"{name}: has no completed iteration, so there is nothing to compare")
        asked = run.reference.sample_time, (run.reference.poses + 0.0).tobytes()  # -0 is 0
        group = groups.setdefault(asked, len(groups))
        rows.append(Row(_values(run, name), group, may_be_best=run.diverged_at is None))
    title = f"Comparison of {len(runs)} runs"
    return ComparisonTable(title, RUN_COLUMNS, tuple(rows), RUN_NOTE, RUN_MARK_NOTE)


def _values(run: RunData, name: str) -> tuple[Value, ...]:
    summary = summarise(run)
    values: dict[str, Value] = {
        **summary.final,
        "run": name,
        **{column: run.settings.get(column) for column in _SETTINGS},
        "trajectory": summary.trajectory,
        "path_size_m": summary.path_size_m,
        "iterations": summary.iterations,
        "speed_limit_rad_s": run.speed_limit,
        "iterations_to_1_percent": summary.settled_at["1 %"],
        "iterations_to_0_1_percent": summary.settled_at["0.1 %"],
        "peak_max_position_error_m": summary.peak_max_position_error_m,
        "peak_iteration": summary.peak_iteration,
        "saturated_share": summary.saturated_share,
        "diverged_at": summary.diverged_at,
    }
    return tuple(values[column.name] for column in RUN_COLUMNS)


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
        """The tables that are printed; there is one, whether everything is asked for or not."""
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
