"""What the tracking controller without learning does along the very path of an experiment.

The point of rest of `tracking_loop` is where a line or a circle that lasts would leave the
platform; most arcs are too short for it. Here the path is driven instead, nonlinear and within the
limit: once undisturbed, once from the trajectory's own start, and with disturbances by many seeds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hilc_cli.analysis.expected_error import LEVEL, ExpectedError
from hilc_cli.analysis.many_passes import SEEDS, Kind, ManyWheels, many_passes
from hilc_cli.analysis.open_loop import unlearned_error
from hilc_cli.analysis.start import in_second_half, joined
from hilc_cli.analysis.wheel_noise import WheelNoise
from hilc_cli.disturbance.streams import Disturbance, Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.feedforward import reference_twist
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial

FAR = 0.01
"""Of the path's size: what is further off does not count as on the reference."""
_NUDGE = 1e-6  # of the path's size: an error so small that the response to it is linear
_STANDS = 1e-3  # of a wheel's speed in turning: who drives slower turns in place
_MOST_SAMPLES = 40_000  # some 8 s
_NONE = 1e-9  # [m and rad]; of a start that differs by less, by rounding only


@dataclass(frozen=True, slots=True)
class TrackingResponse:
    """One pass, which is any: they do not learn from each other.

    Attributes:
        error_m: Largest position error from the trajectory's own start, undisturbed [m].
        error_known_m: Likewise with the true platform as model [m].
        heading_error_rad: Likewise of the heading, where the reference stands [rad]; 0 if it
            nowhere does.
        standing_s: How long the reference turns in place or stands still [s].
        near_m: What counts as on the trajectory [m].
        start_off_m: Distance of the initial pose from the trajectory's start [m].
        is_off: Whether it, or its heading, differs from that at all.
        joins: First sample from which the pass from the initial pose is, for good, no further than
            `near_m` from the one from the trajectory's start; None if it is not by the end.
        end_off_m: How far from that it is at the end [m].
        later_off_m: Likewise in the second half, at most [m].
        samples: Number of the trajectory's sampling intervals.
        sample_time: d_t [s].
        unlearned_m: Position error of the believed feedforward from the initial pose [m].
        aside_left: Share that is left at the end of a small error to the side at the start.
        at_limit: Share of the samples at which the limit acts, undisturbed.
        expected: The error to be expected, with disturbances.
        wheels: What disturbances make of the wheel speeds; None without any.
    """

    error_m: float
    error_known_m: float
    heading_error_rad: float
    standing_s: float
    near_m: float
    start_off_m: float
    is_off: bool
    joins: int | None
    end_off_m: float
    later_off_m: float
    samples: int
    sample_time: float
    unlearned_m: float
    aside_left: float
    at_limit: float
    expected: ExpectedError
    wheels: WheelNoise | None

    @property
    def only_stands(self) -> bool:
        """Whether the reference goes nowhere, so that no side error can be steered away."""
        return self.standing_s > (self.samples - 0.5) * self.sample_time

    @property
    def joins_s(self) -> float | None:
        """`joins` in seconds."""
        return None if self.joins is None else self.joins * self.sample_time


def tracking_response(experiment: Experiment, law: FeedbackLaw) -> TrackingResponse:
    """The response of an experiment of the law, in its last iteration."""
    reference, start = experiment.reference, experiment.initial_pose
    own = float(reference.x[0]), float(reference.y[0]), float(reference.heading[0])
    # A path on the spot has no size, but who drives it has.
    size = max(reference.size, experiment.robot.half_track)
    nudge = _NUDGE * size
    aside = own[0] - nudge * math.sin(own[2]), own[1] + nudge * math.cos(own[2]), own[2]
    quiet, from_own, from_aside = (_undisturbed(experiment, pose) for pose in (start, own, aside))
    known = replace(experiment, law=replace(law, model=experiment.robot))
    between = _apart(quiet, from_own)
    near, off = FAR * size, max(abs(a - b) for a, b in zip(start, own, strict=True))
    standing = _standing(experiment)
    turned = np.abs(reference.heading - from_own.heading)[1:][standing]
    expected, wheels = _disturbed(experiment, law, _furthest(experiment, quiet))
    return TrackingResponse(
        _furthest(experiment, from_own),
        _furthest(experiment, _undisturbed(known, own)),
        float(turned.max()) if len(turned) else 0.0,
        float(standing.sum()) * reference.sample_time,
        near,
        float(between[0]),
        off > _NONE,
        joined(between, near),
        float(between[-1]),
        in_second_half(between),
        reference.samples,
        reference.sample_time,
        unlearned_error(experiment, law.model),
        float(_apart(from_own, from_aside)[-1]) / nudge,
        quiet.saturated_samples / reference.samples,
        expected,
        wheels,
    )


def _undisturbed(experiment: Experiment, start: Triple | None = None) -> Trial:
    """The last iteration from a start; of infinite errors if it leaves the finite numbers."""
    undisturbed = replace(
        experiment,
        initial_pose=experiment.initial_pose if start is None else start,
        iterations=min(experiment.iterations, 1),
        disturbance=Disturbance(),
    )
    try:
        *_, last = simulate(undisturbed)
    except DivergedError:
        nowhere = np.full(experiment.reference.samples + 1, math.inf)
        return Trial(0, nowhere, nowhere, nowhere, nowhere[1:], nowhere[1:])
    return last


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


def _disturbed(
    experiment: Experiment, law: FeedbackLaw, final: float
) -> tuple[ExpectedError, WheelNoise | None]:
    """What disturbances make of the error, and of the wheel speeds.

    Args:
        experiment: The experiment.
        law: Its law.
        final: Largest position error of the last iteration without them [m].
    """
    source, first = experiment.disturbance, final
    opens = not experiment.learn_in_first
    if opens and experiment.iterations:
        first = _furthest(experiment, _undisturbed(replace(experiment, iterations=0)))
    each = source.initial_pose.active, source.output.active, source.state.active
    if not any(each):
        return ExpectedError(first, final, final), None
    if experiment.reference.samples > _MOST_SAMPLES:
        unsure = f"passes with disturbances are not followed over more than {_MOST_SAMPLES} samples"
        return ExpectedError(first, final, final, unsure=unsure), None
    wheels = _open_loop(experiment) if opens and not experiment.iterations else None
    kinds = [Kind(), Kind(state=True, output=True, initial_pose=True, count=SEEDS)]
    alone = Kind(initial_pose=True), Kind(output=True), Kind(state=True)
    if sum(each) > 1:
        kinds += [replace(kind, count=SEEDS) for kind, has in zip(alone, each, strict=True) if has]
    quiet, *passes = many_passes(experiment, wheels or _many_wheels(experiment, law), kinds)
    reached = [max(final, float(np.quantile(kind.position_m, LEVEL))) for kind in passes]
    parts = iter(reached[1:] or reached)
    of_start, of_readings, of_state = (next(parts) - final if has else 0.0 for has in each)
    expected = ExpectedError(first, final, reached[0], of_start, of_readings, of_state)
    columns = ((quiet.change_rad_s, quiet.at_limit), (passes[0].change_rad_s, passes[0].at_limit))
    return expected, WheelNoise.of_seeds(*map(np.concatenate, zip(*columns, strict=True)))


def _furthest(experiment: Experiment, trial: Trial) -> float:
    """Largest position error of a pass [m]."""
    reference = experiment.reference
    return float(np.hypot(reference.x - trial.x, reference.y - trial.y).max())


def _apart(one: Trial, other: Trial) -> Floats:
    """Distance between two passes [m], shape (n + 1,)."""
    distance: Floats = np.hypot(one.x - other.x, one.y - other.y)
    return distance


def _standing(experiment: Experiment) -> NDArray[np.bool_]:
    """Steps in which the reference turns in place or stands still, shape (n,)."""
    speed, yaw_rate = reference_twist(experiment.reference)
    standing: NDArray[np.bool_] = speed <= _STANDS * experiment.robot.half_track * np.abs(yaw_rate)
    return standing
