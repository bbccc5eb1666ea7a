"""Runs side by side: a table of them in several formats, and one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.comparisons.formats import FILES, WRITERS
from hilc_cli.comparisons.table import Column, ComparisonTable, Row, Value
from hilc_cli.errors import UsageError
from hilc_cli.files import merge_folder
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF, METRICS
from hilc_cli.results.run import RunData, distinct_names
from hilc_cli.results.summary import summarise
from hilc_cli.runs.running import RunSource, as_runs
from hilc_cli.wording import listed, near_name, printable, suggestion

if TYPE_CHECKING:
    from pandas import DataFrame

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
    *(
        Column(name, title, title, section=SETTINGS, is_optional=True, is_setting=True)
        for name, title in (
            ("gains", "Gains"),
            ("compensation", "Compensation"),
            ("start_offset", "Start offset"),
        )
    ),
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

OTHER_METRICS = tuple(
    _of_metric(name, ERRORS if metric.unit in ("m", "rad") else LEARNING)
    for name, metric in METRICS.items()
    if name not in {column.name for column in RUN_COLUMNS}
)
"""What it tells as well if it is asked to."""

ROWS = tuple(column.name for column in (*RUN_COLUMNS[1:], *OTHER_METRICS))
"""Names of all that can be told of a run, beside its own."""

_SETTINGS = tuple(column.name for column in RUN_COLUMNS if column.section == SETTINGS)

RUN_NOTE = (
    "Errors and the fastest wheel are those of the last iteration. "
    "From the iteration given for 1 % and 0.1 % on, the maximum error stays within that share of "
    "the path's size. Samples at the speed limit are counted over all iterations."
)
RUN_MARK_NOTE = "the best of the runs on the same trajectory"


def chosen_columns(rows: Sequence[str]) -> tuple[Column, ...]:
    """The columns that tell some of what can be told of runs, in the order that is asked for.

    Args:
        rows: Some of `ROWS`; what is there twice counts once, and none gives the usual ones.

    Raises:
        UsageError: There is no such row.
    """
    if not rows:
        return RUN_COLUMNS
    known = {column.name: column for column in (*RUN_COLUMNS, *OTHER_METRICS)}
    for name in rows:
        if name not in ROWS:
            near = near_name(name, ROWS)
            meant = f"did you mean '{near}'?" if near else f"known: {', '.join(ROWS)}"
            raise UsageError(f"there is no row '{printable(name)}' in a table of runs; {meant}")
    # What somebody asks for is told, even if there is nothing to tell.
    chosen = (replace(known[name], is_optional=False) for name in dict.fromkeys(rows))
    return (RUN_COLUMNS[0], *chosen)


def compare_runs(runs: Sequence[RunData], rows: Sequence[str] = ()) -> ComparisonTable:
    """A table of runs, in the order in which they are given.

    Runs on the very same reference are of one group. One that has diverged is not the best in
    anything: its figures are of the last iteration that could be completed.

    Args:
        runs: At least two; equal names are told apart by a number.
        rows: As of `chosen_columns`.

    Raises:
        UsageError: There are fewer, one has no completed iteration, or there is no such row.
    """
    columns = chosen_columns(rows)
    if len(runs) < 2:
        raise UsageError(f"a comparison needs at least two runs, got {len(runs)}")
    groups: dict[tuple[float, bytes], int] = {}  # of what is asked of a robot, sample by sample
    found = []
    for run, name in zip(runs, distinct_names([run.name for run in runs]), strict=True):
        if len(run.metrics) == 0:
            raise UsageError(f"{name}: has no completed iteration, so there is nothing to compare")
        asked = run.reference.sample_time, (run.reference.poses + 0.0).tobytes()  # -0 is 0
        group = groups.setdefault(asked, len(groups))
        values = _values(run, name)
        chosen = tuple(values[column.name] for column in columns)
        found.append(Row(chosen, group, may_be_best=run.diverged_at is None))
    title = f"Comparison of {len(runs)} runs"
    return ComparisonTable(title, columns, tuple(found), RUN_NOTE, RUN_MARK_NOTE)


def _values(run: RunData, name: str) -> dict[str, Value]:
    summary = summarise(run)
    return {
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


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Comparison(InNotebooks):
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

    def to_pandas(self) -> DataFrame:
        """A data frame of pandas with a row per run and the columns of comparison.csv.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        return self.table.to_pandas()

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
        look: Look = USUAL,
    ) -> list[Path]:
        """Writes comparison.csv, comparison.md, comparison.tex and the picture.

        Args:
            folder: Where to put them; made if it is not there.
            force: Replace files of the same name and other content.
            formats: Of the picture: png, svg, pdf.
            plots: Whether to draw it.
            look: How it is to look, from `picture_look`.

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

                files += save_comparison(self.runs, into, formats, look=look)
            return files

        return merge_folder(Path(folder), fill, lambda file: force, or_same=True)


def compare(runs: Sequence[RunSource], *, rows: Sequence[str] = ()) -> Comparison:
    """Puts runs side by side; nothing is simulated.

    Args:
        runs: At least two, from `run` or `read_run`, or the folders of runs.
        rows: What the table tells of each run, in this order: metrics and other columns of
            comparison.csv by their names; the usual ones by default.

    Raises:
        UsageError: There are fewer runs, one has no completed iteration, or there is no such row.
    """
    chosen_columns(rows)  # told before runs are read
    found = as_runs(runs)
    return Comparison(tuple(found), compare_runs(found, rows))
