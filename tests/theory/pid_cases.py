"""Experiments with law pid, each with its linear learning written down a second time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.pid import PidLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import matrix_of
from tests.theory.cases import WRONG, Case
from tests.theory.linear_pid import LinearPid


@dataclass(frozen=True)
class PidCase:
    """What a controller does, in numbers."""

    kp: float = 0.0
    ki: float = 0.0
    kd: float = 0.0
    forgetting: float = 0.0
    cutoff: float | None = None
    rectifying: int | None = None
    plant: Case = field(default_factory=lambda: Case(0.0))

    def law(self) -> PidLaw:
        return PidLaw(
            self.kp,
            self.ki,
            self.kd,
            self.forgetting,
            matrix_of(self.plant.matrix, self.plant.model),
            "measured",
            self.cutoff,
            self.rectifying,
        )

    def experiment(
        self, reference: Reference, initial_input: tuple[Floats, Floats] | None = None
    ) -> Experiment:
        return replace(self.plant.experiment(reference, initial_input), law=self.law())

    def linear(self, reference: Reference) -> LinearPid:
        return LinearPid(
            self.plant.linear(reference),
            self.kp,
            self.ki,
            self.kd,
            self.forgetting,
            self.cutoff,
            self.rectifying,
        )


OFFSET = (0.02, -0.03, 0.01)
REP103 = Case(0.0, robot=Robot(0.03, 0.08, "rep103"), model=Robot(0.035, 0.07, "rep103"))
PID_CASES: dict[str, PidCase] = {
    "p": PidCase(kp=2.0),
    "d": PidCase(kd=0.6),
    "pid-forgetting": PidCase(1.0, 0.7, 0.4, 0.1, plant=Case(0.0, model=WRONG)),
    "rectifying": PidCase(kd=0.8, kp=0.3, rectifying=25, plant=Case(0.0, offset=OFFSET)),
    "filtered": PidCase(1.0, 0.2, 0.5, cutoff=6.0, plant=REP103),
    "all": PidCase(
        *(0.5, 0.5, 0.3, 0.2, 9.0, 20),
        Case(0.0, matrix="contradicting", offset=OFFSET, learn_in_first=True),
    ),
}
