"""What wheel speeds that are given beforehand make of a pass."""

from __future__ import annotations

import numpy as np

from hilc_cli.analysis.noise_draws import deviations
from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedforward import feedforward
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.robot import Robot, driven_path


def open_loop_error(experiment: Experiment, inputs: tuple[Floats, Floats] | None = None) -> float:
    """Largest of `open_loop_errors`."""
    return float(open_loop_errors(experiment, inputs).max())


def open_loop_errors(experiment: Experiment, inputs: tuple[Floats, Floats] | None = None) -> Floats:
    """Position errors of given wheel speeds within the limit, without disturbances [m].

    Args:
        experiment: The experiment.
        inputs: Left and right [rad/s]; those of iteration 0 if not given.

    Returns:
        Shape (n + 1,).
    """
    reference = experiment.reference
    left, right = inputs or (experiment.initial_left, experiment.initial_right)
    fastest = np.maximum(np.abs(left), np.abs(right))
    scale = np.ones(len(fastest))
    beyond = fastest > experiment.speed_limit
    scale[beyond] = experiment.speed_limit / fastest[beyond]
    x, y, _ = driven_path(
        experiment.initial_pose,
        scale * left,
        scale * right,
        experiment.robot,
        reference.sample_time,
    )
    errors: Floats = np.hypot(reference.x - x, reference.y - y)
    return errors


def unlearned_error(experiment: Experiment, model: Robot) -> float:
    """The same of the feedforward of a believed platform [m]."""
    return open_loop_error(experiment, feedforward(experiment.reference, model))


def spread_of_start(reference: Reference, start: Bounded) -> Floats:
    """RMS position error of each sample that a disturbed start alone makes [m], shape (n + 1,).

    A start that is off moves the whole path rigidly, as long as nobody steers.
    """
    x, y, heading = deviations(start)
    away = np.hypot(reference.x - reference.x[0], reference.y - reference.y[0])
    found: Floats = np.sqrt(x**2 + y**2 + (heading * away) ** 2)
    return found
