"""What an iteration changes in the belief, and what it leaves alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.belief import Belief
from hilc_cli.laws.norm_optimal.motion_fit import MotionFit
from hilc_cli.robot import Robot

SAMPLE_TIME = 0.01
NO_POSES = np.zeros((2, 3))


def fit_of(radius: float, half_track: float, radius_share: float, turn_share: float) -> MotionFit:
    """A fit of a platform with relative standard errors of both gains."""
    distance_gain = SAMPLE_TIME * radius / 2
    turn_gain = distance_gain / half_track
    return MotionFit(
        distance_gain,
        radius_share * distance_gain,
        turn_gain,
        turn_share * abs(turn_gain),
        NO_POSES,
    )


@pytest.mark.parametrize("convention", ["paper", "rep103"])
def test_exact_fit_is_believed(convention: str) -> None:
    model = Robot(0.14, 0.67, "paper" if convention == "paper" else "rep103")
    sign = 1 if convention == "paper" else -1
    belief, said = Belief.at_first(model).updated(
        fit_of(0.2, sign * 0.518, 1e-12, 1e-12), SAMPLE_TIME
    )
    # The wear that is allowed for and the first doubt weigh 1e-24 of the measurement.
    assert belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-12)
    assert belief.robot.half_track == pytest.approx(0.518, rel=1e-12)
    assert belief.robot.turn_convention == model.turn_convention
    assert said.wheel_radius == pytest.approx(0.2)
    assert said.half_track == pytest.approx(0.518)
    assert said.wheel_radius_error == pytest.approx(0.2e-12)
    assert said.half_track_error == pytest.approx(0.518e-12 * math.sqrt(2))


def test_iteration_without_motion_leaves_the_belief() -> None:
    model = Robot(0.14, 0.67)
    nothing = MotionFit(0.0, math.inf, 0.0, math.inf, NO_POSES)
    belief, said = Belief.at_first(model).updated(nothing, SAMPLE_TIME)
    assert belief.robot.wheel_radius == pytest.approx(0.14, rel=1e-15)
    assert belief.robot.half_track == pytest.approx(0.67, rel=1e-15)
    assert (said.wheel_radius, said.half_track) == (0.14, 0.67)
    assert (said.wheel_radius_error, said.half_track_error) == (math.inf, math.inf)


def test_straight_run_leaves_the_half_track() -> None:
    fit = MotionFit(SAMPLE_TIME * 0.2 / 2, 1e-9, 0.0, math.inf, NO_POSES)
    belief, said = Belief.at_first(Robot(0.14, 0.67)).updated(fit, SAMPLE_TIME)
    assert belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-6)
    assert belief.robot.half_track == pytest.approx(0.67, rel=1e-15)
    assert said.half_track_error == math.inf


def test_turn_on_the_spot_tells_the_ratio() -> None:
    fit = MotionFit(0.0, math.inf, SAMPLE_TIME * 0.2 / (2 * 0.518), 1e-12, NO_POSES)
    belief, _ = Belief.at_first(Robot(0.14, 0.67)).updated(fit, SAMPLE_TIME)
    ratio = belief.robot.wheel_radius / belief.robot.half_track
    assert ratio == pytest.approx(0.2 / 0.518, rel=1e-6)


def test_turn_the_wrong_way_is_not_believed() -> None:
    belief, said = Belief.at_first(Robot(0.2, 0.5)).updated(
        fit_of(0.2, -0.518, 1e-6, 1e-6), SAMPLE_TIME
    )
    assert belief.robot.half_track == pytest.approx(0.5, rel=1e-12)
    assert said.half_track_error == math.inf


def test_equally_sure_iterations_are_averaged() -> None:
    share = 0.01
    belief = Belief.at_first(Robot(0.2, 0.518))
    for radius in (0.2, 0.202, 0.204):
        belief, _ = belief.updated(fit_of(radius, 0.518, share, share), SAMPLE_TIME)
    # The mean of logarithms; a first doubt of 0.5 and a wear of 1e-4 each shift it by less than
    # 1e-3 of the spread.
    expected = (0.2 * 0.202 * 0.204) ** (1 / 3)
    assert belief.robot.wheel_radius == pytest.approx(expected, rel=1e-5)
    assert math.sqrt(belief.covariance[0, 0]) == pytest.approx(share / math.sqrt(3), rel=1e-2)


def test_vague_iteration_is_not_used() -> None:
    belief, said = Belief.at_first(Robot(0.2, 0.518)).updated(
        fit_of(0.5, 0.518, 0.3, 0.3), SAMPLE_TIME
    )
    assert belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-12)
    assert said.wheel_radius_error == math.inf
