"""The last iteration of the norm-optimal law, with disturbances and on a wrong model.

Disturbed passes are followed about the motion that the law means to drive.
Learning takes away what the model does not explain of the iterations before, but what it takes for
that has their noise in it, too. With d the pose less the planned one, the plant and the regulator
linearised along the reference,

    d(k+1) = A_k d(k) - B_k K_k [d(k) + alpha(k)] + beta(k) - beta'(k) - [a(k+1) - A_k a(k)],

d(0) = s - s' - a(0). Dashes are the mean of the iterations that are remembered, s the start, and a
what is left of their readings' noise after smoothing. The plan itself starts at s' + a(0), where it
takes the platform to be, and is on the trajectory at sample h.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import feedforward, step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, active_sources, expected_of_seeds, extent
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
    from hilc_cli.laws.norm_optimal.learner import OptimalPlan

_WITHIN = 1e-9  # relative: a limit that is met exactly is met in spite of rounding
_PLANS = 3  # updates after which the plan of a platform that is known hardly changes
_FEW_PASSES = 4
"""Iterations up to which the law itself is run: later ones have identified the platform."""
_FEWER_PASSES = 2
"""What more of them leave is taken from so many."""
_MOST_LEARNED = 6000
"""Samples of all iterations that are run for each seed, in some 5 s."""
_TOO_LONG = "what noise makes of identification is not followed over so many samples"
_OTHER_SEEDS = 2**63  # than anybody takes


def planned_motion(experiment: Experiment, law: NormOptimalLaw) -> OptimalPlan:
    """Returns the motion that learning leads to, within the limit and without disturbances."""
    from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner  # the compiler starts slowly

    known = replace(law, model=experiment.robot)
    learner = NormOptimalLearner(known, experiment.reference, experiment.speed_limit)
    start = np.array(experiment.initial_pose)
    for _ in range(_PLANS):
        plan = learner.plan(start)
    return plan


def noisy_passes(
    experiment: Experiment, law: NormOptimalLaw, plan: OptimalPlan, seeds: int
) -> Passes:
    """Returns the last iteration of many seeds, the first of which is not disturbed.

    The plan is what learning leads to, of which the experiment has at least one update.
    """
    n, draws = experiment.reference.samples, DisturbanceDraws(experiment.disturbance, seeds)
    memory = min(law.memory if law.identify else 1, experiment.iterations)
    nothing = np.zeros((n + 1, 3, seeds))
    start_before = _mean(draws.start, 1, memory, nothing[:1])[0]
    state_before = _mean(draws.state, n, memory, nothing[1:])
    left = _smoothed(experiment, _mean(draws.output, n + 1, memory, nothing))
    start, state, output = draws.start.drawn(1), draws.state.drawn(n), draws.output.drawn(n + 1)

    plant = linearise(experiment)
    pushed = -state_before - left[1:] + np.ascontiguousarray(plant.states) @ left[:-1]
    if state is not None:
        pushed = pushed + state
    away = (0.0 if start is None else start[0]) - start_before - left[0]
    limit = experiment.speed_limit
    deviation = np.empty((n + 1, 3, seeds))
    deviation[0] = away
    inputs = np.stack([plan.left, plan.right], axis=1)[:, :, None]
    gains, applied, held = _gains(experiment, law, plan), np.empty((n, 2, seeds)), np.zeros(seeds)
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


def _gains(experiment: Experiment, law: NormOptimalLaw, plan: OptimalPlan) -> Floats:
    """Returns the gains of the regulator, for the believed platform where it stays as it is."""
    from hilc_cli.laws.norm_optimal.linear_quadratic import feedback_gains

    if law.identify or law.feedback == "none":
        return plan.feedback
    weights = [law.feedback_position**-2, law.feedback_heading**-2]
    model = law.model
    return feedback_gains(
        plan.poses,
        *step_gains(model.wheel_radius, model.signed_half_track, experiment.reference.sample_time),
        np.tile(weights, (len(plan.poses), 1)),
        law.input_change**-2,
    )


def _mean(source: NoiseDraws, samples: int, memory: int, nothing: Floats) -> Floats:
    """Returns the mean of what is drawn for some iterations."""
    total = nothing
    for _ in range(memory):
        drawn = source.drawn(samples)
        if drawn is None:
            return nothing
        total = total + drawn
    return total / memory


def _smoothed(experiment: Experiment, noise: Floats) -> Floats:
    """Returns what the law's smoother leaves of the readings' noise, shape (n + 1, 3, seeds)."""
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


def expected_of_norm_optimal(
    experiment: Experiment, law: NormOptimalLaw, iteration_leaves: float
) -> tuple[ExpectedError, Outcome, WheelNoise | None]:
    """Returns the error to be expected, what comes of learning, and the noise of the wheels.

    An iteration leaves so large a share of an error because its model is wrong.
    """
    plan = planned_motion(experiment, law)
    away: Floats = np.hypot(*(plan.poses - experiment.reference.poses)[:, :2].T)
    planned = float(away.max())
    first = planned if experiment.learn_in_first else open_loop_error(experiment)
    if experiment.iterations == 0:
        return ExpectedError(first, first, first), Outcome.NOTHING, None
    left = min(iteration_leaves, 1.0) ** experiment.iterations
    final = planned + first * left
    outcome = _halved(experiment, law, away, left)
    run = min(experiment.iterations, _FEW_PASSES)
    is_too_long = experiment.reference.samples * (run + 1) > _MOST_LEARNED

    together = noisy_passes(experiment, law, plan, SEEDS)

    def known(part: Experiment) -> Floats:
        found = together if part is experiment else noisy_passes(part, law, plan, SEEDS)
        return found.position_m + (final - planned)

    def passes(part: Experiment) -> Floats:
        # Readings are what identification goes wrong by; all noise together has the last word.
        is_spoiled = part.disturbance.output.active or part is experiment
        if not (law.identify and is_spoiled) or is_too_long:
            return known(part)
        if part.iterations <= _FEW_PASSES:
            return _few_passes(part, final)
        # What is identified wrong falls with the root of the passes.
        few = replace(part, iterations=_FEWER_PASSES)
        beyond = max(0.0, _few_passes(few, final).max() ** 2 - known(few).max() ** 2)
        left = beyond * _FEWER_PASSES / part.iterations
        errors = known(part)
        return np.append(errors[:1], np.sqrt(errors[1:] ** 2 + left))

    is_unsure = is_too_long and law.identify and experiment.disturbance.output.active
    unsure = _TOO_LONG if is_unsure else None
    found = expected_of_seeds(experiment, first, final, passes(experiment), passes, unsure)
    return found, outcome, WheelNoise.of_seeds(together.change_rad_s, together.at_limit)


def _few_passes(experiment: Experiment, final: float) -> Floats:
    """Returns errors of the last of few iterations, shape (seeds,), as the law learns in them [m].

    What it has identified from few noisy passes is off, which nothing but the law itself tells.

    Args:
        experiment: With its disturbances.
        final: Without them [m], of the first of the seeds.
    """
    reference, given = experiment.reference, experiment.disturbance
    found = np.full(SEEDS, final)
    if not active_sources(given):
        return found
    for seed in range(1, SEEDS):
        seeded = replace(given, seed=_OTHER_SEEDS + seed)
        try:
            *_, last = simulate(replace(experiment, disturbance=seeded))
        except DivergedError:
            return np.append(found[:-1], np.inf)
        found[seed] = np.hypot(reference.x - last.x, reference.y - last.y).max()
    return found


def _halved(experiment: Experiment, law: NormOptimalLaw, away: Floats, left: float) -> Outcome:
    """Returns what comes of learning towards a motion, by the rule of all laws that learn.

    Args:
        experiment: The experiment.
        law: Its law.
        away: Distance of the motion that learning leads to from the trajectory [m].
        left: Share of the error of iteration 0 that is left in the last one.
    """
    # Where iteration 0 runs the law, learning is held against what there is without it.
    inputs = feedforward(experiment.reference, law.model) if experiment.learn_in_first else None
    first, planned = open_loop_errors(experiment, inputs), away
    if starts_off(experiment):  # as runs are judged
        first, planned = first[len(first) // 2 :], planned[len(planned) // 2 :]
    before = float(first.max())
    errors = np.array([before, float(planned.max()) + left * before])
    found = predicted_outcome(Prospects(errors, np.zeros(0), extent(experiment)))
    # A motion that is further off at one place is so for its squares' sake.
    return Outcome.DOES_NOT_LEARN if found in FAILED else found
