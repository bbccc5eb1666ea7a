"""Runs side by side: the figures that tell how each went, and which of them is the best."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilc_cli.errors import UnknownNameError, UsageError
from hilc_cli.names import in_short, listed
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.run import RunData, distinct_names
from hilc_cli.results.summary import summarise

_LONG = 1e6  # numbers from here on are written with an exponent

Value = str | int | float | None


@dataclass(frozen=True, slots=True)
class Column:
    """One thing that a table tells of each of its rows.

    Attributes:
        name: Machine name with its unit, as in the CSV files.
        title: What it is called in words.
        heading: The same in few characters, for above a column.
        unit: Of the printed values; empty for none.
        digits: Significant digits of the printed values; whole numbers have all of theirs.
        scale: Printed values are so many times the stored ones.
        absent: What is printed where there is no value.
        section: The part that it belongs to where a table is too wide for its page; empty for
            what names a row, which stands in each part.
        is_ranked: Whether a small value is a good one.
        is_optional: Whether it is not printed where no row has a value.
    """

    name: str
    title: str
    heading: str
    unit: str = ""
    digits: int = 4
    scale: float = 1.0
    absent: str = ""
    section: str = ""
    is_ranked: bool = False
    is_optional: bool = False

    def text(self, value: Value) -> str:
        """A value as it is printed, without its unit."""
        if value is None:
            return self.absent
        if isinstance(value, float):
            return number_text(self.scale * value, self.digits)
        return str(value)


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table.

    Attributes:
        values: By column; None where there is none.
        group: Rows of one group have done the same task, so that one can be better.
        may_be_best: Whether it takes part in that.
    """

    values: tuple[Value, ...]
    group: int = 0
    may_be_best: bool = True


@dataclass(frozen=True, slots=True, repr=False)
class ComparisonTable:
    """What was compared, row by row.

    Attributes:
        title: What it is.
        columns: The columns.
        rows: The rows.
        note: What a reader of the printed table must know.
        mark_note: What it means that a value is marked as the best.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    note: str = ""
    mark_note: str = ""

    def __repr__(self) -> str:
        return in_short(
            f"{self.title}: {len(self.rows)} rows, {len(self.columns)} columns",
            listed(column.name for column in self.columns),
        )

    def values(self, name: str) -> list[Value]:
        """A column by its name.

        Raises:
            UnknownNameError: There is no such column; names those that there are.
        """
        names = [column.name for column in self.columns]
        if name not in names:
            raise UnknownNameError("column", name, names)
        place = names.index(name)
        return [row.values[place] for row in self.rows]

    def records(self) -> list[dict[str, Value]]:
        """The rows, each with its values by the names of the columns."""
        names = [column.name for column in self.columns]
        return [dict(zip(names, row.values, strict=True)) for row in self.rows]

    def printed(self) -> list[int]:
        """Places of the columns that are printed."""
        return [
            place
            for place, column in enumerate(self.columns)
            if not column.is_optional or any(row.values[place] is not None for row in self.rows)
        ]

    def best(self, place: int) -> frozenset[int]:
        """The rows that are the best of their group in a column.

        Values that are printed alike are equally good. Where all rows of a group are, none is the
        best.

        Args:
            place: Of the column.

        Returns:
            Places of the rows.
        """
        column = self.columns[place]
        if not column.is_ranked:
            return frozenset()
        found: set[int] = set()
        for group in {row.group for row in self.rows}:
            members = [number for number, row in enumerate(self.rows) if row.group == group]
            printed = {
                number: float(column.text(value))
                for number in members
                if self.rows[number].may_be_best
                and isinstance(value := self.rows[number].values[place], int | float)
                and math.isfinite(value)
            }
            least = min(printed.values(), default=math.nan)
            best = {number for number, value in printed.items() if value == least}
            if len(best) < len(members):
                found |= best
        return frozenset(found)


SETTINGS = "Settings"
ERRORS, LEARNING = "Errors of the last iteration", "Wheel speeds and learning"

RUN_COLUMNS = (
    Column("run", "Run", "Run"),
    Column("law", "Learning law", "Law", section=SETTINGS, is_optional=True),
    Column("gains", "Gains", "Gains", section=SETTINGS, is_optional=True),
    Column("compensation", "Compensation", "Compensation", section=SETTINGS, is_optional=True),
    Column("start_offset", "Start offset", "Start offset", section=SETTINGS, is_optional=True),
    Column("trajectory", "Trajectory", "Trajectory", section=ERRORS),
    Column("path_size_m", "Path size", "Size", "m", section=ERRORS),
    Column("iterations", "Iterations", "Iterations", section=LEARNING),
    Column(
        "max_position_error_m", "Maximum position error", "Max. error", "m",
        section=ERRORS, is_ranked=True,
    ),
    Column(
        "max_position_error_second_half_m", "Maximum position error, second half",
        "Max. 2nd half", "m", section=ERRORS, is_ranked=True,
    ),
    Column(
        "mean_position_error_m", "Mean position error", "Mean error", "m",
        section=ERRORS, is_ranked=True,
    ),
    Column(
        "rms_position_error_m", "RMS position error", "RMS error", "m",
        section=ERRORS, is_ranked=True,
    ),
    Column(
        "final_position_error_m", "Position error at the end", "End error", "m",
        section=ERRORS, is_ranked=True,
    ),
    Column(
        "max_abs_error_heading_rad", "Maximum heading error", "Heading error", "rad",
        section=ERRORS, is_ranked=True,
    ),
    Column(
        "max_wheel_speed_rad_s", "Fastest wheel", "Fastest wheel", "rad/s",
        section=LEARNING,
    ),
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
    groups: list[Reference] = []
    rows = []
    for run, name in zip(runs, distinct_names([run.name for run in runs]), strict=True):
        if len(run.metrics) == 0:
            raise UsageError(f"{name}: has no completed iteration, so there is nothing to compare")
        group = next(
            (number for number, other in enumerate(groups) if _is_same(run.reference, other)),
            len(groups),
        )
        if group == len(groups):
            groups.append(run.reference)
        rows.append(Row(_values(run, name), group, may_be_best=run.diverged_at is None))
    title = f"Comparison of {len(runs)} runs"
    return ComparisonTable(title, RUN_COLUMNS, tuple(rows), RUN_NOTE, RUN_MARK_NOTE)


def number_text(value: float, digits: int) -> str:
    """A number with so many significant digits, such as 0.5000 or 1.230e-5; zero is 0.

    Up to a million a number has all digits before its point.
    """
    if value == 0:
        return "0"
    text = f"{value:#.{digits}g}"
    if "e+" in text and abs(value) < _LONG:
        return f"{value:.0f}"
    mantissa, _, exponent = text.partition("e")
    return mantissa.rstrip(".") + (f"e{int(exponent)}" if exponent else "")


def _values(run: RunData, name: str) -> tuple[Value, ...]:
    summary = summarise(run)
    final = summary.final
    later = final["max_position_error_second_half_m"]  # which folders of before do not have
    values: dict[str, Value] = {
        "run": name,
        **{column: run.settings.get(column) for column in _SETTINGS},
        "trajectory": summary.trajectory,
        "path_size_m": summary.path_size_m,
        "iterations": summary.iterations,
        "max_position_error_m": final["max_position_error_m"],
        "max_position_error_second_half_m": None if math.isnan(later) else later,
        "mean_position_error_m": final["mean_position_error_m"],
        "rms_position_error_m": final["rms_position_error_m"],
        "final_position_error_m": final["final_position_error_m"],
        "max_abs_error_heading_rad": final["max_abs_error_heading_rad"],
        "max_wheel_speed_rad_s": final["max_wheel_speed_rad_s"],
        "speed_limit_rad_s": run.speed_limit,
        "iterations_to_1_percent": summary.settled_at["1 %"],
        "iterations_to_0_1_percent": summary.settled_at["0.1 %"],
        "peak_max_position_error_m": summary.peak_max_position_error_m,
        "peak_iteration": summary.peak_iteration,
        "saturated_share": summary.saturated_share,
        "diverged_at": summary.diverged_at,
    }
    return tuple(values[column.name] for column in RUN_COLUMNS)


def _is_same(one: Reference, other: Reference) -> bool:
    """Whether two references ask the same of a robot, sample by sample."""
    return one.sample_time == other.sample_time and all(
        np.array_equal(a, b)
        for a, b in ((one.x, other.x), (one.y, other.y), (one.heading, other.heading))
    )
