"""What the tracking controller without learning does along the very path of an experiment.

The point of rest of `tracking_loop` is where a line or a circle that lasts would leave the
platform; most arcs are too short for it. Here the path is driven instead, nonlinear and within the
limit: once undisturbed, once from the trajectory's own start, and with disturbances by many seeds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.analysis.expected_error import LEVEL, ExpectedError
from hilc_cli.analysis.many_passes import SEEDS, Kind, ManyWheels, Passes, many_passes
from hilc_cli.analysis.wheel_noise import WheelNoise
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.feedforward import reference_twist
from hilc_cli.reference.sampled import Floats

FAR = 0.01
"""Of the path's size: what is further off does not count as on the reference."""
_NUDGE = 1e-6  # of the path's size: an error so small that the response to it is linear
_STANDS = 1e-3  # of a wheel's speed in turning: who drives slower turns in place
_NONE = 1e-9  # [m and rad]; of a start that differs by less, by rounding only


@dataclass(frozen=True, slots=True)
class TrackingResponse:
    """One pass, which is any: they do not learn from each other.

    Attributes:
        error_m: Largest position error from the trajectory's own start, undisturbed [m].
        heading_error_rad: Likewise of the heading, where the reference stands [rad]; 0 if it
            nowhere does.
        standing_s: How long the reference turns in place or stands still [s].
        near_m: What counts as on the trajectory [m].
        start_off_m: Distance of the initial pose from the trajectory's start [m].
        is_off: Whether it, or its heading, differs from that at all.
        joins_s: When the pass from the initial pose is, for good, no further than `near_m` from
            the one from the trajectory's start [s]; None if it is not by the end.
        end_off_m: How far from that it is at the end [m].
        aside_left: Share that is left at the end of a small error to the side at the start.
        at_limit: Share of the samples at which the limit acts, undisturbed.
        expected: The error to be expected, with disturbances.
        wheels: What disturbances make of the wheel speeds; None without any.
    """

    error_m: float
    heading_error_rad: float
    standing_s: float
    near_m: float
    start_off_m: float
    is_off: bool
    joins_s: float | None
    end_off_m: float
    aside_left: float
    at_limit: float
    expected: ExpectedError
    wheels: WheelNoise | None


def tracking_response(experiment: Experiment, law: FeedbackLaw) -> TrackingResponse:
    """The response of an experiment of the law, in its last iteration."""
    reference, start = experiment.reference, experiment.initial_pose
    own = float(reference.x[0]), float(reference.y[0]), float(reference.heading[0])
    # A path on the spot has no size, but who drives it has.
    size = max(reference.size, experiment.robot.half_track)
    nudge = _NUDGE * size
    aside = own[0] - nudge * math.sin(own[2]), own[1] + nudge * math.cos(own[2]), own[2]
    opens = not experiment.iterations and not experiment.learn_in_first
    wheels = _open_loop(experiment) if opens else _many_wheels(experiment, law)
    quiet, from_own, from_aside, *disturbed = many_passes(
        experiment, wheels, [Kind(start), Kind(own), Kind(aside), *_disturbed(experiment)]
    )
    first = float(quiet.position_m[0])
    if experiment.iterations and not experiment.learn_in_first:
        (before,) = many_passes(experiment, _open_loop(experiment), [Kind(start)])
        first = float(before.position_m[0])
    between = _apart(quiet, from_own)
    near, off = FAR * size, max(abs(a - b) for a, b in zip(start, own, strict=True))
    standing = _standing(experiment)
    turned = np.abs(reference.heading - from_own.poses[:, 2])[1:][standing]
    return TrackingResponse(
        float(from_own.position_m[0]),
        float(turned.max()) if len(turned) else 0.0,
        float(standing.sum()) * reference.sample_time,
        near,
        float(between[0]),
        off > _NONE,
        _joined(between, near, reference.sample_time),
        float(between[-1]),
        float(_apart(from_own, from_aside)[-1]) / nudge,
        float(quiet.at_limit[0]),
        _expected(experiment, first, quiet, disturbed),
        WheelNoise.of(quiet, disturbed[0]) if disturbed else None,
    )


def _many_wheels(experiment: Experiment, law: FeedbackLaw) -> ManyWheels:
    twists = np.stack(reference_twist(experiment.reference), axis=1).tolist()

    def wheels(
        k: int, cos: Floats, sin: Floats, error_x: Floats, error_y: Floats, error_heading: Floats
    ) -> tuple[Floats, Floats]:
        turned = np.cos(error_heading), np.sin(error_heading)
        return law.wheel_speeds(tuple(twists[k]), (cos, sin), (error_x, error_y), turned)

    return wheels


def _open_loop(experiment: Experiment) -> ManyWheels:
    """The initial input, which is all that a single open-loop iteration runs."""
    left, right = experiment.initial_left.tolist(), experiment.initial_right.tolist()

    def wheels(
        k: int, cos: Floats, sin: Floats, error_x: Floats, error_y: Floats, error_heading: Floats
    ) -> tuple[Floats, Floats]:
        return np.full_like(cos, left[k]), np.full_like(cos, right[k])

    return wheels


def _disturbed(experiment: Experiment) -> list[Kind]:
    """All disturbances together, then those that there are one by one, if several."""
    source, start = experiment.disturbance, experiment.initial_pose
    active = source.initial_pose.active, source.output.active, source.state.active
    if not any(active):
        return []
    together = Kind(start, state=True, output=True, initial_pose=True, count=SEEDS)
    if sum(active) == 1:
        return [together]
    alone = [
        Kind(start, initial_pose=True, count=SEEDS),
        Kind(start, output=True, count=SEEDS),
        Kind(start, state=True, count=SEEDS),
    ]
    return [together, *(kind for kind, is_active in zip(alone, active, strict=True) if is_active)]


def _expected(
    experiment: Experiment, first: float, quiet: Passes, disturbed: list[Passes]
) -> ExpectedError:
    source, final = experiment.disturbance, float(quiet.position_m[0])
    if not disturbed:
        return ExpectedError(first, final, final)
    reached = [max(final, float(np.quantile(kind.position_m, LEVEL))) for kind in disturbed]
    alone = iter(reached[1:] or reached)
    of_start, of_readings, of_state = (
        next(alone) - final if each.active else 0.0
        for each in (source.initial_pose, source.output, source.state)
    )
    return ExpectedError(first, final, reached[0], of_start, of_readings, of_state)


def _apart(one: Passes, other: Passes) -> Floats:
    """Distance of the first pass of two kinds [m], shape (n + 1,)."""
    away = one.poses - other.poses
    distance: Floats = np.hypot(away[:, 0], away[:, 1])
    return distance


def _joined(between: Floats, near: float, sample_time: float) -> float | None:
    """From when on a distance stays within a bound [s]."""
    far = np.flatnonzero(~(between <= near))
    first = int(far[-1]) + 1 if len(far) else 0
    return first * sample_time if first < len(between) else None


def _standing(experiment: Experiment) -> NDArray[np.bool_]:
    """Steps in which the reference turns in place or stands still, shape (n,)."""
    speed, yaw_rate = reference_twist(experiment.reference)
    standing: NDArray[np.bool_] = speed <= _STANDS * experiment.robot.half_track * np.abs(yaw_rate)
    return standing
