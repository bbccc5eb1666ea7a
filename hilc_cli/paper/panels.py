"""The numbers that a panel shows, as a CSV file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.paper.contents import MOTOR_LIMIT, PaperFigure, PaperPanel
from hilc_cli.paper.index import gains_text, group_text, situation_text
from hilc_cli.paper.pictures.panel import ERROR_METRICS, Panel, PanelKind, PanelRow, shown_trials
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.experiment import Scenario

Columns = Mapping[str, NDArray[Any]]


def write_panel(path: Path, panel: Panel) -> None:
    """Writes what a panel shows; every number reads back exactly."""
    columns = panel_columns(panel)
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join(columns) + "\n")
        file.writelines(",".join(map(repr, row)) + "\n" for row in rows)


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


def panel_rows(
    figure: PaperFigure, runs: Mapping[str, RunData], scenarios: Mapping[str, Scenario]
) -> list[PanelRow]:
    """What to draw.

    Args:
        figure: The figure.
        runs: By the names of the examples.
        scenarios: Likewise.
    """
    return [_row(row, runs, scenarios) for row in figure.rows]


def _row(
    panels: tuple[PaperPanel, ...],
    runs: Mapping[str, RunData],
    scenarios: Mapping[str, Scenario],
) -> PanelRow:
    first = panels[0]
    scenario = scenarios[first.situation.scenario]
    together = all(panel.situation == first.situation for panel in panels)
    if together:
        heading = f"({first.letter[0]}) {situation_text(first.situation, scenario)}"
    else:
        heading = group_text(first.situation, scenario)
    return PanelRow(
        heading,
        tuple(
            Panel(
                panel.letter,
                panel.kind,
                panel.kind.capitalize()
                if together
                else gains_text(scenarios[panel.situation.scenario]),
                runs[panel.situation.scenario],
                MOTOR_LIMIT,
            )
            for panel in panels
        ),
    )
