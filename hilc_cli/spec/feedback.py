"""Parameters of the tracking controller that does not learn."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.feedforward import reference_twist
from hilc_cli.reference.sampled import Reference
from hilc_cli.spec.controller import Controller, Setting
from hilc_cli.spec.model import Model
from hilc_cli.spec.quantities import (
    CurvatureGain,
    GainPerSecond,
    LateralGain,
    PositiveWheelSpeed,
    such_as,
)


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
    b_w: PositiveWheelSpeed | None = Field(
        None, description="speed limit of the wheels [rad/s]; null for none"
    )

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
        step = float(fastest.max()) * sample_time
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
