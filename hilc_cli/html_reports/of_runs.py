"""Runs and labs on a page: one with its iterations to play, several side by side."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from hilc_cli.comparisons.comparing import compare_runs
from hilc_cli.comparisons.formats import Cell, Grid
from hilc_cli.comparisons.picture import comparison_figure
from hilc_cli.comparisons.table import number_text
from hilc_cli.html_reports.chapter import Chapter, Table, comparison, names_and_values, picture
from hilc_cli.html_reports.playback import playback
from hilc_cli.labs.trials import read_reports
from hilc_cli.results.metrics import METRICS
from hilc_cli.results.picture_kinds import RUN_PICTURES
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import summarise
from hilc_cli.runs.pictures.catalogue import draw, kinds_of
from hilc_cli.runs.report import summary_rows
from hilc_cli.runs.run_folder import LAB_FOLDER
from hilc_cli.wording import counted

_MOST_ROWS = 300
_SUMMARY = "summary"  # is made of the other pictures
_IN_SHORT = ("path-change", "error")
"""Pictures of each run where there are many."""
_SETTINGS = {
    "law": "Learning law",
    "gains": "Gains",
    "compensation": "Compensation",
    "start_offset": "Start offset",
}
_DIGITS = 4


def run_chapter(
    run: RunData,
    folder: Path | None = None,
    iterations: Collection[int] | None = None,
    *,
    share: float = 1.0,
    in_short: bool = False,
) -> Chapter:
    """A run, or a lab, by itself.

    Args:
        run: The results.
        folder: Where they were read; None if they are in memory only.
        iterations: Which of the recorded ones are shown; None for all.
        share: Of the points of a page that it may have.
        in_short: With few pictures, as others stand beside it.
    """
    lab = folder if folder is not None and LAB_FOLDER.is_at(folder) else None
    is_lab = lab is not None
    summary = summarise(run)
    kinds = [kind for kind in kinds_of([run]) if kind != _SUMMARY]
    if in_short:
        kinds = [kind for kind in kinds if kind in _IN_SHORT]
    count = counted(len(run.metrics), "trial") if is_lab else f"iteration {summary.iterations}"
    tables = [
        names_and_values(f"After {count}", summary_rows(summary, run.speed_limit)),
        names_and_values("What was run", _setting_rows(run)),
        *([] if lab is None else [_trials(lab, len(run.metrics))]),
        _iterations(run, "trial" if is_lab else "iteration"),
    ]
    return Chapter(
        kind="lab" if is_lab else "run",
        title=run.name,
        headline=summary.headline,
        warnings=run.warnings,
        tables=tables,
        played=playback(run, iterations, share=share),
        pictures=[
            picture(RUN_PICTURES[kind].shows, partial(draw, kind, [run], iterations))
            for kind in kinds
        ],
    )


def comparison_chapter(runs: Sequence[RunData]) -> Chapter:
    """Several runs side by side."""
    table = compare_runs(runs)
    return Chapter(
        kind="comparison",
        title=table.title,
        tables=[comparison(table)],
        pictures=[picture("errors and last paths", partial(comparison_figure, runs))],
    )


def _setting_rows(run: RunData) -> list[tuple[str, str]]:
    reference = run.reference
    duration = f"{reference.samples * reference.sample_time:.6g} s"
    rows = [
        ("Trajectory", reference.name),
        ("Duration", f"{duration}, {reference.samples} samples of {reference.sample_time:g} s"),
        *((_SETTINGS.get(key, key), text) for key, text in run.settings.items()),
    ]
    if run.robot is not None:
        rows += [
            ("Wheel radius", f"{run.robot.wheel_radius:.6g} m"),
            ("Half track", f"{run.robot.half_track:.6g} m"),
        ]
    if run.diverged_at is not None:
        rows.append(("Diverged", f"in iteration {run.diverged_at}"))
    return rows


def _iterations(run: RunData, name: str) -> Table:
    """The metrics of each iteration, or of the recorded ones where there are very many."""
    numbers = list(range(len(run.metrics)))
    note = ""
    if len(numbers) > _MOST_ROWS:
        places = np.geomspace(1, len(numbers), _MOST_ROWS).round().astype(int) - 1
        numbers = sorted(set(places.tolist()))
        note = f"{len(numbers)} of {len(run.metrics)} {name}s."
    heads = [(name.capitalize(), "")] + [
        (f"{metric.heading[:1].upper()}{metric.heading[1:]}", metric.unit)
        for metric in METRICS.values()
    ]
    rows = tuple(
        (
            Cell(str(number)),
            *(Cell(_number(key, value)) for key, value in run.metrics.row(number).items()),
        )
        for number in numbers
    )
    grid = Grid(
        title="",
        heads=(
            tuple(head for head, _ in heads),
            tuple(f"[{unit}]" if unit else "" for _, unit in heads),
        ),
        at_right=(True,) * len(heads),
        rows=rows,
    )
    return Table(f"All {name}s", (grid,), note, is_folded=True)


def _number(metric: str, value: float) -> str:
    if math.isnan(value):  # of a folder of before there was the metric
        return "-"
    return str(int(value)) if METRICS[metric].whole else number_text(value, _DIGITS)


def _trials(folder: Path, count: int) -> Table:
    """What the logs of a lab's trials told before they were learned from."""
    rows = []
    for number, report in enumerate(read_reports(folder, count)):
        error = report.start_time_standard_error_s
        start = f"{report.start_time_s:.6g} s"
        rows.append(
            (
                Cell(str(number)),
                Cell(report.log),
                Cell(start if error is None else f"{start}, standard error {error:.2g} s"),
                Cell(" ".join([*report.notes, *(f"Warning: {each}" for each in report.warnings)])),
            )
        )
    heads = (("Trial", "Log", "Start in the log's clock", "What was done to it"),)
    grid = Grid("", heads, (True, False, False, False), tuple(rows))
    return Table("Logs", (grid,), is_folded=True)
