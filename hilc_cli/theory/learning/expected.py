"""The error to be expected of the laws that learn, with what each disturbance makes of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, extent
from hilc_cli.theory.laws.model_mismatch import ModelMismatch
from hilc_cli.theory.learning.forecast import FAR_HEADING, Forecast
from hilc_cli.theory.learning.outcome import FAILED, Outcome, Prospects, predicted_outcome
from hilc_cli.theory.matrices import desired_poses
from hilc_cli.theory.noise.draws import SEEDS, open_loop_error, open_loop_errors
from hilc_cli.theory.noise.learning import noisy_learning
from hilc_cli.theory.noise.passes import noisy_passes, planned_motion
from hilc_cli.theory.noise.wheels import WheelNoise

RESOLUTION = 1e-3
"""Share of the path's size below which no error is foretold: what theory leaves out is as large."""
_NONE = 1e-9  # an initial error up to this [m and rad] is rounding
_FEW_PASSES = 4
"""Iterations up to which the law itself is run: later ones have identified the platform."""
_FEWER_PASSES = 2
"""What more of them leave is taken from so many."""
_MOST_LEARNED = 6000
"""Samples of all iterations that are run for each seed, in some 5 s."""
_TOO_LONG = "what noise makes of identification is not followed over so many samples"
_OTHER_SEEDS = 2**63  # than anybody takes
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
        _is_floor(experiment, ensemble.final_m),
    )


def expected_of_norm_optimal(
    experiment: Experiment, law: NormOptimalLaw, mismatch: ModelMismatch | None
) -> tuple[ExpectedError, Outcome, WheelNoise | None]:
    """The error to be expected of the norm-optimal law, what comes of it, and the wheels' noise.

    Args:
        experiment: The experiment.
        law: Its law.
        mismatch: What a wrong model does to its learning, if it can make up for it by nothing.
    """
    plan = planned_motion(experiment, law)
    away: Floats = np.hypot(*(plan.poses - desired_poses(experiment))[:, :2].T)
    planned = float(away.max())
    first = planned if experiment.learn_in_first else open_loop_error(experiment)
    if experiment.iterations == 0:
        return ExpectedError(first, first, first), Outcome.NOTHING, None
    left = 0.0 if mismatch is None else min(mismatch.left, 1.0) ** experiment.iterations
    final = planned + first * left
    outcome = _halved(experiment, law, away, left)
    run = min(experiment.iterations, _FEW_PASSES)
    is_noisy = experiment.disturbance.output.active
    is_too_long = experiment.reference.samples * (run + 1) > _MOST_LEARNED

    def known(part: Experiment) -> Floats:
        return noisy_passes(part, law, plan, SEEDS).position_m + (final - planned)

    def passes(part: Experiment) -> Floats:
        # Readings are what identification goes wrong by; all noise together has the last word.
        is_spoiled = part.disturbance.output.active or part is experiment
        if not (law.parameters.identify and is_spoiled) or is_too_long:
            return known(part)
        if part.iterations <= _FEW_PASSES:
            return _few_passes(part, final)
        # What is identified wrong falls with the root of the passes.
        few = replace(part, iterations=_FEWER_PASSES)
        beyond = max(0.0, _few_passes(few, final).max() ** 2 - known(few).max() ** 2)
        left = beyond * _FEWER_PASSES / part.iterations
        errors = known(part)
        return np.append(errors[:1], np.sqrt(errors[1:] ** 2 + left))

    together, errors = noisy_passes(experiment, law, plan, SEEDS), passes(experiment)
    start, readings, state = _parts(experiment, errors, passes)
    found = ExpectedError(
        first,
        final,
        _foretold(experiment, final, errors),
        start,
        readings,
        state,
        _TOO_LONG if is_too_long and law.parameters.identify and is_noisy else None,
        _is_floor(experiment, errors),
    )
    return found, outcome, WheelNoise.of_seeds(together.change_rad_s, together.at_limit)


def _few_passes(experiment: Experiment, final: float) -> Floats:
    """Errors of the last of few iterations, shape (seeds,), as the law learns in them [m].

    What it has identified from few noisy passes is off, which nothing but the law itself tells.

    Args:
        experiment: With its disturbances.
        final: Without them [m], of the first of the seeds.
    """
    reference, given = experiment.reference, experiment.disturbance
    found = np.full(SEEDS, final)
    if not any(each.active for each in (given.initial_pose, given.output, given.state)):
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
    """What comes of learning towards a motion, by the rule of all laws that learn.

    Args:
        experiment: The experiment.
        law: Its law.
        away: Distance of the motion that learning leads to from the trajectory [m].
        left: Share of the error of iteration 0 that is left in the last one.
    """
    # Where iteration 0 runs the law, learning is held against what there is without it.
    inputs = feedforward(experiment.reference, law.model) if experiment.learn_in_first else None
    first, planned = open_loop_errors(experiment, inputs), away
    pose = desired_poses(experiment)[0]
    if np.abs(pose - experiment.initial_pose).max() > _NONE:  # as runs are judged
        first, planned = first[len(first) // 2 :], planned[len(planned) // 2 :]
    before = float(first.max())
    errors = np.array([before, float(planned.max()) + left * before])
    found = predicted_outcome(Prospects(errors, np.zeros(0), extent(experiment)))
    # A motion that is further off at one place is so for its squares' sake.
    return Outcome.DOES_NOT_LEARN if found in FAILED else found


def _foretold(experiment: Experiment, final: float, errors: Floats) -> float:
    """What the errors of all seeds stay below; so many seeds are as many as the level asks for."""
    return max(final, float(errors.max()), RESOLUTION * extent(experiment))


def _is_floor(experiment: Experiment, errors: Floats) -> bool:
    """Whether the errors of all seeds are below what is foretold at least."""
    return bool(errors.max() < RESOLUTION * extent(experiment))


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
