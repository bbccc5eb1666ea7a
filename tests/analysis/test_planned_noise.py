"""How noise moves the wheels of law norm-optimal, beside runs of the law."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.analysis.planned_noise import planned_noise
from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.norm_optimal.parameters import NormOptimalParameters
from hilc_cli.robot import Robot
from tests.analysis.test_tracking_response import LEFT, ROBOT, STRAIGHT, WRONG, experiment, path

BENDS = path((STRAIGHT, 120), (LEFT, 15), (STRAIGHT, 60))
NOISE = Disturbance(0, Bounded((3e-4, 3e-4, 5e-4)), Bounded((3e-3, 3e-3, 6e-3)))


@pytest.mark.parametrize(
    ("parameters", "believed", "limit", "off"),
    [
        (NormOptimalParameters(h=50), WRONG, 13.0, (0.0, 0.0, 0.0)),
        (NormOptimalParameters(h=50), ROBOT, 9.0, (0.0, 0.05, 0.1)),
        (NormOptimalParameters(h=50, identify=False), WRONG, 11.0, None),
    ],
)
def test_noise_is_that_of_runs(
    parameters: NormOptimalParameters,
    believed: Robot,
    limit: float,
    off: tuple[float, float, float] | None,
) -> None:
    law = NormOptimalLaw(parameters, believed)
    made = experiment(BENDS, off=off or (0.0, 0.0, 0.0), limit=limit, disturbance=NOISE)
    made = replace(made, law=law, iterations=4)
    foretold = planned_noise(made, law)
    *_, quiet = simulate(replace(made, disturbance=Disturbance()))
    changes, held = [], []
    for seed in range(3):
        *_, trial = simulate(replace(made, disturbance=replace(NOISE, seed=seed)))
        changes.append(np.diff([trial.left - quiet.left, trial.right - quiet.right]))
        held.append(trial.saturated_samples / BENDS.samples)
    assert foretold is not None
    assert foretold.change_rad_s == pytest.approx(math.sqrt(np.square(changes).mean()), rel=0.1)
    assert foretold.at_limit == pytest.approx(np.mean(held), rel=0.2, abs=0.02)


def test_nothing_is_told_without_disturbances_or_feedback() -> None:
    law = NormOptimalLaw(NormOptimalParameters(h=50), ROBOT)
    made = replace(experiment(BENDS, disturbance=NOISE), law=law)
    assert planned_noise(replace(made, disturbance=Disturbance()), law) is None
    assert planned_noise(replace(made, learn_in_first=False), law) is None
    alone = NormOptimalLaw(NormOptimalParameters(h=50, feedback="none"), ROBOT)
    assert planned_noise(replace(made, law=alone), alone) is None
