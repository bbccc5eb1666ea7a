"""The panels of the paper's figures with the runs that they show."""

from __future__ import annotations

from collections.abc import Mapping

from hilc_cli.figures.paper.panel import Panel, PanelRow
from hilc_cli.paper.contents import MOTOR_LIMIT, PaperFigure, PaperPanel
from hilc_cli.paper.wording import gains_text, group_text, situation_text
from hilc_cli.results.run import RunData
from hilc_cli.spec.valid import Scenario


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
