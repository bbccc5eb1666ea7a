"""What it does to a pass that wheels are late, which a law is not told of."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.arriving import ArrivingLaw
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.safety_net import SafetyNetLaw
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.motor import Motor
from hilc_cli.theory.findings import Findings, Rows
from hilc_cli.theory.late_loop import (
    DrivenRobot,
    LateLoop,
    believed_robot,
    late_loops,
    loops_of,
    planned_task,
)
from hilc_cli.theory.reach import driven_error

UNTOLD = 0.05
"""Delay or lag [s] whose effect is told: 50 ms, which hardly any robot is without."""


@dataclass(frozen=True, slots=True)
class Effect:
    """What a delay or a lag of `UNTOLD` does to a pass of a robot that is else as it is believed.

    Attributes:
        open_loop_m: Largest position error of the feedforward alone [m]; infinite if not finite.
        error_m: Likewise with the law's feedback in the pass; None if it has none.
        is_stable: Whether no error grows there; None likewise.
    """

    open_loop_m: float
    error_m: float | None = None
    is_stable: bool | None = None


class Lateness:
    """The delay margin of a law's feedback in the pass, and what `UNTOLD` does."""

    def __init__(self, experiment: Experiment) -> None:
        self._experiment = experiment

    @property
    def is_known(self) -> bool:
        """Whether the law is one of hilc's own, of which all this can be told."""
        law: object = self._experiment.law
        while isinstance(law, ArrivingLaw | SafetyNetLaw):
            law = law.law
        return hasattr(law, "theory")

    @cached_property
    def loops(self) -> list[LateLoop] | None:
        """The loops of the feedback in a pass from which nothing is known yet; see `late_loops`."""
        return late_loops(self._experiment)

    @property
    def own(self) -> Motor:
        """The robot's own motor, as far as it is known."""
        plant = self._experiment.plant
        return plant.drivetrain.motor if isinstance(plant, ImperfectPlant) else Motor()

    @property
    def told(self) -> Motor:
        """The motor that the law is told of."""
        _, drivetrain = believed_robot(self._experiment)
        return Motor() if drivetrain is None else drivetrain.motor

    @property
    def has_feedback(self) -> bool:
        """Whether something in a pass answers to errors of that pass."""
        return self.loops is None or bool(self.loops)

    @cached_property
    def narrowest(self) -> tuple[float, LateLoop] | None:
        """The delay margin [s] and the loop that has it; infinite above the path's duration.

        None if there is no feedback, or one of which it is not known.
        """
        return _narrowest(self.loops, self._longest, self.told)

    @cached_property
    def narrowest_identified(self) -> tuple[float, LateLoop] | None:
        """The same of norm-optimal learning that has identified the robot's own motor.

        Its feedback is then as fast as delay and lag let it be; noise may have made it slower.
        """
        experiment, law = self._experiment, self._experiment.law
        if not isinstance(law, NormOptimalLaw) or law.feedback == "none":
            return None
        from hilc_cli.laws.norm_optimal.motor import Motor as BelievedMotor  # the compiler is slow
        from hilc_cli.laws.norm_optimal.pose_regulator import fastest, regulator

        robot, reference, own = DrivenRobot.of(experiment), experiment.reference, self.own
        motor = BelievedMotor(
            robot.left_radius, robot.right_radius, robot.half_track, own.delay, own.lag, 0.0
        )
        task = planned_task(experiment)
        inputs = np.stack([task.initial_left, task.initial_right], axis=1)
        rate = fastest(motor, reference.sample_time)
        found = regulator(motor, inputs, reference.poses, reference, rate, rate)
        return _narrowest(loops_of(experiment, found.controller), self._longest, own)

    @property
    def _longest(self) -> float:
        reference = self._experiment.reference
        return reference.samples * reference.sample_time

    @cached_property
    def bears_own(self) -> bool | None:
        """Whether the feedback is stable on the robot's own motor; None if that is not known."""
        if not self.loops:
            return None
        return all(each.is_stable(self.own.delay, self.own.lag) for each in self.loops)

    @cached_property
    def of_delay(self) -> Effect:
        """What so much more delay than the law is told of does."""
        return self._effect(replace(self.told, delay=self.told.delay + UNTOLD))

    @cached_property
    def of_lag(self) -> Effect:
        """What so much more lag does."""
        return self._effect(replace(self.told, lag=self.told.lag + UNTOLD))

    def _effect(self, motor: Motor) -> Effect:
        experiment = self._experiment
        task, (model, drivetrain) = planned_task(experiment), believed_robot(experiment)
        wheels = drivetrain or Drivetrain(model.wheel_radius, model.wheel_radius)
        exact = DrivenRobot.of(experiment).lead > 0
        late = replace(
            experiment,
            plant=ImperfectPlant(model, replace(wheels, motor=motor), exact),
            initial_pose=tuple(experiment.reference.poses[0].tolist()),
            initial_left=task.initial_left,
            initial_right=task.initial_right,
            iterations=0,
        )
        open_loop = driven_error(replace(late, learn_in_first=False))
        if not self.has_feedback:
            return Effect(open_loop)
        loops = self.loops
        is_stable = None
        if loops is not None:
            is_stable = all(each.is_stable(motor.delay, motor.lag) for each in loops)
        return Effect(open_loop, driven_error(replace(late, learn_in_first=True)), is_stable)

    @property
    def findings(self) -> Findings:
        """A warning where the robot is later than the feedback bears."""
        experiment, own = self._experiment, self.own
        if not self.is_known or not (own.delay or own.lag) or self.bears_own is not False:
            return Findings()
        if isinstance(experiment.law, NormOptimalLaw) and not experiment.learn_in_first:
            return Findings()  # the pass before has told it
        assert self.narrowest is not None
        margin, loop = self.narrowest
        parts = [("delay", own.delay), ("lag", own.lag)]
        has = " and ".join(f"robot.motor.{name} of {value:g} s" for name, value in parts if value)
        return Findings.warning(
            f"{has}: the feedback in the pass is unstable with it, as it bears {_time(margin)} of "
            f"delay {_where(loop)}; tell the law of it (model.motor), lower its gains, or drive "
            "slower"
        )

    @property
    @np.errstate(all="ignore")
    def rows(self) -> Rows:
        """The delay margin and where it is, and what `UNTOLD` does."""
        if not self.is_known:
            return []
        place = [] if self.narrowest is None else [("  is narrowest", _where(self.narrowest[1]))]
        untold = (f"{_time(UNTOLD)} untold", self._effects())
        return [("Delay margin", self._margin_text()), *place, untold]

    @property
    @np.errstate(all="ignore")
    def brief(self) -> Rows:
        """The same in short: nothing where there is no feedback, and late is late."""
        if not self.is_known or not self.has_feedback:
            return []
        margin = ("Delay margin", self._margin_text())
        if isinstance(self._experiment.law, NormOptimalLaw):  # a pass tells it of delay and lag
            return [margin]
        return [margin, (f"{_time(UNTOLD)} untold", self._effects())]

    def _margin_text(self) -> str:
        if not self.has_feedback:
            return "none needed: nothing in a pass answers to its errors"
        if self.narrowest is None:
            return "not evaluated: what the feedback answers to an error does not end"
        text, identified = _bears(self.narrowest[0]), self.narrowest_identified
        if identified is not None:
            known = self.own.delay + self.own.lag
            beyond = f" beyond the {_time(known)} that it has found" if known else ""
            more = _time(max(identified[0] - self.own.delay, 0.0))
            return f"{text} before a pass has been seen, then {more} or more{beyond}"
        if self.told.delay or self.told.lag:
            text += f", of which the law is told {_time(self.told.delay)}"
        if self.own.delay or self.own.lag:
            stable = "stable" if self.bears_own else "unstable"
            text += f"; {stable} with the robot's own delay and lag"
        return text

    def _effects(self) -> str:
        texts = []
        for name, effect in (("delay", self.of_delay), ("lag", self.of_lag)):
            text = f"{name} {_length(effect.open_loop_m)} off"
            if effect.error_m is not None:
                text += f", {_length(effect.error_m)} with feedback"
                text += ", unstable" if effect.is_stable is False else ""
            texts.append(text)
        if texts[0].partition(" ")[2] == texts[1].partition(" ")[2]:
            return f"delay or lag {texts[0].partition(' ')[2]}"
        return "; ".join(texts)

    @property
    @np.errstate(all="ignore")
    def document(self) -> dict[str, object]:
        """The same as JSON."""
        if not self.is_known:
            return {}
        narrowest, identified = self.narrowest, self.narrowest_identified
        return {
            "has_feedback": self.has_feedback,
            "margin_s": None if narrowest is None else narrowest[0],
            "margin_at_s": None if narrowest is None else narrowest[1].at,
            "margin_at_speed_m_s": None if narrowest is None else narrowest[1].speed,
            "margin_identified_s": None if identified is None else identified[0],
            "told_delay_s": self.told.delay,
            "told_lag_s": self.told.lag,
            "own_delay_s": self.own.delay,
            "own_lag_s": self.own.lag,
            "stable_with_own": self.bears_own,
            "untold_s": UNTOLD,
            **{
                f"of_{name}": {
                    "open_loop_max_position_error_m": effect.open_loop_m,
                    "max_position_error_m": effect.error_m,
                    "stable": effect.is_stable,
                }
                for name, effect in (("delay", self.of_delay), ("lag", self.of_lag))
            },
        }


def _narrowest(
    loops: list[LateLoop] | None, longest: float, told: Motor
) -> tuple[float, LateLoop] | None:
    """Returns the smallest margin with its loop."""
    if not loops:
        return None
    margins = [each.margin(told.delay, told.lag, longest) for each in loops]
    least = int(np.argmin(margins))
    return margins[least], loops[least]


def _bears(margin: float) -> str:
    if math.isinf(margin):
        return "longer than the path takes"
    return _time(margin) if margin else "none: unstable"


def _where(loop: LateLoop) -> str:
    return f"at {loop.speed:.3g} m/s and {loop.yaw_rate:.3g} rad/s (t = {loop.at:.4g} s)"


def _time(seconds: float) -> str:
    return f"{1e3 * seconds:.3g} ms" if seconds < 1 else f"{seconds:.3g} s"


def _length(error: float) -> str:
    if not math.isfinite(error):
        return "not finite"
    return f"{1e3 * error:.3g} mm" if error < 0.1 else f"{error:.3g} m"
