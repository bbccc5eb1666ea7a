"""Metrics of each iteration in lanes, those with and without disturbances side by side."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hilc_cli.engine.lanes.batch import measure_batch
from hilc_cli.engine.lanes.kinds import Kind, joined, kinds_of, member
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.engine.lanes.noise import NONE, NORMAL, UNIFORM
from hilc_cli.results.metrics import FASTEST_WHEEL, MAX_ERROR, METRICS
from hilc_cli.runs.running import load_scenario
from tests.engine.lanes.random_experiments import assert_agree, by_loop

NOISES: dict[str, dict[str, Any]] = {
    "uniform": {"bound": [1e-3] * 3},
    "truncated-normal": {
        "bound": [1e-3] * 3,
        "distribution": "truncated-normal",
        "standard_deviation": [4e-4] * 3,
    },
}


def case(number: int, noise: dict[str, Any] | None) -> dict[str, object]:
    """Changes of a scenario, other ones for each number."""
    disturbed = {} if noise is None else {"seed": number, "state": noise, "output": noise}
    gains: dict[str, object] = {"l1": 0.3 + 0.02 * number, "l2": 1.0 if number % 3 else 0.0}
    if number % 5 == 1:
        gains["lateral"] = 0.2
    if number % 5 == 2:
        gains["derivative"] = 0.02
    return {
        "iterations": number % 4,
        "disturbance": disturbed,
        "controller": {"law": "hybrid", "gains": gains, "compensation": "off", "b_w": 180},
    }


@pytest.mark.parametrize("noise", list(NOISES))
def test_each_iteration_is_what_the_loop_engine_makes_of_it(noise: str) -> None:
    """In more lanes than one pack has, on trajectories of their own."""
    names = ["fig6a", "fig6c"]
    experiments = [
        load_scenario(
            f"example:{names[number % 2]}", case(number, NOISES[noise] if number % 3 else None)
        ).experiment()
        for number in range(LANES + 5)
    ]
    members = [member(experiment) for experiment in experiments]
    kinds = joined(list(kinds_of(members, own_references=True)))
    assert len(set(kinds)) == 1
    drawn = UNIFORM if noise == "uniform" else NORMAL
    assert (kinds[0].state, kinds[0].output, kinds[0].pose) == (drawn, drawn, NONE)
    found = measure_batch(members, kinds[0], list(METRICS))
    for experiment, (rows, diverged_at) in zip(experiments, found, strict=True):
        expected = by_loop(experiment)
        assert diverged_at is None
        assert rows.shape == (experiment.iterations + 1, len(METRICS))
        assert_agree(rows, np.stack([expected[name] for name in METRICS], axis=1))


def test_iterations_end_where_numbers_do() -> None:
    wild = {"law": "hybrid", "gains": {"l1": 1e12}, "compensation": "off"}
    tame = {**wild, "gains": {"l1": 0.5}}
    wilds = load_scenario("example:fig6c", {"iterations": 30, "controller": wild})
    tames = load_scenario("example:fig6c", {"iterations": 30, "controller": tame})
    members = [member(scenario.experiment()) for scenario in (wilds, tames)]
    (lost, diverged_at), (whole, never) = measure_batch(
        members, Kind.of(members[0]), [MAX_ERROR, FASTEST_WHEEL]
    )
    assert diverged_at is not None and 0 < diverged_at < 30
    assert lost.shape == (diverged_at, 2) and np.isfinite(lost).all()
    assert never is None and whole.shape == (31, 2)
    assert_agree(whole[:, 0], by_loop(tames.experiment())[MAX_ERROR])


def test_kinds_join_only_what_can_run_them() -> None:
    plain, other = Kind(), Kind(compensation=True)
    drawn, normal = Kind(state=UNIFORM), Kind(state=NORMAL, pose=NORMAL)
    assert joined([plain, other, drawn, normal]) == [drawn, other, drawn, normal]
    assert joined([plain, other]) == [plain, other]
    assert joined([normal, plain, drawn]) == [normal, normal, drawn]
    aside, rate = Kind(lateral=True, full_matrix=True), Kind(derivative=True, output=NORMAL)
    both = Kind(derivative=True, lateral=True, full_matrix=True, output=NORMAL)
    assert joined([aside, other, rate]) == [both, other, both]
