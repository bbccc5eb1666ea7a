"""How soon the norm-optimal law can be on the trajectory, and when it means to be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Findings, extent
from hilc_cli.theory.laws.norm_optimal_noise import planned_motion
from hilc_cli.theory.learning.outcome import CLEARLY
from hilc_cli.theory.matrices import desired_motion, starts_off
from hilc_cli.theory.noise import open_loop_error
from hilc_cli.theory.reach import (
    WayIn,
    cannot_be_reached,
    earliest_on_trajectory,
    is_too_fast,
    late_start,
    way_in,
)

if TYPE_CHECKING:
    from hilc_cli.laws.norm_optimal.learner import NormOptimalPlan

_LATE = 2  # samples behind h that nobody minds
_ROUNDING = 1e-9  # relative: a limit that is met exactly is met in spite of rounding


@dataclass(frozen=True, slots=True)
class Merging:
    """The way of the norm-optimal law into the trajectory.

    Attributes:
        h: Sample from which on the law is asked to be on the trajectory.
        speed_limit: b_w [rad/s]; infinity for none.
        position_error: Distance of the initial pose from the start of the trajectory [m].
        heading_error: Likewise of the heading [rad], absolute.
        is_off: Whether that is more than rounding.
        earliest: First sample that the speed limit lets any controller reach; None if there is
            none.
        planned: First sample from which the law's own path stays on the trajectory within a
            millimetre, with the true wheel radius and half track; None if it does not get there.
        way: That path's way onto the trajectory or, where that is too fast for the wheels, onto
            what the law makes of it from its own start.
        unlearned: Position error of the believed feedforward from the initial pose [m].
        out_of_reach: Why no controller gets onto the trajectory; empty if one does.
        fastest: Largest wheel speed that the trajectory asks of the true robot [rad/s].
        fastest_believed: Likewise of the one that the law believes in at first.
    """

    h: int
    speed_limit: float
    position_error: float
    heading_error: float
    is_off: bool
    earliest: int | None
    planned: int | None
    way: WayIn
    unlearned: float
    out_of_reach: str
    fastest: float
    fastest_believed: float

    @property
    def is_possible(self) -> bool:
        """Whether the speed limit allows the trajectory itself."""
        return self.fastest <= self.speed_limit * (1 + _ROUNDING)

    @property
    def is_believed_possible(self) -> bool:
        """Whether the law believes so before it has identified the robot."""
        return self.fastest_believed <= self.speed_limit * (1 + _ROUNDING)


def merging(experiment: Experiment, law: NormOptimalLaw) -> Merging:
    """Returns the way into the trajectory, from the experiment's initial pose, undisturbed."""
    reference = experiment.reference
    off = np.array(experiment.initial_pose) - reference.poses[0]
    position, heading = math.hypot(off[0], off[1]), abs(float(off[2]))
    is_off = starts_off(experiment)
    earliest: int | None = 0
    planned: int | None = 0
    away, out_of_reach = np.zeros(reference.samples + 1), ""
    if is_off:
        earliest = earliest_on_trajectory(experiment)
        plan = planned_motion(experiment, law)
        planned, away = plan.merge_sample, _away(experiment, law, plan)
        out_of_reach = cannot_be_reached(experiment)
    believed = feedforward(reference, law.model)
    return Merging(
        min(law.h, reference.samples),
        experiment.speed_limit,
        position,
        heading,
        is_off,
        earliest,
        planned,
        way_in(away, extent(experiment), reference.sample_time),
        open_loop_error(experiment, believed),
        out_of_reach,
        float(np.abs(desired_motion(experiment).inputs).max()),
        float(np.abs(believed).max()),
    )


def _away(experiment: Experiment, law: NormOptimalLaw, plan: NormOptimalPlan) -> Floats:
    """Returns how far the motion that learning leads to is from the trajectory [m], shape (n + 1,).

    Where that is too fast for the wheels, from what the law makes of it from its own start.
    """
    own = experiment.reference.poses
    if is_too_fast(experiment):
        x, y, heading = own[0].tolist()
        own = planned_motion(replace(experiment, initial_pose=(x, y, heading)), law).poses
    away: Floats = np.hypot(*(plan.poses - own)[:, :2].T)
    return away


def merging_findings(found: Merging) -> Findings:
    """Returns what the way into the trajectory means for the experiment."""
    found_too_fast: tuple[str, ...] = ()
    if not found.is_possible:
        # The parts that are too fast are told of the trajectory, each with its remedy.
        found_too_fast = (
            "where the trajectory asks for more than controller.b_w, the law leaves it: it "
            "makes the squared errors of the whole path least, not the delay; run it slower",
        )
    if not found.is_off:
        return Findings(warnings=found_too_fast)
    if found.out_of_reach:
        return Findings((found.out_of_reach,), found_too_fast)
    limit = f"controller.b_w of {found.speed_limit:g} rad/s"
    within = f" within {limit}" if math.isfinite(found.speed_limit) else ""
    late = late_start(
        found.way,
        f"the law{within}",
        "start nearer, or run the trajectory slower",
        asked=found.h + _LATE,
        hopeless=found.position_error >= found.unlearned / CLEARLY,
    )
    if late.failures or found.planned is None:
        return Findings(late.failures, (*late.warnings, *found_too_fast))
    is_too_soon = found.earliest is not None and found.h < found.earliest
    if found.planned <= found.h + (0 if is_too_soon else _LATE):
        return Findings()
    merges = (
        f"the law merges into the trajectory at sample {found.planned} "
        f"({_seconds(found, found.planned)}), later than controller.h of {found.h}"
    )
    if found.earliest is not None and is_too_soon:
        return Findings.warning(
            f"{merges}: within {limit} no sample before {found.earliest} "
            f"({_seconds(found, found.earliest)}) can be reached from initial_pose; raise h "
            f"to at least {found.earliest}"
        )
    return Findings(warnings=(f"{merges}, because of {limit}; raise h for a gentler way in",))


def _seconds(found: Merging, sample: int) -> str:
    return f"{sample * found.way.sample_time:.6g} s"
