"""What a lab tells: how its trials went, what was learned, and what comes next."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.labs.state import LabState
from hilc_cli.labs.trials import printable_report
from hilc_cli.laws.law import Plan
from hilc_cli.reporting.terminal import (
    Grid,
    print_grid,
    print_table,
    print_text,
    title,
    two_columns,
)
from hilc_cli.results.metrics import MAX_ERROR
from hilc_cli.results.summary import summarise
from hilc_cli.runs.report import learned_rows
from hilc_cli.wording import counted

_RMS, _FINAL = "rms_position_error_m", "final_position_error_m"
TRIALS_HEADER = [
    ("Trial", ""), ("Largest error", "mm"), ("RMS", "mm"), ("At the end", "mm"),
    ("Started off", "mm"), ("Started off", "mrad"), ("Log", ""),
]  # fmt: skip


def print_status(state: LabState, plan_file: Path) -> None:
    """What a lab knows, to stdout.

    Args:
        state: That of the lab.
        plan_file: Where its next plan is.
    """
    run = state.run
    trials = counted(len(state.trials), "trial")
    print_table(title(f"{run.name}: {run.reference.name} ({run.reference.size:.4g} m), {trials}"))
    if state.trials:
        print_text(summarise(run).headline)
        print_text("")
        print_grid(
            Grid(TRIALS_HEADER, [trial_row(state, number) for number in range(len(state.trials))])
        )
        print_text("")
        learned = learned_rows(run.learning.last())
        if learned:
            print_table(two_columns("", learned))
            print_text("")
    print_table(two_columns("Next", next_rows(state, plan_file), numbers=False))
    for warning in warnings_of(state):
        print_text(f"warning: {warning}")


def print_alignment(state: LabState) -> None:
    """How the last trial was made of its log, to stdout."""
    report = printable_report(state.trials[-1].report)
    print_text(f"{report['log']}:")
    for note in report["notes"]:
        print_text(f"  {note}")
    print_text("")


def trial_row(state: LabState, number: int) -> list[str]:
    """A trial as a table tells it, under `TRIALS_HEADER`."""
    metrics, report = state.run.metrics.row(number), state.trials[number].report
    away, turned = start_offset(state, number)
    return [
        str(number),
        *(f"{metrics[name] * 1e3:.3g}" for name in (MAX_ERROR, _RMS, _FINAL)),
        f"{away * 1e3:.3g}",
        f"{turned * 1e3:.3g}",
        report.log,
    ]


def start_offset(state: LabState, number: int) -> tuple[float, float]:
    """Returns how far a trial started from the planned start [m], and how it was turned [rad]."""
    x, y, heading = state.trials[number].report.start_pose
    start = state.run.reference.poses[0].tolist()
    return math.hypot(x - start[0], y - start[1]), heading - start[2]


def next_rows(state: LabState, plan_file: Path | None = None) -> list[tuple[str, str]]:
    """Returns what there is to say of the next plan, names and values."""
    plan, reference = state.plan.shortest, state.run.reference
    limits = state.scenario.spec.safety_limits
    fastest = float(np.abs([plan.left, plan.right]).max())
    first = -plan.lead_in * reference.sample_time
    rows = [
        *([] if plan_file is None else [("Plan", str(plan_file))]),
        (
            "Time",
            f"{first:g} to {reference.times[-1]:g} s, a row every {reference.sample_time:g} s",
        ),
        ("Fastest wheel", f"{fastest:.4g} of {limits.wheel_speed:g} rad/s"),
    ]
    if state.trials:
        change = _largest_change(plan, state.trials[-1].planned)
        rows.append(("Largest change of a wheel", f"{change:.3g} rad/s from the plan before"))
    return rows


def _largest_change(plan: Plan, before: Plan) -> float:
    plan = plan.with_lead_in(before.lead_in)
    return float(np.abs([plan.left - before.left, plan.right - before.right]).max())


def warnings_of(state: LabState) -> list[str]:
    """Returns what was probably not meant in the last trial, and what happened to learning."""
    last = state.trials[-1].report.warnings if state.trials else []
    return [*last, *state.run.warnings]


def status_document(state: LabState, plan_file: Path) -> Mapping[str, Any]:
    """Returns what a lab knows as plain data for JSON."""
    run = state.run
    return {
        "name": run.name,
        "trajectory": run.reference.name,
        "trials": [
            {**printable_report(trial.report), **run.metrics.row(number)}
            for number, trial in enumerate(state.trials)
        ],
        "learning": run.learning.last() if state.trials else {},
        "next": dict(_plan_document(state, plan_file)),
        "warnings": warnings_of(state),
    }


def _plan_document(state: LabState, plan_file: Path) -> Mapping[str, Any]:
    plan, reference = state.plan.shortest, state.run.reference
    return {
        "file": str(plan_file),
        "first_time_s": -plan.lead_in * reference.sample_time,
        "last_time_s": float(reference.times[-1]),
        "max_wheel_speed_rad_s": float(np.abs([plan.left, plan.right]).max()),
        "wheel_speed_limit_rad_s": state.scenario.spec.safety_limits.wheel_speed,
    }
