"""Norm-optimal learning as a law of the engines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from hilc_cli.laws.law import Law, Learner, Task
from hilc_cli.laws.parameters import DEFAULT_H, Controller, Setting, SpeedLimit, length_misfits
from hilc_cli.laws.safety_net import STEP_SHARE, WENT_BACK, returns_in_words
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Reference
from hilc_cli.yaml_input.model import Located, Model, valid
from hilc_cli.yaml_input.quantities import PositiveAngle, PositiveLength, Samples, such_as

MERGE_TIME = "merge_time_s"
"""Column of the time from which the plan stays on the trajectory."""

RATIO = "wheel_radius_per_half_track"
"""Column of R / B, which a turn in place tells, though neither R nor B."""

IDENTIFIED = tuple(
    f"model_{name}{ending}{unit}"
    for name, unit in (
        ("wheel_radius", "_m"),
        ("half_track", "_m"),
        (RATIO, ""),
        ("left_per_right_radius", ""),
        ("delay_and_lag", "_s"),
        ("delay", "_s"),
        ("lag", "_s"),
        ("friction", "_rad_s"),
    )
    for ending in ("", "_standard_error")
)
"""Columns of the robot with its motors, as the model takes them from all passes so far."""

MISFITS = {
    "misfit_ahead": "a dead zone, a limit to its acceleration, or slip that changes with the speed",
    "misfit_sideways": "slip in bends, or poses that are not of the point between its wheels",
    "misfit_turning": "one wheel that drags, a load that shifts, or scrubbing tyres",
}
"""Columns of what passes have in common beyond the model, with what it may come from."""

_FIGURES = (*IDENTIFIED, *MISFITS, STEP_SHARE, WENT_BACK, MERGE_TIME, "search_settled")

_NONE = 1e-9  # an initial error up to this [m and rad] is rounding


@dataclass(frozen=True, slots=True)
class NormOptimalLaw:
    """The law with its parameters, each with a meaning on the floor.

    An error is weighted by what counts as one: the cost of an iteration is half the sum, over all
    samples, of (position error / position)^2 + (heading error / heading)^2. Only the ratio matters.

    Attributes:
        model: The platform as the controller believes it to be at first.
        lead: Share of a sample's turn after which its way is gone, see `motor.moved`.
        position: A position error that counts as one [m], > 0.
        heading: A heading error that counts as one [rad], > 0. Large against position / step
            length, or the heading's own samples, tangents of the path, keep the platform off it.
        feedback: regulator: a regulator about the planned motion runs in the iteration; none: the
            planned wheel speeds alone.
        h: Samples within which the platform shall be on the trajectory after an initial error,
            where the speed limit allows it, >= 1.
        drivetrain: What the controller believes at first of wheels, motors and tyres; None: equal
            wheels that do at once what they are told.
    """

    theory: ClassVar[str] = "hilc_cli.theory.laws.norm_optimal:NormOptimalTheory"

    model: Robot
    lead: float = 0.0
    position: float = 1e-3
    heading: float = 0.05
    feedback: Literal["regulator", "none"] = "regulator"
    h: int = 200
    drivetrain: Drivetrain | None = None

    @property
    def squared_weights(self) -> tuple[float, float]:
        """The weights of a squared position error and of a squared heading error."""
        return self.position**-2, self.heading**-2

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        # The compiler starts slowly.
        from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner

        return NormOptimalLearner(self, task.reference, task.speed_limit)


class LearningWeights(Model):
    """What counts as one in the sum of squares that a plan makes least."""

    position: Annotated[float, such_as(PositiveLength, "0.001 or 1 mm")] = Field(
        1e-3, description="an error of the position [m]"
    )
    heading: Annotated[float, such_as(PositiveAngle, "0.05 or 3 deg")] = Field(
        0.05, description="an error of the heading [rad]"
    )


class NormOptimalController(Controller):
    """Norm-optimal learning of a robot as it is, with a way in and constrained wheels."""

    tied_to_trajectory: ClassVar[tuple[str, ...]] = ("h",)

    law: Literal["norm-optimal"]
    weights: LearningWeights = LearningWeights()
    feedback: Literal["regulator", "none"] = Field(
        "regulator",
        description="in the iteration: a regulator about the plan, as fast as delay, lag and noise "
        "let it be, or none",
    )
    h: Samples | None = Field(
        None,
        description="samples until an initial error shall be gone, 1 to n; default 200, or n / 4",
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
        return NormOptimalLaw(
            setting.model,
            setting.lead,
            self.weights.position,
            self.weights.heading,
            self.feedback,
            _within(self.h, setting.reference),
            setting.drivetrain,
        )

    @property
    def knows_drivetrains(self) -> bool:
        """Whether the law makes use of what is believed of motors by itself."""
        return True

    def figures(self) -> tuple[str, ...]:
        """What is identified, what the model does not explain, and what to tell of the plan."""
        return _FIGURES

    def yardsticks(self, setting: Setting) -> dict[str, dict[str, float]]:
        """When the plan is to be on the trajectory, if the platform does not start there."""
        if not setting.has_initial_error(_NONE):
            return {}
        h = _within(self.h, setting.reference)
        return {MERGE_TIME: {"h": h * setting.reference.sample_time}}

    def in_words(self, setting: Setting) -> str:
        """What is learned, how, and how long an initial error may last."""
        answers = "no feedback" if self.feedback == "none" else "feedback as delay and noise let it"
        h = _within(self.h, setting.reference)
        return f"norm-optimal learning of robot and motors; {answers}, rectified within {h} samples"

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": _within(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """A way in that takes up most of the trajectory."""
        half, h = max(setting.reference.samples // 2, 1), _within(self.h, setting.reference)
        if h <= half or not setting.has_initial_error(_NONE):
            return []
        return [
            f"controller.h lets the initial error last for {h} of the trajectory's "
            f"{setting.reference.samples} samples; give {half} or less to track the rest of it"
        ]

    def warnings_after(self, figures: Mapping[str, float]) -> list[str]:
        """What the robot does that the model does not know, and that learning went back."""
        found = []
        beyond = {name: told for name, told in MISFITS.items() if figures.get(name, 0.0) > 1}
        if beyond:
            ways = (
                f"{name.removeprefix('misfit_')} {figures[name]:.2g} times what noise makes, "
                f"as with {told}"
                for name, told in beyond.items()
            )
            found.append(
                "the robot does something the model does not know, the same in each pass: "
                f"{'; '.join(ways)}. It is learned as far as it comes back, but stands in part in "
                "what was identified, by more than standard errors tell"
            )
        if figures.get(STEP_SHARE, 1.0) != 1:
            found.append(f"{returns_in_words(figures)} of what passes tell")
        return found


def _within(h: int | None, reference: Reference) -> int:
    """Samples until an initial error shall be gone; what they are if they are left out."""
    return min(DEFAULT_H, max(reference.samples // 4, 1)) if h is None else h
