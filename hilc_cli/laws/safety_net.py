"""A safety net below a learning law: back to the best pass, and smaller steps, where it gets worse.

It stands between a law and whoever runs it, and knows nothing of how the law learns.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean, median
from typing import Any

import numpy as np
from pydantic import Field

from hilc_cli.laws.law import Figures, Iteration, Law, Learner, Plan, Task, WheelController
from hilc_cli.laws.parameters import Controller, Setting
from hilc_cli.reference.sampled import Reference
from hilc_cli.wording import counted
from hilc_cli.yaml_input.model import Flag

STEP_SHARE, WENT_BACK = "step_share", "went_back"
"""Columns of ``learning.csv``: the share of the law's step that the next pass takes, and whether it
starts from the best pass (1) or from the last (0)."""

SMALLER = 0.5
"""What a step is multiplied by with each return."""
_JUDGED, _LEVEL = 3, 7
"""Passes that are judged together, by their median, since one bad pass is bad luck; and passes of
which the median is the level that they are judged by."""
_WORSE = 1.1
"""What is worse by less than this factor is never clearly worse."""
_SURE = 5.0
"""Nor is what is within so many standard deviations from pass to pass,"""
_NO_CHANCE, _FAR = 4.0, 10.0
"""unless three passes are worse by this factor, or one by that."""
_RECENT, _LONG = 6, 24  # passes
_NOTHING = 1e-9  # [m]; smaller errors are rounding


def wheel_error(iteration: Iteration, half_track: float) -> float:
    """Returns the measured error of both wheels' positions along a pass, root mean square [m]."""
    turned = half_track * iteration.error_heading
    with np.errstate(over="ignore", invalid="ignore"):
        squares = iteration.error_x**2 + iteration.error_y**2 + turned**2
        return math.sqrt(float(np.mean(squares)))


class Judge:
    """Tells passes that are clearly worse than the best so far from those with bad luck.

    Errors are compared by their logarithms, in which learning and divergence are straight lines. So
    second differences of neighbouring passes tell how much of an error is chance. Clearly worse is
    a median of three passes above the best level so far by five standard deviations of that
    chance, but by a tenth at least; by a factor of four, however much is chance; and a single pass
    by a factor of ten. A level is the median of seven passes, or of those that there are: the best
    of many passes, or of medians of a few, would be the one with the best luck.
    """

    def __init__(self) -> None:
        self._stretch: deque[float] = deque(maxlen=_LEVEL)
        self._bends: deque[float] = deque(maxlen=_LONG)
        self._best = math.inf

    def is_worse(self, error: float) -> bool:
        """Takes in the error of the next pass [m]; whether the last passes are clearly worse."""
        level = math.log(max(error, _NOTHING)) if error < math.inf else math.inf
        worse = level > self._best + math.log(_FAR)
        self._stretch.append(level)
        last = list(self._stretch)[-_JUDGED:]
        if len(last) == _JUDGED:
            bend = last[0] - 2 * last[1] + last[2]
            self._bends.append(bend if math.isfinite(bend) else 0.0)
            margin = min(max(math.log(_WORSE), _SURE * self._scatter()), math.log(_NO_CHANCE))
            worse = worse or median(last) > self._best + margin
        if len(last) == _JUDGED or self._best == math.inf:
            self._best = min(self._best, median(self._stretch))
        return worse

    def start_anew(self) -> None:
        """Looks at the next passes by themselves, after a return."""
        self._stretch.clear()

    def _scatter(self) -> float:
        """Standard deviation of a pass in logarithms, the larger one of lately and for long."""
        squares = [bend * bend for bend in self._bends]
        # The second difference of independent numbers has six times their variance.
        return math.sqrt(max(fmean(squares), fmean(squares[-_RECENT:])) / 6)


@dataclass(frozen=True, slots=True)
class SafetyNetLaw:
    """A law with a safety net below it.

    Attributes:
        law: Any whose plan follows from the last iteration that it has learned from.
        half_track: Of the believed robot [m].
    """

    law: Law
    half_track: float

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        return _WatchedLearner(self.law.learner(task), task, self.half_track)


class _WatchedLearner:
    """The law at work on one experiment."""

    def __init__(self, inner: Learner, task: Task, half_track: float) -> None:
        self._inner, self._half_track = inner, half_track
        self._reference = task.reference
        self._judge = Judge()
        self._from = task.initial_left, task.initial_right
        self._best: Iteration | None = None
        self._least = math.inf
        self._share = 1.0

    def plan(self) -> Plan:
        """Returns the law's plan, or one that goes a part of the way there."""
        plan, share = self._inner.plan(), self._share
        if share == 1:
            return plan
        left, right = (
            start + share * (wanted - start)
            for start, wanted in zip(self._from, (plan.left, plan.right), strict=True)
        )
        feedback = plan.feedback
        if feedback is not None:
            start = [wheel.tolist() for wheel in self._from]
            feedback = _part_of_the_way(plan.controller(self._reference), start, share)
        return replace(plan, left=left, right=right, feedback=feedback)

    def learn(self, iteration: Iteration) -> Figures:
        """Has the law learn from a pass, or from the best one if it has become clearly worse."""
        error = wheel_error(iteration, self._half_track)
        if self._best is None or error < self._least:
            self._best, self._least = iteration, error
        worse = self._judge.is_worse(error)
        if worse:
            iteration = self._best
            self._share *= SMALLER
            self._judge.start_anew()
        self._from = iteration.left, iteration.right
        figures = self._inner.learn(iteration)
        return {**figures, STEP_SHARE: self._share, WENT_BACK: float(worse)}


def _part_of_the_way(
    controller: WheelController, start: Sequence[list[float]], share: float
) -> WheelController:
    """Returns a controller that goes a share of the way from learned wheel speeds to another's."""
    lefts, rights = start

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        left, right = controller(k, cos, sin, error_x, error_y, error_heading)
        return lefts[k] + share * (left - lefts[k]), rights[k] + share * (right - rights[k])

    return wheel_speeds


def returns_in_words(figures: Figures) -> str:
    """Returns how often learning has gone back, and what is left of its steps."""
    share = figures[STEP_SHARE]
    times = counted(round(math.log(share, SMALLER)), "time")
    return (
        f"learning made passes clearly worse and went back to the best one {times}: steps are "
        f"now {share:g}"
    )


class WithSafetyNet(Controller):
    """The parameters of a law below which a safety net may be put."""

    safety_net: Flag = Field(
        False, description="go back to the best pass, and take smaller steps, where it gets worse"
    )

    def learning_law(self, setting: Setting) -> Law:
        """The law, with the net below it if there is one."""
        law = self.law_for(setting)
        return SafetyNetLaw(law, setting.model.half_track) if self.safety_net else law

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data, with the net only if there is one."""
        data = super().resolved(reference)
        if not self.safety_net:
            del data["safety_net"]
        return data

    def figures(self) -> tuple[str, ...]:
        """What the net has done."""
        return (STEP_SHARE, WENT_BACK) if self.safety_net else ()

    @property
    def called(self) -> str:
        """The law as messages name it; with the net it is another one."""
        return f"law {self.law}" + (" with safety_net: true" if self.safety_net else "")

    def warnings_after(self, figures: Mapping[str, float]) -> list[str]:
        """That the net has caught the law."""
        if figures.get(STEP_SHARE, 1.0) == 1:
            return []
        return [f"{returns_in_words(figures)} of what the gains say; give smaller gains"]
