"""Small sweeps, and one case of which kills the worker that computes it."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Mapping
from pathlib import Path

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.variation import Value
from hilc_cli.workers import worker
from tests.cli.inputs import SCENARIO, TRAJECTORY


def small_plan(folder: Path, cases: int = 64, *, bands: bool = True) -> Plan:
    """A sweep of a few samples and iterations."""
    (folder / "scenario.yaml").write_text(SCENARIO)
    (folder / "path.yaml").write_text(TRAJECTORY)
    scenario = hilc.load_scenario(folder / "scenario.yaml")
    vary = [f"controller.gains.l1=0.01:{cases / 100}:{cases}"]
    return plan_sweep(scenario, vary, bands=bands, tolerance=0.1)


class DeadlyPlan(Plan):
    """Case 30 of gains 0.01, 0.02 ... kills."""

    def experiment(self, values: Mapping[str, Value]) -> Experiment:
        gain = values["controller.gains.l1"]
        spec = sys.modules["__main__"].__spec__
        is_worker = spec is not None and spec.name == worker.__name__
        if is_worker and isinstance(gain, float) and round(gain, 4) == 0.31:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().experiment(values)


def deadly(plan: Plan) -> Plan:
    """The sweep, but deadly."""
    return DeadlyPlan(plan.scenario, plan.spec, plan.trajectories)
