"""What the law tells of its iterations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.norm_optimal.law import MERGE_TIME, NormOptimalLaw, figures_told
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, build_reference
from tests.engine.experiments import experiment_of, law_of
from tests.laws.norm_optimal.plant import noise

BELIEF = Robot(0.14, 0.67)
ARC = build_reference(
    "arc", (0.0, 0.0, 0.0), [ArcPlan(2.0, "left", radius=3.0, duration=1.0)], 0.01
)
OFF = (0.05, -0.05, 0.0)


def learning(law: NormOptimalLaw, **changes: object) -> Experiment:
    experiment = experiment_of(ARC, law_of(0.0), iterations=2)
    return replace(experiment, law=law, speed_limit=180.0, **changes)  # type: ignore[arg-type]


def told(experiment: Experiment) -> dict[str, list[float]]:
    trials = list(simulate(experiment))
    return {name: [trial.figures[name] for trial in trials] for name in trials[0].figures}


def test_iteration_at_rest_tells_what_is_believed_and_nothing_else() -> None:
    figures = told(learning(NormOptimalLaw(BELIEF, h=30), initial_pose=OFF))
    assert tuple(figures) == figures_told(identify=True)
    at_first = {name: values[0] for name, values in figures.items()}
    believed = {
        "model_wheel_radius_m": 0.14,
        "model_half_track_m": 0.67,
        "model_wheel_radius_per_half_track": 0.14 / 0.67,
    }
    known = {name: value for name, value in at_first.items() if not math.isnan(value)}
    assert known == pytest.approx(believed, rel=1e-12)
    for name, value in (("wheel_radius", 0.2), ("half_track", 0.518)):
        for whose in ("", "model_"):
            assert figures[f"{whose}{name}_m"][1:] == pytest.approx([value, value], rel=1e-9)
            assert max(figures[f"{whose}{name}_standard_error_m"][1:]) < 1e-9
    # By sample h, once the model is right; a small error is within a millimetre well before.
    assert 0 < figures[MERGE_TIME][2] <= 0.3


def test_model_is_the_mean_of_all_iterations_by_their_standard_errors() -> None:
    noises = noise((5e-3, 5e-3, 5e-3)), noise((2e-2, 2e-2, 2e-2))
    experiment = learning(NormOptimalLaw(BELIEF), iterations=5, disturbance=Disturbance(1, *noises))
    figures = told(experiment)
    for name, believed in (("wheel_radius", 0.14), ("half_track", 0.67)):
        values = np.array(figures[f"{name}_m"])[1:]
        errors = np.array(figures[f"{name}_standard_error_m"])[1:]
        assert np.all(errors > 1e-3 * values)  # so that a wear of 1e-4 tells nothing
        weights = 1 / errors**2
        expected, sure = weights @ values / weights.sum(), 1 / math.sqrt(weights.sum())
        # B is the quotient of two means, which differs from the mean of quotients.
        near = 0.05 if name == "wheel_radius" else 0.5
        assert figures[f"model_{name}_m"][-1] == pytest.approx(expected, abs=near * sure)
        assert figures[f"model_{name}_standard_error_m"][-1] == pytest.approx(sure, rel=0.05)
        assert abs(figures[f"model_{name}_m"][-1] - believed) > 10 * sure


def test_nothing_is_told_of_what_is_not_identified() -> None:
    experiment = learning(NormOptimalLaw(BELIEF, identify=False, h=30), initial_pose=OFF)
    figures = told(experiment)
    assert tuple(figures) == figures_told(identify=False) == (MERGE_TIME, "search_settled")
    assert math.isnan(figures[MERGE_TIME][0])  # no plan of the law's was run


def test_plan_that_never_merges_has_an_infinite_merge_time() -> None:
    # The arc's faster wheel needs (6 + 0.518 * 2) / 0.2, 35 rad/s.
    experiment = replace(learning(NormOptimalLaw(BELIEF, h=30), initial_pose=OFF), speed_limit=20.0)
    assert told(experiment)[MERGE_TIME][1:] == [math.inf, math.inf]
