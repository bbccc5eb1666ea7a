"""The line protocol: one answer a line, in time, and never beyond the limits."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.labs.driving import LONGEST_LINE, Drive, serve
from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Reference

DT = 0.1
N = 20
SPEED, ACCELERATION = 5.0, 10.0
STEP = ACCELERATION * DT


def reference() -> Reference:
    x = np.linspace(0.0, 1.0, N + 1)
    return Reference("line", DT, x, np.zeros(N + 1), np.zeros(N + 1))


def drive(
    gain: float = 0.0, *, speed: float = 2.0, lead_in: int = 0, limits: SafetyLimits | None = None
) -> Drive:
    """Wheels that turn evenly, and a feedback to the position along and across the line."""
    left = np.full(N, speed)
    left[:lead_in] = 0.0
    gains = np.zeros((N, 2, 3))
    gains[:, 0, 0] = gains[:, 1, 0] = gains[:, 0, 1] = gain
    gains[:, 1, 1] = -gain
    plan = Plan(left, left.copy(), reference().poses, gains if gain else None, lead_in=lead_in)
    return Drive(plan, reference(), limits or SafetyLimits(SPEED, ACCELERATION))


def answers_to(source: Drive, lines: bytes) -> list[tuple[float, float]]:
    sink = io.BytesIO()
    serve(source, io.BytesIO(lines), sink)
    rows = [row.split() for row in sink.getvalue().decode().splitlines()]
    return [(float(left), float(right)) for left, right in rows]


def line(t: float, x: float = 0.0, y: float = 0.0, heading: float = 0.0) -> bytes:
    return f"{t!r} {x!r} {y!r} {heading!r}\n".encode()


def whole_pass() -> bytes:
    return b"".join(line(100.0 + k * DT, k / N) for k in range(N + 1))


numbers = st.floats(allow_nan=True, allow_infinity=True) | st.floats(-2, 2)
good = st.builds(line, st.floats(0, 3), numbers, numbers, numbers)
rubbish = st.binary(max_size=60).map(lambda junk: junk.replace(b"\n", b" ") + b"\n")
timed = st.lists(st.floats(0.02, 0.25), max_size=40).map(
    lambda steps: [line(sum(steps[:k]), k / N, 0.3) for k in range(len(steps))]
)
any_lines = st.lists(good | rubbish, max_size=40) | timed | st.just([whole_pass()])


@given(any_lines, st.floats(0, 100), st.floats(0.5, 20), st.floats(0.1, 50) | st.just(math.inf))
def test_one_answer_a_line_and_none_beyond_the_limits(
    lines: list[bytes], gain: float, speed: float, acceleration: float
) -> None:
    sent = b"".join(lines)
    limits = SafetyLimits(SPEED, acceleration)
    source = drive(gain, speed=speed, limits=limits)
    sink = io.BytesIO()
    serve(source, io.BytesIO(sent), sink)
    rows = sink.getvalue().splitlines()
    answers = np.array([row.split() for row in rows], dtype=float).reshape(-1, 2)
    assert len(rows) >= sent.count(b"\n")
    assert (np.abs(answers) <= SPEED).all()
    assert (np.abs(np.diff(answers, axis=0, prepend=0.0)) <= acceleration * DT * (1 + 1e-12)).all()
    # What comes after the last line brings the wheels to rest, and no more than that.
    if len(answers):
        assert (answers[-1] == 0).all()
    ramp = answers[sent.count(b"\n") - 1 :]
    assert (np.diff(np.abs(ramp), axis=0) <= 0).all() or not sent


def test_a_whole_pass_is_answered_line_by_line() -> None:
    source = drive()
    answers = answers_to(source, whole_pass())
    # Within 1 rad/s a sample from rest to 2 rad/s, and to rest again at the last line.
    left = [pair[0] for pair in answers]
    assert left == pytest.approx([1.0, *[2.0] * 17, 1.0 * 2, 1.0, 0.0], abs=1e-6)
    assert source.is_whole and not source.stopped
    times, poses, sent = source.log
    assert times.tolist() == [100.0 + k * DT for k in range(N + 1)]
    assert source.start_time == 100.0
    np.testing.assert_array_equal(sent, answers)
    assert poses.shape == (N + 1, 3)


def test_the_first_line_answers_where_the_plan_begins() -> None:
    source = drive(lead_in=4)
    answers = answers_to(source, whole_pass()[: -len(line(100.0)) * 4])
    assert answers[0][0] == pytest.approx(1.0)
    # Nothing is to be sent in the four samples of the lead-in; the line is of the fifth.
    assert source.start_time == pytest.approx(100.0 - 4 * DT)


def test_feedback_answers_to_the_pose() -> None:
    (left, right), *_ = answers_to(drive(3.0), line(0.0, -0.1, -0.2))
    # 2 rad/s, and gains of 3 times 0.1 m ahead and 0.2 m to the left, within 1 rad/s from rest.
    assert (left, right) == pytest.approx((1.0, 1.0), abs=1e-6)
    free = SafetyLimits(SPEED)
    (left, right), *_ = answers_to(drive(3.0, limits=free), line(0.0, -0.1, -0.2))
    assert (left, right) == pytest.approx((2 + 0.3 + 0.6, 2 + 0.3 - 0.6))


def test_headings_may_wrap() -> None:
    far = [line(k * DT, k / N, 0.0, 2 * math.pi * k) for k in range(N + 1)]
    assert answers_to(drive(1.0), b"".join(far)) == answers_to(
        drive(1.0), b"".join(line(k * DT, k / N) for k in range(N + 1))
    )


@pytest.mark.parametrize(
    ("last", "reason"),
    [
        (b"hello\n", "a line was no pose; it must be 't x y heading', SI units"),
        (b"\n", "a line was no pose"),
        (b"0.5 1 2\n", "a line was no pose"),
        (b"0.5 nan 0 0\n", "a line was no pose"),
        (b"0.5 1e300 0 0\n", "a line was no pose"),
        (b"0.5 \xff 0 0\n", "a line was no pose"),
        (b"0.5" + b" " * LONGEST_LINE + b"0 0 0\n", "a line was no pose"),
        (line(0.35), "the time went from 0.4 to 0.35 s; it must rise"),
        (line(0.4), "the time went from 0.4 to 0.4 s; it must rise"),
        (line(0.71), "the line of 0.71 s was late by 2.1 samples"),
    ],
)
def test_what_ends_a_pass_brings_the_wheels_to_rest(last: bytes, reason: str) -> None:
    before = b"".join(line(k * DT, k / N) for k in range(5))
    after = b"".join(line(k * DT, k / N) for k in range(8, 12))
    source = drive()
    answers = answers_to(source, before + last + after)
    assert source.stopped.startswith(reason)
    assert not source.is_whole
    left = [pair[0] for pair in answers]
    assert left == pytest.approx([1, 2, 2, 2, 2, 1, 0, 0, 0, 0], abs=1e-6)


def test_without_a_limit_of_acceleration_wheels_stop_at_once() -> None:
    source = drive(limits=SafetyLimits(SPEED))
    assert [left for left, _ in answers_to(source, line(0.0) + b"?\n")] == [2.0, 0.0]


def test_the_end_of_the_input_brings_the_wheels_to_rest() -> None:
    source = drive()
    answers = answers_to(source, b"".join(line(k * DT, k / N) for k in range(5)) + b"0.5 0 0")
    assert [left for left, _ in answers] == pytest.approx([1, 2, 2, 2, 2, 1, 0], abs=1e-6)
    assert not source.is_whole and not source.stopped


def test_a_slower_robot_misses_samples_and_a_faster_one_gets_answers_twice() -> None:
    rising = Plan(np.arange(N) / 10, np.arange(N) / 10, reference().poses)
    free = SafetyLimits(SPEED)
    slow = Drive(rising, reference(), free)
    left = [slow.answer(line(k * 1.1 * DT, k / N))[0] for k in range(19)]
    assert not slow.stopped
    # It is a whole sample behind after 10 lines: one is left out.
    assert np.diff(left).round(6).tolist() == [0.1] * 9 + [0.2] + [0.1] * 8
    fast = Drive(rising, reference(), free)
    left = [fast.answer(line(k * 0.5 * DT, k / N))[0] for k in range(2 * N - 2)]
    assert not fast.stopped and left == sorted(left) and len(set(left)) == N


def test_a_controller_that_wants_no_number_is_stopped() -> None:
    plan = Plan(np.ones(N), np.ones(N), reference().poses, lambda *_: (math.nan, 1.0))
    source = Drive(plan, reference(), SafetyLimits(SPEED, ACCELERATION))
    assert answers_to(source, line(0.0)) == [(0.0, 0.0)]
    assert source.stopped == "the controller wants no finite speed at sample 0"
