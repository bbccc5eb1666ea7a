"""What is to be reproduced, with the scenarios that it takes."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hilc_cli.paper.claim import Claim
from hilc_cli.paper.contents import FIGURE_NAMES, PaperFigure, figures_named
from hilc_cli.paper.panel import SHOWN_ITERATIONS
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
        scenarios: What is run for them, by the names of the examples.
        claims: What is judged; none if a claim might lack a run.
    """

    figures: tuple[PaperFigure, ...]
    scenarios: Mapping[str, Scenario]
    claims: tuple[Claim, ...]

    def __repr__(self) -> str:
        figures = listed(figure.name for figure in self.figures)
        return in_short(
            f"Plan to reproduce {figures}: {len(self.scenarios)} runs, {len(self.claims)} claims"
        )

    @property
    def steps(self) -> int:
        """Number of runs, claims and figures."""
        return len(self.scenarios) + len(self.claims) + len(self.figures)

    def checksums(self) -> dict[str, str]:
        """SHA-256 of each scenario with everything resolved, by the names of the examples."""
        return {
            name: hashlib.sha256(scenario.resolved_yaml().encode()).hexdigest()
            for name, scenario in self.scenarios.items()
        }

    def checksum(self) -> str:
        """SHA-256 of what tells this reproduction from others: its figures and scenarios."""
        texts = [figure.name for figure in self.figures]
        texts += [scenario.resolved_yaml() for scenario in self.scenarios.values()]
        return hashlib.sha256("\0".join(texts).encode()).hexdigest()


def plan_reproduction(
    figures: Sequence[str] = (), *, overrides: Mapping[str, Any] | None = None
) -> ReproductionPlan:
    """Says what a reproduction is to consist of.

    Args:
        figures: Such as ``fig3``; none for all figures, whereupon the claims are judged too.
        overrides: Values to put into every scenario, by dotted path. The results are then no
            longer those of the paper's experiments, so that no claims are judged.

    Raises:
        UsageError: The paper has no such figure with results.
        InvalidInputError: A scenario is not valid with these values.
    """
    chosen = figures_named(figures)
    names = dict.fromkeys(s.scenario for figure in chosen for s in figure.situations)
    scenarios = {name: _load(name, overrides or {}) for name in names}
    return ReproductionPlan(
        chosen, scenarios, _claims() if _is_whole(chosen) and not overrides else ()
    )


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
