"""Whether the trajectory can be reached from where the platform starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.rectified import earliest_merge, least_left
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Findings, joined as joined_findings
from hilc_cli.theory.law_theory import LawTheory, knows_plant
from hilc_cli.theory.learning.forecast import Forecast
from hilc_cli.theory.learning.outcome import NEAR
from hilc_cli.theory.matrices import desired_motion, desired_poses

_NONE = 1e-9  # an initial error up to this [m and rad] is rounding
_MOSTLY_GONE = 0.1  # of an initial error, or of the path: less in the second half is no failure
_ROUNDING = 1e-9  # relative: a limit that is met exactly is met in spite of rounding


def start_findings(theory: LawTheory) -> Findings:
    """Returns what the start means for an experiment.

    Args:
        theory: What is known of the experiment's law; its disturbances are left out.
    """
    experiment = theory.experiment
    off = np.array(experiment.initial_pose) - desired_poses(experiment)[0]
    if not knows_plant(experiment):
        return Findings()
    if theory.tells_the_way_in or float(np.abs(off).max()) <= _NONE:
        return theory.way_in
    law, expected = theory.linear, theory.forecast
    by_wheels = _by_wheels(experiment, None if law is None else law.compensated_until)
    if by_wheels.failures:
        return by_wheels  # of which the law's own way is a consequence
    if law is None or expected is None:
        return joined_findings([by_wheels, theory.way_in])
    left = _left_by_learning(experiment, expected, law.for_the_start)
    return Findings(left, by_wheels.warnings)


def near(experiment: Experiment) -> float:
    """Position error up to which a platform counts as on the trajectory [m].

    A path on the spot has no size, but who drives it has.
    """
    return NEAR * max(experiment.reference.size, 2 * experiment.robot.half_track)


def cannot_be_reached(experiment: Experiment) -> str:
    """Why no controller gets onto the trajectory from the start; empty if one does.

    Where the trajectory itself is too fast for the wheels, that is what is to be told.
    """
    limit = experiment.speed_limit
    if math.isinf(limit) or is_too_fast(experiment):
        return ""
    left = least_left(
        desired_poses(experiment),
        np.array(experiment.initial_pose),
        experiment.robot.wheel_radius * limit,
        experiment.robot.half_track,
        experiment.reference.sample_time,
    )
    if left <= near(experiment):
        return ""
    return (
        "from initial_pose no sample of the trajectory can be reached in time within "
        f"controller.b_w of {limit:g} rad/s, whatever the law: it is out of reach by {left:.2g} m "
        "at least; start nearer, or run the trajectory slower"
    )


def is_too_fast(experiment: Experiment) -> bool:
    """Whether the trajectory itself is too fast for the wheels."""
    fastest = float(np.abs(desired_motion(experiment).inputs).max())
    return fastest > experiment.speed_limit * (1 + _ROUNDING)


@dataclass(frozen=True, slots=True)
class LateStart:
    """How a law gets from the start onto the trajectory.

    Attributes:
        who: Whose way it is, for sentences.
        off: Distance of the initial pose from the trajectory's start [m].
        size: Of the trajectory [m].
        joins: First sample from which it is on the trajectory, as `near` has it, for good; None if
            it is not by the end.
        samples: Number of the trajectory's sampling intervals.
        sample_time: d_t [s].
        left: Distance from the trajectory at the end [m].
        left_later: Largest one in the second half [m].
        remedy: What helps.
    """

    who: str
    off: float
    size: float
    joins: int | None
    samples: int
    sample_time: float
    left: float
    left_later: float
    remedy: str


def joined(away: Floats, close: float) -> int | None:
    """First sample from which a distance stays within a bound; None if it is not at the end."""
    far = np.flatnonzero(~(away <= close))
    first = int(far[-1]) + 1 if len(far) else 0
    return first if first < len(away) else None


def in_second_half(away: Floats) -> float:
    """Largest distance in the second half, samples k >= n / 2 as in the metrics."""
    return float(away[len(away) // 2 :].max())


def late_start(found: LateStart, *, asked: int = 0, hopeless: bool = True) -> Findings:
    """What it means that a law is not on the trajectory in its second half, as runs are judged.

    Args:
        found: Its way.
        asked: Sample by which it is asked to be there, which may be as late as one likes.
        hopeless: Whether even so the start leaves as much error as there is without the law.
    """
    if found.joins is None:
        text = (
            f"from initial_pose, {found.off:.3g} m off, {found.who} does not get onto the "
            f"trajectory before its end, where {found.left:.3g} m are left; {found.remedy}"
        )
        return Findings(failures=(text,))
    if found.joins <= max(asked, (found.samples + 1) // 2):
        return Findings()
    text = (
        f"from initial_pose, {found.off:.3g} m off, {found.who} is on the trajectory from sample "
        f"{found.joins} of {found.samples} on only ({found.joins * found.sample_time:.4g} s), and "
        f"up to {found.left_later:.3g} m off in its second half; {found.remedy}"
    )
    fails = hopeless and found.left_later > _MOSTLY_GONE * max(found.off, found.size)
    return Findings(failures=(text,)) if fails else Findings(warnings=(text,))


def _by_wheels(experiment: Experiment, h: int | None) -> Findings:
    """What the wheels' limit forbids, to any law and to a compensation within h samples."""
    why = cannot_be_reached(experiment)
    if why:
        return Findings(failures=(why,))
    reference = experiment.reference
    if h is None or math.isinf(experiment.speed_limit):
        return Findings()
    earliest = earliest_merge(
        desired_poses(experiment),
        np.array(experiment.initial_pose),
        experiment.robot.wheel_radius * experiment.speed_limit,
        experiment.robot.half_track,
        reference.sample_time,
    )
    if earliest is None or h >= earliest:
        return Findings()
    return Findings(
        warnings=(
            f"controller.h of {h} is sooner than any law can be on the trajectory: within "
            f"controller.b_w of {experiment.speed_limit:g} rad/s that is at sample {earliest} "
            f"({earliest * reference.sample_time:.6g} s) at the earliest; raise h",
        )
    )


def _left_by_learning(experiment: Experiment, expected: Forecast, remedy: str) -> tuple[str, ...]:
    """Of a start that is further off than the trajectory is large, and of a law that stays there.

    The error of iteration 0 then is less than twice the initial one: it never halves.
    """
    reference, rest, start = experiment.reference, expected.rest, experiment.initial_pose
    initial = math.dist((reference.x[0], reference.y[0]), start[:2])
    if initial <= reference.size or rest is None or not rest.is_finite:
        return ()
    left = rest.end_position_error_m
    if left <= near(experiment):
        return ()
    remedy = f"start nearer, or {remedy}" if remedy else "start nearer"
    return (
        f"from initial_pose, {initial:.3g} m off a trajectory of {reference.size:.3g} m, the law "
        f"does not get onto it before its end: {left:.3g} m are left; {remedy}",
    )
