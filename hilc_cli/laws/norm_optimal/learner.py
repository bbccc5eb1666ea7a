"""Norm-optimal learning at work: what passes tell of the robot, and the plan of the next one."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

import numpy as np

from hilc_cli.laws.law import Figures, Iteration, Plan
from hilc_cli.laws.norm_optimal.belief import MotorBelief
from hilc_cli.laws.norm_optimal.chance import seldom_above
from hilc_cli.laws.norm_optimal.driven import Driven, smooth_passes, squares_off
from hilc_cli.laws.norm_optimal.identification import Identification
from hilc_cli.laws.norm_optimal.kept_passes import KeptPasses
from hilc_cli.laws.norm_optimal.law import IDENTIFIED, MERGE_TIME, MISFITS, NormOptimalLaw
from hilc_cli.laws.norm_optimal.misfit import misfits
from hilc_cli.laws.norm_optimal.motion_filter import Noise
from hilc_cli.laws.norm_optimal.motor import Motor, body_steps, commands_for
from hilc_cli.laws.norm_optimal.motor_plan import motor_plan
from hilc_cli.laws.norm_optimal.optimal_motion import Model
from hilc_cli.laws.norm_optimal.passes_told import Pass, Passes
from hilc_cli.laws.norm_optimal.pose_regulator import bandwidths, regulator
from hilc_cli.laws.norm_optimal.rectified import (
    RectifiedReference,
    merged_sample,
    rectified_reference,
)
from hilc_cli.laws.norm_optimal.repeating import Repeating
from hilc_cli.laws.norm_optimal.safeguard import Learned, Safeguard
from hilc_cli.laws.safety_net import STEP_SHARE, WENT_BACK
from hilc_cli.plants.kinematic import step_gains
from hilc_cli.reference.sampled import Floats, Reference

MEMORY = 16
"""Passes that are kept."""
_ALWAYS = 6
"""The first passes are all identified from; later ones where they show something new."""
_NEW = 1.5
"""So many times the innovations' mean square of before is something new."""
_FREE = 0.05
"""A command may leave that of a robot without limits by this share of the fastest, at the price of
a position error that counts as one."""
_LIMIT = 1e6  # [rad/s], where there is none
_UNTOLD = 0.2
"""Delay [s] that the feedback reckons with before a pass has told it."""
_UNTOLD_SHARE = 1 / 30
"""The same as a share of the path's time, if that is less: short paths are for quick robots."""
_ON_IT = 1e-4  # [m and rad]; a start no further off is on the trajectory
CLEARLY = 3.0
"""So many standard errors off the trajectory a start is taken for what it looks like."""
_RARELY = 1e-3
"""How often readings of one start scatter more than is taken for that."""
_VAGUE = 1e-3  # [m and rad]: noise before anything was measured
_UNKNOWN = np.full(len(MISFITS), np.nan)
_FARTHEST = 1e3
"""A pass that is off by more than so many sizes of the path, meters or radians teaches nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class NormOptimalPlan(Plan):
    """What the next pass does, and the way that it takes.

    Attributes:
        merge_sample: First sample from which it stays on the trajectory, within a millimetre; None
            if it is not there at the end.
        settled: Whether the searches for it ended by themselves.
    """

    merge_sample: int | None = None
    settled: bool = True


class Starts(NamedTuple):
    """Where passes start.

    Attributes:
        mean: Pose, shape (3,).
        variances: Of x, y and heading, 0 of a single one, shape (3,).
        passes: How many they are.
    """

    mean: Floats
    variances: Floats
    passes: int

    @classmethod
    def of(cls, rows: Floats) -> Starts:
        """Returns what some poses have in common, shape (passes, 3)."""
        mean = rows.sum(axis=0) / len(rows)
        variances = np.square(rows - mean).sum(axis=0) / max(len(rows) - 1, 1)
        return cls(mean, variances, len(rows))


class NormOptimalLearner:
    """The law at work on one experiment."""

    def __init__(self, law: NormOptimalLaw, reference: Reference, speed_limit: float) -> None:
        """Begins with what the user believes.

        Args:
            law: The law's parameters, and the platform as the user believes it to be.
            reference: The trajectory.
            speed_limit: b_w [rad/s]; infinity for none.
        """
        self._law, self._reference, self._target = law, reference, reference.poses
        self._speed_limit = min(speed_limit, _LIMIT)
        self._size = reference.size
        self._identification = Identification(reference.sample_time, law.lead, self._size + 1e-3)
        radius, half_track = law.model.wheel_radius, law.model.signed_half_track
        motor = Motor(radius, radius, half_track, 0.0, 0.0, 0.0)
        if law.drivetrain is not None:
            known, kept = law.drivetrain.motor, 1 - law.drivetrain.slip.longitudinal
            radii = kept * law.drivetrain.left_radius, kept * law.drivetrain.right_radius
            late = known.delay, known.lag, known.dead_zone, known.acceleration
            motor = Motor(*radii, half_track, *late)
        self._belief = MotorBelief.at_first(motor, Noise(*[_VAGUE**2] * 5))
        self._identified = _in_figures(self._belief)
        self._kept = KeptPasses(reference.samples, MEMORY)
        self._repeating = Repeating(reference.samples, MEMORY)
        self._stood: deque[Floats] = deque(maxlen=MEMORY)  # where passes at rest were
        self._starts: Starts | None = None
        self._learned = Learned(self._belief.parameters, np.zeros((reference.samples, 3)))
        self._safeguard = Safeguard(self._learned)
        self._plan: NormOptimalPlan | None = None  # of the pass that runs
        self._way: RectifiedReference | None = None  # of the last plan
        self._known_way: RectifiedReference | None = None  # of a plan that has been learned from
        self._usual = 1.0

    @property
    def belief(self) -> MotorBelief:
        """The robot as all passes so far tell it."""
        return self._belief

    def learn(self, iteration: Iteration) -> Figures:
        """Takes in a pass that is over."""
        error = np.array(iteration.errors)
        latest = Pass(self._target - error.T, np.array([iteration.left, iteration.right]).T)
        if iteration.read is not None:  # what lies between readings tells nothing new
            latest.measured[1:][~iteration.read[1:]] = np.nan
        # On the way to divergence nothing is learned; neither is at rest, but where the robot is.
        far = _FARTHEST * max(self._size, 1.0)
        is_near = np.abs(error).max() <= far and np.abs(latest.sent).max() <= _LIMIT
        plan, self._plan = self._plan, None
        returns = self._safeguard.returns
        misfit = _UNKNOWN
        if is_near and latest.sent.any():
            misfit = self._take_in(latest)
        elif is_near:
            self._stood.append(np.nanmean(latest.measured, axis=0))
            self._starts = Starts.of(np.concatenate([self._kept.begun, self._stood]))
        merge_time, settled = self._of_plan(plan)
        return {
            **self._identified,
            **dict(zip(MISFITS, misfit.tolist(), strict=True)),
            STEP_SHARE: self._safeguard.share,
            WENT_BACK: float(self._safeguard.returns > returns),
            MERGE_TIME: merge_time,
            "search_settled": settled,
        }

    def _of_plan(self, plan: NormOptimalPlan | None) -> tuple[float, float]:
        """When a plan was on the trajectory [s], infinity if not by the end; whether it settled.

        Not-a-number where no plan was run.
        """
        if plan is None:
            return np.nan, np.nan
        merged = np.inf if plan.merge_sample is None else plan.merge_sample
        return merged * self._reference.sample_time, float(plan.settled)

    def _take_in(self, latest: Pass) -> Floats:
        """Learns from a pass, and returns by how much the model does not fit, see `misfits`."""
        kept = self._kept
        kept.add(latest)
        self._known_way = self._way
        passes = kept.passes(self._common_start())
        first, seen = kept.last, None
        if kept.seen > _ALWAYS and kept.seen & (kept.seen - 1) != 0:
            seen = self._smoothed(passes, first, first + 1)
        if seen is None or seen.surprise > _NEW * self._usual:
            self._belief = self._identification.update(self._belief, passes)
            self._identified = _in_figures(self._belief)
            first, seen = 0, self._smoothed(passes, 0, kept.count)
            self._usual = max(seen.surprise, 1.0)
        self._repeating.put(first, seen.beyond)
        self._stood.clear()
        self._starts = Starts.of(kept.begun)
        beside = self._repeating.expected(kept.sent, kept.last)
        learned = Learned(self._belief.parameters, beside)
        self._learned = self._safeguard.next(self._error(seen.poses), learned)
        return misfits(kept.white)

    def _common_start(self) -> Floats | None:
        """Where all passes start, shape (3,), if that is one pose.

        As long as starts differ no more than readings of them would, all are at one place, which
        so many readings tell.
        """
        count, noise = self._kept.count, self._belief.noise
        if count < 2:
            return None
        starts = Starts.of(self._kept.first_readings)
        usual = seldom_above(count - 1, _RARELY)
        for variance, read in zip(starts.variances.tolist(), _of_pose(noise), strict=True):
            if variance > usual * read:
                return None
        return starts.mean if self._is_clearly_off(starts) else self._target[0]

    def _error(self, poses: Floats) -> float:
        """RMS of what was off in a pass, from a start off the trajectory in its second half.

        1 counts as one.
        """
        first = 0 if self._start_on_it() else len(poses) // 2
        return math.sqrt(squares_off(poses, self._target, first, self._law.squared_weights))

    def _start_on_it(self) -> bool:
        """Whether passes start on the trajectory, as far as they clearly tell."""
        return self._starts is None or not self._is_clearly_off(self._starts)

    def _is_clearly_off(self, starts: Starts) -> bool:
        """Whether some starts tell another one than the trajectory's."""
        read = _of_pose(self._belief.noise)
        parts = (part.tolist() for part in (starts.mean, self._target[0], starts.variances))
        each = zip(*parts, strict=True)
        return any(
            abs(mean - there) > CLEARLY * math.sqrt(max(own, variance) / starts.passes) + _ON_IT
            for own, (mean, there, variance) in zip(read, each, strict=True)
        )

    def _smoothed(self, passes: Passes, first: int, end: int) -> Driven:
        """What some passes were as the belief and all their readings say."""
        belief, kept, sample_time = self._belief, self._kept, self._reference.sample_time
        known = belief.motor, sample_time, self._law.lead, belief.noise, passes.start_share
        told = passes.measured[first:end], passes.sent[first:end], kept.last - first
        return Driven(*smooth_passes(*told, *known, kept.begun[first:end], kept.white[first:end]))

    @cached_property
    def _steps(self) -> Floats:
        """Way ahead [m] and turn [rad] in each sample of the trajectory, shape (n, 2)."""
        return np.ascontiguousarray(body_steps(self._target, self._law.lead)[:, ::2])

    def _way_in(self, motor: Motor, start: Floats) -> RectifiedReference:
        """A way into the trajectory from a start off it."""
        radius = (motor.left_radius + motor.right_radius) / 2
        gains = step_gains(radius, motor.half_track, self._reference.sample_time)
        drift = np.zeros((self._reference.samples, 3))
        ideal = motor._replace(delay=0.0, lag=0.0, friction=0.0)
        commands = commands_for(ideal, self._steps, self._reference.sample_time)
        fastest = float(np.abs(commands).max())
        return rectified_reference(
            self._target,
            start,
            Model(*gains, drift, self._speed_limit),
            self._law.h,
            (*self._law.squared_weights, (_FREE * fastest + 1e-9) ** -2),
            self._known_way,
        )

    def plan(self, start: Floats | None = None) -> NormOptimalPlan:
        """Plans the next pass anew from the geometry: only what is known of the robot is kept.

        Args:
            start: Pose from which it starts, shape (3,); None: the mean of those so far.
        """
        reference, law = self._reference, self._law
        motor = self._belief.with_parameters(self._learned.parameters).motor
        on_it = self._start_on_it() if start is None else _is_near(start, self._target[0])
        if start is None:
            start = self._target[0] if self._starts is None else self._starts.mean
        way_in = self._way = None if on_it else self._way_in(motor, start)
        found = motor_plan(
            motor,
            self._target if way_in is None else way_in.poses,
            start,
            self._learned.beside,
            reference.sample_time,
            law.lead,
            self._speed_limit,
            law.squared_weights,
            _FREE,
        )
        left, right = found.inputs.T.copy()
        feedback = None
        if law.feedback == "regulator":
            rates = self._rates(found.inputs)
            feedback = regulator(motor, found.inputs, found.poses, reference, *rates)
        self._plan = NormOptimalPlan(
            left,
            right,
            found.poses,
            feedback,
            merge_sample=merged_sample(found.poses, self._target),
            settled=found.settled and (way_in is None or way_in.settled),
        )
        return self._plan

    def _rates(self, inputs: Floats) -> tuple[float, float]:
        """The bandwidths of the feedback about a plan, see `bandwidths`."""
        limit = self._speed_limit if self._speed_limit < _LIMIT else float(np.abs(inputs).max())
        motor, sample_time = self._belief.motor, self._reference.sample_time
        if self._safeguard.share < 1:  # it is not what passes have made it be
            motor = self._belief.with_parameters(self._learned.parameters).motor
        if not self._kept.seen or self._safeguard.share < 1:
            untold = min(_UNTOLD, _UNTOLD_SHARE * self._reference.samples * sample_time)
            motor = motor._replace(delay=motor.delay + untold)
        return bandwidths(motor, self._noise_with_drift(inputs), sample_time, limit)

    def _noise_with_drift(self, inputs: Floats) -> Noise:
        """The noise, and what else takes a pass elsewhere: its own start, and what is unsure.

        What is off by a variance over n samples is answered best as fast as a walk that adds an
        n-th of it in each.
        """
        belief, noise = self._belief, self._belief.noise
        scattered = np.zeros(3)
        if self._starts is not None:
            scattered = self._starts.variances
            if self._starts.passes == 1:
                scattered = np.square(self._starts.mean - self._target[0])
        x, y, heading = scattered.tolist()
        way, turn = belief.drift(inputs, self._reference.sample_time)
        n = len(inputs)
        return noise._replace(
            ahead=noise.ahead + (max(x, y) + way) / n,
            left=noise.left + max(x, y) / n,
            turn=noise.turn + (heading + turn) / n,
        )


def _in_figures(belief: MotorBelief) -> Figures:
    """What is believed of the robot, with standard errors where it is measured."""
    motor, half_track = belief.motor, abs(belief.motor.half_track)
    radius = (motor.left_radius + motor.right_radius) / 2
    shares = radius, half_track, radius / half_track, motor.left_radius / motor.right_radius
    told = (*shares, motor.delay + motor.lag, motor.delay, motor.lag, motor.friction)
    errors = belief.told_errors * [*shares, 1, 1, 1, 1]  # those of shares are of logarithms
    return dict(zip(IDENTIFIED, chain(*zip(told, errors.tolist(), strict=True)), strict=True))


def _of_pose(noise: Noise) -> tuple[float, float, float]:
    """Variances of a reading of x, y and heading."""
    return noise.position, noise.position, noise.heading


def _is_near(start: Floats, other: Floats) -> bool:
    return float(np.abs(start - other).max()) <= _ON_IT
