"""Norm-optimal learning as a law of the engines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from hilc_cli.laws.law import Law, Learner, Task
from hilc_cli.laws.parameters import DEFAULT_H, Controller, Setting, SpeedLimit, length_misfits
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Reference
from hilc_cli.yaml_input.model import Flag, Located, Model, valid
from hilc_cli.yaml_input.quantities import (
    PositiveAngle,
    PositiveLength,
    PositiveWheelSpeed,
    Samples,
    such_as,
)

MERGE_TIME = "merge_time_s"
"""Column of the time from which the plan stays on the trajectory."""

RATIO = "wheel_radius_per_half_track"
"""Column of R / B, which a turn in place tells, though neither R nor B."""

_IDENTIFIED = (
    "wheel_radius_m", "wheel_radius_standard_error_m",
    "half_track_m", "half_track_standard_error_m",
    RATIO, f"{RATIO}_standard_error",
    "model_wheel_radius_m", "model_wheel_radius_standard_error_m",
    "model_half_track_m", "model_half_track_standard_error_m",
    f"model_{RATIO}", f"model_{RATIO}_standard_error",
)  # fmt: skip
"""Columns of what each iteration alone tells, and of what the model takes from all so far."""


IDEAL_MOTORS = {"left_per_right_radius": 1.0, "delay_s": 0.0, "lag_s": 0.0, "friction_rad_s": 0.0}
"""What is believed at first of motors and wheels, by the columns of their quantities."""

MOTOR_FIGURES = tuple(
    f"model_{name}{ending}{unit}"
    for name, unit in (
        ("wheel_radius", "_m"),
        ("left_per_right_radius", ""),
        ("half_track", "_m"),
        ("delay", "_s"),
        ("lag", "_s"),
        ("friction", "_rad_s"),
    )
    for ending in ("", "_standard_error")
)
"""Columns of the robot with its motors, as the model takes them from all passes so far."""


@dataclass(frozen=True, slots=True)
class NormOptimalLaw:
    """The law with its parameters, each with a meaning on the floor.

    An error is weighted by what counts as one: the cost of an iteration is half the sum, over all
    samples, of (position error / position)^2 + (heading error / heading)^2 + (change of each
    wheel's speed / input_change)^2. Only the ratios matter.

    Attributes:
        model: The platform as the controller believes it to be at first.
        position: A position error that counts as one [m], > 0.
        heading: A heading error that counts as one [rad], > 0. Large against position / step
            length, or the heading's own samples, tangents of the path, keep the platform off it.
        input_change: A change of a wheel speed from one iteration to the next that counts as one
            [rad/s], > 0. Smaller: slower learning, less of one iteration's noise in the next.
        feedback: lqr: the regulator about the planned motion runs in the iteration; none: the
            learned wheel speeds alone.
        feedback_position: As `position`, for the regulator [m]. Smaller: stiffer, and more of the
            measured output's noise on the wheels.
        feedback_heading: As `heading`, for the regulator [rad].
        identify: Whether wheel radius and half track are estimated anew after each iteration.
        h: Samples within which the platform shall be on the trajectory after an initial error,
            where the speed limit allows it, >= 1.
        memory: Number of iterations over which motion that the model does not explain is
            averaged, >= 1; without identification always the last one alone.
    """

    theory: ClassVar[str] = "hilc_cli.theory.laws.norm_optimal:NormOptimalTheory"

    model: Robot
    position: float = 1e-3
    heading: float = 0.05
    input_change: float = 10.0
    feedback: Literal["lqr", "none"] = "lqr"
    feedback_position: float = 1e-2
    feedback_heading: float = 0.1
    identify: bool = True
    h: int = 200
    memory: int = 4

    @property
    def squared_weights(self) -> tuple[float, float, float]:
        """The weights of a squared position error, heading error and wheel speed in learning."""
        return self.position**-2, self.heading**-2, self.input_change**-2

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        # The compiler starts slowly.
        from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner

        return NormOptimalLearner(self, task.reference, task.speed_limit)


def figures_told(*, identify: bool) -> tuple[str, ...]:
    """Columns of ``learning.csv`` that the law fills, with and without identification."""
    return (*(_IDENTIFIED if identify else ()), MERGE_TIME, "search_settled")


_NONE = 1e-9  # an initial error up to this [m and rad] is rounding


@dataclass(frozen=True, slots=True)
class MotorLaw:
    """The law on a robot as it is, whose motors it identifies as well.

    Attributes:
        own: Weights of errors, feedback, the way in, and the platform as it is believed to be.
        lead: Share of a sample's turn after which its way is gone.
    """

    own: NormOptimalLaw
    lead: float

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        # The compiler starts slowly.
        from hilc_cli.laws.norm_optimal.motor_learner import MotorLearner

        return MotorLearner(task, self.own, self.lead)


class LearningWeights(Model):
    """What counts as one in the sum of squares that learning minimises."""

    position: Annotated[float, such_as(PositiveLength, "0.001 or 1 mm")] = Field(
        1e-3, description="an error of the position [m]"
    )
    heading: Annotated[float, such_as(PositiveAngle, "0.05 or 3 deg")] = Field(
        0.05, description="an error of the heading [rad]"
    )
    input_change: Annotated[float, such_as(PositiveWheelSpeed, "10 or 100 rpm")] = Field(
        10.0, description="a change of a wheel speed from iteration to iteration [rad/s]"
    )


class FeedbackWeights(Model):
    """What counts as much as weights.input_change in the feedback; smaller ones make it stiffer."""

    position: Annotated[float, such_as(PositiveLength, "0.01 or 1 cm")] = Field(
        1e-2, description="an error of the position [m]"
    )
    heading: Annotated[float, such_as(PositiveAngle, "0.1 or 6 deg")] = Field(
        0.1, description="an error of the heading [rad]"
    )


class NormOptimalController(Controller):
    """Norm-optimal learning with identification, rectified reference and constrained wheels."""

    tied_to_trajectory: ClassVar[tuple[str, ...]] = ("h",)

    law: Literal["norm-optimal"]
    weights: LearningWeights = LearningWeights()
    feedback: Literal["lqr", "none"] = Field(
        "lqr", description="in the iteration: lqr about the planned motion, or none"
    )
    feedback_weights: FeedbackWeights = FeedbackWeights()
    identify: Flag = Field(
        True, description="estimate wheel radius and half track anew after each iteration"
    )
    h: Samples | None = Field(
        None,
        description="samples until an initial error shall be gone, 1 to n; default 200, or n / 4",
    )
    memory: Annotated[int, such_as(Samples, "4", told_in="iterations")] = Field(
        4, description="iterations over which motion that the model does not explain is averaged"
    )
    motors: Literal["ideal", "identify"] = Field(
        "ideal",
        description="identify: each wheel's radius, delay, lag and friction are identified, too, "
        "and planned with; the feedback follows from them and from the noise",
    )
    b_w: SpeedLimit = None

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """What is too long for the trajectory."""
        return length_misfits(valid(Samples, data.get("h")), reference)

    def misfits_on(self, reference: Reference) -> list[Located]:
        """What is too long for a trajectory."""
        return length_misfits(self.h, reference)

    def law_for(self, setting: Setting) -> Law:
        """The law for the engines."""
        law = NormOptimalLaw(
            setting.model,
            self.weights.position,
            self.weights.heading,
            self.weights.input_change,
            self.feedback,
            self.feedback_weights.position,
            self.feedback_weights.heading,
            self.identify,
            _within(self.h, setting.reference),
            self.memory,
        )
        return MotorLaw(law, setting.lead) if self.motors == "identify" else law

    def figures(self) -> tuple[str, ...]:
        """What is identified, if anything is, and what there is to tell of the plan."""
        if self.motors == "identify":
            return MOTOR_FIGURES
        return figures_told(identify=self.identify)

    def yardsticks(self, setting: Setting) -> dict[str, dict[str, float]]:
        """When the plan is to be on the trajectory, if the platform does not start there."""
        if not setting.has_initial_error(_NONE):
            return {}
        h = _within(self.h, setting.reference)
        return {MERGE_TIME: {"h": h * setting.reference.sample_time}}

    def in_words(self, setting: Setting) -> str:
        """What is learned, how, and how long an initial error may last."""
        if self.motors == "identify":
            answers = (
                "no feedback" if self.feedback == "none" else "feedback as delay and noise let it"
            )
            return f"norm-optimal learning of robot and motors; {answers}"
        learned = "wheel speeds, wheel radius and half track" if self.identify else "wheel speeds"
        feedback = "LQR feedback" if self.feedback == "lqr" else "no feedback"
        h = _within(self.h, setting.reference)
        return f"norm-optimal learning of {learned}; {feedback}, rectified within {h} samples"

    @property
    def called(self) -> str:
        """The law as messages name it."""
        return f"law {self.law}" + (" with motors: identify" if self.motors == "identify" else "")

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": _within(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """A way in that takes up most of the trajectory, and keys that have no effect."""
        return [*self._idle(), *self._long_way_in(setting)]

    def _idle(self) -> list[str]:
        """Tells of keys that are given and have no effect on a robot with motors."""
        if self.motors == "ideal":
            return []
        given = {
            "weights.input_change": self.weights.input_change != LearningWeights().input_change,
            **{
                name: getattr(self, name) != type(self).model_fields[name].default
                for name in ("feedback_weights", "identify", "memory")
            },
        }
        return [
            f"controller.{name} has no effect with 'motors: identify'; leave it out"
            for name, is_given in given.items()
            if is_given
        ]

    def _long_way_in(self, setting: Setting) -> list[str]:
        half, h = max(setting.reference.samples // 2, 1), _within(self.h, setting.reference)
        if h <= half or not setting.has_initial_error(_NONE):
            return []
        return [
            f"controller.h lets the initial error last for {h} of the trajectory's "
            f"{setting.reference.samples} samples; give {half} or less to track the rest of it"
        ]


def _within(h: int | None, reference: Reference) -> int:
    """Samples until an initial error shall be gone; what they are if they are left out."""
    return min(DEFAULT_H, max(reference.samples // 4, 1)) if h is None else h
