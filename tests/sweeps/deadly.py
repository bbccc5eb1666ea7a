"""A sweep one case of which kills the worker that computes it."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from hilc_cli.engine.experiment import Experiment
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.varied import Varied
from hilc_cli.variation.axes import Value
from hilc_cli.workers import worker


class DeadlyVaried(Varied):
    """Case 30 of gains 0.01, 0.02 ... kills."""

    def __reduce__(self) -> tuple[Any, ...]:
        return DeadlyVaried, super().__reduce__()[1]

    def experiment(self, values: Mapping[str, Value]) -> Experiment:
        gain = values["controller.gains.l1"]
        spec = sys.modules["__main__"].__spec__
        is_worker = spec is not None and spec.name == worker.__name__
        if is_worker and isinstance(gain, float) and round(gain, 4) == 0.31:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().experiment(values)


def deadly(plan: Plan) -> Plan:
    """The sweep, but deadly."""
    varied = plan.varied
    return replace(plan, varied=DeadlyVaried(varied.scenario, varied.axes, varied.trajectories))
