"""A trial of a lab: what was planned, what was measured, and how that was made of a log."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, Strict

from hilc_cli.files import read_file
from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.reading import MAX_CSV_BYTES, Document, damaged, read_document
from hilc_cli.results.tables import (
    read_motion,
    read_trial as read_trial_table,
    write_plan,
    write_trial as write_trial_table,
)
from hilc_cli.results.trial import Trial
from hilc_cli.wording import printable

FILES = ("log.csv", "plan.csv", "trial.csv", "report.json")
"""What there is of each trial."""
LOG, PLANNED, MEASURED, REPORT = FILES
_AT_LIMIT = 1 - 1e-6

Pose = Annotated[tuple[float, float, float], Strict(False)]


class Report(Document):
    """How a trial was made of a log; what a person reads before believing it.

    Attributes:
        log: Name of the log.
        log_sha256: Checksum of what was read of it.
        start_time_s: When sample 0 was, in the log's clock.
        start_time_standard_error_s: How sure that is; None if it was given.
        start_pose: Where the robot stood before it moved: x [m], y [m], heading [rad].
        moved_to_start: Whether the trial was taken into the frame of that pose.
        notes: What was done to the log, a sentence each.
        warnings: What is probably not meant, a sentence each.
        files_sha256: Checksums of the trial's tables.
    """

    log: str
    log_sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    start_time_s: float
    start_time_standard_error_s: float | None
    start_pose: Pose
    moved_to_start: bool
    notes: list[str]
    warnings: list[str]
    files_sha256: dict[str, str] = Field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class LabTrial:
    """A trial as a lab keeps it.

    Attributes:
        motion: Measured poses, and the wheel speeds that were sent, from the lead-in on.
        planned: What was to be sent, likewise, and the poses that were planned.
        report: How it was made of a log.
        read: Whether a pose was measured at the sample, from the lead-in on; where not, it lies
            between those of others.
    """

    motion: Plan
    planned: Plan
    report: Report
    read: NDArray[np.bool_]

    def trial(self, number: int, speed_limit: float) -> Trial:
        """Returns the trial as laws learn from it, lead-in included.

        Args:
            number: Of the iteration.
            speed_limit: Of either wheel [rad/s].
        """
        motion = self.motion
        x, y, heading = motion.poses.T.copy()
        fastest = np.maximum(np.abs(motion.left), np.abs(motion.right))
        saturated = int(np.count_nonzero(fastest >= _AT_LIMIT * speed_limit))
        return Trial(number, x, y, heading, motion.left, motion.right, saturated, self.read)


def trial_folder(lab: Path, number: int) -> Path:
    """Returns where a lab keeps a trial."""
    return lab / "trials" / f"{number:03d}"


def write_trial(folder: Path, trial: LabTrial, log: str, sample_time: float) -> None:
    """Writes a new trial into a folder that is there.

    Args:
        folder: The folder.
        trial: The trial.
        log: What was taken out of its log, as `log_table.table_of` puts it.
        sample_time: d_t [s].
    """
    (folder / LOG).write_text(log, encoding="ascii")
    write_plan(folder / PLANNED, sample_time, trial.planned)
    write_trial_table(folder / MEASURED, sample_time, trial.motion, trial.read)
    checksums = {name: _checksum(folder / name) for name in (LOG, PLANNED, MEASURED)}
    document = trial.report.model_copy(update={"files_sha256": checksums}).model_dump(mode="json")
    (folder / REPORT).write_text(f"{json.dumps(document, indent=2)}\n", encoding="utf-8")


def read_trial(folder: Path, reference: Reference, lead_in: int) -> LabTrial:
    """Reads a trial of a lab, which may come from anybody.

    Args:
        folder: The trial's.
        reference: What it was to follow, without lead-in.
        lead_in: Samples before that in which a trial is learned from.

    Raises:
        UsageError: It is damaged.
        HilcError: It cannot be read.
    """
    report = read_document(folder / REPORT, Report)
    for name in (LOG, PLANNED, MEASURED):
        if _checksum(folder / name) != report.files_sha256.get(name):
            raise damaged(folder / name, f"it is not what {REPORT} says by its checksum")
    planned = read_motion(folder / PLANNED, reference).with_lead_in(lead_in)
    motion, read = read_trial_table(folder / MEASURED, reference)
    if motion.lead_in != lead_in:
        raise damaged(folder / MEASURED, f"it must begin {lead_in} samples before the trajectory")
    return LabTrial(motion, planned, report, read)


def read_reports(lab: Path, trials: int) -> list[Report]:
    """Reads how the trials of a lab, which may come from anybody, were made of their logs.

    Raises:
        UsageError: A report is damaged.
        HilcError: It cannot be read.
    """
    return [read_document(trial_folder(lab, number) / REPORT, Report) for number in range(trials)]


def printable_report(report: Report) -> Mapping[str, Any]:
    """Returns a report as plain data whose texts do nothing to a terminal."""
    data: dict[str, Any] = report.model_dump(mode="json", exclude={"files_sha256"})
    data["log"] = printable(report.log)
    for key in ("notes", "warnings"):
        data[key] = list(map(printable, data[key]))
    return data


def _checksum(path: Path) -> str:
    return hashlib.sha256(read_file(path, MAX_CSV_BYTES)).hexdigest()
