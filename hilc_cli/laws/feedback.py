"""A tracking controller without learning: what a robot reaches in its first pass."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from hilc_cli.laws.law import LastIteration, Learner, NumericController, Plan, Task, WheelController
from hilc_cli.laws.parameters import Controller, Setting, SpeedLimit
from hilc_cli.plants.kinematic import Number, Robot, reference_twist, wheel_speeds_from_twist
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.yaml_input.model import Model
from hilc_cli.yaml_input.quantities import (
    CurvatureGain,
    GainPerSecond,
    LateralGain,
    such_as,
)


def tracking_twist(
    k_x: float,
    k_y: float,
    k_theta: float,
    speed: float,
    yaw_rate: float,
    cos_heading: Number,
    sin_heading: Number,
    error_x: Number,
    error_y: Number,
    cos_error: Number,
    sin_error: Number,
) -> tuple[Number, Number]:
    """Forward speed [m/s] and yaw rate [rad/s] that lead back to the reference.

    Args:
        k_x: Gain of the error ahead [1/s].
        k_y: Gain of the error aside [rad/m^2].
        k_theta: Gain of the error of the heading [rad/m].
        speed: Of the reference [m/s], negative where it drives backward.
        yaw_rate: Of the reference [rad/s].
        cos_heading: Cosine of the measured heading.
        sin_heading: Its sine.
        error_x: Measured error [m].
        error_y: Measured error [m].
        cos_error: Cosine of the measured heading error.
        sin_error: Its sine.

    Source:
        Kanayama, Kimura, Miyazaki and Noguchi 1990, A stable tracking control method for an
        autonomous mobile robot.
    """
    ahead = cos_heading * error_x + sin_heading * error_y
    aside = cos_heading * error_y - sin_heading * error_x
    # Backward, a heading error is turned back all the same.
    k_theta = math.copysign(k_theta, speed)
    return (
        speed * cos_error + k_x * ahead,
        yaw_rate + speed * (k_y * aside + k_theta * sin_error),
    )


@dataclass(frozen=True, slots=True)
class FeedbackLaw:
    """The tracking controller of Kanayama et al. 1990; iterations do not depend on each other.

    The reference's speeds are those of its next step; the wheels follow by the believed kinematics.

    Attributes:
        k_x: Gain of the error ahead [1/s], >= 0.
        k_y: Gain of the error aside [rad/m^2], >= 0.
        k_theta: Gain of the error of the heading [rad/m], >= 0.
        model: The platform as the controller believes it to be.
    """

    theory: ClassVar[str] = "hilc_cli.theory.laws.feedback:FeedbackTheory"

    k_x: float
    k_y: float
    k_theta: float
    model: Robot

    def lane_parameters(self) -> FeedbackLaw:
        """Returns what the batch engine runs: the law itself."""
        return self

    def learner(self, task: Task) -> Learner:
        """The law, which will learn nothing."""
        plan = self.plan(task.reference)
        return LastIteration(task, lambda last: plan)

    def plan(self, reference: Reference) -> Plan:
        """Plans each iteration: the reference's own wheel speeds, and the feedback about it."""
        twist, model = reference_twist(reference), self.model
        left, right = wheel_speeds_from_twist(*twist, model.wheel_radius, model.signed_half_track)
        return Plan(left, right, reference.poses, TrackingControl(self, twist))

    def wheel_speeds(
        self,
        twist: tuple[float, float],
        heading: tuple[Number, Number],
        error: tuple[Number, Number],
        turned: tuple[Number, Number],
    ) -> tuple[Number, Number]:
        """Left and right wheel speed [rad/s] at one sample of one pass, or of many.

        Args:
            twist: Speed [m/s] and yaw rate [rad/s] of the reference.
            heading: Cosine and sine of the measured heading.
            error: Measured error in x and y [m].
            turned: Cosine and sine of the measured heading error.
        """
        speed, yaw_rate = tracking_twist(
            self.k_x, self.k_y, self.k_theta, *twist, *heading, *error, *turned
        )
        model = self.model
        return wheel_speeds_from_twist(speed, yaw_rate, model.wheel_radius, model.signed_half_track)


@dataclass(frozen=True, slots=True, eq=False)
class TrackingControl(NumericController):
    """The tracking controller about a reference.

    Attributes:
        law: Its gains, and the platform.
        twist: Speed [m/s] and yaw rate [rad/s] of the reference, shape (n,) each.
    """

    law: FeedbackLaw
    twist: tuple[Floats, Floats]

    def controller(self) -> WheelController:
        """Returns the controller for one pass."""
        law = self.law
        speeds, yaw_rates = (part.tolist() for part in self.twist)

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            turned = math.cos(error_heading), math.sin(error_heading)
            return law.wheel_speeds(
                (speeds[k], yaw_rates[k]), (cos, sin), (error_x, error_y), turned
            )

        return wheel_speeds


class FeedbackGains(Model):
    """Gains of the errors in the platform's frame.

    Without limit, a small sideways error e over the path s then follows
    e'' + k_theta e' + k_y e = 0.
    """

    k_x: Annotated[float, such_as(GainPerSecond, "10 or 10/s")] = Field(
        10.0, description="of the error ahead [1/s]"
    )
    k_y: CurvatureGain = Field(8.0, description="of the error to the left [rad/m^2]")
    k_theta: Annotated[float, such_as(LateralGain, "6 or 6 rad/m")] | None = Field(
        None,
        description="of the heading's error [rad/m]; default 2 sqrt(k_y), critically damped: "
        "a sideways error is gone after some 1 / sqrt(k_y) of the path",
    )

    @property
    def damping(self) -> float:
        """K_theta [rad/m]."""
        return 2 * math.sqrt(self.k_y) if self.k_theta is None else self.k_theta


class FeedbackController(Controller):
    """The tracking controller of Kanayama et al. 1990, without learning."""

    learns: ClassVar[bool] = False

    law: Literal["feedback"]
    gains: FeedbackGains = FeedbackGains()
    b_w: SpeedLimit = None

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine knows the law."""
        return True

    def law_for(self, setting: Setting) -> FeedbackLaw:
        """The law for the engines."""
        gains = self.gains
        return FeedbackLaw(gains.k_x, gains.k_y, gains.damping, setting.model)

    def in_words(self, setting: Setting) -> str:
        """All gains."""
        gains = self.gains
        return (
            f"feedback without learning; k_x {gains.k_x:g} 1/s, k_y {gains.k_y:g} rad/m^2, "
            f"k_theta {gains.damping:g} rad/m"
        )

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        data = super().resolved(reference)
        data["gains"]["k_theta"] = self.gains.damping
        return data

    def warnings(self, setting: Setting) -> list[str]:
        """Gains with which errors grow from sample to sample."""
        sample_time = setting.reference.sample_time
        fastest, _ = reference_twist(setting.reference)
        step = float(np.abs(fastest).max()) * sample_time
        k_y, k_theta = self.gains.k_y, self.gains.damping
        found = []
        if self.gains.k_x * sample_time > 2:
            found.append(f"controller.gains.k_x is unstable above {2 / sample_time:g} 1/s, 2 / d_t")
        # Jury's conditions on z^2 - (2 - k_theta s) z + 1 - k_theta s + k_y s^2, s the step.
        if k_theta < k_y * step or 2 * k_theta * step > 4 + k_y * step**2:
            found.append(
                "controller.gains.k_y and k_theta are unstable where the reference goes "
                f"{step:.3g} m in a sample; give smaller ones, or a shorter sample time"
            )
        return found
