"""The folder of a reproduction: what is in it, and when it may be replaced."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hilc_cli.errors import ExistingResultsError
from hilc_cli.paper.contents import MOTOR_LIMIT, PaperFigure, PaperPanel
from hilc_cli.paper.names import (
    CLAIMS_CSV,
    CLAIMS_MD,
    DATA,
    INDEX,
    OWN_DATA,
    REPRODUCTION_FOLDER,
    data_name,
    picture_name,
)
from hilc_cli.paper.panel import Panel, PanelRow, write_panel
from hilc_cli.paper.plan import ReproductionPlan
from hilc_cli.paper.texts import (
    Judged,
    claims_text,
    gains_text,
    group_text,
    index_text,
    situation_text,
    write_claims_csv,
)
from hilc_cli.results.run import RunData
from hilc_cli.scenario.experiment import Scenario


def write_reproduction_folder(
    path: Path,
    plan: ReproductionPlan,
    runs: Mapping[str, RunData],
    judged: Judged,
    manifest: Callable[[], Mapping[str, Any]],
    *,
    formats: Sequence[str],
    dpi: int,
    command: str,
    versions: Mapping[str, str],
    force: bool = False,
    on_figure: Callable[[], None] = lambda: None,
) -> None:
    """Writes figures, data, claims and index as a whole.

    Args:
        path: The folder.
        plan: What has been reproduced.
        runs: The results by the names of the examples.
        judged: The claims with their verdicts; none if they were not judged.
        manifest: Gives what else is to be known, asked last; kind and files are added.
        formats: Of the pictures.
        dpi: Dots per inch of PNG files.
        command: That writes the same folder.
        versions: Of the programs that took part, by name.
        force: Replace the folder of other figures or results.
        on_figure: Called after each figure; may raise to stop.

    Raises:
        ExistingResultsError: The folder holds something else.
        FileAccessError: It cannot be written.
    """
    from hilc_cli.drawing.save import save_figure
    from hilc_cli.paper.sheet import sheet_figure  # Matplotlib starts slowly

    def fill(folder: Path) -> None:
        (folder / DATA).mkdir()
        for figure in plan.figures:
            rows = panel_rows(figure, runs, plan.scenarios)
            sheet = sheet_figure(f"Figure {figure.number}. {figure.title}", rows)
            for suffix in formats:
                save_figure(sheet, folder / picture_name(figure, suffix), dpi)
            drawn = [panel for row in rows for panel in row.panels]
            for panel, content in zip(figure.panels, drawn, strict=True):
                write_panel(folder / data_name(panel), content)
            on_figure()
        if judged:
            write_claims_csv(folder / CLAIMS_CSV, judged)
            _write(folder / CLAIMS_MD, claims_text(judged))
        _write(folder / INDEX, index_text(plan, runs, judged, formats, command, versions))

    REPRODUCTION_FOLDER.write(
        path,
        fill,
        lambda: {
            "figures": [figure.name for figure in plan.figures],
            "checksum": plan.checksum(),
            "scenarios_sha256": plan.checksums(),
            **manifest(),
        },
        lambda folder: check_reproduction_folder(folder, plan, force=force),
    )


def check_reproduction_folder(path: Path, plan: ReproductionPlan, *, force: bool = False) -> None:
    """Whether a reproduction may be written to a folder; to be asked before a long simulation.

    One of fewer figures may be completed: all of them are drawn again, from the same scenarios.

    Args:
        path: The folder.
        plan: What is to be written.
        force: Replace the folder of other figures or scenarios.

    Raises:
        ExistingResultsError: The folder holds something else, or somebody's own files stand
            among the data.
    """
    REPRODUCTION_FOLDER.check(path, lambda there: _is_among(there, plan), force=force)
    for name in sorted(f"{DATA}/{entry.name}" for entry in (path / DATA).glob("*")):
        if name not in OWN_DATA:
            raise ExistingResultsError(
                f"{path / name}: is no file of a reproduction, which would be replaced; "
                "move it elsewhere"
            )


def _is_among(manifest: Mapping[str, Any], plan: ReproductionPlan) -> bool:
    """Whether a plan has all figures and scenarios of the reproduction in a folder."""
    if manifest.get("checksum") == plan.checksum():
        return True
    figures, scenarios = manifest.get("figures"), manifest.get("scenarios_sha256")
    if not isinstance(figures, list) or not isinstance(scenarios, dict) or not scenarios:
        return False
    named, checksums = [figure.name for figure in plan.figures], plan.checksums()
    return all(name in named for name in figures) and all(
        checksums.get(name) == checksum for name, checksum in scenarios.items()
    )


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", newline="\n")


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
