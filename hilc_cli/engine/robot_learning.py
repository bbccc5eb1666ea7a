"""Learning on a real robot: every plan within limits, and back to the best one if passes get worse.

The trajectory is preceded by a standstill, the lead-in, so that inputs that arrive late can be sent
before it begins. To a law that is a part of the path as any other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.laws.law import Figures, Plan
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial

_PATIENCE = 3
"""Passes after the best one by whose median it is judged whether things get worse."""
_CLEARLY = 2.0
"""An error so many times that of the best pass is clearly worse."""
_NOTHING = 1e-2
"""Share of a plan's largest wheel speed below which wheels stand before the trajectory begins."""


def with_standstill(reference: Reference, samples: int) -> Reference:
    """Returns a reference that stands at its start for some samples first."""
    if not samples:
        return reference
    x, y, heading = (
        np.concatenate([np.full(samples, values[0]), values])
        for values in (reference.x, reference.y, reference.heading)
    )
    return replace(
        reference,
        x=x,
        y=y,
        heading=heading,
        segment_ends=tuple(end + samples for end in reference.segment_ends),
    )


def without_lead_in(trial: Trial, lead_in: int) -> Trial:
    """Returns a trial from the start of the trajectory on."""
    names = ["x", "y", "heading", "left", "right", *(["read"] if trial.read is not None else [])]
    return replace(trial, **{name: getattr(trial, name)[lead_in:] for name in names})


def _still_at_first(plan: Plan) -> Plan:
    """The plan, whose wheels stand until what they are told is more than noise."""
    fastest = np.maximum(np.abs(plan.left), np.abs(plan.right))
    moves = fastest[: plan.lead_in] > _NOTHING * fastest.max(initial=0.0)
    still = int(np.argmax(moves)) if moves.any() else plan.lead_in
    left, right = plan.left.copy(), plan.right.copy()
    left[:still] = right[:still] = 0.0
    return replace(plan, left=left, right=right)


@dataclass(slots=True)
class _Best:
    """The best pass so far."""

    iteration: int
    error: float
    plan: Plan
    later: list[float]
    """Errors of the passes since then, or since it was gone back to."""


class RobotLearning:
    """A law at work on a robot that gets plans and gives back what came of them.

    Attributes:
        reference: The trajectory with its lead-in.
        lead_in: Its length in samples.
        returned_to: The iteration whose plan is sent again, being the best so far; None if the
            next plan is a new one.
        share: Share of the way from the best plan to the law's that is taken.
    """

    def __init__(self, experiment: Experiment, limits: SafetyLimits, lead_in: int) -> None:
        """Begins with nothing learned.

        Args:
            experiment: Law and trajectory, the lead-in included.
            limits: Of every plan.
            lead_in: Samples of standstill at the start of the trajectory.
        """
        self.reference = experiment.reference
        self.lead_in = lead_in
        self.returned_to: int | None = None
        self.share = 1.0
        self._limits = limits
        self._learning = Learning(experiment)
        self._best: _Best | None = None
        self._sent: Plan | None = None
        self._plan: Plan | None = None

    def plan(self) -> Plan:
        """Returns what to send next, within all limits; the same until a trial is learned."""
        if self._plan is None:
            self._plan = self._next_plan()
        return self._plan

    def _next_plan(self) -> Plan:
        if self.returned_to is not None and self._best is not None:
            return self._best.plan
        plan = replace(self._learning.unlimited_plan(), lead_in=self.lead_in)
        if self._best is not None and self.share < 1:
            best = self._best.plan
            plan = replace(
                plan,
                left=best.left + self.share * (plan.left - best.left),
                right=best.right + self.share * (plan.right - best.right),
            )
        return self._limits.applied(_still_at_first(plan), self.reference.sample_time, self._sent)

    def learn(self, trial: Trial, planned: Plan) -> Figures:
        """Learns from a trial.

        Args:
            trial: Measured poses and the wheel speeds that were sent, lead-in included, as
                `Learning.learn` takes them.
            planned: The plan that the trial is of.

        Returns:
            What the law has to tell of it, by column of ``learning.csv``.

        Raises:
            UsageError: An array has another length than the trajectory asks for, or is not finite.
        """
        self.plan()  # whoever plans remembers it: whether anybody asked for it makes no difference
        figures = self._learning.learn(trial)
        self._plan, self._sent = None, planned
        self._judge(trial.iteration, self._error(trial), planned)
        return figures

    def _error(self, trial: Trial) -> float:
        """The root mean square of the position error [m]."""
        off: Floats = np.hypot(self.reference.x - trial.x, self.reference.y - trial.y)
        return float(np.sqrt(np.mean(np.square(off[self.lead_in :]))))

    def _judge(self, iteration: int, error: float, planned: Plan) -> None:
        """Takes note of a pass, and goes back if the last ones are clearly worse than the best.

        One bad pass is bad luck, so that the median of several decides.
        """
        returned, self.returned_to, best = self.returned_to, None, self._best
        if best is None or error <= best.error:
            self._best, self.share = _Best(iteration, error, planned, []), min(1.0, 2 * self.share)
        elif returned is not None:  # what was the best once is as good as it is now
            best.error = error
        else:
            best.later.append(error)
            last = best.later[-_PATIENCE:]
            if len(last) == _PATIENCE and float(np.median(last)) > _CLEARLY * best.error:
                best.later.clear()
                self.returned_to, self.share = best.iteration, self.share / 2
