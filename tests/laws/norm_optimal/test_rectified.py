"""The way from an initial error into the trajectory, and how soon it can be there at all."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.laws.norm_optimal.optimal_motion import Model
from hilc_cli.laws.norm_optimal.rectified import (
    RectifiedReference,
    merged_sample,
    rectified_reference,
    tracked,
    trajectory_inputs,
)
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.reach import earliest_merge

N, SAMPLE_TIME, SPEED, YAW_RATE = 300, 0.01, 2.0, 0.7
RADIUS, HALF_TRACK = 0.1, 0.3
WEIGHTS = (1e6, 400.0, 0.01)


def model_with(speed_limit: float) -> Model:
    gain = SAMPLE_TIME * RADIUS / 2
    return Model(gain, gain / HALF_TRACK, np.zeros((N, 3)), speed_limit)


def arc() -> Floats:
    """Left around (0, 0); its wheels need 20 and 2.1 rad/s in sum, 22.1 at most."""
    heading = math.pi / 2 + YAW_RATE * SAMPLE_TIME * np.arange(N + 1)
    radius = SPEED / YAW_RATE
    return np.stack([radius * np.sin(heading), -radius * np.cos(heading), heading], axis=1)


def rectified(start: Floats, h: int, speed_limit: float = 30.0) -> RectifiedReference:
    return rectified_reference(arc(), start, model_with(speed_limit), h, WEIGHTS)


NEAR, FAR = np.array([1e-3, -1e-3, 2e-3]), np.array([0.1, -0.2, 0.5])
OFFSETS = [(0.2, 0.0, 0.0), (-0.3, 0.1, 1.5), (0.0, 0.4, -0.5)]


@pytest.mark.parametrize("offset", OFFSETS)
def test_way_that_is_known_is_found_again_in_fewer_steps_and_is_as_good(
    offset: tuple[float, float, float],
) -> None:
    """Of nearly the same start, and of one that it is of no use for."""
    model, start = model_with(30.0), arc()[0] + offset
    known = rectified(start, 150)
    for other in (start, start + NEAR, start + FAR):
        anew = rectified(other, 150)
        found = rectified_reference(arc(), other, model, 150, WEIGHTS, known)
        assert found.settled
        assert found.merged == pytest.approx(anew.merged, abs=1)
        assert found.motion == pytest.approx(anew.motion, abs=2e-3)
        assert np.abs(found.inputs).max() <= 30.0
    again = rectified_reference(arc(), start, model, 150, WEIGHTS, known)
    assert again.motion == pytest.approx(known.motion, abs=1e-3)


@pytest.mark.parametrize("offset", OFFSETS)
def test_way_in_is_feasible_and_over_by_sample_h(offset: tuple[float, float, float]) -> None:
    start = arc()[0] + offset
    found = rectified(start, 150)
    assert found.merged is not None
    assert found.merged <= 152
    left = np.hypot(*(found.motion - arc())[:, :2].T)
    assert np.all(left[found.merged :] <= 1e-3)
    assert left[found.merged - 1] > 1e-3
    assert np.abs(found.inputs).max() <= 30.0
    # It is a motion of the platform: the model's own equations, step by step.
    assert found.motion[0] == pytest.approx(start)
    left_wheel, right_wheel = found.inputs.T
    step = SAMPLE_TIME * RADIUS * (left_wheel + right_wheel) / 2
    heading = found.motion[:-1, 2]
    expected = np.stack([step * np.cos(heading), step * np.sin(heading)], axis=1)
    assert np.diff(found.motion[:, :2], axis=0) == pytest.approx(expected, abs=1e-12)
    turn = SAMPLE_TIME * RADIUS * (left_wheel - right_wheel) / (2 * HALF_TRACK)
    assert np.diff(found.motion[:, 2]) == pytest.approx(turn, abs=1e-12)
    # After an initial error of hundreds of millimetres, that is the reference.
    assert found.poses == pytest.approx(found.motion, abs=1e-4)


def test_without_initial_error_it_is_the_trajectory() -> None:
    found = rectified(arc()[0], 150)
    assert np.array_equal(found.poses, arc())
    assert found.merged == 0
    assert found.settled
    # The platform itself steps along its heading, half a step ahead of the arc.
    assert np.hypot(*(found.motion - arc())[:, :2].T).max() < 1e-3


def corner() -> Floats:
    """Left by a right angle at sample 100, at 2 m/s."""
    along = SPEED * SAMPLE_TIME * np.arange(N + 1)
    turned = along > along[100]
    x, y = along.clip(max=along[100]), (along - along[100]).clip(min=0)
    return np.stack([x, y, np.where(turned, math.pi / 2, 0.0)], axis=1)


def test_way_in_is_continuous_in_the_initial_error() -> None:
    # An error counts as one about in proportion to the initial error, so that nothing on the way
    # grows faster than that, be it a cut corner; there is no offset from which on it counts less.
    offsets = np.concatenate([[0.0], np.geomspace(1e-5, 1.0, 26)])
    largest = []
    for offset in offsets:
        start = corner()[0] + [0.0, offset, 0.0]
        found = rectified_reference(corner(), start, model_with(60.0), 200, WEIGHTS)
        largest.append(np.hypot(*(found.motion - corner())[:, :2].T).max())
    first, errors = largest[0], np.array(largest[1:])
    factor = offsets[2] / offsets[1]
    assert first < 0.05
    assert errors[0] == pytest.approx(first, rel=0.01)
    assert np.all(errors[1:] <= factor * errors[:-1] * (1 + 1e-6))
    assert np.all(errors <= first + 10 * offsets[1:])
    assert errors[-1] == pytest.approx(1.0, rel=0.01)  # it is nowhere further than at the start


@pytest.mark.parametrize("offset", [0.0, 1e-9, 1e-7])
def test_reference_goes_over_into_the_trajectory(offset: float) -> None:
    found = rectified(arc()[0] + [offset, 0, 0], 150)
    assert np.abs(found.poses - arc()).max() <= offset


def test_heading_counts_as_an_initial_error_by_its_weight() -> None:
    # 0.05 rad and 1 mm count as one, and so does the root of the half of each: the reference is
    # half way between trajectory and motion.
    for offset in ([0.0, 0.0, 0.05], [1e-3, 0.0, 0.0], [0.0, 5e-4**0.5 / 1e3**0.5, 0.05 / 2**0.5]):
        found = rectified(arc()[0] + offset, 150)
        assert found.poses[0] == pytest.approx(arc()[0] + np.array(offset) / 2, abs=1e-12)


def test_search_without_limit_keeps_to_what_the_trajectory_needs() -> None:
    start = arc()[0] + [2.0, 1.0, 2.5]
    free, bounded = rectified(start, 75, math.inf), rectified(start, 75, 200.0)
    assert free.settled and bounded.settled
    assert np.abs(bounded.inputs).max() < 190.0
    assert free.inputs == pytest.approx(bounded.inputs, abs=0.1)
    assert free.speed_limit < 1e4
    assert bounded.speed_limit == 200.0


def test_way_in_takes_longer_where_the_limit_leaves_less() -> None:
    start = arc()[0] + [0.0, -0.5, 0.0]  # behind
    merged = [rectified(start, 20, limit).merged for limit in (60.0, 30.0, 25.0)]
    earliest = [
        earliest_merge(arc(), start, RADIUS * limit, HALF_TRACK, SAMPLE_TIME)
        for limit in (60.0, 30.0, 25.0)
    ]
    last = 0
    for found, bound in zip(merged, earliest, strict=True):
        assert found is not None
        assert bound is not None
        assert found >= bound - 2  # within a millimetre it is there a little earlier
        assert found >= last
        last = found


def test_platform_that_is_too_slow_never_gets_there() -> None:
    start = arc()[0] + [0.0, -0.5, 0.0]
    assert rectified(start, 20, 15.0).merged is None


def test_wheel_speeds_of_the_trajectory_have_its_lengths_and_turns() -> None:
    inputs, longest = trajectory_inputs(arc(), model_with(30.0))
    chord = 2 * SPEED / YAW_RATE * math.sin(YAW_RATE * SAMPLE_TIME / 2)
    mean, half = chord / (SAMPLE_TIME * RADIUS), HALF_TRACK * YAW_RATE / RADIUS
    assert inputs == pytest.approx(np.tile([mean + half, mean - half], (N, 1)), rel=1e-9)
    assert longest == pytest.approx(chord)
    backwards = np.stack([-0.02 * np.arange(5.0), np.zeros(5), np.zeros(5)], axis=1)
    gain = SAMPLE_TIME * RADIUS / 2
    model = Model(gain, gain / HALF_TRACK, np.zeros((4, 3)), 30.0)
    inputs, longest = trajectory_inputs(backwards, model)
    assert inputs == pytest.approx(np.full((4, 2), -20.0))
    assert longest == pytest.approx(0.02)


def test_drift_is_driven_against() -> None:
    model = model_with(30.0)
    model.drift[:] = [0.001, 0.0, -0.002]
    plain, _ = trajectory_inputs(arc(), model_with(30.0))
    mean, half = -0.001 / (2 * model.distance_gain), 0.002 / (2 * model.turn_gain)
    expected = plain + np.array([mean + half, mean - half])
    assert trajectory_inputs(arc(), model)[0] == pytest.approx(expected, rel=1e-12)


@settings(max_examples=25)
@given(x=st.floats(-1, 1), y=st.floats(-1, 1), heading=st.floats(-6, 6), rate=st.floats(0.02, 0.05))
def test_first_guess_comes_to_the_trajectory_within_the_limit(
    x: float, y: float, heading: float, rate: float
) -> None:
    model = model_with(60.0)
    target = arc()
    inputs, poses = tracked(
        target[0] + [x, y, heading],
        target,
        trajectory_inputs(target, model)[0],
        rate,
        0.002,
        model,
    )
    assert np.abs(inputs).max() <= 60.0 * (1 + 1e-12)
    assert np.hypot(*(poses - target)[-1, :2]) < 0.15
    assert abs(poses[-1, 2] - target[-1, 2]) < 0.3  # not wrapped


def test_motion_has_merged_where_it_stays_within_a_millimetre() -> None:
    off = np.array([0.1, 0.5e-3, 2e-3, 0.9e-3, 0.0])
    there = np.zeros((5, 3))
    away = there + np.stack([0.6 * off, 0.8 * off, np.ones(5)], axis=1)
    assert merged_sample(away, there) == 3
    assert merged_sample(there, there) == 0
    assert merged_sample(away[::-1].copy(), there) is None
    assert merged_sample(np.full((5, 3), np.nan), there) is None
