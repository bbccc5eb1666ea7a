"""Made-up references: forth, a stop, a turn in place, a clothoid, and back in reverse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hilc_cli.reference.sampled import Floats, Reference

SAMPLE_TIME = 0.02  # [s]
Piece = tuple[str, Floats, Floats]
"""Kind of a segment, and speed [m/s] and yaw rate [rad/s] of each of its steps."""


def steady(kind: str, steps: int, speed: float, yaw_rate: float) -> Piece:
    """A segment of constant speeds."""
    return kind, np.full(steps, speed), np.full(steps, yaw_rate)


def driven(pieces: Sequence[Piece]) -> tuple[Reference, list[str]]:
    """A reference made of exact arcs, and the names of its segments.

    The chord of an arc points along the mean of the headings at its ends, and is shorter than the
    arc by the sine of half its angle.
    """
    poses = [(0.0, 0.0, 0.0)]
    ends, lengths = [], []
    for _, speeds, yaw_rates in pieces:
        for speed, yaw_rate in zip(speeds.tolist(), yaw_rates.tolist(), strict=True):
            x, y, heading = poses[-1]
            half = yaw_rate * SAMPLE_TIME / 2
            chord = speed * SAMPLE_TIME * (float(np.sin(half)) / half if half else 1.0)
            along = heading + half
            poses.append(
                (
                    x + chord * float(np.cos(along)),
                    y + chord * float(np.sin(along)),
                    heading + 2 * half,
                )
            )
        ends.append(len(poses) - 1)
        lengths.append(float(np.abs(speeds).sum()) * SAMPLE_TIME)
    x, y, heading = np.array(poses).T
    none = (0.0,) * len(pieces)
    reference = Reference("made-up", SAMPLE_TIME, x, y, heading, tuple(ends), tuple(lengths), none)
    return reference, [f"segments.{index}.{kind}" for index, (kind, _, _) in enumerate(pieces)]


def clothoid(steps: int, speed: float, last: float) -> Piece:
    """A segment whose curvature grows from 0 to a last one [1/m], at constant speed."""
    curvature = (np.arange(steps) + 0.5) / steps * last
    return "clothoid", np.full(steps, speed), speed * curvature


FORTH_AND_BACK = (
    steady("line", 100, 1.0, 0.0),
    steady("stop", 50, 0.0, 0.0),
    steady("turn", 50, 0.0, np.pi / 2),
    clothoid(100, 0.5, 2.0),
    steady("arc", 50, 0.5, 1.0),
    steady("arc", 100, -0.8, 0.4),
    steady("line", 50, -0.4, 0.0),
)
