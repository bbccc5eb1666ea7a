"""The error to be expected of the laws that learn, with what each disturbance makes of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, extent
from hilc_cli.theory.laws.model_mismatch import ModelMismatch
from hilc_cli.theory.learning.forecast import FAR_HEADING, Forecast
from hilc_cli.theory.learning.recursion import linearise
from hilc_cli.theory.matrices import desired_poses
from hilc_cli.theory.noise.draws import (
    SEEDS,
    DisturbanceDraws,
    NoiseDraws,
    deviations,
    open_loop_error,
)
from hilc_cli.theory.noise.learning import noisy_learning
from hilc_cli.theory.noise.wheels import WheelNoise, changes_beside_first

_WITHIN = 1e-9  # relative: a limit that is met exactly is met in spite of rounding
_PLANS = 3  # updates after which the plan of a platform that is known hardly changes


@dataclass(frozen=True, slots=True, eq=False)
class PlannedMotion:
    """What the law plans once it knows the platform.

    Attributes:
        poses: Shape (n + 1, 3).
        inputs: Wheel speeds of the true platform [rad/s], shape (n, 2).
        gains: Of the regulator, shape (n, 2, 3).
    """

    poses: Floats
    inputs: Floats
    gains: Floats


def planned_motion(experiment: Experiment, law: NormOptimalLaw) -> PlannedMotion:
    """The motion that learning leads to, within the limit and without disturbances."""
    from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner  # the compiler starts slowly

    learner = NormOptimalLearner(
        law.parameters, experiment.reference, experiment.robot, experiment.speed_limit
    )
    start = np.array(experiment.initial_pose)
    for _ in range(_PLANS):
        plan = learner.plan(start)
    return PlannedMotion(plan.desired, plan.feedforward, plan.gains)


@dataclass(frozen=True, slots=True, eq=False)
class NoisyPasses:
    """The last iteration, a column for each seed; the first one is not disturbed.

    Attributes:
        position_m: Largest position error [m], shape (seeds,).
        change_rad_s: RMS change of the wheel speeds from sample to sample beside the first [rad/s].
        at_limit: Share of samples at which the limit acts.
    """

    position_m: Floats
    change_rad_s: Floats
    at_limit: Floats


def noisy_passes(
    experiment: Experiment, law: NormOptimalLaw, plan: PlannedMotion, seeds: int
) -> NoisyPasses:
    """The last iteration of many seeds.

    Args:
        experiment: With its disturbances, and at least one learning update.
        law: Its law.
        plan: What learning leads to.
        seeds: How many are followed side by side.
    """
    n, draws = experiment.reference.samples, DisturbanceDraws(experiment.disturbance, seeds)
    memory = min(law.parameters.memory if law.parameters.identify else 1, experiment.iterations)
    nothing = np.zeros((n + 1, 3, seeds))
    start_before = _mean(draws.start, 1, memory, nothing[:1])[0]
    state_before = _mean(draws.state, n, memory, nothing[1:])
    left = _smoothed(experiment, _mean(draws.output, n + 1, memory, nothing))
    start, state, output = draws.start.drawn(1), draws.state.drawn(n), draws.output.drawn(n + 1)

    plant = linearise(experiment)
    pushed = -state_before - left[1:] + plant_states(plant.states, left[:-1])
    if state is not None:
        pushed = pushed + state
    away = (0.0 if start is None else start[0]) - start_before - left[0]
    limit = experiment.speed_limit
    deviation = np.empty((n + 1, 3, seeds))
    deviation[0] = away
    gains, applied, held = _gains(experiment, law, plan), np.empty((n, 2, seeds)), np.zeros(seeds)
    for k in range(n):
        now = deviation[k]
        seen = now if output is None else now + output[k]
        speeds = plan.inputs[k][:, None] - gains[k] @ seen
        fastest = np.abs(speeds).max(axis=0)
        if (fastest > limit).any():
            speeds = speeds * np.minimum(1.0, limit / np.maximum(fastest, limit))
            held += fastest > limit * (1 + _WITHIN)
        applied[k] = speeds
        driven = plant.inputs[k] @ (speeds - plan.inputs[k][:, None])
        deviation[k + 1] = plant.states[k] @ now + driven + pushed[k]

    way_in = np.clip(1 - np.arange(n + 1) / min(law.parameters.h, n), 0, 1)[:, None, None]
    meant = (plan.poses - desired_poses(experiment))[:, :, None]
    error = meant + deviation + way_in * (start_before + left[0])
    furthest = np.sqrt((error[:, 0] ** 2 + error[:, 1] ** 2).max(axis=0))
    return NoisyPasses(furthest, changes_beside_first(applied), held / n)


def plant_states(states: Floats, errors: Floats) -> Floats:
    """A_k times errors, shapes (n, 3, 3) and (n, 3, seeds)."""
    return np.ascontiguousarray(states) @ errors


def _gains(experiment: Experiment, law: NormOptimalLaw, plan: PlannedMotion) -> Floats:
    """Those of the regulator, for the believed platform where it stays as it is."""
    from hilc_cli.laws.norm_optimal.linear_quadratic import feedback_gains

    parameters = law.parameters
    if parameters.identify or parameters.feedback == "none":
        return plan.gains
    weights = [parameters.feedback_position**-2, parameters.feedback_heading**-2]
    model = law.model
    return feedback_gains(
        plan.poses,
        *step_gains(model.wheel_radius, model.signed_half_track, experiment.reference.sample_time),
        np.tile(weights, (len(plan.poses), 1)),
        parameters.input_change**-2,
    )


def _mean(source: NoiseDraws, samples: int, memory: int, nothing: Floats) -> Floats:
    """The mean of some iterations."""
    total = nothing
    for _ in range(memory):
        drawn = source.drawn(samples)
        if drawn is None:
            return nothing
        total = total + drawn
    return total / memory


def _smoothed(experiment: Experiment, noise: Floats) -> Floats:
    """What the law's smoother leaves of the readings' noise, shape (n + 1, 3, seeds)."""
    from hilc_cli.laws.norm_optimal.local_level import smoothed  # the compiler starts slowly

    disturbance = experiment.disturbance
    if not disturbance.output.active:
        return noise
    found = np.empty_like(noise)
    pairs = zip(deviations(disturbance.state), deviations(disturbance.output), strict=True)
    for axis, (drift, reading) in enumerate(pairs):
        both = drift**2 + reading**2
        share = drift**2 / both if both else 0.0
        for seed in range(noise.shape[2]):
            found[:, axis, seed] = smoothed(np.ascontiguousarray(noise[:, axis, seed]), share)[0]
    return found


RESOLUTION = 1e-3
"""Share of the path's size below which no error is foretold: what theory leaves out is as large."""
_SELDOM = 0.02
"""Share of an iteration's samples at the limit that a prediction without it need not mind."""


def expected_of_learning(experiment: Experiment, found: Forecast) -> ExpectedError:
    """The error to be expected of the laws hybrid and pid.

    Args:
        experiment: The experiment.
        found: What is predicted of it.
    """
    ensemble, errors = found.ensemble, found.errors_m

    def alone(part: Experiment) -> Floats:
        return noisy_learning(part).final_m

    start, readings, state = _parts(experiment, ensemble.final_m, alone)
    return ExpectedError(
        float(errors[0]),
        float(errors[-1]),
        _foretold(experiment, float(errors[-1]), ensemble.final_m),
        start,
        readings,
        state,
        _unsure(experiment, found),
    )


def expected_of_norm_optimal(
    experiment: Experiment, law: NormOptimalLaw, mismatch: ModelMismatch | None
) -> tuple[ExpectedError, WheelNoise | None]:
    """The error to be expected of the norm-optimal law, and the noise of its wheels.

    Args:
        experiment: The experiment.
        law: Its law.
        mismatch: What a wrong model does to its learning, if it can make up for it by nothing.
    """
    plan = planned_motion(experiment, law)
    away = (plan.poses - desired_poses(experiment))[:, :2]
    planned = float(np.hypot(*away.T).max())
    first = planned if experiment.learn_in_first else open_loop_error(experiment)
    if experiment.iterations == 0:
        return ExpectedError(first, first, first), None
    final = planned
    if mismatch is not None:
        final += first * mismatch.left**experiment.iterations

    def passes(part: Experiment) -> Floats:
        return noisy_passes(part, law, plan, SEEDS).position_m + (final - planned)

    together = noisy_passes(experiment, law, plan, SEEDS)
    errors = together.position_m + (final - planned)
    start, readings, state = _parts(experiment, errors, passes)
    foretold = _foretold(experiment, final, errors)
    wheels = WheelNoise.of_seeds(together.change_rad_s, together.at_limit)
    return ExpectedError(first, final, foretold, start, readings, state), wheels


def _foretold(experiment: Experiment, final: float, errors: Floats) -> float:
    """What the errors of all seeds stay below; so many seeds are as many as the level asks for."""
    return max(final, float(errors.max()), RESOLUTION * extent(experiment))


def _parts(
    experiment: Experiment, together: Floats, alone: Callable[[Experiment], Floats]
) -> Iterator[float]:
    """What the disturbances of start, readings and state add each alone [m].

    Args:
        experiment: With all of them.
        together: Errors of all seeds with all of them, the first one without any.
        alone: The same of an experiment with one of them.
    """
    given = experiment.disturbance
    sources = given.initial_pose, given.output, given.state
    names = "initial_pose", "output", "state"
    for name, source in zip(names, sources, strict=True):
        if not source.active:
            yield 0.0
            continue
        errors = together
        if sum(each.active for each in sources) > 1:
            errors = alone(replace(experiment, disturbance=_only(name, source)))
        yield max(0.0, float(errors.max() - errors[0]))


def _only(name: str, source: Bounded) -> Disturbance:
    return replace(Disturbance(), **{name: source})  # type: ignore[arg-type]  # by its name


def _unsure(experiment: Experiment, found: Forecast) -> str | None:
    ensemble = found.ensemble
    turned = float(ensemble.heading_rad[-1].max())
    if not np.isfinite(ensemble.final_m).all():
        return "predicted errors leave the finite numbers"
    if turned > FAR_HEADING:
        return (
            f"headings are off by up to {turned:.3g} rad in the last iteration, where what is "
            "linear in them no longer holds"
        )
    held = ensemble.at_limit.max(axis=1)
    acts = held[-1] > _SELDOM or held.mean() > _SELDOM
    if acts and not ensemble.is_limited:
        return "controller.b_w acts on the feedback, and so long a path is not followed with that"
    if acts and ensemble.iterations < experiment.iterations:
        return f"controller.b_w acts, which is followed for {ensemble.iterations} iterations only"
    return None
