"""What an engine runs, and its learning, pass by pass, whoever drives: an engine or a robot.

It knows nothing of files.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.disturbance.streams import Disturbance, Triple
from hilc_cli.errors import UsageError
from hilc_cli.laws.law import Figures, Iteration, Law, Plan, Task
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.plant import Plant
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial


@dataclass(frozen=True, slots=True, eq=False)
class Experiment:
    """One learning experiment, every number resolved.

    Attributes:
        reference: The trajectory y_d, n + 1 samples.
        plant: The platform as it really moves; what the controller believes is in the law.
        law: The learning law.
        initial_pose: Pose at which each iteration starts [m, m, rad], before its disturbance.
        initial_left: u_0 of the left wheel [rad/s], shape (n,).
        initial_right: u_0 of the right wheel [rad/s], shape (n,).
        learn_in_first: Whether iteration 0 already runs the law, from u_0 and no error, instead
            of applying u_0 as it is.
        iterations: Number of learning updates N; iterations 0..N are run.
        speed_limit: b_w [rad/s]; infinity for none.
        disturbance: Disturbances of state, output and initial pose.
    """

    reference: Reference
    plant: Plant
    law: Law
    initial_pose: Triple
    initial_left: Floats
    initial_right: Floats
    learn_in_first: bool
    iterations: int
    speed_limit: float
    disturbance: Disturbance

    @property
    def robot(self) -> Robot:
        """The true platform."""
        return self.plant.robot


class Learning:
    """A law at work: a plan, the trial that came of it, the next plan, and so on.

    Attributes:
        reference: The trajectory that is to be followed.
    """

    def __init__(self, experiment: Experiment) -> None:
        self.reference = experiment.reference
        self._speed_limit = experiment.speed_limit
        task = Task(
            experiment.reference,
            experiment.initial_left,
            experiment.initial_right,
            experiment.speed_limit,
        )
        self._learner = experiment.law.learner(task)
        self._plan = None if experiment.learn_in_first else task.first_plan

    def plan(self) -> Plan:
        """Returns what to send next, within the speed limit; the same until a trial is learned.

        Its feedback, if it has one, still answers beyond the limit.
        """
        return self.unlimited_plan().within(self._speed_limit)

    def unlimited_plan(self) -> Plan:
        """Returns the plan as the law made it: whoever applies it sees where the limit acts."""
        if self._plan is None:
            # On the way to divergence products overflow; that shows in the state they lead to.
            with np.errstate(over="ignore", invalid="ignore"):
                self._plan = self._learner.plan()
        return self._plan

    def learn(self, trial: Trial) -> Figures:
        """Learns from a trial, whether its wheel speeds came from a plan of here or not.

        Args:
            trial: The measured poses x [m], y [m] and heading [rad, not wrapped], shape (n + 1,)
                each, and the wheel speeds that were sent [rad/s], shape (n,) each.

        Returns:
            What the law has to tell of it, by column of ``learning.csv``.

        Raises:
            UsageError: An array has another length than the trajectory asks for, or is not finite.
        """
        _check(trial, self.reference)
        return self.take_in(trial)

    def take_in(self, trial: Trial) -> Figures:
        """Learns from a trial whatever it holds: an engine notices divergence by itself."""
        reference = self.reference
        measured = Iteration(
            trial.left,
            trial.right,
            reference.x - trial.x,
            reference.y - trial.y,
            reference.heading - trial.heading,
            trial.read,
        )
        self._plan = None
        with np.errstate(over="ignore", invalid="ignore"):
            return self._learner.learn(measured)


def _check(trial: Trial, reference: Reference) -> None:
    """Raises what `Learning.learn` raises."""
    n = reference.samples
    arrays: list[tuple[str, Floats, int]] = [
        *((name, getattr(trial, name), n + 1) for name in ("x", "y", "heading")),
        *((name, getattr(trial, name), n) for name in ("left", "right")),
    ]
    for name, values, length in arrays:
        if np.shape(values) != (length,):
            raise UsageError(
                f"{name} of the trial must have {length} numbers for the {n} samples of "
                f"{reference.name!r}, got shape {np.shape(values)}"
            )
        if not np.isfinite(values).all():
            raise UsageError(f"{name} of the trial must be finite")
