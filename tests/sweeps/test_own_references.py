"""Sweeps over trajectories: which share lanes, and that nobody sees who computed them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.results.metrics import METRICS
from hilc_cli.sweeps.chunks import Chunk
from hilc_cli.sweeps.compute import run_chunk
from hilc_cli.sweeps.plan import Plan
from tests.conftest import Write

DURATION, GAIN = "trajectory.segments.0.line.duration", "controller.gains.l1"


def planned(*vary: str, **options: object) -> Plan:
    scenario = hilc_api.load_scenario("scenario.yaml", {"iterations": 3})
    return hilc_api.plan_sweep(scenario, list(vary), **options)  # type: ignore[arg-type]


def test_cases_next_to_each_other_decide_which_lanes_there_are(write: Write) -> None:
    write()
    gains, durations = f"{GAIN}=0.1:0.9", f"{DURATION}=0.5:1.5"
    assert not planned(f"{gains}:50").own_references
    # Lanes are full of one trajectory after the other, or hold one each.
    assert not planned(f"{durations}:3", f"{gains}:48").own_references
    assert planned(f"{durations}:3", f"{gains}:26").own_references
    assert planned(f"{gains}:48", f"{durations}:3").own_references
    assert planned(f"{durations}:30").own_references
    assert planned(durations, gains, sample="random", cases=100).own_references


def test_chunks_and_workers_do_not_change_the_numbers(write: Write) -> None:
    write()
    plan = planned(f"{DURATION}=0.5:1.5:13", f"{GAIN}=0.5,0.9")
    whole = run_chunk(plan, Chunk(0, 26))
    parts = [run_chunk(plan, Chunk(*pair)) for pair in itertools.pairwise([0, 1, 5, 24, 26])]
    assert np.concatenate([part.rows for part in parts]).tobytes() == whole.rows.tobytes()
    by_two = hilc_api.sweep(plan, hilc_api.Execution(workers=2))
    for name, column in zip(METRICS, whole.rows.T, strict=False):
        assert by_two.columns[name].tobytes() == column.tobytes()
    for case in (0, 13, 25):
        run = hilc_api.run(plan.case(plan.cases.values(case, case + 1)[0]))
        expected = [run.metrics.row(-1)[name] for name in METRICS]
        assert whole.rows[case, : len(METRICS)] == pytest.approx(expected, rel=1e-9, abs=1e-12)
