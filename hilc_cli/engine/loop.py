"""The loop engine: one experiment in plain Python, easy to step through in a debugger.

Where many samples are to come it takes machine code of the same formulas, see `compiled_pass`: to
the bit nothing changes.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from dataclasses import replace
from functools import partial

import numpy as np

from hilc_cli.disturbance.streams import UnitNumbers, unit_numbers
from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.errors import DivergedError
from hilc_cli.laws.law import Plan
from hilc_cli.plants.kinematic import limit_wheel_speeds
from hilc_cli.plants.plant import Plant, Pose
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import METRICS, measure
from hilc_cli.results.trial import Trial, is_finite


def simulate(experiment: Experiment, learning: Learning | None = None) -> Generator[Trial]:
    """Runs iterations 0..N, one at a time: what is not kept by the caller is forgotten.

    Args:
        experiment: The experiment.
        learning: Its learning, from which the caller can take a plan when all is over; None for
            one that nobody else sees.

    Yields:
        Each iteration as it is completed.

    Raises:
        DivergedError: An iteration left the finite numbers; it is not yielded.
        PlantError: The plant cannot go on.
    """
    learning = Learning(experiment) if learning is None else learning
    compiled = _takes_machine_code(experiment)
    with experiment.plant.session() as plant:
        for iteration in range(experiment.iterations + 1):
            plan = learning.unlimited_plan()
            trial, measured = _run_iteration(experiment, plant, iteration, plan, compiled)
            figures = learning.take_in(measured)
            yield replace(trial, figures=figures) if figures else trial


_PAYS = 400_000
"""Samples of a run from which on machine code is faster although it must be loaded."""


def prepare_machine_code() -> None:
    """Loads, or compiles for all processes, what many runs to come will take."""
    from hilc_cli.engine.compiled_pass import prepare  # the compiler starts slowly

    prepare()


def _takes_machine_code(experiment: Experiment) -> bool:
    samples = experiment.reference.samples * (experiment.iterations + 1)
    if "hilc_cli.numba_loading" not in sys.modules and samples < _PAYS:
        return False
    from hilc_cli.engine.compiled_pass import moves, pays  # the compiler starts slowly

    return moves(experiment.plant) and pays(samples)


def _run_iteration(
    experiment: Experiment, plant: Plant, iteration: int, plan: Plan, compiled: bool
) -> tuple[Trial, Trial]:
    """Runs one pass over the trajectory.

    Args:
        experiment: The experiment.
        plant: Its plant, in session.
        iteration: Number of the pass.
        plan: What to send in it.
        compiled: Whether to take machine code where there is some.

    Returns:
        The true motion, and the same with the measured output y = q + alpha (Eq. 11).

    Raises:
        DivergedError: The pass left the finite numbers.
    """
    reference, disturbance = experiment.reference, experiment.disturbance
    steps = reference.samples
    units = _unit_numbers() if compiled else unit_numbers
    beta = disturbance.of_state(iteration, steps, units)
    alpha = disturbance.of_output(iteration, steps + 1, units)
    offset = disturbance.of_initial_pose(iteration)
    x, y, heading = (p + o for p, o in zip(experiment.initial_pose, offset, strict=True))
    run_pass = _machine_code(experiment, plan) if compiled else None
    run_pass = run_pass or partial(_run_pass, plant)
    poses, inputs, saturated = run_pass(experiment, plan, (x, y, heading), beta, alpha)
    if poses is None:
        raise DivergedError(iteration)
    xs, ys, headings = poses
    lefts, rights = inputs
    trial = Trial(iteration, xs, ys, headings, lefts, rights, saturated)
    if not _stayed_finite(trial, reference):
        raise DivergedError(iteration)
    if alpha is None:
        return trial, trial
    return trial, replace(
        trial,
        x=trial.x + alpha[:, 0],
        y=trial.y + alpha[:, 1],
        heading=trial.heading + alpha[:, 2],
    )


def _stayed_finite(trial: Trial, reference: Reference) -> bool:
    end = float(trial.x[-1]), float(trial.y[-1]), float(trial.heading[-1])
    with np.errstate(over="ignore", invalid="ignore"):
        off_x, off_y = np.abs(reference.x - trial.x), np.abs(reference.y - trial.y)
        # The corner of the box around all errors is as far out as any of them, and sooner found.
        if is_finite(math.hypot(off_x.max(), off_y.max()), *end):
            return True
        return is_finite(float(np.hypot(off_x, off_y).max()), *end)


_Motion = tuple[Floats | None, Floats, int]
"""Poses, shape (3, n + 1), None if it left the finite numbers on the way; wheel speeds within the
limit, shape (2, n); at how many samples that acted."""


def _unit_numbers() -> UnitNumbers:
    """What draws the same numbers in machine code."""
    from hilc_cli.disturbance import compiled_streams

    return compiled_streams.unit_numbers


def _machine_code(experiment: Experiment, plan: Plan) -> Callable[..., _Motion] | None:
    """What runs a plan in machine code; None if there is none for it."""
    from hilc_cli.engine.compiled_pass import knows, run_pass

    return run_pass if knows(plan, experiment.reference) else None


def _run_pass(
    plant: Plant,
    experiment: Experiment,
    plan: Plan,
    start: Pose,
    beta: Floats | None,
    alpha: Floats | None,
) -> _Motion:
    reference = experiment.reference
    speed_limit, controller = experiment.speed_limit, plan.controller(reference)
    desired_x = reference.x.tolist()
    desired_y = reference.y.tolist()
    desired_heading = reference.heading.tolist()
    state_noise = None if beta is None else beta.tolist()
    output_noise = None if alpha is None else alpha.tolist()
    x, y, heading = start
    step = plant.start(start, reference.sample_time)
    xs, ys, headings = [x], [y], [heading]
    lefts: list[float] = []
    rights: list[float] = []
    saturated = 0
    for k in range(reference.samples):
        seen_x, seen_y, seen_heading = x, y, heading
        if output_noise is not None:
            # Eq. 11: the controller sees y = q + alpha, its gain heading included.
            noise_x, noise_y, noise_heading = output_noise[k]
            seen_x, seen_y, seen_heading = x + noise_x, y + noise_y, heading + noise_heading
        try:
            cos, sin = math.cos(seen_heading), math.sin(seen_heading)
        except ValueError:  # Python's "math domain error" of an infinite heading
            return None, np.array([lefts, rights]), saturated
        left, right = controller(
            k,
            cos,
            sin,
            desired_x[k] - seen_x,
            desired_y[k] - seen_y,
            desired_heading[k] - seen_heading,
        )
        limited_left, limited_right = limit_wheel_speeds(left, right, speed_limit)  # Eq. 25
        if limited_left != left or limited_right != right:
            saturated += 1
        # The limited speeds are also what the next iteration learns from.
        x, y, heading = step((x, y, heading), limited_left, limited_right)
        if state_noise is not None:
            noise_x, noise_y, noise_heading = state_noise[k]
            x, y, heading = x + noise_x, y + noise_y, heading + noise_heading  # Eq. 11
        lefts.append(limited_left)
        rights.append(limited_right)
        xs.append(x)
        ys.append(y)
        headings.append(heading)
    return np.array([xs, ys, headings]), np.array([lefts, rights]), saturated


class MeasuredTrials:
    """The completed iterations of an experiment with their metrics; a divergence ends them.

    Only the last iteration is remembered: whoever goes through them keeps what is wanted.

    Attributes:
        last: The last iteration that has been completed; None if none has.
        diverged_at: The iteration that left the finite numbers; None if none has.
    """

    def __init__(
        self,
        experiment: Experiment,
        learning: Learning | None = None,
        names: Iterable[str] = METRICS,
    ) -> None:
        """Takes what is run.

        Args:
            experiment: The experiment.
            learning: Its learning if plans are to be asked for, see `simulate`.
            names: Which metrics are wanted.
        """
        self._experiment, self._learning, self._names = experiment, learning, tuple(names)
        self.last: Trial | None = None
        self.diverged_at: int | None = None

    def __iter__(self) -> Iterator[tuple[Trial, dict[str, float]]]:
        try:
            # Closed as soon as nobody goes on, so that a plant's program ends with it.
            with closing(simulate(self._experiment, self._learning)) as trials:
                for trial in trials:
                    metrics = measure(trial, self._experiment.reference, self.last, self._names)
                    self.last = trial
                    yield trial, metrics
        except DivergedError as error:
            self.diverged_at = error.iteration
