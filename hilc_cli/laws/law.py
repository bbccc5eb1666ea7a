"""What is asked of a learning law: a plan for the next iteration, from those that are over.

A law is plain data: its parameters, the believed robot among them. For each experiment it gives a
learner, which keeps whatever is learned from iteration to iteration, be it the last iteration alone
or an estimate that grows with each. An engine applies the plan, or whoever drives a robot.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hilc_cli.plants.kinematic import limit_wheel_speeds
from hilc_cli.reference.sampled import Floats, Reference

WheelController = Callable[[int, float, float, float, float, float], tuple[float, float]]
"""The wheel speeds at one sample of the running iteration, before the speed limit.

Called once for each sample k = 0, 1, ... in order, with k, the cosine and sine of the measured
heading, and the measured error in x [m], y [m] and heading [rad]; returns left and right [rad/s].
"""


class NumericController(ABC):
    """A controller whose numbers are known to an engine that has machine code for it."""

    @abstractmethod
    def controller(self) -> WheelController:
        """Returns the controller for one pass."""


Figures = Mapping[str, float]
"""What a law has to tell of an iteration, by column of ``learning.csv``, units in the names.

The same names in every iteration, not-a-number where there is no such figure.
"""

NO_FIGURES: Figures = {}


@dataclass(frozen=True, slots=True, eq=False)
class Iteration:
    """What was measured in one iteration: all that a law may learn from.

    Attributes:
        left: Speed of the left wheel that the plant got [rad/s], shape (n,).
        right: Speed of the right wheel that the plant got [rad/s], shape (n,).
        error_x: Reference less measured output [m], shape (n + 1,).
        error_y: Likewise [m], shape (n + 1,).
        error_heading: Likewise [rad], shape (n + 1,).
        read: Whether a pose was measured at the sample, shape (n + 1,); where not, its error lies
            between those of others. None: at all.
    """

    left: Floats
    right: Floats
    error_x: Floats
    error_y: Floats
    error_heading: Floats
    read: NDArray[np.bool_] | None = None

    @property
    def errors(self) -> tuple[Floats, Floats, Floats]:
        """The errors in x, y and heading."""
        return self.error_x, self.error_y, self.error_heading


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """What a law wants of the next iteration, made before that runs.

    Attributes:
        left: Feedforward speed of the left wheel [rad/s], shape (n,).
        right: Feedforward speed of the right wheel [rad/s], shape (n,).
        poses: Where the plan is to lead: x [m], y [m] and heading [rad], shape (n + 1, 3). A law
            that plans no motion of its own aims at the reference. The believed robot's motion
            would be another one: what has been learned makes up for a wrong belief, too.
        feedback: What answers to the poses that are measured on the way; None if nothing does.
            Gains K, shape (n, 2, 3), add K(k) (poses(k) - measured(k)) to the feedforward; a
            function, or what can be made one, gives the wheel speeds themselves.
        lead_in: Samples by which the plan begins before the trajectory does, as it has to where
            inputs arrive late; they are among the n.
    """

    left: Floats
    right: Floats
    poses: Floats
    feedback: Floats | NumericController | WheelController | None = None
    lead_in: int = field(default=0, kw_only=True)

    def controller(self, reference: Reference) -> WheelController:
        """Returns the controller that runs the plan, given errors against a reference."""
        left, right = self.left.tolist(), self.right.tolist()
        if self.feedback is None:
            return lambda k, cos, sin, error_x, error_y, error_heading: (left[k], right[k])
        if isinstance(self.feedback, NumericController):
            return self.feedback.controller()
        if not isinstance(self.feedback, np.ndarray):
            return self.feedback
        # Errors are told against the reference; the planned poses are others.
        away = self.poses - reference.poses
        rows = np.concatenate([self.feedback.reshape(-1, 6), away[:-1]], axis=1).tolist()

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            lx, ly, lh, rx, ry, rh, away_x, away_y, away_heading = rows[k]
            x, y, heading = error_x + away_x, error_y + away_y, error_heading + away_heading
            return (
                left[k] + lx * x + ly * y + lh * heading,
                right[k] + rx * x + ry * y + rh * heading,
            )

        return wheel_speeds

    def within(self, speed_limit: float) -> Plan:
        """Returns the plan with its feedforward within a speed limit [rad/s] (Eq. 25)."""
        pairs = zip(self.left.tolist(), self.right.tolist(), strict=True)
        limited = [limit_wheel_speeds(left, right, speed_limit) for left, right in pairs]
        left, right = np.array(limited).T.copy()
        return replace(self, left=left, right=right)

    def times(self, sample_time: float) -> Floats:
        """Returns the time of each pose [s], 0 where the trajectory begins, shape (n + 1,).

        Args:
            sample_time: d_t [s].
        """
        samples = np.arange(-self.lead_in, len(self.poses) - self.lead_in, dtype=np.float64)
        return samples * sample_time

    def with_lead_in(self, samples: int) -> Plan:
        """Returns the feedforward of the plan with another lead-in.

        Where it gets longer, the wheels stand; where it gets shorter, they have to have stood.
        """
        more, less = max(samples - self.lead_in, 0), max(self.lead_in - samples, 0)
        still = np.zeros(more)
        return Plan(
            np.concatenate([still, self.left[less:]]),
            np.concatenate([still, self.right[less:]]),
            np.concatenate([np.repeat(self.poses[:1], more, axis=0), self.poses[less:]]),
            lead_in=samples,
        )

    @property
    def shortest(self) -> Plan:
        """The feedforward of the plan without a standstill at the start of its lead-in."""
        moves = (self.left[: self.lead_in] != 0) | (self.right[: self.lead_in] != 0)
        return self.with_lead_in(self.lead_in - int(np.argmax(moves)) if moves.any() else 0)


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What a law knows of an experiment before its first iteration.

    Attributes:
        reference: The trajectory to follow; it has the sample time.
        initial_left: u_0 of the left wheel [rad/s], shape (n,).
        initial_right: u_0 of the right wheel [rad/s], shape (n,).
        speed_limit: b_w [rad/s]; infinity for none.
    """

    reference: Reference
    initial_left: Floats
    initial_right: Floats
    speed_limit: float

    @property
    def first_plan(self) -> Plan:
        """The plan that sends u_0 as it is."""
        return Plan(self.initial_left, self.initial_right, self.reference.poses)


class Learner(Protocol):
    """A law at work on one experiment."""

    def plan(self) -> Plan:
        """Plans the next iteration from all that has been learned so far."""

    def learn(self, iteration: Iteration) -> Figures:
        """Takes in an iteration that is over, whether its plan came from here or not.

        Numbers close to divergence may overflow here without harm: what is not finite ends the
        run in the next iteration.

        Args:
            iteration: What was measured in it.

        Returns:
            What there is to tell of it.
        """


class Law(Protocol):
    """A learning law with its parameters: plain data, so that it can be sent to other processes."""

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment, with nothing learned yet."""


class LastIteration:
    """A learner that remembers the last iteration alone, and has nothing to tell."""

    def __init__(self, task: Task, after: Callable[[Iteration], Plan]) -> None:
        """Begins with what makes a plan of the iteration before."""
        none = np.zeros(task.reference.samples + 1)  # u_0, and no error, stands for one before
        self._last = Iteration(task.initial_left, task.initial_right, none, none, none)
        self._after = after

    def plan(self) -> Plan:
        """Returns the plan that follows from the last iteration."""
        return self._after(self._last)

    def learn(self, iteration: Iteration) -> Figures:
        """Remembers the iteration in the place of the one before."""
        self._last = iteration
        return NO_FIGURES
