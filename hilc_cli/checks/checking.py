"""What can be said of a scenario without simulating it, and a simulation beside that."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.checks.advice import advice
from hilc_cli.files import merge_folder
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.look import USUAL, Look
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import ScenarioSource, as_scenario
from hilc_cli.theory.feasibility.feasibility import Feasibility
from hilc_cli.theory.findings import ExpectedError, Findings
from hilc_cli.theory.identifiable import Identifiable
from hilc_cli.theory.lateness import Lateness
from hilc_cli.theory.law_theory import LawTheory, law_theory
from hilc_cli.theory.learning.forecast import Forecast
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.matrices import knows_plant
from hilc_cli.theory.noise import unsure_findings
from hilc_cli.theory.proof.proof import Proof
from hilc_cli.theory.reach import judged_feasibility, start_findings
from hilc_cli.wording import counted, wrapped

if TYPE_CHECKING:
    from pandas import DataFrame

    from hilc_cli.checks.simulating import Simulated
    from hilc_cli.runs.running import OnIteration
    from hilc_cli.theory.proof.bounds import Bounds
    from hilc_cli.theory.proof.constants import Conditions

_RANKS = {"feasibility": 1, "advice": 2}
"""Parts whose warnings come after those of learning, which are of this very scenario."""
_UNSURE = {
    Outcome.OUT_OF_RANGE: "unclear",
    Outcome.DOES_NOT_LEARN: "does not halve the error",
    Outcome.DROWNED: "does not learn",
}
"""What is expected of learning where that is neither that it works nor that it cannot."""
_MOST_TOLD = 4  # findings that a check shows of itself


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Check(InNotebooks):
    """What a check of a scenario has found.

    Attributes:
        scenario: What was checked.
        feasibility: What its trajectory demands of wheels and tyres, beside what they can do.
        law: What theory says of its law.
        lateness: What late wheels do to a pass, computed when it is asked for.
        identifiable: What a pass tells of the robot, likewise.
        proof: What the paper's theorems say, computed when it is asked for; None for a law of which
            they do not speak.
        simulated: A simulation, if one was asked for and an iteration of it was completed.
        findings: Failures and warnings of each part of the check: ``settings``, ``feasibility``,
            ``start``, ``lateness``, ``learning``, ``prediction``, ``simulation``, ``theory``,
            ``advice``.
    """

    scenario: Scenario
    feasibility: Feasibility
    law: LawTheory
    lateness: Lateness
    identifiable: Identifiable
    proof: Proof | None
    simulated: Simulated | None
    findings: Mapping[str, Findings]

    def __repr__(self) -> str:
        found = [*self.failures, *(f"warning: {warning}" for warning in self.warnings)]
        more = [f"and {len(found) - _MOST_TOLD} more"] if len(found) > _MOST_TOLD else []
        title = f"Check of {self.scenario.name!r}: {self.verdict}"
        return wrapped(title, *found[:_MOST_TOLD], *more)

    @property
    def verdict(self) -> str:
        """What has come out, in a few words."""
        warned = f", {counted(len(self.warnings), 'warning')}" if self.warnings else ""
        if self.failures:
            return f"cannot work, {counted(len(self.failures), 'error')}{warned}"
        if self.outcome in _UNSURE:
            return f"{_UNSURE[self.outcome]}{warned}"
        if not self.law.is_known and self.simulated is None:
            unknown = "law" if knows_plant(self.law.experiment) else "plant"
            return f"nothing wrong with the path, and the {unknown} is not known{warned}"
        return f"works{warned}" if warned else "nothing wrong"

    @property
    def conditions(self) -> Conditions | None:
        """Those of the paper's theorems; None for a law of which it does not speak."""
        return None if self.proof is None else self.proof.conditions

    @property
    def theories(self) -> Mapping[str, Bounds] | None:
        """Bounds of the paper's theory, by name; None likewise."""
        return None if self.proof is None else self.proof.theories

    @property
    def forecast(self) -> Forecast | None:
        """What learning is expected to do; None for a law of which that is not known."""
        return self.law.forecast

    @property
    def outcome(self) -> Outcome | None:
        """What comes of learning: as simulated, else as expected; None if that is not known."""
        if self.simulated is not None:
            return self.simulated.outcome if self.scenario.spec.controller.learns else None
        return self.law.outcome

    @property
    def expected(self) -> ExpectedError | None:
        """How large the error of the last iteration will be; None if theory does not tell."""
        return self.law.expected

    @property
    def failures(self) -> tuple[str, ...]:
        """Why the scenario cannot work, each with its remedy; empty if nothing is wrong."""
        return tuple(text for part in self.findings.values() for text in part.failures)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is legal but unwise, what matters most first."""
        ranked = sorted(self.findings, key=lambda part: _RANKS.get(part, 0))
        return tuple(text for part in ranked for text in self.findings[part].warnings)

    def to_pandas(self) -> DataFrame:
        """Errors by iteration as a data frame of pandas, with the columns of transient.csv.

        Raises:
            UsageError: No errors are predicted of the law.
            MissingPackageError: pandas is not installed.
        """
        from hilc_cli.checks.picture import errors_of  # Matplotlib starts slowly
        from hilc_cli.results.frames import frame

        return frame({"transient": lambda: errors_of(self)}, "transient")

    def plot(
        self,
        folder: str | Path,
        *,
        formats: Sequence[str] = ("png",),
        look: Look = USUAL,
        may_replace: Callable[[Path], bool] = lambda file: False,
    ) -> list[Path]:
        """Draws the predicted error over the iterations, beside the simulated one if there is one.

        The same errors go into transient.csv.

        Args:
            folder: Where to put transient.FORMAT and transient.csv; made if it is not there.
            formats: png, svg, pdf.
            look: How the picture is to look, from `picture_look`.
            may_replace: Whether a file of that name that stands there may be replaced.

        Returns:
            The pictures, and the table last; none if no errors are predicted of the law.

        Raises:
            UsageError: There is no such format.
            ExistingResultsError: A file stands there that may not be replaced.
            FileAccessError: They cannot be written.
        """
        from hilc_cli.checks.picture import (  # Matplotlib starts slowly
            TRANSIENT_FILE,
            figure_of,
            write_transient,
        )
        from hilc_cli.drawing.save import save_figure

        expected, figure = self.forecast, figure_of(self, look)
        if expected is None or figure is None:
            return []
        run = None if self.simulated is None else self.simulated.run
        pictures = [f"transient.{name}" for name in dict.fromkeys(formats)]
        names = [*pictures, TRANSIENT_FILE]

        def draw(into: Path) -> None:
            for name in pictures:
                save_figure(figure, into / name)
            write_transient(
                into / TRANSIENT_FILE,
                expected.transient.max_position_error_m,
                None if run is None else run.metrics["max_position_error_m"],
            )

        merge_folder(Path(folder), draw, may_replace)
        return [Path(folder) / name for name in names]


def check(
    scenario: ScenarioSource,
    *,
    simulate: bool = False,
    closely: bool = False,
    on_iteration: OnIteration | None = None,
) -> Check:
    """Checks a scenario.

    Args:
        scenario: From `load_scenario`, or what it takes: ``example:NAME``, a file, a dictionary.
        simulate: Run it as well, and put what it does beside what theory says.
        closely: Predict the error of each iteration at once; else that is done when it is asked
            for, and what is said of learning follows from less.
        on_iteration: Told of each completed iteration of that run.
    """
    scenario = as_scenario(scenario)
    experiment = scenario.experiment()
    lateness = Lateness(experiment)
    # Where numbers leave the range of floating point, they end as infinite: above any limit.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        feasibility = scenario.feasibility()
        theory = law_theory(experiment)
        if closely and theory.forecast is not None:
            _ = theory.forecast.transient
        findings = {
            "settings": Findings(warnings=tuple(scenario.warnings())),
            "feasibility": judged_feasibility(
                feasibility, experiment, scenario.setting.model, theory.expected
            ),
            "start": start_findings(theory),
            "lateness": lateness.findings,
            "learning": theory.findings,
        }
        is_paper = theory.linear is not None and theory.linear.paper is not None
        proof = Proof(experiment) if is_paper else None
        seen: Simulated | None = None
        if simulate:
            from hilc_cli.checks.simulating import decided, simulated, theory_findings

            bounds = {} if proof is None else proof.theories
            findings["simulation"], seen = simulated(
                scenario, experiment, bounds, theory.expected, on_iteration
            )
        if seen is None:
            findings["prediction"] = unsure_findings(experiment, theory.expected)
        else:
            learns = scenario.spec.controller.learns
            findings["learning"] = decided(theory.findings, seen, theory.expected, learns=learns)
            findings["theory"] = theory_findings(seen)
        findings["advice"] = Findings(warnings=tuple(advice(theory)))
    return Check(
        scenario,
        feasibility,
        theory,
        lateness,
        Identifiable(experiment),
        proof,
        seen,
        findings,
    )
