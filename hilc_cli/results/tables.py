"""The CSV files of a run: written so that every number reads back exactly."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hilc_cli.errors import UsageError
from hilc_cli.files import read_file
from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import METRICS, MetricsTable
from hilc_cli.results.plain_tables import plain_file
from hilc_cli.results.reading import (
    MAX_CSV_BYTES,
    Numbers,
    check_columns,
    check_counted,
    damaged,
    no_such_table,
    read_numbers,
)
from hilc_cli.results.trial import LARGEST, Trial
from hilc_cli.variation import Value
from hilc_cli.wording import printable

ITERATIONS_HEADER = ("iteration", *METRICS)
SAMPLES_HEADER = (
    "iteration", "sample", "t_s",
    "reference_x_m", "reference_y_m", "reference_heading_rad",
    "x_m", "y_m", "heading_rad",
    "error_x_m", "error_y_m", "error_heading_rad",
    "left_wheel_rad_s", "right_wheel_rad_s",
)  # fmt: skip
INPUT_HEADER = ("sample", "t_s", "left_wheel_rad_s", "right_wheel_rad_s")
PLAN_HEADER = (*INPUT_HEADER, "x_m", "y_m", "heading_rad")
TRIAL_HEADER = (*PLAN_HEADER, "read")
GRAVITY_CENTER_HEADER = ("iteration", "sample", "t_s", "x_m", "y_m", "heading_rad")

FASTEST = 1e200
"""Wheel speeds [rad/s] beyond this would have moved any robot out of the finite numbers."""

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


def write_plan(path: Path, sample_time: float, plan: Plan, *, stops: bool = False) -> None:
    """Writes ``plan.csv``: what to send next, and the pose that it is to lead to.

    Args:
        path: The file.
        sample_time: d_t [s].
        plan: What is to be sent; what it needs of its lead-in has negative times.
        stops: Whether the last row tells the wheels to stop; else it has none of their speeds.
    """
    rows = _motion_rows(sample_time, plan.shortest, "0.0,0.0" if stops else ",")
    _write(path, PLAN_HEADER, rows)


def write_trial(path: Path, sample_time: float, motion: Plan, read: NDArray[np.bool_]) -> None:
    """Writes what was sent at each sample of a trial and the pose there.

    Args:
        path: The file.
        sample_time: d_t [s].
        motion: Wheel speeds and poses from the lead-in on.
        read: Whether a pose was measured there, shape (lead-in + n + 1,).
    """
    rows = zip(_motion_rows(sample_time, motion, ","), read.tolist(), strict=True)
    _write(path, TRIAL_HEADER, (f"{row},{int(own)}" for row, own in rows))


def _motion_rows(sample_time: float, plan: Plan, last: str) -> Iterator[str]:
    """Rows of a motion from the lead-in on, ``last`` being the wheel speeds at the last sample."""
    pairs = zip(*_lists(plan.left, plan.right), strict=True)
    wheels = [f"{left!r},{right!r}" for left, right in pairs]
    rows = zip([*wheels, last], plan.poses.tolist(), strict=True)
    for k, (speeds, (x, y, heading)) in enumerate(rows, -plan.lead_in):
        yield f"{k},{k * sample_time!r},{speeds},{x!r},{y!r},{heading!r}"


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


_COUNT = Numbers(0, 1e9, whole=True)
_FINITE = Numbers()
_FAR = 3 * LARGEST  # a difference of two that count as finite
_POSE = Numbers(-_FAR, _FAR)
_SPEED = Numbers(-FASTEST, FASTEST)


def metric_columns(*, empty: bool = False) -> list[tuple[str, Numbers]]:
    """The metrics of an iteration and what each may be; empty: or not be there."""
    return [
        (
            name,
            Numbers(
                0,
                1e9 if metric.whole else FASTEST if metric.unit == "rad/s" else _FAR,
                whole=metric.whole,
                empty=empty,
            ),
        )
        for name, metric in METRICS.items()
    ]


def read_iterations(path: Path) -> MetricsTable:
    """Reads ``iterations.csv``.

    Raises:
        HilcError: There is no such table, or it is damaged.
    """
    numbers = read_numbers(path, [("iteration", _COUNT), *metric_columns()])
    check_counted(path, "iteration", numbers[:, 0])
    table = MetricsTable()
    for row in numbers[:, 1:].tolist():
        pairs = zip(METRICS.values(), row, strict=True)
        table.append({each.name: int(value) if each.whole else value for each, value in pairs})
    return table


_SAMPLE_COLUMNS = [
    *zip(SAMPLES_HEADER[:3], (_COUNT, _COUNT, Numbers(0)), strict=True),
    *((name, _POSE) for name in SAMPLES_HEADER[3:12]),
    *((name, replace(_SPEED, empty=True)) for name in SAMPLES_HEADER[12:]),
]


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
    table = _large_table(path)
    check_columns(path, _SAMPLE_COLUMNS, table)
    starts = np.flatnonzero(table[:, 1] == 0)
    samples = len(table) // max(1, len(starts))
    if len(starts) == 0 or len(table) % len(starts) or samples < 2:
        raise damaged(path, "its iterations are of different length")
    blocks = table.reshape(len(starts), samples, len(SAMPLES_HEADER))
    if (blocks[:, :, 1] != np.arange(samples)).any():
        raise damaged(path, "its samples are not in order")
    numbers, sample_time = blocks[:, 0, 0], float(blocks[0, 1, 2])
    if (blocks[:, :, 0] != numbers[:, np.newaxis]).any() or (np.diff(numbers) <= 0).any():
        raise damaged(path, "an iteration's samples are not together")
    times = np.arange(samples) * sample_time
    if sample_time <= 0 or not np.allclose(blocks[:, :, 2], times, rtol=1e-9, atol=0):
        raise damaged(path, "its times are not those of samples")
    if (blocks[:, :, _REFERENCE_COLUMNS] != blocks[:1, :, _REFERENCE_COLUMNS]).any():
        raise damaged(path, "its iterations do not follow the same reference")
    if (np.isnan(blocks[:, :, 12:]) != (np.arange(samples) == samples - 1)[:, np.newaxis]).any():
        raise damaged(path, "wheel speeds must stand at all samples but the last")
    x, y, heading = blocks[0, :, 3:6].T
    reference = Reference(name, sample_time, x, y, heading)
    trials = {
        int(block[0, 0]): Trial(
            int(block[0, 0]), block[:, 6], block[:, 7], block[:, 8], block[:-1, 12], block[:-1, 13]
        )
        for block in blocks
    }
    return reference, trials


_INPUT_COLUMNS = [("sample", _COUNT), *((name, _FINITE) for name in INPUT_HEADER[1:])]


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
        content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise UsageError(f"{path}: is not UTF-8 text; give an input CSV file") from None
    table = read_numbers(path, _INPUT_COLUMNS, content)
    if len(table) != steps:
        raise UsageError(
            f"{path}: has {len(table)} rows, but the trajectory has {steps} samples to drive; "
            "give an input of the same trajectory"
        )
    check_counted(path, "sample", table[:, 0])
    for k, time in enumerate(table[:, 1].tolist()):
        if abs(time - k * sample_time) > 1e-6 * sample_time + 1e-9 * k * sample_time:
            raise UsageError(
                f"{path}:{k + 2}: is of another sample time: t_s is {time:g} where the "
                f"trajectory has {k * sample_time:g}; give an input of the same trajectory"
            )
    return table[:, 2].copy(), table[:, 3].copy()


def read_stored_input(path: Path) -> tuple[float, Floats, Floats]:
    """Sample time [s], left and right wheel speeds [rad/s] of what `write_input` has written.

    Raises:
        HilcError: There is no such table, or it is damaged.
    """
    table = read_numbers(path, _INPUT_COLUMNS)
    check_counted(path, "sample", table[:, 0])
    sample_time = float(table[1, 1]) if len(table) > 1 else 0.0  # of one sample it is not known
    if not np.allclose(table[:, 1], np.arange(len(table)) * sample_time, rtol=1e-9, atol=0):
        raise damaged(path, "its times are not those of samples")
    return sample_time, table[:, 2], table[:, 3]


_PLAN_COLUMNS = [
    ("sample", Numbers(-1e9, 1e9, whole=True)),
    ("t_s", _FINITE),
    *((name, replace(_SPEED, empty=True)) for name in PLAN_HEADER[2:4]),
    *((name, _POSE) for name in PLAN_HEADER[4:]),
]


def read_plan(path: Path, reference: Reference) -> Plan | None:
    """Reads ``plan.csv``, without the feedback, which it does not hold.

    Args:
        path: The file.
        reference: What the plan is to follow.

    Returns:
        The plan; None if there is no such file.

    Raises:
        HilcError: It cannot be read, or it is damaged.
    """
    return read_motion(path, reference) if path.exists() else None


def read_motion(path: Path, reference: Reference) -> Plan:
    """Reads what `write_plan` has written.

    Args:
        path: The file.
        reference: What the motion was to follow.

    Raises:
        HilcError: There is no such file, it cannot be read, or it is damaged.
    """
    return _motion(read_numbers(path, _PLAN_COLUMNS), path, reference)


def read_trial(path: Path, reference: Reference) -> tuple[Plan, NDArray[np.bool_]]:
    """Reads what `write_trial` has written: the motion, and where a pose was measured.

    Args:
        path: The file.
        reference: What the motion was to follow.

    Raises:
        HilcError: There is no such file, it cannot be read, or it is damaged.
    """
    table = read_numbers(path, [*_PLAN_COLUMNS, (TRIAL_HEADER[-1], Numbers(0, 1, whole=True))])
    return _motion(table[:, :-1], path, reference), table[:, -1] == 1


def _motion(table: Floats, path: Path, reference: Reference) -> Plan:
    """The motion that a table has, of a file that is told where it is damaged."""
    first = int(table[0, 0]) if len(table) else 0
    lead_in, rows = max(-first, 0), reference.samples + 1
    if len(table) != rows + lead_in:
        raise damaged(path, f"it has {len(table)} rows, not {rows + lead_in}")
    samples = table[:, 0]
    check_counted(path, "sample", samples, -lead_in)
    times = samples * reference.sample_time
    if not np.allclose(table[:, 1], times, rtol=1e-9, atol=0):
        raise damaged(path, "its times are not those of samples")
    if np.isnan(table[:-1, 2:4]).any():
        raise damaged(path, "wheel speeds must stand at all samples but the last")
    left, right = table[:-1, 2:4].T
    return Plan(left.copy(), right.copy(), table[:, 4:].copy(), lead_in=lead_in)


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


def _large_table(path: Path) -> Floats:
    """The rows of ``samples.csv``, of which there may be millions; empty cells not-a-number."""
    plain = plain_file(path, MAX_CSV_BYTES, SAMPLES_HEADER)
    if plain is not None:
        left, right = np.isnan(plain.numbers[:, -2:]).T
        if plain.full[:-2].all() and (left == right).all():
            return plain.numbers
    first, _, body = read_file(path, MAX_CSV_BYTES).partition(b"\n")
    if first.rstrip(b"\r") != ",".join(SAMPLES_HEADER).encode():
        raise no_such_table(path, SAMPLES_HEADER)
    if not body.strip():
        raise damaged(path, "it has no rows")
    body = re.sub(rb",,(?=\r?$)", b",nan,nan", body, flags=re.MULTILINE)
    try:
        table: Floats = np.loadtxt(io.BytesIO(body), delimiter=",", ndmin=2, comments=None)
    except ValueError as error:
        # NumPy's own words show the cell. It counts cells from row 0, and lengths of rows from 1.
        row = re.search(r"at row (\d{1,12})[;,]", str(error))
        is_cell = str(error).startswith("could not convert")
        where = f" in line {int(row[1]) + 1 + is_cell}" if row else ""
        what = "something is no number" if is_cell else "another number of cells should stand"
        raise damaged(path, f"{what}{where}") from None
    if table.shape[1] != len(SAMPLES_HEADER):
        raise damaged(path, f"{len(SAMPLES_HEADER)} cells should stand in each line")
    return table


def value_text(value: Value) -> str:
    """A value as a command line takes it; it reads back as the same value."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    return quoted(value) if isinstance(value, str) else repr(value)
