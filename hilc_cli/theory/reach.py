"""Whether the trajectory can be reached from the start, and followed within the wheels' limit."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.disturbance.streams import Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.feasibility.feasibility import Feasibility, feasibility_findings
from hilc_cli.theory.feasibility.real_wheels import RealWheels, real_wheels
from hilc_cli.theory.findings import ExpectedError, Findings, extent, joined
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.learning.forecast import Forecast
from hilc_cli.theory.learning.outcome import CLEARLY, NEAR, STAYS
from hilc_cli.theory.matrices import desired_motion, knows_plant, starts_off
from hilc_cli.theory.noise import open_loop_error
from hilc_cli.theory.plain_arrays import distinct

_MOSTLY_GONE = 0.1  # of an initial error, or of the path: less in the second half is no failure
_ROUNDING = 1e-9  # relative: a limit that is met exactly is met in spite of rounding
_MOST_POINTS = 400  # of the reference that are looked at in pairs


def start_findings(theory: LawTheory) -> Findings:
    """Returns what the start means for an experiment, whose disturbances are left out."""
    experiment = theory.experiment
    if not knows_plant(experiment):
        return Findings()
    if theory.tells_the_way_in or not starts_off(experiment):
        return theory.way_in
    law, expected = theory.linear, theory.forecast
    by_wheels = _by_wheels(experiment, None if law is None else law.compensated_until)
    if by_wheels.failures:
        return by_wheels  # of which the law's own way is a consequence
    if law is None or expected is None:
        return joined(by_wheels, theory.way_in)
    left = _left_by_learning(experiment, expected, law.for_the_start)
    return Findings(left, by_wheels.warnings)


def cannot_be_reached(experiment: Experiment) -> str:
    """Returns why no controller gets onto the trajectory from the start; empty if one does.

    Where the trajectory itself is too fast for the wheels, that is what is to be told.
    """
    limit = experiment.speed_limit
    if math.isinf(limit) or is_too_fast(experiment):
        return ""
    left = least_left(*_to_reach(experiment))
    if left <= NEAR * extent(experiment):
        return ""
    return (
        "from initial_pose no sample of the trajectory can be reached in time within "
        f"controller.b_w of {limit:g} rad/s, whatever the law: it is out of reach by {left:.2g} m "
        "at least; start nearer, or run the trajectory slower"
    )


def earliest_on_trajectory(experiment: Experiment) -> int | None:
    """Returns the first sample that any controller can reach within the wheels' limit, if any."""
    return earliest_merge(*_to_reach(experiment))


def _to_reach(experiment: Experiment) -> tuple[Floats, Floats, float, float, float]:
    """Returns the numbers of an experiment that `earliest_merge` takes."""
    reference, robot = experiment.reference, experiment.robot
    top_speed = robot.wheel_radius * experiment.speed_limit
    start = np.array(experiment.initial_pose)
    return reference.poses, start, top_speed, robot.half_track, reference.sample_time


def is_too_fast(experiment: Experiment) -> bool:
    """Returns whether the trajectory itself is too fast for the wheels."""
    fastest = float(np.abs(desired_motion(experiment).inputs).max())
    return fastest > experiment.speed_limit * (1 + _ROUNDING)


@dataclass(frozen=True, slots=True)
class WayIn:
    """The way of a pass from the initial pose onto the trajectory.

    Attributes:
        off: Distance from the trajectory at the start [m].
        left: Likewise at the end [m].
        left_later: The largest one in the second half, samples k >= n / 2 as in the metrics [m].
        size: Of the trajectory [m].
        near: Distance up to which the pass counts as on the trajectory [m].
        joins: First sample from which it is so for good; None if it is not by the end.
        samples: Number of the trajectory's sampling intervals.
        sample_time: d_t [s].
    """

    off: float
    left: float
    left_later: float
    size: float
    near: float
    joins: int | None
    samples: int
    sample_time: float

    @property
    def joins_s(self) -> float | None:
        """`joins` in seconds."""
        return None if self.joins is None else self.joins * self.sample_time


def way_in(away: Floats, size: float, sample_time: float) -> WayIn:
    """Returns the way of a pass.

    Args:
        away: Its distance from the trajectory at each sample [m], shape (n + 1,).
        size: Of the trajectory [m].
        sample_time: d_t [s].
    """
    samples, near = len(away) - 1, NEAR * size
    far = np.flatnonzero(~(away <= near))
    first = int(far[-1]) + 1 if len(far) else 0
    left_later = float(away[len(away) // 2 :].max())
    joins = first if first <= samples else None
    return WayIn(
        float(away[0]), float(away[-1]), left_later, size, near, joins, samples, sample_time
    )


def late_start(
    found: WayIn, who: str, remedy: str, *, asked: int = 0, hopeless: bool = True
) -> Findings:
    """Returns what it means that a law is late on the trajectory: as runs are judged, from half on.

    Args:
        found: Its way.
        who: Whose way it is, for sentences.
        remedy: What helps.
        asked: Sample by which it is asked to be there, which may be as late as one likes.
        hopeless: Whether even so the start leaves as much error as there is without the law.
    """
    if found.joins is None:
        text = (
            f"from initial_pose, {found.off:.3g} m off, {who} does not get onto the "
            f"trajectory before its end, where {found.left:.3g} m are left; {remedy}"
        )
        return Findings.failure(text) if hopeless else Findings.warning(text)
    if found.joins <= max(asked, (found.samples + 1) // 2):
        return Findings()
    text = (
        f"from initial_pose, {found.off:.3g} m off, {who} is on the trajectory from sample "
        f"{found.joins} of {found.samples} on only ({found.joins * found.sample_time:.4g} s), and "
        f"up to {found.left_later:.3g} m off in its second half; {remedy}"
    )
    fails = hopeless and found.left_later > _MOSTLY_GONE * max(found.off, found.size)
    return Findings.failure(text) if fails else Findings.warning(text)


def _by_wheels(experiment: Experiment, h: int | None) -> Findings:
    """Returns what the wheels' limit forbids, to any law and to a compensation within h samples."""
    why = cannot_be_reached(experiment)
    if why:
        return Findings.failure(why)
    reference = experiment.reference
    if h is None or math.isinf(experiment.speed_limit):
        return Findings()
    earliest = earliest_on_trajectory(experiment)
    if earliest is None or h >= earliest:
        return Findings()
    return Findings.warning(
        f"controller.h of {h} is sooner than any law can be on the trajectory: within "
        f"controller.b_w of {experiment.speed_limit:g} rad/s that is at sample {earliest} "
        f"({earliest * reference.sample_time:.6g} s) at the earliest; raise h"
    )


def _left_by_learning(experiment: Experiment, expected: Forecast, remedy: str) -> tuple[str, ...]:
    """Tells of a start further off than the trajectory is large, and of a law that stays there.

    The error of iteration 0 then is less than twice the initial one: it never halves.
    """
    reference, rest, start = experiment.reference, expected.rest, experiment.initial_pose
    initial = math.dist((reference.x[0], reference.y[0]), start[:2])
    if initial <= reference.size or rest is None or not rest.is_finite:
        return ()
    left = rest.end_position_error_m
    if left <= NEAR * extent(experiment):
        return ()
    remedy = f"start nearer, or {remedy}" if remedy else "start nearer"
    return (
        f"from initial_pose, {initial:.3g} m off a trajectory of {reference.size:.3g} m, the law "
        f"does not get onto it before its end: {left:.3g} m are left; {remedy}",
    )


def least_error(experiment: Experiment) -> float:
    """Returns a position error that no wheel speeds within the limit can stay below [m].

    Between two samples a platform moves by the wheels' fastest speed times the time at most; where
    the reference moves further, at least half of the difference is left at one of the two. The
    second half of the path has to be reached from the initial pose.
    """
    reference = experiment.reference
    step = experiment.robot.wheel_radius * experiment.speed_limit * reference.sample_time
    if not math.isfinite(step):
        return 0.0
    samples = distinct(np.linspace(0, reference.samples, _MOST_POINTS).astype(int))
    x, y = reference.x[samples], reference.y[samples]
    apart = np.hypot(x[:, None] - x, y[:, None] - y)
    between = (apart - step * np.abs(samples[:, None] - samples)).max() / 2
    later = samples >= reference.samples / 2
    from_start = np.hypot(x - experiment.initial_pose[0], y - experiment.initial_pose[1])
    reached = (from_start - step * samples)[later].max()
    return max(0.0, float(between), float(reached))


def judged_feasibility(
    feasibility: Feasibility, experiment: Experiment, model: Robot, expected: ExpectedError | None
) -> Findings:
    """Returns what is to be said of a reference, judged by the error that its excess leaves.

    It cannot work if no law can halve the error that is there without learning, be it that of
    iteration 0 or of the feedforward of the believed platform, or if theory says that the law will
    not. Else what is too fast is a warning: a corner that takes some samples more than it should
    leaves a small error, and everything else can be learned. What the tyres do not hold stays a
    failure, and so does everything of a plant that theory does not know. Of a robot as it is, which
    can do no more than an ideal one but for the size of its wheels, iteration 0 is driven instead.
    """
    found = feasibility_findings(feasibility)
    real = real_wheels(experiment)
    if real is not None:
        return _of_real_robot(found, real, feasibility, experiment)
    limits = replace(feasibility.limits, wheel_speed=math.inf)
    only_wheels = replace(feasibility, limits=limits).feasible
    if not found.failures or not only_wheels or not knows_plant(experiment):
        return found
    unlearned = open_loop_error(experiment, feedforward(experiment.reference, model))
    if not experiment.learn_in_first:
        unlearned = min(unlearned, open_loop_error(experiment))
    least, small = least_error(experiment), NEAR * extent(experiment)
    if least > max(unlearned / CLEARLY, small):
        return found
    if expected is not None and expected.unsure is None and _starts_on(experiment):
        least = max(least, expected.final_m)
        if least > max(STAYS * unlearned, small):
            return found
    if expected is not None and expected.unsure is None:
        left = f"about {max(least, expected.final_m):.2g} m of error is left"
    elif least > small:
        left = f"at least {least:.2g} m of error is left"
    else:
        left = "how much of error is left is not known (--simulate)"
    softened = (f"{text}; as it is, {left}" for text in found.failures)
    return Findings(warnings=(*softened, *found.warnings))


def _of_real_robot(
    found: Findings, real: RealWheels, feasibility: Feasibility, experiment: Experiment
) -> Findings:
    """Returns the same of a robot with wheels, motors and tyres of its own."""
    only_tyres = replace(feasibility.limits, wheel_speed=math.inf)
    if not found.failures or not replace(feasibility, limits=only_tyres).feasible:
        return joined(found, real.findings)
    least, small = least_error(experiment), NEAR * extent(experiment)
    if least > max(driven_error(replace(experiment, iterations=0)) / CLEARLY, small):
        return joined(found, real.findings)
    warnings = found.warnings
    if not real.within_limit:  # what an ideal robot needs is less by what the wheels lose
        warnings = (*found.failures, *warnings)
    return joined(Findings(warnings=warnings), real.findings)


def driven_error(experiment: Experiment) -> float:
    """Returns the largest position error of an experiment's iteration 0 [m], undisturbed.

    It is driven as the engine does it; infinite where it leaves the finite numbers.
    """
    try:
        trial = next(simulate(replace(experiment, disturbance=Disturbance())))
    except DivergedError:
        return math.inf
    reference = experiment.reference
    return float(np.hypot(reference.x - trial.x, reference.y - trial.y).max())


def _starts_on(experiment: Experiment) -> bool:
    """Returns whether the platform starts on the reference."""
    reference, pose = experiment.reference, experiment.initial_pose
    off = math.hypot(reference.x[0] - pose[0], reference.y[0] - pose[1])
    return off <= NEAR * extent(experiment)


def earliest_merge(
    trajectory: Floats, start: Floats, top_speed: float, half_track: float, sample_time: float
) -> int | None:
    """First sample whose pose the platform can have; None if there is none.

    This is a bound that no controller can beat.

    Args:
        trajectory: Poses, shape (n + 1, 3).
        start: Pose of sample 0, shape (3,).
        top_speed: R_c b_w [m/s].
        half_track: B_c [m], > 0.
        sample_time: d_t [s].
    """
    least = shortest_way(trajectory, start, half_track) / top_speed
    # A time that is met exactly counts as met.
    reached = least <= np.arange(len(trajectory)) * sample_time + 1e-12
    return int(np.flatnonzero(reached)[0]) if reached.any() else None


def least_left(
    trajectory: Floats, start: Floats, top_speed: float, half_track: float, sample_time: float
) -> float:
    """What no controller can make up for, at whichever sample that is least [m]; 0 for none.

    A platform that at some sample is within a distance e and an angle p of the trajectory's pose
    has a way to that pose itself that costs at most e + B p more than it has rolled by then. So
    much of the same numbers as of `earliest_merge`: the least position error plus B_c times the
    heading error that is left.
    """
    rolled = top_speed * np.arange(len(trajectory)) * sample_time
    return max(0.0, float((shortest_way(trajectory, start, half_track) - rolled).min()))


def shortest_way(poses: Floats, start: Floats, half_track: float) -> Floats:
    """Least of what the faster wheel rolls on the way to each pose [m], shape (n + 1,).

    The wheels' limit leaves |speed| + B |yaw rate| <= top speed, so that a way costs its length and
    B times its turns, whoever drives it. Let its headings fill an interval [lo, hi]. It then turns
    at least from the start to one end, to the other and to the heading of the pose. With the
    line to the pose, or its reverse, in the interval, its length is at least the distance d. If it
    is not, let the headings count from the line, all between 0 and pi: the shortest way is to
    drive ahead at one end of the interval and back at the other, and has the length

        d sin((lo + hi) / 2) / sin((hi - lo) / 2).

    As both ends are visited anyway, there is a way that costs no more than this, and the least
    over all intervals is what a way costs at least. It is at an interval of which one end is the
    start's or the pose's heading, since the sine is concave; the other end follows from the
    derivative, by half the width w: sin(w)^2 = d sin(the end that is kept) / (4 B).

    Args:
        poses: Poses, shape (n + 1, 3).
        start: Where the platform is, shape (3,).
        half_track: B_c [m], > 0.

    Source:
        Balkcom and Mason: Time optimal trajectories for bounded velocity differential drive
        vehicles. Int. J. Robotics Research 21 (2002), 199-217: straight lines and turns in place
        suffice, zigzags ("tacking") among them.
    """
    dx, dy = (poses[:, :2] - start[:2]).T
    distance, line = np.hypot(dx, dy), np.arctan2(dy, dx)
    ends = np.stack([np.full_like(line, start[2]), poses[:, 2]]) - line
    lowest, highest = ends.min(axis=0), ends.max(axis=0)
    turn = highest - lowest
    half_turns = np.pi * np.floor(lowest / np.pi)
    lowest, highest = lowest - half_turns, highest - half_turns
    has_line = (highest >= np.pi) | (lowest == 0) | (distance == 0)
    # Where the interval at hand has the line, nothing is to be gained and these do not count.
    kept = np.where(has_line, np.pi / 2, np.stack([highest, np.pi - lowest]))
    sine = np.sqrt((distance * np.sin(kept) / (4 * half_track)).clip(0, 1))
    half = np.arcsin(sine).clip(turn / 2, kept / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        length = distance * (np.sin(kept) / np.tan(half) - np.cos(kept))
    zigzag = (length + half_track * (4 * half - turn)).min(axis=0)
    shortest: Floats = np.where(has_line, distance + half_track * turn, zigzag)
    return shortest
