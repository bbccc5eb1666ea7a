"""Sheets of a reproduction: a figure under a reading, as pictures and tables of its panels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilc_cli.paper.contents import MOTOR_LIMIT, PaperFigure, PaperPanel, data_name, picture_name
from hilc_cli.paper.panel import Panel, PanelRow, panel_table
from hilc_cli.paper.reading import Reading, readings_named
from hilc_cli.paper.texts import gains_text, group_text, situation_text
from hilc_cli.results.look import Look
from hilc_cli.results.run import RunData
from hilc_cli.runs.running import Run
from hilc_cli.scenario.experiment import Scenario

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn


@dataclass(frozen=True, slots=True)
class DrawnSheets:
    """What a worker gets, and does: it draws a sheet, which with its panels' data are files.

    Attributes:
        sheets: A figure and the name of a reading each.
        scenarios: By reading and name.
        runs: Likewise.
        suffixes: Of the pictures.
        dpi: Of PNG files.
        look: How the sheets are to look.
    """

    sheets: tuple[tuple[PaperFigure, str], ...]
    scenarios: Mapping[str, Mapping[str, Scenario]]
    runs: Mapping[str, Mapping[str, Run]]
    suffixes: tuple[str, ...]
    dpi: int
    look: Look

    def __call__(self, number: int) -> dict[str, bytes]:
        """Returns the contents of all files of a sheet, by name in the folder."""
        from hilc_cli.drawing.save import render  # Matplotlib starts slowly

        figure, name = self.sheets[number]
        (reading,) = readings_named(name)
        sheet, drawn = draw_sheet(figure, reading, self.runs[name], self.scenarios[name], self.look)
        files = {
            picture_name(figure, reading, suffix): render(sheet, suffix, self.dpi)
            for suffix in self.suffixes
        }
        for panel, content in zip(figure.panels, drawn, strict=True):
            files[data_name(panel, reading)] = panel_table(content)
        return files


def draw_sheet(
    figure: PaperFigure,
    reading: Reading,
    runs: Mapping[str, Run],
    scenarios: Mapping[str, Scenario],
    look: Look,
) -> tuple[Drawn, list[Panel]]:
    """A figure under a reading, and its panels."""
    from hilc_cli.paper.sheet import sheet_figure  # Matplotlib starts slowly

    rows = [_row(panels, runs, scenarios, reading) for panels in figure.rows]
    drawn = sheet_figure(
        f"Figure {figure.number}. {figure.title}",
        f"{reading.name.capitalize()} reading: {reading.law}",
        rows,
        look,
    )
    return drawn, [panel for row in rows for panel in row.panels]


def _row(
    panels: tuple[PaperPanel, ...],
    runs: Mapping[str, RunData],
    scenarios: Mapping[str, Scenario],
    reading: Reading,
) -> PanelRow:
    """What a row of a figure shows under a reading."""
    first = panels[0]
    scenario = scenarios[first.situation.scenario]
    together = all(panel.situation == first.situation for panel in panels)
    if together:
        heading = f"({first.letter[0]}) {situation_text(first.situation, scenario, reading)}"
    else:
        heading = group_text(first.situation, scenario, reading)
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
