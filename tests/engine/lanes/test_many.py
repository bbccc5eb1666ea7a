"""Experiments in lanes and others at once: each gets what it gets alone."""

from __future__ import annotations

import numpy as np

from hilc_cli.engine.lanes.batch import NEVER, simulate_batch, simulate_many
from hilc_cli.engine.lanes.kinds import knows
from hilc_cli.results.metrics import METRICS
from hilc_cli.runs.running import load_scenario, run

PID = {"law": "pid", "gains": {"kp": 0.5, "kd": 0.2}, "b_w": 180}
RUNAWAY = {"law": "pid", "gains": {"kp": 1e12, "kd": 1e9}}
BELIEVED = {"model.motor.delay": 0.01}
SCENARIOS = [
    load_scenario("example:fig6a", {"iterations": 3}),
    load_scenario("example:fig6a", {"iterations": 2, "controller": {**PID, "safety_net": True}}),
    load_scenario(
        "example:fig6a", {"iterations": 0, "controller": {"law": "feedback"}, **BELIEVED}
    ),
    load_scenario("example:fig6a", {"iterations": 30, "controller": RUNAWAY, **BELIEVED}),
    load_scenario("example:fig6b", {"iterations": 1}),
]


def test_safety_nets_and_believed_motors_are_left_to_the_loop_engine() -> None:
    experiments = [scenario.experiment() for scenario in SCENARIOS]
    assert [knows(experiment) for experiment in experiments] == [True, False, False, False, True]
    assert [scenario.spec.in_lanes for scenario in SCENARIOS] == [True, False, False, False, True]


def test_each_experiment_gets_what_it_gets_alone() -> None:
    result = simulate_many([scenario.experiment() for scenario in SCENARIOS])
    for case, scenario in enumerate(SCENARIOS):
        if case in (0, 4):
            alone = simulate_batch([scenario.experiment()])
            np.testing.assert_array_equal(result.final[case], alone.final[0])
            count = scenario.spec.iterations + 1
            np.testing.assert_array_equal(result.errors[case, :count], alone.errors[0])
        else:
            found = run(scenario)
            count = len(found.metrics)
            row = found.metrics.row(-1)
            assert result.final[case].tolist() == [row[name] for name in METRICS]
            errors = found.metrics["max_position_error_m"]
            np.testing.assert_array_equal(result.errors[case, :count], errors)
            never = NEVER if found.diverged_at is None else found.diverged_at
            assert result.diverged_at[case] == never
        assert np.isnan(result.errors[case, count:]).all()
    assert (result.diverged_at != NEVER).tolist() == [False, False, False, True, False]


def test_divergence_in_the_first_iteration_leaves_no_metrics() -> None:
    wild = {"law": "feedback", "gains": {"k_x": 1e12, "k_y": 1e9}}
    changes = {"iterations": 2, "controller": wild, "initial_pose.x": 0}
    result = simulate_many([load_scenario("example:fig6a", changes).experiment()])
    assert result.diverged_at.tolist() == [0]
    assert np.isnan(result.final).all() and np.isnan(result.errors).all()
