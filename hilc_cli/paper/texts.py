"""What figures and situations are called, and the page that shows them, ``index.md``."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from itertools import groupby

from hilc_cli.drawing.labels import number_text
from hilc_cli.laws.hybrid import HybridController
from hilc_cli.laws.parameters import default_length
from hilc_cli.paper.claim_texts import (
    Judged,
    cell,
    readings_text,
    table,
    verdict_table,
    verdicts_text,
)
from hilc_cli.paper.contents import (
    CLAIMS_CSV,
    CLAIMS_MD,
    DATA,
    FIGURE_NAMES,
    PaperFigure,
    PaperPanel,
    Situation,
    data_name,
    picture_name,
)
from hilc_cli.paper.panel import SHOWN_ITERATIONS
from hilc_cli.paper.plan import ReproductionPlan
from hilc_cli.paper.reading import Reading
from hilc_cli.results.run import RunData
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.shipped_files import PREFIX


def situation_text(situation: Situation, scenario: Scenario, reading: Reading) -> str:
    """Number, trajectory and controller of a situation, on one line."""
    controller = ", ".join([gains_text(scenario), *setting_texts(scenario)])
    course = course_text(situation, scenario, reading)
    return f"{_head(situation.number, situation)}: {course}, {controller}"


def group_text(situation: Situation, scenario: Scenario, reading: Reading) -> str:
    """What runs of one situation have in common: all but the gains."""
    head = _head(situation.number.rstrip("abc"), situation)
    course = course_text(situation, scenario, reading)
    return ", ".join([f"{head}: {course}", *setting_texts(scenario)])


def _head(number: str, situation: Situation) -> str:
    return f"Situation {number}, Eq. {situation.equation}"


def course_text(situation: Situation, scenario: Scenario, reading: Reading) -> str:
    """The trajectory, and where the platform starts if not on it.

    A heading that the reading does not take as printed is told with the printed one.
    """
    name = scenario.spec.trajectory.name
    if not any(scenario.spec.initial_error):
        return name
    x, y, heading = scenario.spec.start_pose
    degrees = number_text(math.degrees(heading), 4)
    start = f"{name} from ({number_text(x)}, {number_text(y)}) m at {degrees}°"
    misprint = reading.starts.get(situation.scenario)
    return start if misprint is None else f"{start} ({misprint})"


def law_text(scenario: Scenario) -> str:
    """The law that the switch of Fig. 2 takes."""
    return "Eq. 21" if scenario.compensates else "Eq. 17"


def gains_text(scenario: Scenario) -> str:
    """The parameters of the law that is used."""
    controller = _of_the_paper(scenario)
    gains = controller.gains
    if scenario.compensates:
        h = default_length(controller.h, scenario.spec.reference)
        return f"l₁ = {number_text(gains.l1)}, h = {h}"
    values = zip("₁₂₃", (gains.l1, gains.l2, gains.l3), strict=True)
    return ", ".join(f"l{index} = {number_text(value)}" for index, value in values)


def setting_texts(scenario: Scenario) -> list[str]:
    """What else tells the controller from others."""
    controller = _of_the_paper(scenario)
    texts = []
    if controller.gain_matrix == "unit":
        texts.append("matrix with R = B = 1")
    elif controller.gain_matrix != "model":
        rows = "; ".join(" ".join(map(str, row)) for row in controller.gain_matrix)
        texts.append(f"matrix [{rows}]".replace("-", "\N{MINUS SIGN}"))
    if any(scenario.spec.initial_error) and not scenario.compensates:
        texts.append("compensation off")
    limit = scenario.speed_limit
    texts.append("no speed limit" if limit is None else f"limit {number_text(limit)} rad/s")
    return texts


def _of_the_paper(scenario: Scenario) -> HybridController:
    controller = scenario.spec.controller
    assert isinstance(controller, HybridController)  # all its situations have this law
    return controller


PAPER = (
    "Qiao, Xiao, Luo, Li, Jiang: *Design Hybrid Iterative Learning Controller for Directly Driving "
    "the Wheels of Mobile Platform against Uncertain Parameters and Initial Errors*, Appl. Sci. "
    "2021, 11, 8181"
)


def index_text(
    plan: ReproductionPlan,
    runs: Mapping[str, Mapping[str, RunData]],
    judged: Judged,
    formats: Sequence[str],
    command: str,
    versions: Mapping[str, str],
) -> str:
    """The content of ``index.md``.

    Args:
        plan: What has been reproduced.
        runs: The results by the names of readings and then of examples.
        judged: The claims with their verdicts; none if they were not judged.
        formats: Of the pictures; the page shows the first that browsers show.
        command: That writes the same folder.
        versions: Of the programs that took part, by name.
    """
    parts = [
        f"# {_numbers(plan.figures)} of the paper, simulated again",
        f"{PAPER}. Captions are in our words; letters are the paper's.",
        "## Readings" if len(plan.readings) > 1 else "## Reading",
        f"{readings_text(plan.readings)}",
        *(_figure(figure, plan, runs, formats) for figure in plan.figures),
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
    plan: ReproductionPlan,
    runs: Mapping[str, Mapping[str, RunData]],
    formats: Sequence[str],
) -> str:
    parts = [f"## Figure {figure.number}", f"**{figure.title}.** {figure.caption}"]
    for reading in plan.readings:
        parts += _read(
            figure, reading, plan.scenarios[reading.name], runs[reading.name], list(formats)
        )
    return "\n\n".join(parts)


def _read(
    figure: PaperFigure,
    reading: Reading,
    scenarios: Mapping[str, Scenario],
    runs: Mapping[str, RunData],
    formats: list[str],
) -> Sequence[str]:
    """A figure under a reading: its picture, what the panels show, and how the runs ended."""
    files = [picture_name(figure, reading, suffix) for suffix in formats]
    shown = next(file for file in files if not file.endswith(".pdf"))
    panels = "; ".join(_panel(panel, scenarios, reading) for panel in figure.panels)
    return (
        f"### Figure {figure.number}, {reading.name}: {reading.law}",
        f"![Figure {figure.number}, {reading.name}]({shown})",
        f"{panels}.",
        f"Files: {', '.join(f'[{file}]({file})' for file in files)}.",
        table(
            (
                *("panels", "situation", "trajectory", "law", "scenario", "iterations"),
                *("maximum error [m]", "average error [m]", "data"),
            ),
            (
                _situation(situation, list(panels), runs, scenarios, reading)
                for situation, panels in groupby(figure.panels, lambda panel: panel.situation)
            ),
        ),
    )


def _panel(panel: PaperPanel, scenarios: Mapping[str, Scenario], reading: Reading) -> str:
    situation = panel.situation
    scenario, equation = scenarios[situation.scenario], situation.equation
    if len(panel.letter) == 1:
        return f"({panel.letter}) {gains_text(scenario)} (Eq. {equation})"
    course = course_text(situation, scenario, reading)
    return f"({panel.letter}) {panel.kind}, {course} (Eq. {equation})"


def _situation(
    situation: Situation,
    panels: Sequence[PaperPanel],
    runs: Mapping[str, RunData],
    scenarios: Mapping[str, Scenario],
    reading: Reading,
) -> Sequence[str]:
    scenario, run = scenarios[situation.scenario], runs[situation.scenario]
    last = run.metrics.row(-1)
    law = ", ".join([law_text(scenario), gains_text(scenario), *setting_texts(scenario)])
    data = ", ".join(f"[{panel.letter}]({data_name(panel, reading)})" for panel in panels)
    words = [f"{PREFIX}{situation.scenario}"]
    for override in reading.overrides(situation.scenario):
        words += ["--set", override]
    return (
        ", ".join(panel.letter for panel in panels),
        f"{situation.number}, Eq. {situation.equation}",
        cell(course_text(situation, scenario, reading)),
        cell(law),
        f"`{shlex.join(words)}`",
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
        f"{verdicts_text(judged)} What was measured, by which criterion, and why a claim does not "
        f"hold: [{CLAIMS_MD}]({CLAIMS_MD}); for programs: [{CLAIMS_CSV}]({CLAIMS_CSV}).",
        verdict_table(judged, CLAIMS_MD),
    ]
