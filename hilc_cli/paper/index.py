"""``index.md``: figures, claims, and where everything comes from, on one page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby

from hilc_cli.figures.labels import number_text
from hilc_cli.figures.paper.panel import SHOWN_ITERATIONS
from hilc_cli.paper.claim_tables import Judged, count_text, verdict_table
from hilc_cli.paper.contents import FIGURE_NAMES, PaperFigure, PaperPanel, Situation
from hilc_cli.paper.markdown import cell, table
from hilc_cli.paper.names import CLAIMS_CSV, CLAIMS_MD, DATA, data_name, picture_name
from hilc_cli.paper.plan import ReproductionPlan
from hilc_cli.paper.wording import course_text, gains_text, law_text, setting_texts
from hilc_cli.results.run import RunData
from hilc_cli.shipped_files import PREFIX
from hilc_cli.spec.valid import Scenario

PAPER = (
    "Qiao, Xiao, Luo, Li, Jiang: *Design Hybrid Iterative Learning Controller for Directly Driving "
    "the Wheels of Mobile Platform against Uncertain Parameters and Initial Errors*, Appl. Sci. "
    "2021, 11, 8181"
)


def index_text(
    plan: ReproductionPlan,
    runs: Mapping[str, RunData],
    judged: Judged,
    formats: Sequence[str],
    command: str,
    versions: Mapping[str, str],
) -> str:
    """The content of ``index.md``.

    Args:
        plan: What has been reproduced.
        runs: The results by the names of the examples.
        judged: The claims with their verdicts; none if they were not judged.
        formats: Of the pictures; the page shows the first that browsers show.
        command: That writes the same folder.
        versions: Of the programs that took part, by name.
    """
    parts = [
        f"# {_numbers(plan.figures)} of the paper, simulated again",
        f"{PAPER}. Captions are in our words; letters are the paper's.",
        *(_figure(figure, runs, plan.scenarios, formats) for figure in plan.figures),
        "## Claims",
        *_claims(judged),
        "## Data",
        _DATA_TEXT,
        "## Made with",
        f"```\n{command}\n```",
        ", ".join(f"{name} {version}" for name, version in versions.items()) + ".",
    ]
    return "\n\n".join(parts) + "\n"


_DATA_TEXT = (
    f"`{DATA}/` has a CSV file for each panel, with what is drawn in it and nothing else. Paths "
    "have a row per sample of each drawn iteration "
    f"({', '.join(map(str, SHOWN_ITERATIONS))} where all are run), wheel speeds a row per sample, "
    "each held until the next, errors a row per iteration, with the number of samples at which the "
    "speed limit acted. Errors are distances of the wheels' midpoint from the reference; maximum "
    "and average run over all samples of an iteration."
)


def _numbers(figures: Sequence[PaperFigure]) -> str:
    numbers = [figure.number for figure in figures]
    if len(numbers) == len(FIGURE_NAMES):
        return f"Figures {numbers[0]} to {numbers[-1]}"
    return f"Figure{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"


def _figure(
    figure: PaperFigure,
    runs: Mapping[str, RunData],
    scenarios: Mapping[str, Scenario],
    formats: Sequence[str],
) -> str:
    files = [picture_name(figure, suffix) for suffix in formats]
    shown = next((file for file in files if not file.endswith(".pdf")), None)
    panels = "; ".join(_panel(panel, scenarios) for panel in figure.panels)
    parts = [
        f"## Figure {figure.number}",
        f"![Figure {figure.number}]({shown})" if shown else "",
        f"**{figure.title}.** {figure.caption} {panels}.",
        f"Files: {', '.join(f'[{file}]({file})' for file in files)}.",
        table(
            (
                *("panels", "situation", "trajectory", "law", "scenario", "iterations"),
                *("maximum error [m]", "average error [m]", "data"),
            ),
            (
                _situation(situation, list(panels), runs, scenarios)
                for situation, panels in groupby(figure.panels, lambda panel: panel.situation)
            ),
        ),
    ]
    return "\n\n".join(part for part in parts if part)


def _panel(panel: PaperPanel, scenarios: Mapping[str, Scenario]) -> str:
    scenario, equation = scenarios[panel.situation.scenario], panel.situation.equation
    if len(panel.letter) == 1:
        return f"({panel.letter}) {gains_text(scenario)} (Eq. {equation})"
    return f"({panel.letter}) {panel.kind}, {course_text(scenario)} (Eq. {equation})"


def _situation(
    situation: Situation,
    panels: Sequence[PaperPanel],
    runs: Mapping[str, RunData],
    scenarios: Mapping[str, Scenario],
) -> Sequence[str]:
    scenario, run = scenarios[situation.scenario], runs[situation.scenario]
    last = run.metrics.row(-1)
    law = ", ".join([law_text(scenario), gains_text(scenario), *setting_texts(scenario)])
    data = ", ".join(f"[{panel.letter}]({data_name(panel)})" for panel in panels)
    return (
        ", ".join(panel.letter for panel in panels),
        f"{situation.number}, Eq. {situation.equation}",
        cell(course_text(scenario)),
        cell(law),
        f"`{PREFIX}{situation.scenario}`",
        str(run.last.iteration),
        number_text(last["max_position_error_m"], 4),
        number_text(last["mean_position_error_m"], 4),
        data,
    )


def _claims(judged: Judged) -> Sequence[str]:
    if not judged:
        return [
            "Not judged: they need the runs of all figures. `hilc reproduce` without naming "
            "figures judges them."
        ]
    return [
        f"{count_text(judged)}. What was measured, by which criterion, and why a claim does not "
        f"hold: [{CLAIMS_MD}]({CLAIMS_MD}); for programs: [{CLAIMS_CSV}]({CLAIMS_CSV}).",
        verdict_table(judged, CLAIMS_MD),
    ]
