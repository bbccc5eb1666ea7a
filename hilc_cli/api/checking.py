"""What can be said of a scenario without simulating it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.advice import advice
from hilc_cli.analysis.demand import demand_of
from hilc_cli.analysis.feasibility import Feasibility, Limits
from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.remedies import feasibility_findings
from hilc_cli.spec.valid import Scenario


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """What a check of a scenario has found.

    Attributes:
        scenario: What was checked.
        feasibility: What its trajectory demands of wheels and tyres, beside what they can do.
        findings: Failures and warnings of each part of the check: ``settings``, ``feasibility``.
    """

    scenario: Scenario
    feasibility: Feasibility
    findings: Mapping[str, Findings]

    @property
    def failures(self) -> tuple[str, ...]:
        """Why the scenario cannot work, each with its remedy; empty if nothing is wrong."""
        return tuple(text for part in self.findings.values() for text in part.failures)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is legal but unwise."""
        return tuple(text for part in self.findings.values() for text in part.warnings)


def check(scenario: Scenario) -> Check:
    """Checks a scenario, without simulating it.

    Args:
        scenario: From `load_scenario`.
    """
    experiment = scenario.experiment()
    names = scenario.spec.trajectory.segment_names
    # Where numbers leave the range of floating point, they end as infinite: above any limit.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        feasibility = Feasibility(
            demand_of(experiment.reference, experiment.robot, names),
            experiment.robot,
            Limits(experiment.speed_limit, scenario.spec.robot.friction),
        )
        findings = {
            "settings": Findings(warnings=(*scenario.warnings(), *advice(experiment))),
            "feasibility": feasibility_findings(feasibility),
        }
    return Check(scenario, feasibility, findings)
