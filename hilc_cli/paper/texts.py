"""The texts of a reproduction: ``index.md``, ``claims.md`` and ``claims.csv``."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path

from hilc_cli.drawing.labels import number_text
from hilc_cli.laws.hybrid import HybridController
from hilc_cli.laws.parameters import default_length
from hilc_cli.paper.claim import Claim, Figure, Finding, Verdict
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
from hilc_cli.results.run import RunData
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.shipped_files import PREFIX


def cell(text: str) -> str:
    """A text that a table's cell can hold."""
    return " ".join(text.split()).replace("|", r"\|")


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the cells stand as they are."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


CLAIMS_HEADER = ("id", "sentence", "place", "measured", "criterion", "figures", "verdict", "reason")

Judged = Sequence[tuple[Claim, Finding]]


def write_claims_csv(path: Path, judged: Judged) -> None:
    """Writes ``claims.csv``: a row per claim; every figure reads back exactly."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(CLAIMS_HEADER)
        for claim, finding in judged:
            figures = "; ".join(f"{f.name}={_exact(f)}" for f in finding.figures)
            writer.writerow(
                [
                    *(claim.name, claim.sentence, claim.place, claim.measured, claim.criterion),
                    *(figures, finding.verdict.value, finding.reason),
                ]
            )


def _exact(figure: Figure) -> str:
    value = "none" if figure.value is None else repr(float(figure.value))
    return f"{value} {figure.unit}".rstrip()


def claims_text(judged: Judged) -> str:
    """The content of ``claims.md``."""
    parts = [
        "# What the paper claims, and what was measured",
        f"{count_text(judged)}. A claim that does not hold is a finding, not an error.",
        verdict_table(judged, ""),
        *(_section(claim, finding) for claim, finding in judged),
    ]
    return "\n\n".join(parts) + "\n"


def verdict_table(judged: Judged, file: str) -> str:
    """A table of claims and verdicts.

    Args:
        judged: The claims.
        file: That has a section for each claim; empty for the one that the table stands in.
    """
    return table(
        ("claim", "the paper says", "verdict"),
        (
            (f"[{claim.name}]({file}#{claim.name.lower()})", cell(claim.sentence), finding.verdict)
            for claim, finding in judged
        ),
    )


def count_text(judged: Judged) -> str:
    """How many claims there are of each verdict."""
    verdicts = [finding.verdict for _, finding in judged]
    plural = {Verdict.HOLDS: "hold", Verdict.IN_PART: "hold in part", Verdict.FAILS: "do not hold"}
    counts = [(verdicts.count(verdict), verdict) for verdict in Verdict]
    told = ", ".join(
        f"{count} {verdict.value if count == 1 else plural[verdict]}" for count, verdict in counts
    )
    return f"{len(verdicts)} claims: {told}" if len(verdicts) != 1 else f"1 claim: {told}"


def figure_text(figure: Figure) -> str:
    """The value of a measured figure, in a few digits."""
    if figure.value is None:
        return "none"
    value = figure.value
    text = number_text(value, 4) if math.isfinite(value) else str(value)
    return f"{text} {figure.unit}".rstrip()


def _open(text: str) -> str:
    """A sentence without its full stop."""
    return text.rstrip().removesuffix(".")


def _section(claim: Claim, finding: Finding) -> str:
    lines = [
        f"## {claim.name}",
        f"{_open(claim.sentence)} ({_open(claim.place)}).",
        f"**Verdict: {finding.verdict}.** {finding.reason}".rstrip(),
        f"- Measured: {_open(claim.measured)}.",
        f"- Criterion: {_open(claim.criterion)}.",
    ]
    text = "\n\n".join(lines[:4]) + f"\n{lines[4]}"
    if not finding.figures:
        return text
    figures = ((cell(figure.name), cell(figure_text(figure))) for figure in finding.figures)
    return f"{text}\n\n{table(('figure', 'value'), figures)}"


def situation_text(situation: Situation, scenario: Scenario) -> str:
    """Number, trajectory and controller of a situation, on one line."""
    controller = ", ".join([gains_text(scenario), *setting_texts(scenario)])
    return f"{_head(situation.number, situation)}: {course_text(scenario)}, {controller}"


def group_text(situation: Situation, scenario: Scenario) -> str:
    """What runs of one situation have in common: all but the gains."""
    number = situation.number.rstrip("abc")
    return ", ".join(
        [f"{_head(number, situation)}: {course_text(scenario)}", *setting_texts(scenario)]
    )


def _head(number: str, situation: Situation) -> str:
    return f"Situation {number}, Eq. {situation.equation}"


def course_text(scenario: Scenario) -> str:
    """The trajectory, and where the platform starts if not on it."""
    name = scenario.spec.trajectory.name
    if not any(scenario.spec.initial_error):
        return name
    x, y, heading = scenario.spec.start_pose
    degrees = number_text(math.degrees(heading), 4)
    return f"{name} from ({number_text(x)}, {number_text(y)}) m at {degrees}°"


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
