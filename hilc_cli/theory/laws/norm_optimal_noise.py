"""The last iteration of the norm-optimal law, with disturbances.

Disturbed passes are followed about the motion that the law means to drive. With d the pose less the
planned one, the plant and the regulator linearised along the reference,

    d(k+1) = A_k d(k) - B_k K_k [d(k) + alpha(k)] + beta(k) - beta'(k)
             - [a(k+1) - A_k a(k)] - p(k),

d(0) = s - s' - a(0). Dashes are what has come back in each of the iterations before and is
therefore allowed for, s the start, a what is left of readings that are off the same way each time
after smoothing, and p what comes of a robot that is identified with an error. The plan itself
starts at s' + a(0), where it takes the platform to be, and is on the trajectory at sample h.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.law import WheelController
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, expected_of_seeds, extent
from hilc_cli.theory.learning.outcome import FAILED, Outcome, Prospects, predicted_outcome
from hilc_cli.theory.matrices import linearise, starts_off
from hilc_cli.theory.noise import (
    SEEDS,
    DisturbanceDraws,
    NoiseDraws,
    Passes,
    WheelNoise,
    changes_beside_first,
    deviations,
    open_loop_error,
    open_loop_errors,
)

if TYPE_CHECKING:
    from hilc_cli.laws.norm_optimal.belief import MotorBelief
    from hilc_cli.laws.norm_optimal.learner import NormOptimalPlan

_WITHIN = 1e-9  # relative: a limit that is met exactly is met in spite of rounding
_TOLD = 3  # passes that tell what comes back in each


def planned_motion(experiment: Experiment, law: NormOptimalLaw) -> NormOptimalPlan:
    """Returns the motion that learning leads to, within the limit and without disturbances."""
    from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner  # the compiler starts slowly

    known = replace(law, model=experiment.robot, drivetrain=None)
    learner = NormOptimalLearner(known, experiment.reference, experiment.speed_limit)
    return learner.plan(np.array(experiment.initial_pose))


def _moving_passes(experiment: Experiment) -> int:
    """Returns how many iterations before the last one have told anything of the robot."""
    rests = not np.any([experiment.initial_left, experiment.initial_right])
    return experiment.iterations - (rests and not experiment.learn_in_first)


def noisy_passes(
    experiment: Experiment, law: NormOptimalLaw, plan: NormOptimalPlan, seeds: int
) -> Passes:
    """Returns the last iteration of many seeds, the first of which is not disturbed.

    The plan is what learning leads to, of which the experiment has at least one update.
    """
    from hilc_cli.laws.norm_optimal.learner import MEMORY  # the compiler starts slowly

    n, draws = experiment.reference.samples, DisturbanceDraws(experiment.disturbance, seeds)
    memory = min(experiment.iterations, MEMORY)
    belief = _belief(experiment, law, plan)
    nothing = np.zeros((n + 1, 3, seeds))
    start_before = _mean(draws.start, 1, memory, nothing[:1])[0]
    left, plant = nothing, linearise(experiment)
    share, passes = 1.0, max(1, _moving_passes(experiment))
    given = experiment.disturbance
    # What comes back in each pass is told apart from what the robot is.
    if given.state.repeat and passes >= _TOLD:
        state_before, seen = _mean(draws.state, n, 1, nothing[1:]), nothing
    else:
        state_before = nothing[1:]
        seen = _carried(plant.states, _mean(draws.state, n, memory, state_before))
    seen = seen + _mean(draws.output, n + 1, memory, nothing)
    if passes > 1 and (given.initial_pose.repeat or not given.initial_pose.active):
        share = 1 / passes  # all start at one place, which so many readings tell
        if not starts_off(experiment):
            seen[0] *= _clearly_off(seen[0], np.array(deviations(given.output)), passes)
    errors = _identified_errors(experiment, law, plan, belief, seen, share)
    if given.output.repeat and passes >= _TOLD:
        errors = np.zeros_like(errors)
    if given.output.active:
        left = _smoothed(experiment, law, plan, belief, seen, errors, share)
        if not given.output.repeat:
            left[1:] = 0.0
    start, state, output = draws.start.drawn(1), draws.state.drawn(n), draws.output.drawn(n + 1)

    pushed = -state_before - _misled(experiment, law, plan, belief, errors)
    if given.output.repeat:
        pushed += np.ascontiguousarray(plant.states) @ left[:-1] - left[1:]
    if state is not None:
        pushed = pushed + state
    away = (0.0 if start is None else start[0]) - start_before - left[0]
    limit = experiment.speed_limit
    deviation = np.empty((n + 1, 3, seeds))
    deviation[0] = away
    inputs = np.stack([plan.left, plan.right], axis=1)[:, :, None]
    gains = _gains(experiment, law, plan, belief)
    applied, held = np.empty((n, 2, seeds)), np.zeros(seeds)
    for k in range(n):
        now = deviation[k]
        seen = now if output is None else now + output[k]
        speeds = inputs[k] - gains[k] @ seen
        fastest = np.abs(speeds).max(axis=0)
        if (fastest > limit).any():
            speeds = speeds * np.minimum(1.0, limit / np.maximum(fastest, limit))
            held += fastest > limit * (1 + _WITHIN)
        applied[k] = speeds
        driven = plant.inputs[k] @ (speeds - inputs[k])
        deviation[k + 1] = plant.states[k] @ now + driven + pushed[k]

    way_in = np.clip(1 - np.arange(n + 1) / min(law.h, n), 0, 1)[:, None, None]
    meant = (plan.poses - experiment.reference.poses)[:, :, None]
    error = meant + deviation + way_in * (start_before + left[0])
    furthest = np.sqrt((error[:, 0] ** 2 + error[:, 1] ** 2).max(axis=0))
    return Passes(furthest, changes_beside_first(applied), held / n)


def _mean(source: NoiseDraws, samples: int, memory: int, nothing: Floats) -> Floats:
    """Returns the mean of what is drawn for some iterations."""
    total = nothing
    for _ in range(memory):
        drawn = source.drawn(samples)
        if drawn is None:
            return nothing
        total = total + drawn
    return total / memory


def _clearly_off(off: Floats, deviations: Floats, passes: int) -> NDArray[np.bool_]:
    """Whether the law takes a start for off the trajectory, by what passes tell, (seeds,)."""
    from hilc_cli.laws.norm_optimal.learner import CLEARLY  # the compiler starts slowly

    told = CLEARLY * deviations / math.sqrt(passes)
    return np.asarray(np.any(np.abs(off) > told[:, None], axis=0))


def _carried(states: Floats, pushed: Floats) -> Floats:
    """Returns where pushes [m, m and rad] in each sample take a pass, shape (n + 1, 3, seeds)."""
    gone = np.zeros((len(pushed) + 1, *pushed.shape[1:]))
    if pushed.any():
        for k, push in enumerate(pushed):
            gone[k + 1] = states[k] @ gone[k] + push
    return gone


def _belief(experiment: Experiment, law: NormOptimalLaw, plan: NormOptimalPlan) -> MotorBelief:
    """Returns what the law believes of the robot and of the noise once it has seen some passes."""
    # The compiler starts slowly.
    from hilc_cli.laws.norm_optimal.belief import MotorBelief
    from hilc_cli.laws.norm_optimal.identification import Identification
    from hilc_cli.laws.norm_optimal.motion_filter import Noise
    from hilc_cli.laws.norm_optimal.motor import Motor
    from hilc_cli.laws.norm_optimal.passes_told import Pass

    robot, reference = experiment.robot, experiment.reference
    radius, half_track = robot.wheel_radius, robot.signed_half_track
    given = experiment.disturbance
    x, y, turn = deviations(given.state)
    read_x, read_y, read_heading = deviations(given.output)
    motion, position = (x * x + y * y) / 2, (read_x**2 + read_y**2) / 2
    identification = Identification(reference.sample_time, law.lead, reference.size + 1e-3)
    noise = identification.quietest(Noise(motion, motion, turn**2, position, read_heading**2))
    belief = MotorBelief.at_first(Motor(radius, radius, half_track, 0.0, 0.0, 0.0), noise)
    told = max(1, _moving_passes(experiment))
    like = Pass(plan.poses, np.stack([plan.left, plan.right], axis=1))
    return replace(belief, covariance=identification.expected_covariance(belief, like, told))


def _misled(
    experiment: Experiment,
    law: NormOptimalLaw,
    plan: NormOptimalPlan,
    belief: MotorBelief,
    errors: Floats,
) -> Floats:
    """Returns what is driven otherwise since the robot is identified with errors, (n, 3, seeds)."""
    inputs = np.stack([plan.left, plan.right], axis=1)
    _, slopes = belief.steps_and_slopes(inputs, experiment.reference.sample_time)
    ahead, turn = np.moveaxis(slopes @ errors, 1, 0)
    heading = plan.poses[:-1, 2] + law.lead * np.diff(plan.poses[:, 2])
    cos, sin = np.cos(heading)[:, None], np.sin(heading)[:, None]
    return np.stack([ahead * cos, ahead * sin, turn], axis=1)


def _identified_errors(
    experiment: Experiment,
    law: NormOptimalLaw,
    plan: NormOptimalPlan,
    belief: MotorBelief,
    seen: Floats,
    share: float,
) -> Floats:
    """Errors of the parameters that passes tell, shape (6, seeds).

    To first order they are C J'w, with the innovations w that readings off the plan make, their
    slopes J, and the covariance C. But delay, lag and friction, of which this robot has none, are
    never found below none, which keeps what they are mixed up with in place as well.

    Args:
        experiment: The experiment.
        law: Its law.
        plan: What is driven.
        belief: What is known after all passes.
        seen: How far readings are off the plan, on average over the passes, (n + 1, 3, seeds).
        share: Share of a reading's variance that the start is known to.
    """
    from hilc_cli.laws.norm_optimal.filter_slopes import (
        innovation_slopes,
    )  # the compiler starts slowly

    inputs = np.stack([plan.left, plan.right], axis=1)
    steps = belief.steps_and_slopes(inputs, experiment.reference.sample_time)
    onto = max(1, _moving_passes(experiment)) * belief.covariance
    errors = np.zeros((len(onto), seen.shape[2]))
    for seed in np.flatnonzero(seen.any(axis=(0, 1))).tolist():
        measured = plan.poses + seen[:, :, seed]
        white, slopes = innovation_slopes(measured, *steps, law.lead, belief.noise, share)
        found = -onto @ np.einsum("kci,kc->i", slopes, white)
        errors[:, seed] = _nearest_possible(belief.covariance, found)
    return errors


def _nearest_possible(covariance: Floats, errors: Floats) -> Floats:
    """The nearest parameters of which none is below what there may be."""
    from hilc_cli.laws.norm_optimal.belief import AT_LEAST_NONE

    best, least = errors, np.inf
    for count in range(len(AT_LEAST_NONE) + 1):
        for held in map(list, combinations(AT_LEAST_NONE, count)):
            onto = covariance[:, held] @ np.linalg.inv(covariance[np.ix_(held, held)])
            found = errors - onto @ errors[held]
            far = float(
                errors[held] @ np.linalg.solve(covariance[np.ix_(held, held)], errors[held])
            )
            if far < least and np.all(found[AT_LEAST_NONE] >= -1e-12):
                best, least = found, far
    return best


def _gains(
    experiment: Experiment, law: NormOptimalLaw, plan: NormOptimalPlan, belief: MotorBelief
) -> Floats:
    """Returns what the regulator makes of a pose that is off the plan, shape (n, 2, 3)."""
    from hilc_cli.laws.norm_optimal.pose_regulator import (
        bandwidths,
        regulator,
    )  # the compiler starts slowly

    reference, n = experiment.reference, experiment.reference.samples
    if law.feedback == "none":
        return np.zeros((n, 2, 3))
    inputs = np.stack([plan.left, plan.right], axis=1)
    limit = experiment.speed_limit
    limit = limit if math.isfinite(limit) else float(np.abs(inputs).max())
    start = experiment.disturbance.initial_pose
    x, y, heading = (0.0, 0.0, 0.0) if start.repeat else deviations(start)
    way, turn = belief.drift(inputs, reference.sample_time)
    apart, noise = max(x, y) ** 2, belief.noise
    noise = noise._replace(
        ahead=noise.ahead + (apart + way) / n,
        left=noise.left + apart / n,
        turn=noise.turn + (heading**2 + turn) / n,
    )
    rates = bandwidths(belief.motor, noise, reference.sample_time, limit)
    feedback = regulator(belief.motor, inputs, plan.poses, reference, *rates)
    return _linear(feedback.controller(), plan, n)


def _linear(controller: WheelController, plan: NormOptimalPlan, n: int) -> Floats:
    """Returns the gains of a controller that is linear in the errors, shape (n, 2, 3)."""
    gains = np.empty((n, 2, 3))
    for k, heading in enumerate(plan.poses[:-1, 2].tolist()):
        cos, sin = math.cos(heading), math.sin(heading)
        none = np.array(controller(k, cos, sin, 0.0, 0.0, 0.0))
        for axis, unit in enumerate(np.eye(3).tolist()):
            gains[k, :, axis] = np.array(controller(k, cos, sin, *unit)) - none
    return gains


def _smoothed(
    experiment: Experiment,
    law: NormOptimalLaw,
    plan: NormOptimalPlan,
    belief: MotorBelief,
    seen: Floats,
    errors: Floats,
    share: float,
) -> Floats:
    """Returns what the law's smoother leaves of readings off the plan, shape (n + 1, 3, seeds).

    It takes the robot for what it is identified as, with errors.
    """
    from hilc_cli.laws.norm_optimal.motion_filter import (
        run_filter,
        smoothed_poses,
    )  # the compiler starts slowly

    inputs = np.stack([plan.left, plan.right], axis=1)
    steps, slopes = belief.steps_and_slopes(inputs, experiment.reference.sample_time)
    found = np.empty_like(seen)
    for seed in range(seen.shape[2]):
        measured, believed = plan.poses + seen[:, :, seed], steps + slopes @ errors[:, seed]
        kept = run_filter(measured, believed, law.lead, belief.noise, share, keep=True)
        found[:, :, seed] = smoothed_poses(kept) - plan.poses
    return found


def expected_of_norm_optimal(
    experiment: Experiment, law: NormOptimalLaw
) -> tuple[ExpectedError, Outcome, WheelNoise | None]:
    """Returns the error to be expected, what comes of learning, and the noise of the wheels."""
    plan = planned_motion(experiment, law)
    away: Floats = np.hypot(*(plan.poses - experiment.reference.poses)[:, :2].T)
    planned = float(away.max())
    first = planned if experiment.learn_in_first else open_loop_error(experiment)
    if experiment.iterations == 0:
        return ExpectedError(first, first, first), Outcome.NOTHING, None
    if _moving_passes(experiment) == 0:
        # Nothing was told of the robot: what comes of the belief itself is quickly seen.
        *_, last = simulate(replace(experiment, disturbance=Disturbance()))
        reference = experiment.reference
        away = np.hypot(reference.x - last.x, reference.y - last.y)
    final = float(away.max())
    outcome = _halved(experiment, law, away)
    together = noisy_passes(experiment, law, plan, SEEDS)

    def passes(part: Experiment) -> Floats:
        found = together if part is experiment else noisy_passes(part, law, plan, SEEDS)
        return found.position_m + (final - planned)

    found = expected_of_seeds(experiment, first, final, passes(experiment), passes, None)
    return found, outcome, WheelNoise.of_seeds(together.change_rad_s, together.at_limit)


def _halved(experiment: Experiment, law: NormOptimalLaw, away: Floats) -> Outcome:
    """Returns what comes of learning towards a motion, by the rule of all laws that learn.

    Args:
        experiment: The experiment.
        law: Its law.
        away: Distance of the motion that learning leads to from the trajectory [m].
    """
    # Where iteration 0 runs the law, learning is held against what there is without it.
    inputs = feedforward(experiment.reference, law.model) if experiment.learn_in_first else None
    first, planned = open_loop_errors(experiment, inputs), away
    if starts_off(experiment):  # as runs are judged
        first, planned = first[len(first) // 2 :], planned[len(planned) // 2 :]
    errors = np.array([float(first.max()), float(planned.max())])
    found = predicted_outcome(Prospects(errors, np.zeros(0), extent(experiment)))
    # A motion that is further off at one place is so for its squares' sake.
    return Outcome.DOES_NOT_LEARN if found in FAILED else found
