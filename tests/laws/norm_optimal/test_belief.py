"""What an iteration changes in the belief, and what it leaves alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from hilc_cli.laws.norm_optimal.belief import Belief
from hilc_cli.laws.norm_optimal.identification import MotionFit
from hilc_cli.plants.kinematic import Robot

SAMPLE_TIME = 0.01
NO_POSES = np.zeros((2, 3))


TRUTH = Robot(0.2, 0.518)
DISTANCE_GAIN = SAMPLE_TIME * 0.2 / 2
TURN_GAIN = DISTANCE_GAIN / 0.518


def read(random: np.random.Generator, share: float) -> MotionFit:
    """What an iteration says whose errors are normal and as large as it says."""
    errors = share * DISTANCE_GAIN, share * TURN_GAIN
    distance, turn = random.normal((DISTANCE_GAIN, TURN_GAIN), errors).tolist()
    return MotionFit(distance, errors[0], turn, errors[1], NO_POSES)


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
    # Nothing is lost of so small an error, 1e-24 of what was believed before in its square.
    assert belief.wheel_radius_error == pytest.approx(0.2e-12, rel=1e-9)
    assert belief.half_track_error == pytest.approx(0.518e-12 * math.sqrt(2), rel=1e-9)


def test_iteration_without_motion_leaves_the_belief() -> None:
    model = Robot(0.14, 0.67)
    nothing = MotionFit(0.0, math.inf, 0.0, math.inf, NO_POSES)
    belief, said = Belief.at_first(model).updated(nothing, SAMPLE_TIME)
    assert belief.robot.wheel_radius == pytest.approx(0.14, rel=1e-15)
    assert belief.robot.half_track == pytest.approx(0.67, rel=1e-15)
    assert (said.wheel_radius, said.half_track) == (0.14, 0.67)
    assert (said.wheel_radius_error, said.half_track_error) == (math.inf, math.inf)
    assert (belief.wheel_radius_error, belief.half_track_error) == (math.inf, math.inf)


def test_straight_run_leaves_the_half_track() -> None:
    fit = MotionFit(SAMPLE_TIME * 0.2 / 2, 1e-9, 0.0, math.inf, NO_POSES)
    belief, said = Belief.at_first(Robot(0.14, 0.67)).updated(fit, SAMPLE_TIME)
    assert belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-6)
    assert belief.robot.half_track == pytest.approx(0.67, rel=1e-15)
    assert said.half_track_error == math.inf
    assert belief.wheel_radius_error == pytest.approx(0.2 * 1e-9 / fit.distance_gain, rel=1e-3)
    assert belief.half_track_error == math.inf


def test_turn_on_the_spot_tells_the_ratio() -> None:
    fit = MotionFit(0.0, math.inf, SAMPLE_TIME * 0.2 / (2 * 0.518), 1e-12, NO_POSES)
    belief, said = Belief.at_first(Robot(0.14, 0.67)).updated(fit, SAMPLE_TIME)
    assert belief.ratio == pytest.approx(0.2 / 0.518, rel=1e-6)
    assert belief.ratio_error == pytest.approx(2e-12 / SAMPLE_TIME, rel=1e-3)
    assert (said.ratio, said.ratio_error) == pytest.approx((0.2 / 0.518, 2e-12 / SAMPLE_TIME))
    assert (belief.wheel_radius_error, belief.half_track_error) == (math.inf, math.inf)


def test_turns_on_the_spot_leave_the_radius_until_it_is_told() -> None:
    # Turns tell 0.4 and, by their noise, something near to it: nothing of that is the radius'.
    belief = Belief.at_first(Robot(0.14, 0.67))
    for ratio in (0.41, 0.39, 0.4):
        turned = MotionFit(0.0, math.inf, SAMPLE_TIME * ratio / 2, 1e-5, NO_POSES)
        belief, said = belief.updated(turned, SAMPLE_TIME)
        assert belief.robot.wheel_radius == said.wheel_radius == 0.14
        assert belief.robot.half_track == pytest.approx(0.14 / belief.ratio, rel=1e-12)
    assert belief.ratio == pytest.approx(0.4, rel=1e-3)
    driven = MotionFit(SAMPLE_TIME * 0.2 / 2, 1e-9, 0.0, math.inf, NO_POSES)
    belief, _ = belief.updated(driven, SAMPLE_TIME)
    assert belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-5)
    assert belief.robot.half_track == pytest.approx(0.5, rel=1e-3)


def test_turn_the_wrong_way_is_not_believed() -> None:
    belief, said = Belief.at_first(Robot(0.2, 0.5)).updated(
        fit_of(0.2, -0.518, 1e-6, 1e-6), SAMPLE_TIME
    )
    assert belief.robot.half_track == pytest.approx(0.5, rel=1e-12)
    assert said.half_track_error == math.inf


def test_iterations_count_by_their_standard_errors() -> None:
    # Inverse variances add up, of both gains, since their errors are independent.
    radii, errors = np.array([0.2, 0.202, 0.205]), np.array([2e-3, 4e-3, 1e-3])
    belief = Belief.at_first(TRUTH)
    for radius, error in zip(radii.tolist(), errors.tolist(), strict=True):
        share = error / radius
        belief, _ = belief.updated(fit_of(radius, 0.518, share, share), SAMPLE_TIME)
    weights = 1 / errors**2
    expected, sure = weights @ radii / weights.sum(), 1 / math.sqrt(weights.sum())
    # A first doubt of 0.5 and a wear of 1e-4 have shares of less than 1e-3 in the weights.
    assert belief.robot.wheel_radius == pytest.approx(expected, abs=1e-3 * sure)
    assert belief.wheel_radius_error == pytest.approx(sure, rel=1e-2)
    assert belief.robot.half_track == pytest.approx(0.518, rel=1e-5)
    share = sure / expected * math.sqrt(2)
    assert belief.half_track_error == pytest.approx(0.518 * share, rel=1e-2)


def test_wear_bounds_what_many_iterations_are_worth() -> None:
    # The Kalman filter's rest: R and B each change by a random walk, R and R / B are read.
    wear, spread = 1e-4, 1e-3
    belief = Belief.at_first(TRUTH)
    for _ in range(200):
        belief, _ = belief.updated(fit_of(0.2, 0.518, spread, spread), SAMPLE_TIME)
    walk, noise = wear**2 * np.array([[1.0, 1.0], [1.0, 2.0]]), spread**2 * np.eye(2)
    ahead = solve_discrete_are(np.eye(2), np.eye(2), walk, noise)
    rest = ahead - ahead @ np.linalg.solve(ahead + noise, ahead)
    quotient = np.array([1.0, -1.0])
    assert belief.wheel_radius_error == pytest.approx(0.2 * math.sqrt(rest[0, 0]), rel=1e-6)
    assert belief.half_track_error == pytest.approx(
        0.518 * math.sqrt(quotient @ rest @ quotient), rel=1e-6
    )


@pytest.mark.parametrize("share", [1e-3, 0.1])
def test_what_is_believed_is_as_sure_as_it_says(share: float) -> None:
    random, seeds = np.random.default_rng(11), 200
    off = np.empty((seeds, 2))
    for seed in range(seeds):
        belief = Belief.at_first(Robot(0.14, 0.67))
        for _ in range(30):
            belief, _ = belief.updated(read(random, share), SAMPLE_TIME)
        robot = belief.robot
        off[seed] = (
            (robot.wheel_radius - 0.2) / belief.wheel_radius_error,
            (robot.half_track - 0.518) / belief.half_track_error,
        )
    # The mean of 200 is known to 0.07, and the root of their mean square to 0.05. Where wear that
    # is not there is allowed for, errors are smaller than is said, by sqrt(2) at most.
    assert np.all(np.abs(np.mean(off, axis=0)) < 0.25)
    spread = np.sqrt(np.mean(off**2, axis=0))
    assert np.all((spread > (0.65 if share < 0.01 else 0.85)) & (spread < 1.15))


def test_vague_iteration_is_not_used() -> None:
    belief, said = Belief.at_first(Robot(0.2, 0.518)).updated(
        fit_of(0.5, 0.518, 0.3, 0.3), SAMPLE_TIME
    )
    assert belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-12)
    assert said.wheel_radius_error == math.inf
