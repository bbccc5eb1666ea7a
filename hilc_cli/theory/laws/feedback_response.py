"""What the tracking controller without learning does along the very path of an experiment.

The point of rest of `feedback` is where a line or a circle that lasts would leave the
platform; most arcs are too short for it. Here the path is driven instead, nonlinear and within the
limit: once undisturbed, once from the trajectory's own start, and with disturbances by many seeds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Bounded, Disturbance, Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import advance, feedforward, reference_twist, step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.theory.findings import LEVEL, SOURCES, ExpectedError, Rows, active_sources
from hilc_cli.theory.matrices import starts_off
from hilc_cli.theory.noise import NoiseDraws, Passes, open_loop_error
from hilc_cli.theory.reach import WayIn, way_in
from hilc_cli.theory.wheel_noise import WheelNoise

ManyWheels = Callable[[int, Floats, Floats, Floats, Floats, Floats], tuple[Floats, Floats]]
"""A `WheelController` of many passes at once, shape (passes,) each."""
Kind = frozenset[str]
"""Which of its disturbances a pass has: ``initial_pose``, ``output``, ``state``."""

SEEDS = 100
"""Passes of each kind that is disturbed; of the other one there is one."""
_BLOCK = 64  # samples whose disturbances are drawn at once


@np.errstate(over="ignore", invalid="ignore")
def many_passes(experiment: Experiment, wheels: ManyWheels, kinds: Sequence[Kind]) -> list[Passes]:
    """Drives all passes side by side.

    All start at the experiment's initial pose. Kinds are disturbed by the same draws, so that what
    differs between them is not chance.

    Args:
        experiment: The experiment; its law and its iterations are not looked at.
        wheels: Wheel speeds from what is measured, before the limit.
        kinds: The passes.

    Returns:
        What each kind of pass does; infinite or not-a-number where it leaves the finite numbers.
    """
    reference, robot, limit = experiment.reference, experiment.robot, experiment.speed_limit
    gains = step_gains(robot.wheel_radius, robot.signed_half_track, reference.sample_time)
    n, source = reference.samples, experiment.disturbance
    counts = [SEEDS if kind else 1 for kind in kinds]
    state = _Draws(source.state, "state", kinds, 1)
    output = _Draws(source.output, "output", kinds, 2)
    initial = _Draws(source.initial_pose, "initial_pose", kinds, 3)
    x, y, heading = np.repeat(np.array([experiment.initial_pose]).T, sum(counts), axis=1)
    if (noise := initial.at(0)) is not None:
        x, y, heading = x + noise[0], y + noise[1], heading + noise[2]
    furthest, held, changes = np.zeros((3, len(x)))
    before: tuple[Floats, Floats] | None = None
    for k, (desired_x, desired_y, desired_heading) in enumerate(reference.poses.tolist()):
        error_x, error_y, error_heading = desired_x - x, desired_y - y, desired_heading - heading
        # Not-a-number is kept by the larger of two numbers.
        furthest = np.maximum(furthest, error_x * error_x + error_y * error_y)
        if k == n:
            break
        cos, sin = np.cos(heading), np.sin(heading)
        seen = cos, sin, error_x, error_y, error_heading
        if (noise := output.at(k)) is not None:
            measured = heading + noise[2]
            error = error_x - noise[0], error_y - noise[1], error_heading - noise[2]
            seen = np.cos(measured), np.sin(measured), *error
        left, right = wheels(k, *seen)
        if limit < math.inf:
            fastest = np.maximum(np.abs(left), np.abs(right))
            over = fastest > limit
            if over.any():
                scale = np.where(over, limit / fastest, 1.0)  # Eq. 25
                left, right, held = left * scale, right * scale, held + over
        beside = left - left[0], right - right[0]
        if before is not None:
            changes += (beside[0] - before[0]) ** 2 + (beside[1] - before[1]) ** 2
        before = beside
        distance, turn = gains[0] * (left + right), gains[1] * (left - right)
        x, y, heading = advance(x, y, heading, cos, sin, distance, turn)
        if (noise := state.at(k)) is not None:
            x, y, heading = x + noise[0], y + noise[1], heading + noise[2]
    columns = np.sqrt(furthest), np.sqrt(changes / (2 * max(n - 1, 1))), held / n
    kinds_of_columns = [np.split(column, np.cumsum(counts)[:-1]) for column in columns]
    return [Passes(*parts) for parts in zip(*kinds_of_columns, strict=True)]


class _Draws:
    """Draws of one disturbance for all passes, some of which do not have it."""

    def __init__(self, source: Bounded, name: str, kinds: Sequence[Kind], key: int) -> None:
        """Draws the disturbance of a name, with a key of its own."""
        # Block by block, of which a repeated disturbance would be the same.
        self._noise = NoiseDraws(replace(source, repeat=False), 1 + SEEDS, key)
        self._active = source.active and any(name in kind for kind in kinds)
        # Each pass of a kind that has it takes a draw of its own, the others the first, which is 0.
        own, none = np.arange(SEEDS) + 1, np.zeros(SEEDS, int)
        which = [own if name in kind else none[: SEEDS if kind else 1] for kind in kinds]
        self._which = np.concatenate(which)
        self._block: list[Floats] = []

    def at(self, k: int) -> Floats | None:
        """The draws of sample k, asked for in order, shape (3, passes); None if there are none."""
        if not self._active:
            return None
        if k % _BLOCK == 0:
            drawn = self._noise.drawn(_BLOCK)
            assert drawn is not None  # it is active
            self._block = list(drawn[:, :, self._which])
        return self._block[k % _BLOCK]


_NUDGE = 1e-6  # of the path's size: an error so small that the response to it is linear
_STANDS = 1e-3  # of a wheel's speed in turning: who drives slower turns in place
_MOST_SAMPLES = 40_000  # some 8 s


@dataclass(frozen=True, slots=True)
class TrackingResponse:
    """One pass, which is any: they do not learn from each other.

    Attributes:
        error_m: Largest position error from the trajectory's own start, undisturbed [m].
        error_known_m: Likewise with the true platform as model [m].
        heading_error_rad: Likewise of the heading, where the reference stands [rad]; 0 if it
            nowhere does.
        standing_s: How long the reference turns in place or stands still [s].
        is_off: Whether the initial pose differs from the trajectory's start at all.
        way: Of the pass from the initial pose onto the one from the trajectory's start.
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
    is_off: bool
    way: WayIn
    unlearned_m: float
    aside_left: float
    at_limit: float
    expected: ExpectedError
    wheels: WheelNoise | None

    @property
    def only_stands(self) -> bool:
        """Whether the reference goes nowhere, so that no side error can be steered away."""
        return self.standing_s > (self.way.samples - 0.5) * self.way.sample_time


def tracking_response(experiment: Experiment, law: FeedbackLaw) -> TrackingResponse:
    """Returns the response of an experiment of the law, in its last iteration."""
    reference, start = experiment.reference, experiment.initial_pose
    x, y, heading = own = tuple(reference.poses[0].tolist())
    # A path on the spot has no size, but who drives it has.
    size = max(reference.size, experiment.robot.half_track)
    nudge = _NUDGE * size
    aside = x - nudge * math.sin(heading), y + nudge * math.cos(heading), heading
    quiet, from_own, from_aside = (_undisturbed(experiment, pose) for pose in (start, own, aside))
    known = replace(experiment, law=replace(law, model=experiment.robot))
    standing = _standing(experiment)
    turned = np.abs(reference.heading - from_own.heading)[1:][standing]
    expected, wheels = _disturbed(experiment, law, _furthest(experiment, quiet))
    return TrackingResponse(
        _furthest(experiment, from_own),
        _furthest(experiment, _undisturbed(known, own)),
        float(turned.max()) if len(turned) else 0.0,
        float(standing.sum()) * reference.sample_time,
        starts_off(experiment),
        way_in(_apart(quiet, from_own), size, reference.sample_time),
        open_loop_error(experiment, feedforward(reference, law.model)),
        float(_apart(from_own, from_aside)[-1]) / nudge,
        quiet.saturated_samples / reference.samples,
        expected,
        wheels,
    )


def response_rows(found: TrackingResponse) -> Rows:
    """Returns what law feedback does along the path."""
    error = f"up to {found.error_m:.4g} m from the trajectory's start"
    if found.at_limit:
        error += f"; at the limit in {found.at_limit:.1%} of the samples"
    rows = [("Error along this path", error)]
    if found.is_off:
        joins = (
            f"not by the end, where {found.way.left:.3g} m are left"
            if found.way.joins_s is None
            else f"from {found.way.joins_s:.4g} s on"
        )
        rows.append(("On the trajectory", f"{joins}; starts {found.way.off:.4g} m off"))
    if found.standing_s:
        heading = f"heading up to {found.heading_error_rad:.3g} rad off there"
        text = f"{found.standing_s:.4g} s, in which nothing is steered; {heading}"
        rows.append(("Turns in place", text))
    return rows


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

    def wheels(k: int, *seen: Floats) -> tuple[Floats, Floats]:
        cos, sin, error_x, error_y, error_heading = seen
        turned = np.cos(error_heading), np.sin(error_heading)
        return law.wheel_speeds(tuple(twists[k]), (cos, sin), (error_x, error_y), turned)

    return wheels


def _open_loop(experiment: Experiment) -> ManyWheels:
    """Returns the initial input, which is all that a single open-loop iteration runs."""
    left, right = experiment.initial_left.tolist(), experiment.initial_right.tolist()

    def wheels(k: int, *seen: Floats) -> tuple[Floats, Floats]:
        return np.full_like(seen[0], left[k]), np.full_like(seen[0], right[k])

    return wheels


def _disturbed(
    experiment: Experiment, law: FeedbackLaw, final: float
) -> tuple[ExpectedError, WheelNoise | None]:
    """Returns what disturbances make of the error, and of the wheel speeds.

    Args:
        experiment: The experiment.
        law: Its law.
        final: Largest position error of the last iteration without them [m].
    """
    first = final
    opens = not experiment.learn_in_first
    if opens and experiment.iterations:
        first = _furthest(experiment, _undisturbed(replace(experiment, iterations=0)))
    active = list(active_sources(experiment.disturbance))
    if not active:
        return ExpectedError(first, final, final), None
    if experiment.reference.samples > _MOST_SAMPLES:
        unsure = f"passes with disturbances are not followed over more than {_MOST_SAMPLES} samples"
        return ExpectedError(first, final, final, unsure=unsure), None
    wheels = _open_loop(experiment) if opens and not experiment.iterations else None
    kinds = [Kind(), Kind(active)]
    if len(active) > 1:
        kinds += [Kind({name}) for name in active]
    quiet, *passes = many_passes(experiment, wheels or _many_wheels(experiment, law), kinds)
    reached = [max(final, float(np.quantile(each.position_m, LEVEL))) for each in passes]
    alone = dict(zip(active, reached[1:] or reached, strict=True))
    of_start, of_readings, of_state = (alone.get(name, final) - final for name in SOURCES)
    expected = ExpectedError(first, final, reached[0], of_start, of_readings, of_state)
    columns = ((quiet.change_rad_s, quiet.at_limit), (passes[0].change_rad_s, passes[0].at_limit))
    return expected, WheelNoise.of_seeds(*map(np.concatenate, zip(*columns, strict=True)))


def _furthest(experiment: Experiment, trial: Trial) -> float:
    """Returns the largest position error of a pass [m]."""
    reference = experiment.reference
    return float(np.hypot(reference.x - trial.x, reference.y - trial.y).max())


def _apart(one: Trial, other: Trial) -> Floats:
    """Returns the distance between two passes [m], shape (n + 1,)."""
    distance: Floats = np.hypot(one.x - other.x, one.y - other.y)
    return distance


def _standing(experiment: Experiment) -> NDArray[np.bool_]:
    """Returns the steps in which the reference turns in place or stands still, shape (n,)."""
    speed, yaw_rate = reference_twist(experiment.reference)
    standing: NDArray[np.bool_] = np.abs(speed) <= _STANDS * experiment.robot.half_track * np.abs(
        yaw_rate
    )
    return standing
