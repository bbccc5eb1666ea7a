"""What can be said of a scenario without simulating it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from hilc_cli.analysis.advice import advice
from hilc_cli.analysis.bounds import Bounds
from hilc_cli.analysis.conditions import Conditions, conditions
from hilc_cli.analysis.feasibility import Feasibility
from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.forecast import Forecast, forecast, forecast_findings, rest_error
from hilc_cli.analysis.measured import Comparison
from hilc_cli.analysis.measured import compare as beside
from hilc_cli.analysis.remedies import feasibility_findings
from hilc_cli.analysis.theories import CORRECTED, WITHIN_LIMIT, theories
from hilc_cli.api.running import OnIteration, RunData, Summary, measured_trials
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import DivergedError
from hilc_cli.files import merge_folder
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.results.metrics import MetricsTable
from hilc_cli.results.summary import summarise
from hilc_cli.results.transient_table import TRANSIENT_FILE, write_transient
from hilc_cli.results.trial import Trial
from hilc_cli.spec.hybrid import HybridController
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


@dataclass(frozen=True, slots=True, eq=False)
class Check:
    """What a check of a scenario has found.

    Attributes:
        scenario: What was checked.
        feasibility: What its trajectory demands of wheels and tyres, beside what they can do.
        forecast: What learning is expected to do; None for another law than the hybrid law.
        rest_error_m: Largest position error where learning rests, after the start or, with a
            compensation, after sample h; None if it rests at no finite motion.
        conditions: Those of the paper's theorems; None for another law.
        theories: Bounds of the paper's theory, by name; None for another law.
        simulated: A simulation, if one was asked for and an iteration of it was completed.
        findings: Failures and warnings of each part of the check: ``settings``, ``feasibility``,
            ``learning``, ``simulation``, ``theory``.
    """

    scenario: Scenario
    feasibility: Feasibility
    forecast: Forecast | None
    rest_error_m: float | None
    conditions: Conditions | None
    theories: Mapping[str, Bounds] | None
    simulated: Simulated | None
    findings: Mapping[str, Findings]

    @property
    def failures(self) -> tuple[str, ...]:
        """Why the scenario cannot work, each with its remedy; empty if nothing is wrong."""
        return tuple(text for part in self.findings.values() for text in part.failures)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is legal but unwise."""
        return tuple(text for part in self.findings.values() for text in part.warnings)

    def plot(
        self,
        folder: str | Path,
        *,
        formats: Sequence[str] = ("png",),
        may_replace: Callable[[Path], bool] = lambda file: False,
    ) -> list[Path]:
        """Draws the predicted error over the iterations, beside the simulated one if there is one.

        The same errors go into transient.csv.

        Args:
            folder: Where to put transient.FORMAT and transient.csv; made if it is not there.
            formats: png, svg, pdf.
            may_replace: Whether a file of that name that stands there may be replaced.

        Returns:
            The pictures, and the table last; none if nothing is predicted of the law.

        Raises:
            UsageError: There is no such format.
            ExistingResultsError: A file stands there that may not be replaced.
            FileAccessError: They cannot be written.
        """
        from hilc_cli.figures.save import save_figure  # Matplotlib starts slowly
        from hilc_cli.figures.transient import transient_figure

        expected = self.forecast
        if expected is None:
            return []
        rest = expected.rest if expected.settles else None
        figure = transient_figure(
            self.scenario.name,
            expected.transient,
            self.scenario.spec.iterations,
            None if self.simulated is None else self.simulated.run,
            rest.max_position_error_m if rest is not None and rest.is_finite else None,
            _law_text(self.scenario),
        )
        pictures = [f"transient.{name}" for name in dict.fromkeys(formats)]
        names = [*pictures, TRANSIENT_FILE]

        def draw(into: Path) -> None:
            for name in pictures:
                save_figure(figure, into / name)
            write_transient(
                into / TRANSIENT_FILE,
                expected.transient.max_position_error_m,
                None
                if self.simulated is None
                else self.simulated.run.metrics["max_position_error_m"],
            )

        merge_folder(Path(folder), draw, may_replace)
        return [Path(folder) / name for name in names]


def _law_text(scenario: Scenario) -> str:
    """The law and its gains in a few words."""
    controller = scenario.spec.controller
    assert isinstance(controller, HybridController)  # nothing is predicted of another one
    gains = controller.gains
    equation = "Eq. 21" if scenario.compensates else "Eq. 17"
    lateral = f", lateral {gains.lateral:g} rad/m" if gains.lateral else ""
    return f"{equation}, l1 {gains.l1:g}, l2 {gains.l2:g}, l3 {gains.l3:g}{lateral}"


def check(
    scenario: Scenario, *, simulate: bool = False, on_iteration: OnIteration | None = None
) -> Check:
    """Checks a scenario.

    Args:
        scenario: From `load_scenario`.
        simulate: Run it as well, and put what it does beside what theory says.
        on_iteration: Told of each completed iteration of that run.
    """
    experiment = scenario.experiment()
    # Where numbers leave the range of floating point, they end as infinite: above any limit.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        feasibility = scenario.feasibility()
        findings = {
            "settings": Findings(warnings=(*scenario.warnings(), *advice(experiment))),
            "feasibility": feasibility_findings(feasibility),
        }
        expected, rest, premises, bounds = None, None, None, None
        if isinstance(experiment.law, HybridLaw):
            expected = forecast(experiment)
            if expected.rest is not None and expected.rest.is_finite:
                rest = rest_error(experiment, expected.rest)
            premises, bounds = conditions(experiment), theories(experiment)
            findings["learning"] = forecast_findings(experiment, expected)
        simulated = None
        if simulate:
            findings["simulation"], simulated = _simulated(
                scenario, experiment, bounds or {}, on_iteration
            )
        findings["theory"] = _theory_findings(simulated)
    return Check(scenario, feasibility, expected, rest, premises, bounds, simulated, findings)


def _simulated(
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


def _theory_findings(simulated: Simulated | None) -> Findings:
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
