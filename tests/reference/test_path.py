"""Placing segments: relative and absolute forms, turns, corners, speeds, every error, motions."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.special import fresnel

from hilc_cli.reference.path import (
    MAX_SAMPLES,
    ArcPlan,
    ClothoidPlan,
    LinePlan,
    PathBuilder,
    PathError,
    SamplesError,
    SegmentPlan,
    StopPlan,
    build_reference,
)
from hilc_cli.reference.sampled import Floats, Reference
from tests.reference.paths import Move, Pose, absolute_plans, relative_plans

ORIGIN = (0.0, 0.0, 0.0)


def refusal(
    plan: SegmentPlan, start: tuple[float, float, float] = ORIGIN, sample_time: float = 0.001
) -> PathError:
    """The error that one segment is refused with."""
    builder = PathBuilder(start, sample_time)
    with pytest.raises(PathError) as caught:
        builder.add(plan)
    return caught.value


def test_relative_line_runs_along_the_running_heading() -> None:
    reference = build_reference(
        "line", (1.0, 2.0, math.pi / 6), [LinePlan(length=2.0, duration=0.004)], 0.001
    )
    np.testing.assert_allclose(reference.x, 1 + math.sqrt(3) / 2 * np.arange(5) / 2, atol=1e-15)
    np.testing.assert_allclose(reference.y, 2 + np.arange(5) / 4, atol=1e-15)
    np.testing.assert_array_equal(reference.heading, math.pi / 6)


def test_absolute_line_ends_at_its_point_to_the_last_bit() -> None:
    to = (0.1 + 0.2, 0.7)
    heading = math.atan2(to[1], to[0])
    reference = build_reference(
        "line", (0.0, 0.0, heading), [LinePlan(to=to, duration=0.007)], 0.001
    )
    assert (reference.x[-1], reference.y[-1]) == to


def test_relative_left_arc_has_its_center_on_the_left() -> None:
    # From the origin, heading along x, radius 2: the centre is (0, 2), a quarter ends at (2, 2).
    reference = build_reference(
        "arc", ORIGIN, [ArcPlan(math.pi / 2, "left", radius=2.0, duration=0.01)], 0.001
    )
    end = (reference.x[-1], reference.y[-1], reference.heading[-1])
    assert end == pytest.approx((2.0, 2.0, math.pi / 2), abs=1e-15)


def test_relative_right_arc_has_its_center_on_the_right() -> None:
    reference = build_reference(
        "arc", ORIGIN, [ArcPlan(math.pi / 2, "right", radius=2.0, duration=0.01)], 0.001
    )
    end = (reference.x[-1], reference.y[-1], reference.heading[-1])
    assert end == pytest.approx((2.0, -2.0, -math.pi / 2), abs=1e-15)


def test_absolute_right_arc_runs_clockwise() -> None:
    # The unit circle about the origin from (0, 1), heading along x: half way it is at (1, 0).
    reference = build_reference(
        "arc",
        (0.0, 1.0, 0.0),
        [ArcPlan(math.pi, "right", center=(0.0, 0.0), radius=1.0, duration=0.01)],
        0.001,
    )
    poses = np.column_stack([reference.x, reference.y, reference.heading])
    np.testing.assert_allclose(poses[5], [1, 0, -math.pi / 2], atol=1e-15)
    np.testing.assert_allclose(poses[10], [0, -1, -math.pi], atol=1e-15)


def test_arc_without_a_radius_takes_the_distance_of_its_center() -> None:
    reference = build_reference(
        "arc",
        (3.0, 4.0, math.atan2(3, -4)),
        [ArcPlan(1.0, "left", (0.0, 0.0), duration=0.01)],
        0.001,
    )
    np.testing.assert_allclose(np.hypot(reference.x, reference.y), 5.0, atol=1e-14)


def test_heading_of_a_second_turn_goes_on_from_the_first() -> None:
    turn = ArcPlan(2 * math.pi, "left", center=(0.0, 0.0), duration=0.1)
    reference = build_reference("two turns", (1.0, 0.0, math.pi / 2), [turn, turn], 0.001)
    assert reference.heading[-1] == pytest.approx(4.5 * math.pi, abs=1e-12)
    assert np.abs(np.diff(reference.heading)).max() == pytest.approx(math.pi / 50, abs=1e-12)


def test_start_heading_may_be_any_number_of_turns() -> None:
    reference = build_reference(
        "wound",
        (1.0, 0.0, math.pi / 2 - 6 * math.pi),
        [ArcPlan(1.0, "left", (0.0, 0.0), duration=0.01)],
        0.001,
    )
    assert reference.heading[-1] == pytest.approx(1 - 5.5 * math.pi, abs=1e-12)


def test_corner_is_refused_with_its_angle() -> None:
    error = refusal(LinePlan(to=(0.0, 1.0), duration=0.01))
    assert f"a corner of {math.pi / 2:.3g} rad" in str(error)
    assert "corners: allow" in str(error)


def test_allowed_corner_turns_the_heading_at_the_joint() -> None:
    reference = build_reference(
        "corner",
        ORIGIN,
        [LinePlan(to=(1.0, 0.0), duration=0.002), LinePlan(to=(1.0, 1.0), duration=0.002)],
        0.001,
        corners=True,
    )
    np.testing.assert_allclose(reference.x, [0, 0.5, 1, 1, 1], atol=1e-15)
    np.testing.assert_allclose(reference.y, [0, 0, 0, 0.5, 1], atol=1e-15)
    # The joint belongs to the later segment.
    np.testing.assert_allclose(
        reference.heading, [0, 0, math.pi / 2, math.pi / 2, math.pi / 2], atol=1e-15
    )


def test_allowed_corner_turns_the_shorter_way_from_a_wound_up_heading() -> None:
    reference = build_reference(
        "corner",
        (0.0, 0.0, 4 * math.pi),
        [LinePlan(length=1.0, duration=0.002), LinePlan(to=(1.0, -1.0), duration=0.002)],
        0.001,
        corners=True,
    )
    assert reference.heading[-1] == pytest.approx(3.5 * math.pi, abs=1e-12)


def test_reference_tells_of_lengths_and_corners() -> None:
    reference = build_reference(
        "corners",
        (0.0, 0.0, 0.5),
        [
            LinePlan(to=(3.0, 4.0), duration=0.005),
            ArcPlan(math.pi / 2, "right", radius=2.0, duration=0.01),
            LinePlan(length=0.25, duration=0.001),
        ],
        0.001,
        corners=True,
    )
    assert reference.lengths == pytest.approx((5.0, math.pi, 0.25), rel=1e-15)
    # The line heads atan(4 / 3), the start 0.5; the others go on as they arrive.
    assert reference.corners == pytest.approx((math.atan2(4, 3) - 0.5, 0, 0), abs=1e-15)
    assert reference.corners[1:] == (0, 0)


def test_speed_stands_in_for_the_duration() -> None:
    by_speed = build_reference("line", ORIGIN, [LinePlan(length=3.0, speed=1.5)], 0.01)
    assert by_speed.samples == 200


def test_speed_on_an_arc_is_along_the_arc() -> None:
    # pi * 2 m at pi m/s take 2 s.
    plan = ArcPlan(math.pi, "left", radius=2.0, speed=math.pi)
    assert build_reference("arc", ORIGIN, [plan], 0.01).samples == 200


@pytest.mark.parametrize(("speed", "samples"), [(1.0, 3), (1 / 3.4, 3), (1 / 3.6, 4), (50.0, 1)])
def test_speed_takes_the_nearest_whole_number_of_samples_and_at_least_one(
    speed: float, samples: int
) -> None:
    length = 3.0 if speed == 1.0 else 1.0
    plan = LinePlan(length=length, speed=speed)
    assert build_reference("line", ORIGIN, [plan], 1.0).samples == samples


def test_gap_is_the_distance_of_the_running_point_from_the_start() -> None:
    builder = PathBuilder((1.0, 1.0, 0.0), 0.001)
    builder.add(LinePlan(length=3.0, duration=0.01))
    builder.add(ArcPlan(math.pi / 2, "left", radius=4.0, duration=0.01))
    assert builder.gap() == pytest.approx(math.hypot(7, 4), abs=1e-14)
    assert builder.samples == 20


def test_arc_off_the_running_point_is_refused_with_the_gap() -> None:
    # The path stands 4 m from the centre; the arc wants 5 m.
    error = refusal(
        ArcPlan(math.pi, "left", center=(0.0, 0.0), radius=5.0, duration=0.5),
        start=(4.0, 0.0, math.pi / 2),
    )
    assert error.field == "center"
    assert "does not pass through (4, 0)" in str(error)
    assert "4 m from the centre" in str(error)
    assert "a gap of 1 m" in str(error)


@pytest.mark.parametrize(("gap", "fits"), [(0.9e-9, True), (1.2e-9, False)])
def test_arc_may_miss_the_running_point_by_a_nanometer(gap: float, fits: bool) -> None:
    plan = ArcPlan(math.pi, "left", center=(0.0, 0.0), radius=1.0 + gap, duration=0.5)
    builder = PathBuilder((1.0, 0.0, math.pi / 2), 0.001)
    if fits:
        builder.add(plan)
    else:
        with pytest.raises(PathError):
            builder.add(plan)


def test_arc_about_the_running_point_is_refused() -> None:
    error = refusal(ArcPlan(math.pi, "left", center=(0.0, 0.0), duration=0.5))
    assert error.field == "center"
    assert "has its centre at (0, 0)" in str(error)


def test_arc_without_center_and_radius_is_refused() -> None:
    assert "give 'center' or 'radius'" in str(refusal(ArcPlan(math.pi, "left", duration=0.5)))


def test_line_without_an_end_is_refused() -> None:
    assert "give 'to' or 'length'" in str(refusal(LinePlan(duration=0.5)))


def test_segment_without_a_time_is_refused() -> None:
    assert "give 'duration' or 'speed'" in str(refusal(LinePlan(length=1.0)))


def test_line_to_the_running_point_is_refused() -> None:
    error = refusal(LinePlan(to=(2.0, 3.0), duration=0.5), start=(2.0, 3.0, 0.0))
    assert error.field == "to"
    assert "has no length: it starts and ends at (2, 3)" in str(error)


def test_line_of_zero_length_is_refused() -> None:
    error = refusal(LinePlan(length=0.0, duration=0.5))
    assert error.field == "length"
    assert "has no length" in str(error)


def test_duration_between_samples_is_refused_with_a_whole_one() -> None:
    error = refusal(LinePlan(length=1.0, duration=0.0123))
    assert error.field == "duration"
    assert "12.3 samples of 0.001 s" in str(error)
    assert "such as 0.012 s" in str(error)


def test_duration_below_one_sample_is_refused_with_one_sample() -> None:
    error = refusal(LinePlan(length=1.0, duration=0.0001))
    assert error.field == "duration"
    assert "such as 0.001 s" in str(error)


@pytest.mark.parametrize("samples", [3, 7, 333, 123_457])
def test_rounding_of_a_whole_duration_is_not_held_against_it(samples: int) -> None:
    # The product of a decimal step and a whole number is a few ulps off a whole number of steps.
    builder = PathBuilder((0.0, 0.0, 0.0), 0.001)
    builder.add(LinePlan(length=1.0, duration=samples * 0.001))
    assert builder.samples == samples


@pytest.mark.parametrize(
    ("plan", "field"),
    [
        (LinePlan(length=1.0, duration=(MAX_SAMPLES + 1) * 0.001), "duration"),
        (LinePlan(length=1.0, speed=1 / ((MAX_SAMPLES + 1) * 0.001)), "speed"),
    ],
    ids=["duration", "speed"],
)
def test_segment_of_too_many_samples_is_refused(plan: LinePlan, field: str) -> None:
    error = refusal(plan)
    assert error.field == field
    assert str(MAX_SAMPLES) in str(error)


def test_segments_that_together_take_too_many_samples_are_refused() -> None:
    builder = PathBuilder((0.0, 0.0, 0.0), 0.001)
    builder.add(LinePlan(length=1.0, duration=MAX_SAMPLES * 0.001))
    with pytest.raises(PathError, match=f"{MAX_SAMPLES + 1} samples"):
        builder.add(LinePlan(length=1.0, duration=0.001))


def test_path_without_segments_is_refused() -> None:
    with pytest.raises(PathError, match="no segments"):
        build_reference("nothing", ORIGIN, [], 0.001)


def test_segment_of_a_wrong_time_is_there_for_what_comes_after_it() -> None:
    builder = PathBuilder((0.0, 0.0, 0.0), 0.001)
    with pytest.raises(SamplesError):
        builder.add(LinePlan(length=1.0, duration=0.0123))
    builder.add(ArcPlan(math.pi / 2, "left", center=(1.0, 1.0), duration=0.01))
    assert builder.gap() == pytest.approx(math.hypot(2, 1), abs=1e-12)


def test_refused_segment_leaves_the_path_as_it_was() -> None:
    builder = PathBuilder((0.0, 0.0, 0.0), 0.001)
    builder.add(LinePlan(length=1.0, duration=0.01))
    with pytest.raises(PathError):
        builder.add(LinePlan(to=(5.0, 5.0), duration=0.01))
    assert (builder.samples, builder.gap()) == (10, 1.0)


DT = 0.01
positions = st.floats(-100, 100)
angles = st.floats(-20, 20)
poses = st.tuples(positions, positions, angles)
moves = st.lists(
    st.builds(
        Move,
        size=st.floats(0.1, 20),
        sweep=st.floats(0.01, 7),
        turn=st.sampled_from(["left", "right", None]),
        steps=st.integers(1, 12),
    ),
    min_size=1,
    max_size=6,
)


def rows(reference: Reference) -> Floats:
    """The poses, shape (n + 1, 3)."""
    return np.column_stack([reference.x, reference.y, reference.heading])


@given(start=poses, path=moves)
@settings(max_examples=100, deadline=None)
def test_relative_segments_equal_their_absolute_counterparts(start: Pose, path: list[Move]) -> None:
    relative = build_reference("relative", start, relative_plans(path, DT), DT)
    absolute = build_reference("absolute", start, absolute_plans(start, path, DT), DT)
    np.testing.assert_allclose(rows(relative), rows(absolute), rtol=0, atol=1e-9)


@given(start=poses, path=moves, turn=angles, shift=st.tuples(positions, positions))
@settings(max_examples=100, deadline=None)
def test_moving_the_plan_rigidly_moves_the_path_with_it(
    start: Pose, path: list[Move], turn: float, shift: tuple[float, float]
) -> None:
    turning, offset = cmath.exp(1j * turn), complex(*shift)
    moved_start = complex(start[0], start[1]) * turning + offset
    new_start = (moved_start.real, moved_start.imag, start[2] + turn)

    before = build_reference("here", start, absolute_plans(start, path, DT), DT)
    after = build_reference("there", new_start, absolute_plans(new_start, path, DT), DT)

    expected = (before.x + 1j * before.y) * turning + offset
    np.testing.assert_allclose(after.x, expected.real, rtol=0, atol=1e-9)
    np.testing.assert_allclose(after.y, expected.imag, rtol=0, atol=1e-9)
    np.testing.assert_allclose(after.heading, before.heading + turn, rtol=0, atol=1e-9)
    assert after.segment_ends == before.segment_ends


@given(start=poses, path=moves)
@settings(max_examples=100, deadline=None)
def test_speed_is_constant_within_every_segment(start: Pose, path: list[Move]) -> None:
    reference = build_reference("path", start, relative_plans(path, DT), DT)
    chords = np.hypot(np.diff(reference.x), np.diff(reference.y))
    first = 0
    for move, end in zip(path, reference.segment_ends, strict=True):
        # A line of length L in m steps, or an arc: chords of 2 r sin(sweep / 2m).
        expected = (
            move.size / move.steps
            if move.turn is None
            else 2 * move.size * abs(math.sin(move.sweep / (2 * move.steps)))
        )
        np.testing.assert_allclose(chords[first:end], expected, rtol=0, atol=1e-9)
        first = end
    assert first == reference.samples


@given(start=poses, path=moves)
@settings(max_examples=100, deadline=None)
def test_first_sample_is_the_start_to_the_last_bit(start: Pose, path: list[Move]) -> None:
    reference = build_reference("path", start, relative_plans(path, DT), DT)
    assert tuple(rows(reference)[0].tolist()) == start


def test_clothoid_backward_is_the_one_ahead_turned_around_its_start() -> None:
    """Abramowitz and Stegun 1964, 7.3: the Fresnel integrals C and S."""
    length, curvature = 2.0, 0.6
    path = build_reference(
        "back", (0, 0, 0), [ClothoidPlan(length, curvature, 0.0, 2.0, reverse=True)], 0.1
    )
    s = np.linspace(0, length, 21)
    scale = math.sqrt(math.pi * length / curvature)
    sines, cosines = fresnel(s / scale)
    np.testing.assert_allclose(path.x, -scale * cosines, atol=1e-12)
    np.testing.assert_allclose(path.y, -scale * sines, atol=1e-12)
    np.testing.assert_allclose(path.heading, curvature * s**2 / (2 * length), atol=1e-12)


@pytest.mark.parametrize("stop", [[], [StopPlan(1.0)]])
@pytest.mark.parametrize("arc_back", [False, True])
@pytest.mark.parametrize("back", [False, True])
def test_clothoid_goes_on_with_the_wheels_as_they_are(
    stop: list[StopPlan], arc_back: bool, back: bool
) -> None:
    # Where the robot turns round, wheels that are steered to the left turn it to the right.
    arc = ArcPlan(1.0, "left", radius=2.0, duration=1.0, reverse=arc_back)
    clothoid = ClothoidPlan(1.0, 0.0, duration=1.0, reverse=back)
    path = build_reference("on", (0, 0, 0), [arc, *stop, clothoid], 0.1)
    side = 1 if arc_back == back else -1
    assert path.heading[-1] == pytest.approx(1.0 + side * 0.5 * 1.0 / 2, abs=1e-12)
