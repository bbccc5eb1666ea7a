"""Parameters of norm-optimal learning."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from hilc_cli.laws.compensation import has_initial_error
from hilc_cli.laws.norm_optimal.law import MERGE_TIME, NormOptimalLaw, figures_told
from hilc_cli.laws.norm_optimal.parameters import NormOptimalParameters
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Robot
from hilc_cli.spec.controller import DEFAULT_H, Controller, Setting, length_misfits
from hilc_cli.spec.model import Flag, Located, Model, valid
from hilc_cli.spec.quantities import (
    PositiveAngle,
    PositiveLength,
    PositiveWheelSpeed,
    Samples,
    such_as,
)

_NONE = 1e-9  # an initial error up to this [m and rad] is rounding


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
    memory: Annotated[int, such_as(Samples, "4")] = Field(
        4, description="iterations over which motion that the model does not explain is averaged"
    )
    b_w: PositiveWheelSpeed | None = Field(
        None, description="speed limit of the wheels [rad/s]; null for none"
    )

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """What is too long for the trajectory."""
        return length_misfits(valid(Samples, data.get("h")), reference)

    def misfits_on(self, reference: Reference) -> list[Located]:
        """What is too long for a trajectory."""
        return length_misfits(self.h, reference)

    def law_for(self, setting: Setting) -> NormOptimalLaw:
        """The law for the engines."""
        parameters = NormOptimalParameters(
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
        return NormOptimalLaw(parameters, setting.model)

    def figures(self) -> tuple[str, ...]:
        """What is identified, if anything is, and what there is to tell of the plan."""
        return figures_told(identify=self.identify)

    def yardsticks(self, setting: Setting) -> dict[str, dict[str, float]]:
        """When the plan is to be on the trajectory, if the platform does not start there."""
        if not has_initial_error(setting.initial_error, setting.initial_bound, _NONE):
            return {}
        h = _within(self.h, setting.reference)
        return {MERGE_TIME: {"h": h * setting.reference.sample_time}}

    def in_words(self, setting: Setting) -> str:
        """What is learned, how, and how long an initial error may last."""
        learned = "wheel speeds, wheel radius and half track" if self.identify else "wheel speeds"
        feedback = "LQR feedback" if self.feedback == "lqr" else "no feedback"
        h = _within(self.h, setting.reference)
        return f"norm-optimal learning of {learned}; {feedback}, rectified within {h} samples"

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": _within(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """A way in that takes up most of the trajectory."""
        half, h = max(setting.reference.samples // 2, 1), _within(self.h, setting.reference)
        off = has_initial_error(setting.initial_error, setting.initial_bound, _NONE)
        if h <= half or not off:
            return []
        return [
            f"controller.h lets the initial error last for {h} of the trajectory's "
            f"{setting.reference.samples} samples; give {half} or less to track the rest of it"
        ]


def _within(h: int | None, reference: Reference) -> int:
    """Samples until an initial error shall be gone; what they are if they are left out."""
    return min(DEFAULT_H, max(reference.samples // 4, 1)) if h is None else h
