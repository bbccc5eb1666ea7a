"""What a panel of the paper's figures shows, and its numbers as a CSV file. No Matplotlib."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial

SHOWN_ITERATIONS = (0, 1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100)
"""Their paths can still be told apart in a panel as wide as a third of a page."""


class PanelKind(StrEnum):
    """What is drawn."""

    PATH_CHANGE = "path change"
    PATHS = "path change and final path"
    FINAL_PATH = "final path"
    WHEEL_SPEEDS = "final wheel speeds"
    MAXIMUM_ERROR = "maximum error"
    AVERAGE_ERROR = "average error"


ERROR_METRICS = {
    PanelKind.MAXIMUM_ERROR: "max_position_error_m",
    PanelKind.AVERAGE_ERROR: "mean_position_error_m",
}


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel with the run that it shows.

    Attributes:
        letter: Such as ``a1``.
        kind: What is drawn.
        title: What stands above it, behind the letter.
        run: The results.
        speed_limit: The motors' limit [rad/s], shown with wheel speeds whether the run kept it
            or not.
    """

    letter: str
    kind: PanelKind
    title: str
    run: RunData
    speed_limit: float


@dataclass(frozen=True, slots=True)
class PanelRow:
    """Panels side by side.

    Attributes:
        heading: What they have in common; empty for nothing.
        panels: From left to right.
    """

    heading: str
    panels: tuple[Panel, ...]


def shown_trials(run: RunData) -> list[Trial]:
    """The iterations whose paths a panel shows: some of those recorded, and the last."""
    last = run.last.iteration
    return [
        trial
        for number, trial in sorted(run.trials.items())
        if number in SHOWN_ITERATIONS or number == last
    ]


Columns = Mapping[str, NDArray[Any]]


def panel_table(panel: Panel) -> bytes:
    """What a panel shows, as a CSV file; every number reads back exactly."""
    columns = panel_columns(panel)
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    return ("\n".join(lines) + "\n").encode("ascii")


def panel_columns(panel: Panel) -> Columns:
    """The columns of a panel's table, named as in the tables of a run folder.

    Paths have a row per sample of each iteration that is drawn, wheel speeds a row per sample
    (each is held until the next), errors a row per iteration.
    """
    run = panel.run
    match panel.kind:
        case PanelKind.PATH_CHANGE | PanelKind.PATHS:
            blocks = [_path(run, trial) for trial in shown_trials(run)]
            return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
        case PanelKind.FINAL_PATH:
            return _path(run, run.last)
        case PanelKind.WHEEL_SPEEDS:
            left, right = run.learned_input
            return {
                "sample": np.arange(len(left)),
                "t_s": run.reference.times[:-1],
                "left_wheel_rad_s": left,
                "right_wheel_rad_s": right,
                "speed_limit_rad_s": np.full(len(left), panel.speed_limit),
            }
        case PanelKind.MAXIMUM_ERROR | PanelKind.AVERAGE_ERROR:
            metric = ERROR_METRICS[panel.kind]
            return {
                "iteration": np.arange(len(run.metrics)),
                metric: run.metrics[metric],
                "saturated_samples": run.metrics["saturated_samples"].astype(np.int64),
            }


def _path(run: RunData, trial: Trial) -> Columns:
    samples = np.arange(len(trial.x))
    return {
        "iteration": np.full_like(samples, trial.iteration),
        "sample": samples,
        "reference_x_m": run.reference.x,
        "reference_y_m": run.reference.y,
        "x_m": trial.x,
        "y_m": trial.y,
    }
