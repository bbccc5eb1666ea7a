"""What compensation leaves on a circle: the closed form against quadrature and the engine."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.paper.claims.initial_error import sideways_error_after_compensation
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import METRICS
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import Pose

SPEED, YAW_RATE, HEADING = 0.6, 1.5, 0.4  # [m/s], [rad/s], [rad] at the start
DURATION, COMPENSATED = 2.4, 1.5  # [s]
OFFSETS = {
    "sideways": (0.0, 0.05, 0.0),
    "along": (0.05, 0.0, 0.0),
    "heading": (0.0, 0.0, 0.01),
    "all": (-0.03, 0.04, -0.01),
}


@pytest.mark.parametrize("yaw_rate", [0.0, YAW_RATE, -4.0])
@pytest.mark.parametrize("name", OFFSETS)
def test_closed_form_solves_the_sideways_equation(name: str, yaw_rate: float) -> None:
    along, sideways, heading = OFFSETS[name]
    duration = 1.3

    def slope(time: float, error: list[float]) -> list[float]:
        weight = math.exp(-time) * 2 / duration * (1 - time / duration)  # Eq. 22
        ahead = along * math.cos(yaw_rate * time) + sideways * math.sin(yaw_rate * time)
        return [SPEED * (-weight * heading) - yaw_rate * (-weight * ahead)]

    solved = solve_ivp(slope, (0, duration), [sideways], rtol=1e-10, atol=1e-13)
    found = sideways_error_after_compensation(along, sideways, heading, SPEED, yaw_rate, duration)
    assert found == pytest.approx(solved.y[0, -1], abs=1e-10)


def test_on_a_line_a_sideways_error_stays_as_it_is() -> None:
    assert sideways_error_after_compensation(0.3, 0.2, 0.0, 1.0, 0.0, 0.2) == 0.2


def test_paper_circle_is_missed_by_more_than_its_start() -> None:
    # From (9, 0): 1 m aside at the start. To first order in T = 0.2 s it grows by
    # yaw_rate^2 T / 3 = 0.66 of itself.
    found = sideways_error_after_compensation(0.0, -1.0, 0.0, 10 * math.pi, math.pi, 0.2)
    assert found == pytest.approx(-1 - math.pi**2 * 0.2 / 3, rel=0.05)


def turning(sample_time: float) -> Reference:
    """A circle as the Euler plant drives it, so that the feedforward leaves nothing."""
    steps = round(DURATION / sample_time)
    heading = HEADING + YAW_RATE * sample_time * np.arange(steps + 1, dtype=np.float64)
    x = np.concatenate([[0], np.cumsum(SPEED * sample_time * np.cos(heading[:-1]))])
    y = np.concatenate([[0], np.cumsum(SPEED * sample_time * np.sin(heading[:-1]))])
    return Reference("circle", sample_time, x, y, heading)


def off_the_circle(along: float, sideways: float, heading: float) -> Pose:
    """A start with the given initial error: the reference is ahead, to the left, turned left."""
    cos, sin = math.cos(HEADING), math.sin(HEADING)
    return -(cos * along - sin * sideways), -(sin * along + cos * sideways), HEADING - heading


@pytest.mark.slow
def test_closed_form_is_where_the_engine_comes_to_rest() -> None:
    # Of first order in the sample time: about 1 / h, or 0.3 %, and the turn of a few samples. The
    # slowest mode loses 0.5 % in an iteration.
    reference = turning(0.005)
    case = experiment_of(
        reference,
        law_of(2.0, compensation=True, h=300),
        initial_input=feedforward(reference, PLATFORM),
        iterations=4000,
    )
    result = simulate_batch(
        [replace(case, initial_pose=off_the_circle(*offset)) for offset in OFFSETS.values()]
    )
    expected = [
        abs(sideways_error_after_compensation(*offset, SPEED, YAW_RATE, COMPENSATED))
        for offset in OFFSETS.values()
    ]
    found = result.final[:, list(METRICS).index("final_position_error_m")]
    np.testing.assert_allclose(found, expected, rtol=0.02)
