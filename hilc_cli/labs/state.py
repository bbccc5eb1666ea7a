"""What a lab knows: it follows from the scenario and the trials alone."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

from hilc_cli.engine.robot_learning import RobotLearning, without_lead_in
from hilc_cli.labs.trials import LabTrial
from hilc_cli.laws.law import Figures, Plan
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.learning import TRUE, LearningTable
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.experiment import Scenario, settings_of
from hilc_cli.scenario.yardsticks import yardsticks_of
from hilc_cli.wording import counted, in_short

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, slots=True, eq=False)
class _Learned:
    """What follows from trials.

    Attributes:
        learning: The law at work, all of them taken in.
        figures: What the law has to tell of each.
        warnings: What happened to learning.
    """

    learning: RobotLearning
    figures: tuple[Figures, ...] = ()
    warnings: tuple[str, ...] = ()

    def after(self, trial: Trial, planned: Plan) -> _Learned:
        """Returns what follows with one more trial; this stays as it is."""
        learning = deepcopy(self.learning)
        figures = (*self.figures, learning.learn(trial, planned))
        if learning.returned_to is None:
            return _Learned(learning, figures, self.warnings)
        told = (
            f"trial {trial.iteration} and those before it were clearly worse than trial "
            f"{learning.returned_to}: its plan comes next again, then smaller steps"
        )
        return _Learned(learning, figures, (*self.warnings, told))


@dataclass(frozen=True, eq=False, repr=False)
class LabState(InNotebooks):
    """A scenario and the trials of it so far.

    Attributes:
        scenario: What is to be learned, and how.
        trials: In order.
        before: The state without the last trial, if that is known.
    """

    scenario: Scenario
    trials: tuple[LabTrial, ...] = ()
    before: LabState | None = None

    def __repr__(self) -> str:
        trials = counted(len(self.trials), "trial")
        return in_short(f"LabState: {self.scenario.name}, {trials}")

    def after(self, trial: LabTrial) -> LabState:
        """Returns the state with one more trial."""
        return LabState(self.scenario, (*self.trials, trial), replace(self, before=None))

    @property
    def without_last(self) -> LabState:
        """The state without the last trial."""
        return self.before or LabState(self.scenario, self.trials[:-1])

    @property
    def learning(self) -> RobotLearning:
        """The law at work, all trials taken in."""
        return self._learned.learning

    @property
    def plan(self) -> Plan:
        """What to send next, from the lead-in on, within all limits."""
        return self.learning.plan()

    @cached_property
    def _learned(self) -> _Learned:
        first = 0 if self.before is None else len(self.before.trials)
        known = (
            _Learned(self.scenario.robot_learning())
            if self.before is None
            else self.before._learned
        )
        for number in range(first, len(self.trials)):
            each = self.trials[number]
            known = known.after(each.trial(number, self._speed_limit), each.planned)
        return known

    @property
    def _speed_limit(self) -> float:
        return self.scenario.spec.safety_limits.wheel_speed

    def to_pandas(self, table: str = "iterations") -> DataFrame:
        """A table as a data frame of pandas, with the columns of its CSV file.

        Args:
            table: Of those that a run has; a row of iterations is a trial.

        Raises:
            UnknownNameError: There is no such table of this lab; names those that there are.
            MissingPackageError: pandas is not installed.
        """
        return self.run.to_pandas(table)

    @cached_property
    def run(self) -> RunData:
        """The trials as the iterations of a run."""
        scenario, learned = self.scenario, self._learned
        learning, reference = learned.learning, scenario.spec.reference
        metrics, table = MetricsTable(), LearningTable()
        trials: dict[int, Trial] = {}
        before: Trial | None = None
        for number, each in enumerate(self.trials):
            table.append(learned.figures[number])
            trial = without_lead_in(each.trial(number, self._speed_limit), learning.lead_in)
            metrics.append(measure(trial, reference, before))
            trials[number] = before = trial
        robot = scenario.spec.robot.robot()
        return RunData(
            name=scenario.name,
            reference=reference,
            metrics=metrics,
            trials=trials,
            speed_limit=self._speed_limit,
            gravity_center=robot.gravity_center,
            learning=table,
            settings=settings_of(scenario),
            yardsticks=_known(scenario),
            warnings=learned.warnings,
            plan=learning.plan().shortest,
            robot=robot,
        )


def _known(scenario: Scenario) -> dict[str, dict[str, float]]:
    """Values to hold what is learned against: of a real robot nobody knows what is true."""
    known = {
        column: {name: value for name, value in named.items() if name != TRUE}
        for column, named in yardsticks_of(scenario).items()
    }
    return {column: named for column, named in known.items() if named}
