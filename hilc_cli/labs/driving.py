"""The controller of a pass, line by line: a pose comes in, wheel speeds go out, within all limits.

Whatever comes in, each line gets one answer, and no answer is beyond the limits. A line that is no
pose, or that comes late, ends the pass: from then on the wheels are brought to rest.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator
from contextlib import suppress
from typing import BinaryIO

import numpy as np

from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.laws.law import Plan
from hilc_cli.plants.kinematic import limit_wheel_speeds
from hilc_cli.reference.sampled import Floats, Reference

LONGEST_LINE = 1000
"""Bytes; no pose has more."""
_LATE = 2
"""A line so many samples behind its time is late: what was to be sent meanwhile was not."""
_LARGEST = 1e9  # [m, rad or s]; what is larger is no pose

Pair = tuple[float, float]


class Drive:
    """One pass over a plan, whoever drives.

    Attributes:
        stopped: Why the pass was ended before its time; empty as long as it was not.
    """

    def __init__(self, plan: Plan, reference: Reference, limits: SafetyLimits) -> None:
        """Begins at rest.

        Args:
            plan: What is to be sent, with its feedback if it has one, from the lead-in on.
            reference: What errors are told against, lead-in included, n samples.
            limits: Of every answer.
        """
        self.stopped = ""
        self._limits = limits
        self._sample_time = reference.sample_time
        self._step = limits.step(reference.sample_time)
        self._samples = reference.samples
        self._controller = plan.controller(reference)
        self._poses = reference.poses.tolist()
        self._first = plan.lead_in - plan.shortest.lead_in
        for k in range(self._first):
            self._wanted(k, self._poses[k])  # which a law may count
        self._next = self._first
        self._last: Pair = (0.0, 0.0)
        self._lines: list[tuple[float, float, float, float]] = []
        self._sent: list[Pair] = []

    # --- line by line

    def answer(self, line: bytes) -> Pair:
        """Returns left and right wheel speed [rad/s] for a line ``t x y heading``."""
        if not self.stopped:
            pose = _parsed(line)
            if pose is None:
                self.stopped = "a line was no pose; it must be 't x y heading', SI units"
            elif self._is_in_time(pose[0]):
                return self._driven(*pose)
        return self._towards_rest()

    def ramp(self) -> Iterator[Pair]:
        """Yields what brings the wheels to rest, where nobody asks any more; nothing at rest."""
        while self._last != (0.0, 0.0):
            yield self._towards_rest()

    def _is_in_time(self, t: float) -> bool:
        """Whether a line comes when its sample is due; else the pass is stopped."""
        if not self._lines:
            return True
        before = self._lines[-1][0]
        if t <= before:
            self.stopped = f"the time went from {before:g} to {t:g} s; it must rise"
            return False
        behind = self._behind(t)
        if behind >= _LATE and self._next <= self._samples:
            self.stopped = f"the line of {t:g} s was late by {behind:.3g} samples"
            return False
        return True

    def _behind(self, t: float) -> float:
        """Samples by which the next one was due before a time."""
        if not self._lines:
            return 0.0
        return (t - self._lines[0][0]) / self._sample_time - (self._next - self._first)

    def _driven(self, t: float, x: float, y: float, heading: float) -> Pair:
        """The answer of a pass that goes on."""
        near = self._lines[-1][3] if self._lines else self._poses[self._first][2]
        heading += 2 * math.pi * round((near - heading) / (2 * math.pi))
        behind = self._behind(t)
        self._lines.append((t, x, y, heading))
        if behind <= -1:  # a robot that asks faster than agreed gets the same answer again
            self._sent.append(self._last)
            return self._last
        pose = [x, y, heading]
        if behind >= 1 and self._next < self._samples:  # one that is slower misses a sample
            self._wanted(self._next, pose)
            self._next += 1
        k = self._next
        self._next += 1
        if k >= self._samples:
            answer = self._towards_rest()
        else:
            answer = self._limited(k, *self._wanted(k, pose))
        self._sent.append(answer)
        return answer

    def _wanted(self, k: int, pose: list[float]) -> Pair:
        """What the controller wants at a sample."""
        x, y, heading = pose
        to_x, to_y, to_heading = self._poses[k]
        return self._controller(
            k, math.cos(heading), math.sin(heading), to_x - x, to_y - y, to_heading - heading
        )

    def _limited(self, k: int, left: float, right: float) -> Pair:
        """The nearest answer within the limits."""
        if not (math.isfinite(left) and math.isfinite(right)):
            self.stopped = f"the controller wants no finite speed at sample {k}"
            return self._towards_rest()
        left, right = limit_wheel_speeds(left, right, self._limits.wheel_speed)
        if math.isfinite(self._step):
            step, most = self._step, math.inf
            if self._limits.stop_at_end:
                most = step * (self._samples - k)  # from which the end is reached at rest
            before_left, before_right = self._last
            left = min(max(left, before_left - step, -most), before_left + step, most)
            right = min(max(right, before_right - step, -most), before_right + step, most)
        self._last = (left, right)
        return self._last

    def _towards_rest(self) -> Pair:
        left, right = self._last
        step = self._limits.wheel_acceleration * self._sample_time
        if math.isfinite(step):
            self._last = (_nearer_rest(left, step), _nearer_rest(right, step))
        else:
            self._last = (0.0, 0.0)
        return self._last

    # --- what came of it

    @property
    def is_whole(self) -> bool:
        """Whether the pass has come to its end; where the last pose is missing it is at rest."""
        return not self.stopped and self._next >= self._samples

    @property
    def progress(self) -> str:
        """How many of the plan's samples were driven."""
        whole = self._samples - self._first
        return f"{min(self._next - self._first, whole)} of {whole} samples"

    @property
    def start_time(self) -> float:
        """When the plan began, in the clock of the lines [s]; its lead-in is before that."""
        return self._lines[0][0] - self._first * self._sample_time

    @property
    def log(self) -> tuple[Floats, Floats, Floats]:
        """Times [s], shape (m,), poses, shape (m, 3), and answers [rad/s], shape (m, 2)."""
        lines = np.array(self._lines).reshape(-1, 4)
        return lines[:, 0], lines[:, 1:], np.array(self._sent).reshape(-1, 2)


def serve(drive: Drive, lines: BinaryIO, answers: BinaryIO) -> None:
    """Answers each line until there is none any more, then brings the wheels to rest.

    Args:
        drive: The pass.
        lines: Poses; a last line without an end is none.
        answers: Where wheel speeds go, a line each, at once.
    """

    def tell(pair: Pair) -> None:
        answers.write(b"%r %r\n" % pair)
        answers.flush()

    gc.disable()  # which would take milliseconds now and then
    try:
        for line in _whole_lines(lines):
            tell(drive.answer(line))
    except BrokenPipeError:
        drive.stopped = drive.stopped or "nobody took the answers any more"
    finally:
        gc.enable()
        with suppress(BrokenPipeError):
            for pair in drive.ramp():
                tell(pair)


def _whole_lines(stream: BinaryIO) -> Iterator[bytes]:
    """Lines with an end, of which what is too long for a pose is left out."""
    while line := stream.readline(LONGEST_LINE + 1):
        ends = line.endswith(b"\n")
        rest = line
        while not rest.endswith(b"\n") and (rest := stream.readline(LONGEST_LINE)):
            ends = rest.endswith(b"\n")
        if ends:
            yield line


def _parsed(line: bytes) -> tuple[float, float, float, float] | None:
    """Time and pose of a line; None if it is something else."""
    if len(line) > LONGEST_LINE:
        return None
    try:
        t, x, y, heading = map(float, line.split())
    except ValueError:
        return None
    pose = (t, x, y, heading)
    return pose if all(abs(number) <= _LARGEST for number in pose) else None


def _nearer_rest(speed: float, step: float) -> float:
    return math.copysign(max(abs(speed) - step, 0.0), speed) if abs(speed) > step else 0.0
