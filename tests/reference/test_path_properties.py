"""Properties of random paths."""

from __future__ import annotations

import cmath
import math

import numpy as np
from hypothesis import given, settings, strategies as st

from hilc_cli.reference.path import build_reference
from hilc_cli.reference.sampled import Floats, Reference
from tests.reference.paths import Move, Pose, absolute_plans, relative_plans

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
