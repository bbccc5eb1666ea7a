"""What is to be reproduced, with the scenarios that it takes."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hilc_cli.paper.claim import Claim
from hilc_cli.paper.contents import FIGURE_NAMES, PaperFigure, figures_named
from hilc_cli.paper.panel import SHOWN_ITERATIONS
from hilc_cli.paper.reading import BOTH, Reading, readings_named
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.scenario import recorded_iterations
from hilc_cli.shipped_files import PREFIX
from hilc_cli.wording import in_short, listed


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ReproductionPlan:
    """Some of the paper's figures, and its claims if all figures are among them.

    Attributes:
        figures: In the order of the paper.
        readings: How the paper is read: each figure is drawn, each claim judged under each.
        scenarios: What is run for them, by the names of readings and then of examples.
        claims: What is judged; none if a claim might lack a run.
    """

    figures: tuple[PaperFigure, ...]
    readings: tuple[Reading, ...]
    scenarios: Mapping[str, Mapping[str, Scenario]]
    claims: tuple[Claim, ...]

    def __repr__(self) -> str:
        figures = listed(figure.name for figure in self.figures)
        readings = listed(reading.name for reading in self.readings)
        return in_short(
            f"Plan to reproduce {figures}, read as {readings}: {self.runs} runs, "
            f"{len(self.claims)} claims"
        )

    @property
    def runs(self) -> int:
        """Number of runs."""
        return sum(map(len, self.scenarios.values()))

    @property
    def steps(self) -> int:
        """Number of runs, and of claims and figures under each reading."""
        return self.runs + len(self.readings) * (len(self.claims) + len(self.figures))

    def checksums(self) -> dict[str, str]:
        """SHA-256 of each scenario with everything resolved, by ``READING/EXAMPLE``."""
        return {
            f"{reading}/{name}": hashlib.sha256(scenario.resolved_yaml().encode()).hexdigest()
            for reading, scenarios in self.scenarios.items()
            for name, scenario in scenarios.items()
        }

    def checksum(self) -> str:
        """SHA-256 of what tells this reproduction from others: its figures and scenarios."""
        texts = [figure.name for figure in self.figures]
        texts += [f"{name} {checksum}" for name, checksum in self.checksums().items()]
        return hashlib.sha256("\0".join(texts).encode()).hexdigest()


def plan_reproduction(
    figures: Sequence[str] = (),
    *,
    reading: str = BOTH,
    overrides: Mapping[str, Any] | None = None,
) -> ReproductionPlan:
    """Says what a reproduction is to consist of.

    Args:
        figures: Such as ``fig3``; none for all figures, whereupon the claims are judged too.
        reading: How the paper is read: literal, derivative or both.
        overrides: Values to put into every scenario, by dotted path. The results are then no
            longer those of the paper's experiments, so that no claims are judged.

    Raises:
        UsageError: The paper has no such figure with results, or there is no such reading.
        InvalidInputError: A scenario is not valid with these values.
    """
    chosen, readings = figures_named(figures), readings_named(reading)
    names = dict.fromkeys(s.scenario for figure in chosen for s in figure.situations)
    scenarios = {
        each.name: {name: _load(name, {**each.values(name), **(overrides or {})}) for name in names}
        for each in readings
    }
    claims = _claims() if _is_whole(chosen) and not overrides else ()
    return ReproductionPlan(chosen, readings, scenarios, claims)


def _is_whole(figures: Sequence[PaperFigure]) -> bool:
    return len(figures) == len(FIGURE_NAMES)


def _claims() -> tuple[Claim, ...]:
    from hilc_cli.paper.claims import CLAIMS  # with all that they measure

    return CLAIMS


def _load(name: str, overrides: Mapping[str, Any]) -> Scenario:
    """An example that records what the panels show besides what it records by itself."""
    values = dict(overrides)
    last = load_scenario(f"{PREFIX}{name}", values).spec.iterations
    shown = {iteration for iteration in SHOWN_ITERATIONS if iteration <= last}
    values["record.iterations"] = sorted(shown | recorded_iterations("auto", last))
    return load_scenario(f"{PREFIX}{name}", values)
