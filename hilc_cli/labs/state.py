"""What a lab knows: it follows from the scenario and the trials alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from hilc_cli.engine.robot_learning import RobotLearning, without_lead_in
from hilc_cli.labs.trials import LabTrial
from hilc_cli.laws.law import Plan
from hilc_cli.results.learning import TRUE, LearningTable
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.experiment import Scenario, settings_of, yardsticks_of


@dataclass(frozen=True, eq=False)
class LabState:
    """A scenario and the trials of it so far.

    Attributes:
        scenario: What is to be learned, and how.
        trials: In order.
    """

    scenario: Scenario
    trials: tuple[LabTrial, ...] = ()

    def after(self, trial: LabTrial) -> LabState:
        """Returns the state with one more trial."""
        return replace(self, trials=(*self.trials, trial))

    @property
    def before(self) -> LabState:
        """The state without the last trial."""
        return replace(self, trials=self.trials[:-1])

    @property
    def learning(self) -> RobotLearning:
        """The law at work, all trials taken in."""
        return self._learned[0]

    @property
    def plan(self) -> Plan:
        """What to send next, from the lead-in on, within all limits."""
        return self.learning.plan()

    @property
    def run(self) -> RunData:
        """The trials as the iterations of a run."""
        return self._learned[1]

    @cached_property
    def _learned(self) -> tuple[RobotLearning, RunData]:
        scenario = self.scenario
        learning = scenario.robot_learning()
        reference, limit = scenario.spec.reference, scenario.spec.safety_limits.wheel_speed
        metrics, table = MetricsTable(), LearningTable()
        trials: dict[int, Trial] = {}
        warnings: list[str] = []
        before: Trial | None = None
        for number, each in enumerate(self.trials):
            whole = each.trial(number, limit)
            table.append(learning.learn(whole, each.planned))
            trials[number] = trial = without_lead_in(whole, learning.lead_in)
            metrics.append(measure(trial, reference, before))
            before = trial
            if learning.returned_to is not None:
                warnings.append(
                    f"trial {number} and those before it were clearly worse than trial "
                    f"{learning.returned_to}: its plan comes next again, then smaller steps"
                )
        robot = scenario.spec.robot.robot()
        data = RunData(
            name=scenario.name,
            reference=reference,
            metrics=metrics,
            trials=trials,
            speed_limit=limit,
            gravity_center=robot.gravity_center,
            learning=table,
            settings=settings_of(scenario),
            yardsticks=_known(scenario),
            warnings=tuple(warnings),
            plan=learning.plan().shortest,
            robot=robot,
        )
        return learning, data


def _known(scenario: Scenario) -> dict[str, dict[str, float]]:
    """Values to hold what is learned against: of a real robot nobody knows what is true."""
    known = {
        column: {name: value for name, value in named.items() if name != TRUE}
        for column, named in yardsticks_of(scenario).items()
    }
    return {column: named for column, named in known.items() if named}
