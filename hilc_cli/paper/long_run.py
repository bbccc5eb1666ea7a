"""What becomes of an experiment in far more iterations than the paper runs."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

from hilc_cli.engine.batch import simulate_batch
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.feedforward import feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.robot import driven_path
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
    reference, robot = experiment.reference, experiment.robot
    start = (float(reference.x[0]), float(reference.y[0]), float(reference.heading[0]))
    left, right = feedforward(reference, robot)
    x, y, heading = driven_path(start, left, right, robot, reference.sample_time)
    return replace(experiment, reference=replace(reference, x=x, y=y, heading=heading))
