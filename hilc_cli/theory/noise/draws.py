"""Disturbances of many seeds at once, for estimates: none of them is that of a run."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.disturbance.streams import Bounded, Disturbance, scaled
from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import Robot, driven_path, feedforward
from hilc_cli.reference.sampled import Floats, Reference

_SMALLEST = 1e-10  # of a probability, as a random word of a run has it
SEEDS = 17
"""Side by side, the first of them without disturbances."""


class NoiseDraws:
    """Draws of one disturbance, iteration after iteration."""

    def __init__(self, source: Bounded, seeds: int, key: int) -> None:
        """The first of the seeds is not disturbed.

        Args:
            source: What is drawn from.
            seeds: How many are drawn side by side.
            key: Another one for each disturbance.
        """
        self._source, self._seeds = source, seeds
        self._random = np.random.default_rng(key)
        self._kept: Floats | None = None

    def drawn(self, samples: int) -> Floats | None:
        """Offsets of the next iteration, shape (samples, 3, seeds); None for no disturbance."""
        source = self._source
        if not source.active:
            return None
        if source.repeat and self._kept is not None:
            return self._kept
        found = np.zeros((samples, 3, self._seeds))
        for axis, (bound, deviation) in enumerate(zip(source.bound, source.deviation, strict=True)):
            units = self._random.uniform(_SMALLEST, 1 - _SMALLEST, (samples, self._seeds - 1))
            found[:, axis, 1:] = scaled(units, source.distribution, bound, deviation)
        self._kept = found
        return found


class DisturbanceDraws:
    """Draws of all three disturbances of an experiment."""

    def __init__(self, disturbance: Disturbance, seeds: int) -> None:
        """For so many seeds, the first of which is not disturbed."""
        self.start = NoiseDraws(disturbance.initial_pose, seeds, 1)
        self.state = NoiseDraws(disturbance.state, seeds, 2)
        self.output = NoiseDraws(disturbance.output, seeds, 3)


def deviations(noise: Bounded) -> tuple[float, float, float]:
    """Standard deviations of the components of a disturbance [m, m, rad]."""
    x, y, heading = (
        _deviation(noise.distribution == "uniform", bound, deviation)
        for bound, deviation in zip(noise.bound, noise.deviation, strict=True)
    )
    return x, y, heading


def _deviation(is_uniform: bool, bound: float, deviation: float) -> float:
    if is_uniform or bound == 0:
        return bound / math.sqrt(3)
    if deviation == 0:
        return 0.0
    z = bound / deviation  # of a normal that is cut off at +- z standard deviations
    density = math.exp(-z * z / 2) / math.sqrt(2 * math.pi)
    kept = 1 - 2 * z * density / math.erf(z / math.sqrt(2))
    return min(deviation * math.sqrt(max(0.0, kept)), bound / math.sqrt(3))


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
