"""What becomes of an experiment in far more iterations than the paper runs."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hilc_cli.engine.batch import simulate_batch
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.feedforward import feedforward
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.robot import Robot, step_gains
from hilc_cli.spec.loading import load_scenario


def shipped(name: str, *overrides: str) -> Experiment:
    """A shipped scenario with some values replaced, such as ``controller.b_w=null``."""
    return load_scenario(f"example:{name}", overrides).experiment()


def errors_of(experiments: Sequence[Experiment]) -> list[Floats]:
    """Maximum position error [m] of each iteration, an array for each experiment."""
    errors = simulate_batch(experiments).errors
    return [
        row[: experiment.iterations + 1]
        for row, experiment in zip(errors, experiments, strict=True)
    ]


def last_trial(experiment: Experiment) -> Trial:
    """The last iteration with all its samples.

    Raises:
        DivergedError: The experiment leaves the finite numbers.
    """
    return deque(simulate(experiment), maxlen=1)[0]


def on_reachable_reference(experiment: Experiment) -> Experiment:
    """The experiment with the reference that its own feedforward gives without any error.

    The samples of an arc cannot be reached by the Euler plant, which steps along the tangent: on
    a circle it drifts sideways by half a step's turn. Theorems that assume an input with no error
    are tested where there is one.
    """
    reference = _driven(experiment.reference, experiment.robot)
    return replace(experiment, reference=reference)


def _driven(reference: Reference, robot: Robot) -> Reference:
    left, right = feedforward(reference, robot)
    distance_gain, turn_gain = step_gains(
        robot.wheel_radius, robot.signed_half_track, reference.sample_time
    )
    distance = distance_gain * (left + right)
    heading = reference.heading[0] + _running_sum(turn_gain * (left - right))
    x = reference.x[0] + _running_sum(distance * np.cos(heading[:-1]))  # Eq. 8
    y = reference.y[0] + _running_sum(distance * np.sin(heading[:-1]))
    return replace(reference, x=x, y=y, heading=heading)


def _running_sum(steps: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(steps)])
