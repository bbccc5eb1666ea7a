"""A simulation of what is checked, beside what theory says of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import MeasuredTrials
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import MetricsTable
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import Summary, summarise
from hilc_cli.results.trial import Trial
from hilc_cli.runs.running import OnIteration
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.theory.findings import RESOLUTION, ExpectedError, Findings, extent
from hilc_cli.theory.learning.outcome import CLEARLY, FAILED, NEAR, Outcome, seen_outcome
from hilc_cli.theory.proof.bounds import CORRECTED, WITHIN_LIMIT, Bounds
from hilc_cli.theory.proof.measured import Comparison, compare as beside


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """A simulation beside what theory says of it.

    Attributes:
        run: The run.
        extent_m: Beside which errors are large or small.
        unlearned_m: Largest position error of iteration 0 without disturbances; not-a-number if
            that is not known.
        comparisons: The bounds of each theory beside the run, by the theory's name; empty if the
            law is another one than the hybrid law.
    """

    run: RunData
    extent_m: float
    unlearned_m: float
    comparisons: Mapping[str, Comparison]

    @property
    def errors_m(self) -> Floats:
        """Largest position errors of the iterations [m]; infinite where the run diverged."""
        return self._to_the_end(self.run.metrics["max_position_error_m"])

    @property
    def telling_errors_m(self) -> Floats:
        """Errors by which the run is judged: from a wrong start, of the second half [m]."""
        return self._to_the_end(self.run.telling_errors_m)

    @property
    def outcome(self) -> Outcome:
        """What came of learning; an error of the whole path that has doubled is one in any case."""
        whole = seen_outcome(self.errors_m, self.extent_m, self.unlearned_m)
        if whole in FAILED:
            return whole
        return seen_outcome(self.telling_errors_m, self.extent_m, self.unlearned_m)

    def _to_the_end(self, errors: Floats) -> Floats:
        return errors if self.run.diverged_at is None else np.append(errors, np.inf)

    @property
    def summary(self) -> Summary:
        """The run in a few figures."""
        return summarise(self.run)


def simulated(
    scenario: Scenario,
    experiment: Experiment,
    bounds: Mapping[str, Bounds],
    expected: ExpectedError | None,
    on_iteration: OnIteration | None,
) -> tuple[Findings, Simulated | None]:
    """One run, of which each iteration is measured as it comes, and only the last is kept."""
    metrics = MetricsTable()
    measured = MeasuredTrials(experiment)

    def completed() -> Iterator[Trial]:
        for trial, row in measured:
            metrics.append(row)
            if on_iteration is not None:
                on_iteration(trial.iteration)
            yield trial

    trials = completed()
    first = next(trials, None)
    comparisons = {} if first is None else beside(experiment, bounds, chain([first], trials))
    diverged_at = measured.diverged_at
    findings = Findings()
    if diverged_at is not None:
        findings = Findings.failure(
            f"the simulation diverged to non-finite values in iteration {diverged_at}; "
            "lower the gains, or set controller.b_w"
        )
    if measured.last is None:
        return findings, None
    run = RunData(
        name=scenario.name,
        reference=experiment.reference,
        metrics=metrics,
        trials={measured.last.iteration: measured.last},
        speed_limit=scenario.speed_limit,
        gravity_center=experiment.robot.gravity_center,
        diverged_at=diverged_at,
        readings_off_m=max(experiment.disturbance.output.bound[:2]),
    )
    unlearned = math.nan if expected is None else expected.first_m
    return findings, Simulated(run, extent(experiment), unlearned, comparisons)


def decided(
    found: Findings, simulated: Simulated, expected: ExpectedError | None, *, learns: bool
) -> Findings:
    """Returns what theory has found of learning, where a simulation has the last word.

    Failures only where the simulation did not do better, and what theory did not foresee.
    """
    errors, outcome = simulated.telling_errors_m, simulated.outcome
    whole = simulated.errors_m
    if outcome is Outcome.MADE_WORSE and whole[-1] >= CLEARLY * whole[0]:
        errors = whole
    first, last, count = float(errors[0]), float(errors[-1]), len(errors) - 1
    of_half = "" if np.array_equal(errors, whole) else " of the second half"
    went = (
        f"the simulated error{of_half} goes from {first:.3g} m to {last:.3g} m in iteration {count}"
    )
    failures, warnings = found.failures, found.warnings
    if outcome is Outcome.MADE_WORSE:
        if learns and not failures and math.isfinite(last):
            failures = (f"{went}: learning makes it worse; lower the gains, or disturbances",)
    elif failures and last <= max(first / CLEARLY, NEAR * simulated.extent_m):
        warnings = (*(f"{text}; and yet {went}" for text in failures), *warnings)
        failures = ()
    elif learns and not failures and outcome is Outcome.DOES_NOT_LEARN:
        warnings = (f"{went}, which is not half of it within {count} iterations", *warnings)
    elif learns and outcome is Outcome.GROWS_WITHIN:
        best = int(errors.argmin())
        warnings = (f"{went}, and was {errors[best]:.3g} m in iteration {best}", *warnings)
    if expected is not None and expected.unsure is None and not failures:
        foretold = max(expected.foretold_m, RESOLUTION * simulated.extent_m)
        if whole[-1] > CLEARLY * foretold:
            warnings = (
                f"the simulated error of iteration {count} is {whole[-1]:.3g} m, where theory "
                f"expects {expected.foretold_m:.3g} m",
                *warnings,
            )
    return Findings(failures, warnings)


def theory_findings(simulated: Simulated) -> Findings:
    """Tells of bounds that are violated, which should not be: a defect of the theory's code."""
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
