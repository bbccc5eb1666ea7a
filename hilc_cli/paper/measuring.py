"""What becomes of an experiment in far more iterations than the paper runs."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.engine.loop import simulate
from hilc_cli.paper.claim import Figure, Verdict
from hilc_cli.paper.reading import Reading
from hilc_cli.plants.kinematic import driven_path, feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import settled_at
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.loading import load_scenario


def shipped(reading: Reading, name: str, *overrides: str) -> Experiment:
    """A shipped scenario under a reading, with more values replaced.

    Args:
        reading: How the paper is read.
        name: Of the example.
        overrides: Such as ``controller.b_w=null``.
    """
    return load_scenario(f"example:{name}", [*reading.overrides(name), *overrides]).experiment()


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


TRACKED = 0.01
NEARLY = 0.05

TRACKED_WORDS = "maximum error at most 1 % of the path's size"
NEARLY_WORDS = "maximum error at most 5 % of the path's size"


def relative_error(run: RunData) -> float:
    """Maximum position error of the last iteration, as a share of the path's size."""
    return float(run.metrics["max_position_error_m"][-1]) / run.reference.size


def relative_error_after(run: RunData, sample: int) -> float:
    """Maximum error after a sample of the last iteration, as a share of the path's size."""
    error = run.position_error(run.last.iteration)[sample + 1 :]
    return float(error.max()) / run.reference.size


def second_half(run: RunData) -> Floats:
    """Position error of the last iteration over the second half of the samples [m]."""
    return run.position_error(run.last.iteration)[run.reference.samples // 2 :]


def relative_error_in_second_half(run: RunData) -> float:
    """Maximum error in the second half of the last iteration, as a share of the path's size."""
    return float(second_half(run).max()) / run.reference.size


def tracking(errors: Sequence[float]) -> Verdict:
    """Whether paths are tracked: all of them, some or nearly, or none even nearly.

    Args:
        errors: Maximum error of each, as a share of its path's size.
    """
    if all(error <= TRACKED for error in errors):
        return Verdict.HOLDS
    return Verdict.IN_PART if any(error <= NEARLY for error in errors) else Verdict.FAILS


def iterations_needed(run: RunData) -> int | None:
    """First iteration from which on the run nearly tracks; None if it does not at its end."""
    return iterations_needed_by(run.metrics["max_position_error_m"], run.reference.size)


def iterations_needed_by(errors: Floats, size: float) -> int | None:
    """First iteration from which on errors [m] stay below 5 % of the size of a path [m]."""
    return settled_at(errors, NEARLY * size)


def fewer(first: int | None, second: int | None) -> bool:
    """Whether the first needs fewer iterations than the second; none means never."""
    return first is not None and (second is None or first < second)


def percent(name: str, share: float) -> Figure:
    """A share of the path's size as a figure."""
    return Figure(name, 100 * share, "%")


def count(name: str, iterations: int | None) -> Figure:
    """A number of iterations as a figure."""
    return Figure(name, iterations, "iterations")


def roughness(run: RunData) -> float:
    """RMS change of the wheel speeds from sample to sample in the last iteration [rad/s]."""
    changes = [np.diff(run.last.left), np.diff(run.last.right)]
    return float(np.sqrt(np.mean(np.square(changes))))


def kinks(run: RunData) -> float:
    """RMS second difference of the wheel speeds in the last iteration [rad/s]."""
    changes = [np.diff(run.last.left, 2), np.diff(run.last.right, 2)]
    return float(np.sqrt(np.mean(np.square(changes))))
