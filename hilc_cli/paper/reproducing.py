"""The paper's figures and claims: run their scenarios, judge, draw, keep."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.engine.loop import prepare_machine_code
from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.paper.claim import Claim, Evidence, Finding
from hilc_cli.paper.claim_texts import claims_rows, claims_text, write_claims_csv
from hilc_cli.paper.contents import (
    CLAIMS_CSV,
    CLAIMS_MD,
    DATA,
    FIGURES,
    INDEX,
    OWN_DATA,
    REPRODUCTION_FOLDER,
    PaperFigure,
    with_shown,
)
from hilc_cli.paper.panel import Panel
from hilc_cli.paper.plan import ReproductionPlan
from hilc_cli.paper.reading import READINGS, Reading, readings_named
from hilc_cli.paper.sheets import DrawnSheets, draw_sheet
from hilc_cli.paper.texts import index_text
from hilc_cli.results.folder import DRAWN_WITH, origin, versions
from hilc_cli.results.frames import frame
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.look import USUAL, Look
from hilc_cli.runs.running import Run, run
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.wording import in_short, listed
from hilc_cli.workers.crews import shared_out

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawn
    from pandas import DataFrame

_MANY = 1000
"""Iterations of all runs, of some 4 ms each, from which on worker processes pay."""

DPI = 300
"""Resolution of pictures in print [dots per inch]."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Reproduction(InNotebooks):
    """Results of the paper's experiments, and how they came to be.

    Attributes:
        plan: What was to be reproduced.
        runs: The results by the names of readings and then of examples.
        judged: The claims, each with its verdict under each reading by the reading's name; none
            unless all figures are reproduced.
        started: When, in UTC.
        timings: Seconds that each step took.
    """

    plan: ReproductionPlan
    runs: Mapping[str, Mapping[str, Run]]
    judged: tuple[tuple[Claim, Mapping[str, Finding]], ...]
    started: datetime
    timings: Mapping[str, float]

    def __repr__(self) -> str:
        figures = listed(figure.name for figure in self.plan.figures)
        return in_short(
            f"Reproduction of {figures}: {self.plan.runs} runs, {len(self.judged)} claims judged"
        )

    def to_pandas(self) -> DataFrame:
        """The claims as a data frame of pandas, with the columns of claims.csv.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        header, rows = claims_rows(self.judged)
        columns = {name: [row[place] for row in rows] for place, name in enumerate(header)}
        return frame({"claims": lambda: columns}, "claims")

    def sheet(
        self, figure: PaperFigure, reading: Reading, look: Look = USUAL
    ) -> tuple[Drawn, list[Panel]]:
        """Draws one of the paper's figures under a reading, and tells its panels."""
        return draw_sheet(
            figure, reading, self.runs[reading.name], self.plan.scenarios[reading.name], look
        )

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        dpi: int = DPI,
        look: Look = USUAL,
        command: Sequence[str] = (),
        on_step: Callable[[], None] = lambda: None,
    ) -> dict[str, float]:
        """Writes figures, the data of their panels, claims and an index.

        Args:
            folder: The very folder that is written; it is there as a whole or not at all.
            force: Replace the folder of figures that are not all among these.
            formats: Of the pictures: png, svg, pdf; pdf alone is joined by png, which the index
                shows.
            dpi: Resolution of png.
            look: How the figures are to look, from `picture_look`.
            command: Command line to note in the manifest.
            on_step: Called after each figure of each reading; may raise to stop.

        Returns:
            Seconds that it took.

        Raises:
            ExistingResultsError: The folder holds something else.
            FileAccessError: It cannot be written.
            UsageError: There is no such picture format or resolution.
        """
        from hilc_cli.drawing.save import check_format  # Matplotlib starts slowly

        for name in formats:
            check_format(name)
        if not 1 <= dpi <= 10_000:
            raise UsageError(f"dpi must be from 1 to 10000, got {dpi}")
        clock = time.perf_counter()
        timings: dict[str, float] = {}
        chosen = tuple(dict.fromkeys(formats))
        plan, runs, judged, shown = self.plan, self.runs, self.judged, with_shown(chosen)

        def fill(into: Path) -> None:
            (into / DATA).mkdir()
            sheets = tuple(product(plan.figures, (reading.name for reading in plan.readings)))
            # Plain dicts, which can be sent.
            scenarios = {name: dict(named) for name, named in plan.scenarios.items()}
            draw = DrawnSheets(sheets, scenarios, runs, shown, dpi, look)
            titles = [f"figure {figure.number} ({reading})" for figure, reading in sheets]
            for _, files in shared_out(draw, titles, share=len(sheets) > 1):
                for name, content in files.items():
                    (into / name).write_bytes(content)
                on_step()
            if judged:
                write_claims_csv(into / CLAIMS_CSV, judged)
                _write(into / CLAIMS_MD, claims_text(judged))
            again, made_with = _command(plan, chosen, dpi, look), versions(DRAWN_WITH)
            _write(into / INDEX, index_text(plan, runs, judged, shown, again, made_with))

        def manifest() -> Mapping[str, Any]:
            timings["figures and tables"] = time.perf_counter() - clock
            return {
                "figures": [figure.name for figure in plan.figures],
                "readings": [reading.name for reading in plan.readings],
                "checksum": plan.checksum(),
                "scenarios_sha256": plan.checksums(),
                **origin(self.started, DRAWN_WITH),
                "command": list(command),
                "timings_s": {**self.timings, **timings},
            }

        REPRODUCTION_FOLDER.write(
            Path(folder), fill, manifest, lambda there: check_reproduction(plan, there, force=force)
        )
        return timings


def reproduce(
    plan: ReproductionPlan, *, on_step: Callable[[], None] = lambda: None
) -> Reproduction:
    """Runs the experiments behind the paper's figures and judges its claims.

    Args:
        plan: From `plan_reproduction`.
        on_step: Called after each run, and after each claim under each reading; may raise to stop.

    Raises:
        WorkersError: Worker processes, which share many runs out, cannot do anything here.
    """
    started, clock = datetime.now(UTC), time.perf_counter()
    runs, known = _simulate(plan, on_step)
    simulated = time.perf_counter()
    judged: list[tuple[Claim, Mapping[str, Finding]]] = []
    for claim in plan.claims:
        findings: dict[str, Finding] = {}
        for reading in plan.readings:
            finding = known.get((claim.name, reading.name))
            if finding is None:
                finding = claim.judge(Evidence(reading, runs[reading.name]))
            findings[reading.name] = finding
            on_step()
        judged.append((claim, findings))
    timings = {"simulation": simulated - clock, "claims": time.perf_counter() - simulated}
    return Reproduction(plan, runs, tuple(judged), started, timings)


@dataclass(frozen=True, slots=True)
class _Work:
    """What a worker gets, and does: it judges a claim, or runs a scenario, by their number.

    Nobody asks for the plan of one more iteration, which is code and cannot be sent.

    Attributes:
        claims: That need no runs, each with the name of a reading. They come first, since they
            take longest.
        scenarios: To be run.
    """

    claims: tuple[tuple[Claim, str], ...]
    scenarios: tuple[Scenario, ...]

    @property
    def are_many(self) -> bool:
        """Whether the runs are worth the start of other processes, and of machine code."""
        return sum(scenario.spec.iterations + 1 for scenario in self.scenarios) >= _MANY

    def __call__(self, number: int) -> Finding | Run:
        if self.are_many:
            prepare_machine_code()
        if number < len(self.claims):
            claim, reading = self.claims[number]
            return claim.judge(Evidence(readings_named(reading)[0], {}))
        return replace(run(self.scenarios[number - len(self.claims)]), plan=None)


def _simulate(
    plan: ReproductionPlan, on_step: Callable[[], None]
) -> tuple[dict[str, dict[str, Run]], dict[tuple[str, str], Finding]]:
    """All runs of a plan, in worker processes where that is worth their start.

    Returns:
        The runs by reading and name, and what is found of the claims that need none, by claim and
        reading.
    """
    keys = [(reading, name) for reading, named in plan.scenarios.items() for name in named]
    claims = [(c, each.name) for c in plan.claims if not c.needs_runs for each in plan.readings]
    titles = [f"{claim.name} ({reading})" for claim, reading in claims]
    titles += [f"{name} ({reading})" for reading, name in keys]
    work = _Work(tuple(claims), tuple(plan.scenarios[reading][name] for reading, name in keys))
    found: dict[int, Finding | Run] = {}
    if work.are_many:
        prepare_machine_code()
    for number, result in shared_out(work, titles, share=work.are_many):
        found[number] = result
        if isinstance(result, Run):
            on_step()
    runs: dict[str, dict[str, Run]] = {reading: {} for reading in plan.scenarios}
    findings: dict[tuple[str, str], Finding] = {}
    for number, result in sorted(found.items()):
        if isinstance(result, Run):
            reading, name = keys[number - len(claims)]
            runs[reading][name] = result
        else:
            claim, reading = claims[number]
            findings[claim.name, reading] = result
    return runs, findings


def check_reproduction(plan: ReproductionPlan, folder: str | Path, *, force: bool = False) -> None:
    """Whether a reproduction may be written to a folder, before it is simulated.

    One of fewer figures may be completed: all of them are drawn again, from the same scenarios.

    Args:
        plan: What is to be written.
        folder: Where.
        force: Replace the folder of other figures or scenarios.

    Raises:
        ExistingResultsError: The folder holds something else, or somebody's own files stand
            among the data.
    """
    path = Path(folder)
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


def _command(plan: ReproductionPlan, formats: Sequence[str], dpi: int, look: Look) -> str:
    """The shortest command that writes the same; where it writes is left out."""
    names = [figure.name for figure in plan.figures]
    words = ["hilc", "reproduce", *(names if len(names) < len(FIGURES) else [])]
    if plan.readings != READINGS:
        words += ["--reading", plan.readings[0].name]
    if tuple(formats) != ("png",):
        words += [word for name in formats for word in ("--format", name)]
    if dpi != DPI:
        words += ["--dpi", str(dpi)]
    return " ".join(words) + look.options
