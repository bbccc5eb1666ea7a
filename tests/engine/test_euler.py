"""The forward Euler plant with exact feedforward input: its error and its order."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.engine.loop import simulate
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import paper_reference


def euler_error(reference: Reference) -> tuple[Floats, Floats]:
    """Distance from the reference, and heading error, of the run with feedforward input."""
    experiment = experiment_of(
        reference, law_of(0.0), initial_input=feedforward(reference, PLATFORM), iterations=0
    )
    (trial,) = simulate(experiment)
    distance = np.hypot(trial.x - reference.x, trial.y - reference.y)
    return distance, trial.heading - reference.heading


@pytest.mark.parametrize("samples", [8, 100, 2000])
def test_result_on_a_circle_is_the_reference_turned_back_by_half_a_step(samples: int) -> None:
    reference = paper_reference("circle", 2.0 / samples)
    distance, heading_error = euler_error(reference)
    step = 2 * math.pi / samples
    from_start = np.hypot(reference.x - reference.x[0], reference.y - reference.y[0])
    np.testing.assert_allclose(distance, from_start * 2 * math.sin(step / 4), rtol=0, atol=1e-10)
    np.testing.assert_allclose(heading_error, 0, atol=1e-11)


def test_result_on_a_circle_is_turned_clockwise_about_its_start() -> None:
    reference = paper_reference("circle", 0.02)
    (trial,) = simulate(
        experiment_of(
            reference, law_of(0.0), initial_input=feedforward(reference, PLATFORM), iterations=0
        )
    )
    path = (reference.x - 10) + 1j * reference.y
    turned = 10 + path * np.exp(-0.5j * 2 * math.pi / 100)
    np.testing.assert_allclose(trial.x + 1j * trial.y, turned, rtol=0, atol=1e-12)


def test_largest_error_on_a_circle_falls_with_the_sample_time() -> None:
    sample_times = np.array([0.02, 0.01, 0.005, 0.002, 0.001])
    largest = [
        float(euler_error(paper_reference("circle", sample_time))[0].max())
        for sample_time in sample_times.tolist()
    ]
    order = np.polyfit(np.log(sample_times), np.log(largest), 1)[0]
    assert order == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("name", ["arc-and-line", "cardioid", "spiral"])
def test_largest_error_on_every_other_trajectory_falls_with_the_sample_time(name: str) -> None:
    sample_times = np.array([0.02, 0.01, 0.005, 0.0025])
    largest = [
        float(euler_error(paper_reference(name, sample_time))[0].max())
        for sample_time in sample_times.tolist()
    ]
    order = np.polyfit(np.log(sample_times), np.log(largest), 1)[0]
    assert order == pytest.approx(1.0, abs=0.05)


def test_line_is_followed_without_an_error() -> None:
    reference = build_reference("line", (1.0, 2.0, 0.7), [LinePlan(length=9.0, duration=1.0)], 0.01)
    distance, _ = euler_error(reference)
    np.testing.assert_allclose(distance, 0, atol=1e-13)


def test_right_turn_is_turned_the_other_way_by_the_same_amount() -> None:
    reference = build_reference(
        "arc", (0.0, 0.0, 0.3), [ArcPlan(math.pi, "right", radius=3.0, duration=1.0)], 0.01
    )
    distance, _ = euler_error(reference)
    from_start = np.hypot(reference.x, reference.y)
    expected = from_start * 2 * math.sin(math.pi / 100 / 4)
    np.testing.assert_allclose(distance, expected, rtol=0, atol=1e-12)
