"""A simulation beside what a check of a scenario says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain

from hilc_cli.analysis.bounds import Bounds
from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.measured import Comparison
from hilc_cli.analysis.measured import compare as beside
from hilc_cli.analysis.theories import CORRECTED, WITHIN_LIMIT
from hilc_cli.api.running import OnIteration, RunData, Summary, measured_trials
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import DivergedError
from hilc_cli.results.metrics import MetricsTable
from hilc_cli.results.summary import summarise
from hilc_cli.results.trial import Trial
from hilc_cli.spec.valid import Scenario


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """A simulation beside what theory says of it.

    Attributes:
        run: The run.
        comparisons: The bounds of each theory beside the run, by the theory's name; empty if the
            law is another one than the hybrid law.
    """

    run: RunData
    comparisons: Mapping[str, Comparison]

    @property
    def summary(self) -> Summary:
        """The run in a few figures."""
        return summarise(self.run)


def simulated(
    scenario: Scenario,
    experiment: Experiment,
    bounds: Mapping[str, Bounds],
    on_iteration: OnIteration | None,
) -> tuple[Findings, Simulated | None]:
    """One run, of which each iteration is measured as it comes, and only the last is kept."""
    metrics = MetricsTable()
    last: dict[int, Trial] = {}
    diverged_at: int | None = None

    def completed() -> Iterator[Trial]:
        nonlocal diverged_at
        try:
            for trial in measured_trials(experiment, metrics):
                last.clear()
                last[trial.iteration] = trial
                if on_iteration is not None:
                    on_iteration(trial.iteration)
                yield trial
        except DivergedError as error:
            diverged_at = error.iteration

    trials = completed()
    first = next(trials, None)
    comparisons = {} if first is None else beside(experiment, bounds, chain([first], trials))
    findings = Findings()
    if diverged_at is not None:
        findings = Findings(
            failures=(
                f"the simulation diverged to non-finite values in iteration {diverged_at}; "
                "lower the gains, or set controller.b_w",
            )
        )
    if first is None:
        return findings, None
    run = RunData(
        name=scenario.name,
        reference=experiment.reference,
        metrics=metrics,
        trials=last,
        speed_limit=scenario.speed_limit,
        gravity_center=experiment.robot.gravity_center,
        diverged_at=diverged_at,
    )
    return findings, Simulated(run, comparisons)


def theory_findings(simulated: Simulated | None) -> Findings:
    """Bounds that should hold, and do not: a violated one is a defect of the theory's code."""
    if simulated is None:
        return Findings()
    found = []
    for name in (CORRECTED, WITHIN_LIMIT):
        for quantity, part in (
            simulated.comparisons[name].parts if name in simulated.comparisons else {}
        ).items():
            if len(part.violated):
                found.append(
                    f"the bound of the {quantity} error, {name}, is violated in "
                    f"{len(part.violated)} iterations, which should not be; please report it"
                )
    return Findings(warnings=tuple(found))
