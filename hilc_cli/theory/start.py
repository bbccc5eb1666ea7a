"""Whether the trajectory can be reached from where the platform starts."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.earliest_merge import earliest_merge, least_left
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.law_theory import LawTheory, knows_plant
from hilc_cli.theory.learning.forecast import Forecast
from hilc_cli.theory.learning.outcome import NEAR
from hilc_cli.theory.matrices import desired_motion, desired_poses

_NONE = 1e-9  # an initial error up to this [m and rad] is rounding
_ROUNDING = 1e-9  # relative: a limit that is met exactly is met in spite of rounding


def start_findings(theory: LawTheory) -> Findings:
    """Returns what the start means for an experiment, if the theory of its law does not tell.

    Args:
        theory: What is known of the experiment's law; its disturbances are left out.
    """
    experiment = theory.experiment
    off = np.array(experiment.initial_pose) - desired_poses(experiment)[0]
    told = theory.tells_the_way_in or not knows_plant(experiment)
    if told or float(np.abs(off).max()) <= _NONE:
        return Findings()
    law, expected = theory.linear, theory.forecast
    by_wheels = _by_wheels(experiment, None if law is None else law.compensated_until)
    if by_wheels.failures or law is None or expected is None:
        return by_wheels
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
    if math.isinf(limit):
        return ""
    if np.abs(desired_motion(experiment).inputs).max() > limit * (1 + _ROUNDING):
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
