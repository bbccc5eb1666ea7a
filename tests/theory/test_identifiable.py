"""What a pass tells of a robot: closed forms of plain paths, and what passes really tell."""

from __future__ import annotations

import math

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.identifiable import MOVED, READ_POSITION, Identifiable

ROBOT = {"wheel_radius": 0.05, "half_track": 0.1, "turn_convention": "ros"}
LINE = {"line": {"length": 2, "speed": 0.4}}
ARC = {"arc": {"radius": 0.5, "turn": "left", "sweep": "pi", "speed": 0.4}}
BEND = {"arc": {"radius": 0.4, "turn": "right", "sweep": "pi", "speed": 0.2}}


def experiment(*segments: object, **changes: object) -> Experiment:
    data: dict[str, object] = {
        "name": "any",
        "trajectory": {
            "name": "any",
            "sample_time": 0.05,
            "start": {"x": 0, "y": 0, "heading": 0},
            "segments": list(segments),
        },
        "robot": ROBOT,
        "iterations": 1,
        "initial_input": "feedforward",
        "controller": {"law": "norm-optimal"},
        **changes,
    }
    return hilc.load_scenario(data).experiment()


def test_a_straight_line_tells_no_half_track() -> None:
    (_, told), (_, hidden), (_, alike) = Identifiable(experiment(LINE)).rows
    # Of one speed friction takes as much as a smaller wheel, and delay shows as lag does.
    assert hidden == "half track, friction"
    assert "delay and lag" in told
    assert alike == "wheel radius and friction, delay and lag"


def test_bends_of_two_speeds_tell_more_than_a_line() -> None:
    line, bends = (
        Identifiable(experiment(*path)).of_a_pass.errors for path in ([LINE], [LINE, ARC, BEND])
    )
    assert math.isnan(line[1])
    assert bends[1] < 0.05
    assert bends[0] < 0.5 * line[0]
    assert bends[4] < line[4]


def test_standard_error_of_the_veer_on_a_line_is_that_of_a_random_walk() -> None:
    # Headings tell the ratio of the radii: (v / 2B) ratio in each sample beside a random walk, of
    # which a reading of each of n poses is worth its last one, and that of the start as well.
    quiet = Identifiable(
        experiment(
            LINE,
            disturbance={
                "output": {"bound": [1e-6, 1e-6, 1e-6]},
                "state": {"bound": [1e-3, 1e-3, 1e-3]},
            },
        )
    )
    walk = 1e-3 / math.sqrt(3)  # a uniform draw, each sample
    samples, way = 100, 0.02
    turned = way / (2 * ROBOT["half_track"]) * math.sqrt(samples) / walk  # type: ignore[operator]
    # The heading's prior belief in the radii is far wider, but counts.
    expected = 1 / math.sqrt(turned**2 + 0.05**-2)
    assert quiet.of_a_pass.errors[3] == pytest.approx(expected, rel=0.02)


def test_noise_is_the_scenarios_own_where_it_has_any() -> None:
    usual = Identifiable(experiment(LINE)).noise
    assert math.sqrt(usual.position) == pytest.approx(READ_POSITION)
    # 2 m in 100 samples; friction and slip add up as their root.
    assert math.sqrt(100 * usual.ahead) == pytest.approx(MOVED * math.sqrt(2), rel=1e-6)
    noisy = experiment(LINE, disturbance={"output": {"bound": [0.03, 0.03, 0.06]}})
    own = Identifiable(noisy).noise
    assert math.sqrt(own.position) == pytest.approx(0.03 / math.sqrt(3))
    assert math.sqrt(own.heading) == pytest.approx(0.06 / math.sqrt(3))
    assert own.ahead == usual.ahead


def test_errors_are_those_that_runs_make() -> None:
    names = "model_wheel_radius_m", "model_half_track_m"
    disturbance = {
        "output": {"bound": [4e-3, 4e-3, 8e-3]},
        "state": {"bound": [3e-4, 3e-4, 1e-3]},
    }
    made = []
    for seed in range(12):
        noisy = {"seed": seed, **disturbance}
        data = {
            "name": "noisy",
            "trajectory": {
                "name": "bends",
                "sample_time": 0.05,
                "start": {"x": 0, "y": 0, "heading": 0},
                "segments": [LINE, ARC, BEND],
            },
            "robot": ROBOT,
            "iterations": 0,
            "initial_input": "feedforward",
            "controller": {"law": "norm-optimal"},
            "disturbance": noisy,
        }
        run = hilc.run(data)
        assert run.learning is not None
        made.append([run.learning[name][-1] for name in names])
    off = np.array(made) / [ROBOT["wheel_radius"], ROBOT["half_track"]] - 1
    foretold = Identifiable(
        experiment(LINE, ARC, BEND, disturbance={"seed": 1, **disturbance})
    ).of_a_pass.errors[:2]
    spread = np.sqrt(np.square(off).mean(axis=0))
    assert (spread < 2 * foretold).all()
    assert (spread > foretold / 3).all()
