"""Small sweeps, and what they must give."""

from __future__ import annotations

from pathlib import Path

import hilc_cli as hilc
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.sweeping import plan_sweep
from tests.cli.inputs import SCENARIO, TRAJECTORY


def small_plan(folder: Path, cases: int = 64, *, bands: bool = True) -> Plan:
    """A sweep of a few samples and iterations."""
    (folder / "scenario.yaml").write_text(SCENARIO)
    (folder / "path.yaml").write_text(TRAJECTORY)
    scenario = hilc.load_scenario(folder / "scenario.yaml")
    vary = [f"controller.gains.l1=0.01:{cases / 100}:{cases}"]
    return plan_sweep(scenario, vary, bands=bands, tolerance=0.1)
