"""A sweep one case of which kills whoever computes it."""

from __future__ import annotations

import os
import signal
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from hilc_cli.engine.experiment import Experiment
from hilc_cli.spec.varied import Varied
from hilc_cli.sweeping.plan import Plan
from hilc_cli.variation.axes import Value


class DeadlyVaried(Varied):
    """Case 30 of gains 0.01, 0.02 ... kills."""

    def __reduce__(self) -> tuple[Any, ...]:
        return DeadlyVaried, super().__reduce__()[1]

    def experiment(self, values: Mapping[str, Value]) -> Experiment:
        gain = values["controller.gains.l1"]
        if isinstance(gain, float) and round(gain, 4) == 0.31:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().experiment(values)


def deadly(plan: Plan) -> Plan:
    """The sweep, but deadly."""
    varied = plan.varied
    return replace(plan, varied=DeadlyVaried(varied.scenario, varied.axes, varied.trajectories))
