"""The paper's figures and claims: run their scenarios, judge, draw, keep."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.names import in_short, listed
from hilc_cli.paper.claim import Claim, Finding
from hilc_cli.paper.contents import FIGURES
from hilc_cli.paper.folder import check_reproduction_folder, write_reproduction_folder
from hilc_cli.paper.names import with_shown
from hilc_cli.paper.plan import ReproductionPlan
from hilc_cli.results.folder import DRAWN_WITH, origin, versions
from hilc_cli.runs.running import Run, run

DPI = 300
"""Resolution of pictures in print [dots per inch]."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Reproduction:
    """Results of the paper's experiments, and how they came to be.

    Attributes:
        plan: What was to be reproduced.
        runs: The results by the names of the examples.
        judged: The claims with their verdicts; none unless all figures are reproduced.
        started: When, in UTC.
        timings: Seconds that each step took.
    """

    plan: ReproductionPlan
    runs: Mapping[str, Run]
    judged: tuple[tuple[Claim, Finding], ...]
    started: datetime
    timings: Mapping[str, float]

    def __repr__(self) -> str:
        figures = listed(figure.name for figure in self.plan.figures)
        return in_short(
            f"Reproduction of {figures}: {len(self.runs)} runs, {len(self.judged)} claims judged"
        )

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        dpi: int = DPI,
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
            command: Command line to note in the manifest.
            on_step: Called after each figure; may raise to stop.

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

        def manifest() -> Mapping[str, Any]:
            timings["figures and tables"] = time.perf_counter() - clock
            return {
                **origin(self.started, DRAWN_WITH),
                "command": list(command),
                "timings_s": {**self.timings, **timings},
            }

        chosen = tuple(dict.fromkeys(formats))
        write_reproduction_folder(
            Path(folder),
            self.plan,
            self.runs,
            self.judged,
            manifest,
            formats=with_shown(chosen),
            dpi=dpi,
            command=_command(self.plan, chosen, dpi),
            versions=versions(DRAWN_WITH),
            force=force,
            on_figure=on_step,
        )
        return timings


def reproduce(
    plan: ReproductionPlan, *, on_step: Callable[[], None] = lambda: None
) -> Reproduction:
    """Runs the experiments behind the paper's figures and judges its claims.

    Args:
        plan: From `plan_reproduction`.
        on_step: Called after each run and each claim; may raise to stop.
    """
    started, clock = datetime.now(UTC), time.perf_counter()
    runs: dict[str, Run] = {}
    for name, scenario in plan.scenarios.items():
        runs[name] = run(scenario)
        on_step()
    simulated = time.perf_counter()
    judged: list[tuple[Claim, Finding]] = []
    for claim in plan.claims:
        judged.append((claim, claim.judge(runs)))
        on_step()
    timings = {"simulation": simulated - clock, "claims": time.perf_counter() - simulated}
    return Reproduction(plan, runs, tuple(judged), started, timings)


def check_reproduction(plan: ReproductionPlan, folder: str | Path, *, force: bool = False) -> None:
    """Whether a reproduction may be written to a folder, before it is simulated.

    Raises:
        ExistingResultsError: The folder holds something else.
    """
    check_reproduction_folder(Path(folder), plan, force=force)


def _command(plan: ReproductionPlan, formats: Sequence[str], dpi: int) -> str:
    """The shortest command that writes the same; where it writes is left out."""
    names = [figure.name for figure in plan.figures]
    words = ["hilc", "reproduce", *(names if len(names) < len(FIGURES) else [])]
    if tuple(formats) != ("png",):
        words += [word for name in formats for word in ("--format", name)]
    if dpi != DPI:
        words += ["--dpi", str(dpi)]
    return " ".join(words)
