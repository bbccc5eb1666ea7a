"""The error to be expected of the laws that learn, with what each disturbance makes of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from hilc_cli.analysis.expected_error import ExpectedError
from hilc_cli.analysis.extent import extent
from hilc_cli.analysis.forecast import FAR_HEADING, Forecast
from hilc_cli.analysis.matrices import desired_poses
from hilc_cli.analysis.model_mismatch import ModelMismatch
from hilc_cli.analysis.noise_draws import SEEDS
from hilc_cli.analysis.noisy_learning import noisy_learning
from hilc_cli.analysis.noisy_pass import noisy_passes, planned_motion
from hilc_cli.analysis.open_loop import open_loop_error
from hilc_cli.analysis.wheel_noise import WheelNoise
from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.reference.sampled import Floats

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
