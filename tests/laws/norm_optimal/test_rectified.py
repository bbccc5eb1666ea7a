"""The way from an initial error into the trajectory, and how soon it can be there at all."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.laws.norm_optimal.optimal_motion import Model
from hilc_cli.laws.norm_optimal.rectified import (
    RectifiedReference,
    earliest_merge,
    rectified_reference,
    shortest_way,
    tracked,
    trajectory_inputs,
)
from hilc_cli.reference.sampled import Floats

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


OFFSETS = [(0.2, 0.0, 0.0), (-0.3, 0.1, 1.5), (0.0, 0.4, -0.5)]


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
    inputs = trajectory_inputs(arc(), model_with(30.0))
    chord = 2 * SPEED / YAW_RATE * math.sin(YAW_RATE * SAMPLE_TIME / 2)
    mean, half = chord / (SAMPLE_TIME * RADIUS), HALF_TRACK * YAW_RATE / RADIUS
    assert inputs == pytest.approx(np.tile([mean + half, mean - half], (N, 1)), rel=1e-9)
    backwards = np.stack([-0.02 * np.arange(5.0), np.zeros(5), np.zeros(5)], axis=1)
    gain = SAMPLE_TIME * RADIUS / 2
    model = Model(gain, gain / HALF_TRACK, np.zeros((4, 3)), 30.0)
    assert trajectory_inputs(backwards, model) == pytest.approx(np.full((4, 2), -20.0))


def test_drift_is_driven_against() -> None:
    model = model_with(30.0)
    model.drift[:] = [0.001, 0.0, -0.002]
    plain = trajectory_inputs(arc(), model_with(30.0))
    mean, half = -0.001 / (2 * model.distance_gain), 0.002 / (2 * model.turn_gain)
    expected = plain + np.array([mean + half, mean - half])
    assert trajectory_inputs(arc(), model) == pytest.approx(expected, rel=1e-12)


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
        trajectory_inputs(target, model),
        rate,
        0.002,
        model,
    )
    assert np.abs(inputs).max() <= 60.0 * (1 + 1e-12)
    assert np.hypot(*(poses - target)[-1, :2]) < 0.15
    assert abs(poses[-1, 2] - target[-1, 2]) < 0.3  # not wrapped


def straight(n: int) -> Floats:
    poses = np.zeros((n + 1, 3))
    poses[:, 0] = np.arange(n + 1.0)
    return poses


@pytest.mark.parametrize(
    ("start", "expected"),
    [
        ((0.0, 0.0, 0.0), 0),
        # At 2 m/s behind what moves at 1 m/s: 5 m are made good after 5 s.
        ((-5.0, 0.0, 0.0), 5),
        # 4 m ahead: they meet after 4 / 3 s, backwards; the next sample is 2.
        ((4.0, 0.0, 0.0), 2),
        # A turn by 1 rad takes 0.5 m of wheel; t + 0.5 <= 2 t.
        ((0.0, 0.0, 1.0), 1),
        # Turned by pi: B pi = 1.57 m.
        ((0.0, 0.0, math.pi), 2),
        # 3 m aside, at (m, 0): root(m^2 + 9) + 2 * 0.5 atan(3 / m) <= 2 m.
        ((0.0, 3.0, 0.0), 3),
    ],
)
def test_earliest_merge_by_hand(start: tuple[float, float, float], expected: int) -> None:
    assert earliest_merge(straight(10), np.array(start), 2.0, 0.5, 1.0) == expected


def test_earliest_merge_is_not_after_a_zigzag_that_was_driven() -> None:
    # Ahead, turn in place, back: into a pose 0.1 m ahead, from 30 deg to its left to 150 deg.
    top, half_track, sample_time = 36.0, 0.518, 0.001
    low, high = math.radians(30), math.radians(150)
    pieces = [  # lengths from the law of sines, rounded up to whole samples
        (0.1 * math.sin(high) / math.sin(high - low), 0.0),
        (0.0, high - low),
        (-0.1 * math.sin(low) / math.sin(high - low), 0.0),
    ]
    x, y, heading, samples = 0.0, 0.0, low, 0
    for length, turn in pieces:
        need = math.ceil((abs(length) + half_track * turn) / (top * sample_time))
        for _ in range(need):
            x += length / need * math.cos(heading)
            y += length / need * math.sin(heading)
            heading += turn / need
        samples += need
    pose = np.array([0.1, 0.0, high])
    assert np.array([x, y, heading]) == pytest.approx(pose, abs=1e-12)
    assert samples == 35
    earliest = earliest_merge(
        np.tile(pose, (50, 1)), np.array([0, 0, low]), top, half_track, sample_time
    )
    assert earliest is not None
    assert samples - 2 <= earliest <= samples  # two pieces were rounded up for nothing


@pytest.mark.parametrize("seed", range(12))
def test_shortest_way_is_the_best_of_all_sequences(seed: int) -> None:
    """Turn, straight, turn, straight, turn, straight, turn: three headings and one free length."""
    random = np.random.default_rng(seed)
    start_heading, end_heading = random.uniform(-4, 4, 2)
    half_track, x, y = (
        random.uniform(0.2, 1.0),
        *random.normal(0, 10 ** random.uniform(-1.5, 0.5), 2),
    )

    def way(headings: Floats, third: Floats) -> Floats:
        """What sequences cost; headings of shape (3, cases), lengths at the third of them."""
        cos, sin = np.cos(headings), np.sin(headings)
        rest_x, rest_y = x - third * cos[2], y - third * sin[2]
        # The first two lengths lead to where the third begins.
        across = cos[0] * sin[1] - sin[0] * cos[1]
        first = (rest_x * sin[1] - rest_y * cos[1]) / across
        second = (rest_y * cos[0] - rest_x * sin[0]) / across
        turns = np.abs(np.diff(headings, axis=0, prepend=start_heading, append=end_heading))
        lengths = np.abs(first) + np.abs(second) + np.abs(third)
        cost: Floats = lengths + half_track * turns.sum(axis=0)
        return cost

    least = shortest_way(
        np.array([[x, y, end_heading]]), np.array([0, 0, start_heading]), half_track
    )[0]
    wide = random.uniform(-6, 6, (3, 100_000))
    wide[0, ::4], wide[1, 1::4] = start_heading, end_heading  # without the first or a later turn
    third = random.normal(0, 1, wide.shape[1]) * np.tile([0.0, 1.0], wide.shape[1] // 2)
    costs = way(wide, third)
    assert np.all(costs >= least * (1 - 1e-9))
    # The best is refined by ever smaller random changes, some of them of one number alone.
    best = np.concatenate([wide, third[None]])[:, costs.argmin()]
    for size in np.geomspace(1.0, 1e-6, 40).tolist():
        some = random.choice([0.0, 1.0], (4, 2000))
        near: Floats = best[:, None] + random.normal(0, size, (4, 2000)) * some
        near[:, 0] = best
        near[3, ::3] = 0.0
        costs = way(near[:3], near[3])
        best = near[:, costs.argmin()]
    assert costs.min() == pytest.approx(least, rel=1e-3)


def test_what_cannot_be_caught_up_with_is_none() -> None:
    assert earliest_merge(straight(10), np.array([-5.0, 0, 0]), 1.0, 0.5, 1.0) is None
