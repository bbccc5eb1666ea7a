"""The CSV files of a run: written so that every number reads back exactly."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.errors import UsageError, printable
from hilc_cli.files import read_file
from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import (
    INTEGER_METRICS,
    METRIC_NAMES,
    IterationMetrics,
    MetricsTable,
)
from hilc_cli.results.trial import Trial
from hilc_cli.variation.axes import Value

if TYPE_CHECKING:
    import _csv

ITERATIONS_HEADER = ("iteration", *METRIC_NAMES)
_FIRST_ITERATIONS_HEADER = ITERATIONS_HEADER[:11]
"""Of tables that were written before there were metrics of the second half."""
SAMPLES_HEADER = (
    "iteration", "sample", "t_s",
    "reference_x_m", "reference_y_m", "reference_heading_rad",
    "x_m", "y_m", "heading_rad",
    "error_x_m", "error_y_m", "error_heading_rad",
    "left_wheel_rad_s", "right_wheel_rad_s",
)  # fmt: skip
INPUT_HEADER = ("sample", "t_s", "left_wheel_rad_s", "right_wheel_rad_s")
PLAN_HEADER = (*INPUT_HEADER, "x_m", "y_m", "heading_rad")
GRAVITY_CENTER_HEADER = ("iteration", "sample", "t_s", "x_m", "y_m", "heading_rad")

MAX_CSV_BYTES = 2_000_000_000

_RUN = tuple(
    "=+-@\N{FULLWIDTH EQUALS SIGN}\N{FULLWIDTH PLUS SIGN}"
    "\N{FULLWIDTH HYPHEN-MINUS}\N{FULLWIDTH COMMERCIAL AT}"
)
"""What formulas of spreadsheets begin with."""

_REFERENCE_COLUMNS = slice(2, 6)


def write_iterations(path: Path, metrics: MetricsTable) -> None:
    """Writes ``iterations.csv``: a row per iteration."""
    rows = (",".join(map(repr, row.values())) for row in metrics.rows())
    _write(path, ITERATIONS_HEADER, (f"{i},{row}" for i, row in enumerate(rows)))


def write_samples(path: Path, reference: Reference, trials: Iterable[Trial]) -> None:
    """Writes ``samples.csv``: for each recorded iteration a row per sample."""
    _write(path, SAMPLES_HEADER, _sample_rows(reference, trials))


def _sample_rows(reference: Reference, trials: Iterable[Trial]) -> Iterator[str]:
    # The columns that are the same in every iteration are put into words once.
    desired = [
        f"{k},{t!r},{x!r},{y!r},{heading!r}"
        for k, (t, x, y, heading) in enumerate(
            zip(*_lists(reference.times, reference.x, reference.y, reference.heading), strict=True)
        )
    ]
    for trial in trials:
        motion = _lists(
            trial.x,
            trial.y,
            trial.heading,
            reference.x - trial.x,
            reference.y - trial.y,
            reference.heading - trial.heading,
        )
        wheels = [
            f"{left!r},{right!r}"
            for left, right in zip(*_lists(trial.left, trial.right), strict=True)
        ]
        wheels.append(",")  # no wheel speeds belong to the last sample
        for row, x, y, heading, error_x, error_y, error_heading, speeds in zip(
            desired, *motion, wheels, strict=True
        ):
            yield (
                f"{trial.iteration},{row},{x!r},{y!r},{heading!r},"
                f"{error_x!r},{error_y!r},{error_heading!r},{speeds}"
            )


def write_input(path: Path, sample_time: float, left: Floats, right: Floats) -> None:
    """Writes ``input.csv``, or any input that a scenario may start from."""
    times = np.arange(len(left), dtype=np.float64) * sample_time
    rows = zip(*_lists(times, left, right), strict=True)
    _write(path, INPUT_HEADER, (f"{k},{t!r},{lw!r},{rw!r}" for k, (t, lw, rw) in enumerate(rows)))


def write_plan(path: Path, sample_time: float, plan: Plan) -> None:
    """Writes ``plan.csv``: what to send next, and the pose that it is to lead to."""
    times = np.arange(len(plan.poses), dtype=np.float64) * sample_time
    pairs = zip(*_lists(plan.left, plan.right), strict=True)
    wheels = [f"{left!r},{right!r}" for left, right in pairs]
    rows = zip(*_lists(times), [*wheels, ","], plan.poses.tolist(), strict=True)
    lines = (
        f"{k},{t!r},{speeds},{x!r},{y!r},{heading!r}"
        for k, (t, speeds, (x, y, heading)) in enumerate(rows)
    )
    _write(path, PLAN_HEADER, lines)


def write_gravity_center(
    path: Path, times: Floats, paths: Mapping[int, tuple[Floats, Floats, Floats]]
) -> None:
    """Writes ``gravity-center.csv``: the pose of the gravity centre by recorded iteration."""
    _write(
        path,
        GRAVITY_CENTER_HEADER,
        (
            f"{iteration},{k},{t!r},{x!r},{y!r},{heading!r}"
            for iteration, pose in paths.items()
            for k, (t, x, y, heading) in enumerate(zip(*_lists(times, *pose), strict=True))
        ),
    )


def read_iterations(path: Path) -> MetricsTable:
    """Reads ``iterations.csv``; metrics that a table of before does not have are not-a-number.

    Raises:
        HilcError: There is no such table, or it is damaged.
    """
    table = MetricsTable()
    lines = read_file(path, MAX_CSV_BYTES).decode("utf-8", "replace").splitlines()
    is_first = lines[:1] == [",".join(_FIRST_ITERATIONS_HEADER)]
    header = _FIRST_ITERATIONS_HEADER if is_first else ITERATIONS_HEADER
    for line, row in _parse(path, lines, header):
        if row[0] != len(table):
            raise _damaged(path, line, f"iteration {len(table)} should stand here")
        values = dict.fromkeys(METRIC_NAMES, math.nan)
        values |= dict(zip(header[1:], row[1:], strict=True))
        for name in INTEGER_METRICS:
            values[name] = int(values[name])
        table.append(IterationMetrics(**values))  # type: ignore[arg-type]  # made whole above
    return table


def read_samples(path: Path, name: str) -> tuple[Reference, dict[int, Trial]]:
    """Reads ``samples.csv``.

    Args:
        path: The file.
        name: Name of the trajectory, which the table does not hold.

    Returns:
        The reference and the recorded iterations by number.

    Raises:
        HilcError: There is no such table, or it is damaged.
    """
    table = _array(path, SAMPLES_HEADER)
    if len(table) < 2:
        raise UsageError(f"{path}: holds no samples")
    starts = np.flatnonzero(table[:, 1] == 0)
    samples = len(table) // max(1, len(starts))
    if len(starts) == 0 or len(table) % len(starts) or samples < 2:
        raise UsageError(f"{path}: is damaged: its iterations are of different length")
    blocks = table.reshape(len(starts), samples, len(SAMPLES_HEADER))
    if not np.array_equal(blocks[:, :, 1], np.broadcast_to(np.arange(samples), blocks.shape[:2])):
        raise UsageError(f"{path}: is damaged: its samples are not in order")
    if not (blocks[:, :, 0] == blocks[:, :1, 0]).all():
        raise UsageError(f"{path}: is damaged: an iteration's samples are not together")
    times, x, y, heading = blocks[0, :, _REFERENCE_COLUMNS].T
    reference = Reference(name, float(times[1]), x, y, heading)
    trials = {
        int(block[0, 0]): Trial(
            int(block[0, 0]), block[:, 6], block[:, 7], block[:, 8], block[:-1, 12], block[:-1, 13]
        )
        for block in blocks
    }
    return reference, trials


def read_input(path: Path, content: bytes, steps: int, sample_time: float) -> tuple[Floats, Floats]:
    """Wheel speeds from an input table.

    Args:
        path: What to call it in errors.
        content: The table.
        steps: Number of rows that it must have.
        sample_time: Time between them [s].

    Returns:
        Left and right wheel speeds [rad/s], shape (steps,) each.

    Raises:
        UsageError: It is no such table, has another number of rows or sample time, or holds
            non-finite numbers.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise UsageError(f"{path}: is not UTF-8 text; give an input CSV file") from None
    rows = list(_parse(path, text.splitlines(), INPUT_HEADER))
    if len(rows) != steps:
        raise UsageError(
            f"{path}: has {len(rows)} rows, but the trajectory has {steps} samples to drive; "
            "give an input of the same trajectory"
        )
    for k, (line, row) in enumerate(rows):
        if row[0] != k:
            raise _damaged(path, line, f"sample {k} should stand here")
        if not all(map(math.isfinite, row)):
            raise _damaged(path, line, "numbers must be finite")
        if abs(row[1] - k * sample_time) > 1e-6 * sample_time + 1e-9 * k * sample_time:
            raise UsageError(
                f"{path}:{line}: is of another sample time: t_s is {row[1]:g} where the "
                f"trajectory has {k * sample_time:g}; give an input of the same trajectory"
            )
    table = np.array([row for _, row in rows], dtype=np.float64)
    return table[:, 2].copy(), table[:, 3].copy()


def read_stored_input(path: Path) -> tuple[float, Floats, Floats]:
    """Sample time [s], left and right wheel speeds [rad/s] of what `write_input` has written.

    Raises:
        HilcError: There is no such table, or it is damaged.
    """
    table = _array(path, INPUT_HEADER)
    sample_time = float(table[1, 1]) if len(table) > 1 else 0.0  # of one sample it is not known
    return sample_time, table[:, 2], table[:, 3]


def text_cell(text: str) -> str:
    """A text as a cell of a CSV file: on one line, and for a spreadsheet never a formula."""
    return quoted(unrun(text))


def unrun(text: str) -> str:
    """A text without what steers a terminal, and with ``'`` before what a spreadsheet would run."""
    text = printable(text)
    return f"'{text}" if text.startswith(_RUN) else text


def quoted(text: str) -> str:
    """The text as a cell of a CSV file."""
    if not set(text) & set(',"\r\n'):
        return text
    doubled = text.replace('"', '""')
    return f'"{doubled}"'


def _lists(*columns: Floats) -> list[list[float]]:
    return [column.tolist() for column in columns]


def _write(path: Path, header: Sequence[str], rows: Iterable[str]) -> None:
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join(header) + "\n")
        file.writelines(f"{row}\n" for row in rows)


def _rows(path: Path, header: Sequence[str]) -> Iterator[tuple[int, list[float]]]:
    content = read_file(path, MAX_CSV_BYTES)
    return _parse(path, content.decode("utf-8", "replace").splitlines(), header)


def _array(path: Path, header: Sequence[str]) -> Floats:
    """A large table of numbers; empty cells become 0."""
    content = read_file(path, MAX_CSV_BYTES)
    first, _, body = content.partition(b"\n")
    _check_header(path, first.decode("utf-8", "replace").rstrip("\r").split(","), header)
    if not body.strip():
        raise UsageError(f"{path}: is damaged: it has no rows")
    try:
        table: Floats = np.loadtxt(
            io.BytesIO(body), delimiter=",", ndmin=2, converters=_number_or_zero
        )
    except ValueError as error:
        why = str(error).splitlines()[0].partition(";")[0]
        raise UsageError(f"{path}: is damaged: {why}") from None
    if table.shape[1] != len(header):
        raise UsageError(f"{path}: is damaged: its rows have {table.shape[1]} cells")
    return table


def _number_or_zero(cell: str) -> float:
    return float(cell) if cell else 0.0


def _parse(
    path: Path, lines: Iterable[str], header: Sequence[str]
) -> Iterator[tuple[int, list[float]]]:
    reader = csv.reader(lines)
    rows = _without_csv_errors(path, reader)
    _check_header(path, next(rows, []), header)
    for row in rows:
        if len(row) != len(header):
            raise _damaged(path, reader.line_num, f"{len(header)} cells should stand here")
        try:
            yield reader.line_num, [float(cell) for cell in row]
        except ValueError:
            raise _damaged(path, reader.line_num, "holds something that is no number") from None


def _without_csv_errors(path: Path, reader: _csv.Reader) -> Iterator[list[str]]:
    try:
        yield from reader
    except csv.Error as error:
        raise _damaged(path, reader.line_num, str(error)) from None


def _check_header(path: Path, found: Sequence[str], header: Sequence[str]) -> None:
    if tuple(found) != tuple(header):
        raise UsageError(f"{path}: is no such table; its first line must be {','.join(header)}")


def _damaged(path: Path, line: int, what: str) -> UsageError:
    return UsageError(f"{path}:{line}: is damaged: {what}")


def value_text(value: Value) -> str:
    """A value as a command line takes it; it reads back as the same value."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    return quoted(value) if isinstance(value, str) else repr(value)
