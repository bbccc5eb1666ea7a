"""Parameters of the hybrid law of Qiao et al. 2021."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field

from hilc_cli.laws.compensation import has_initial_error
from hilc_cli.laws.gain_heading import GainHeading
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.lateral import has_constant_heading_column, with_lateral_gain
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Robot
from hilc_cli.spec.controller import Controller, Setting, default_length, length_misfits
from hilc_cli.spec.gain_matrix import GainMatrixChoice, gain_matrix, matrix_misfits
from hilc_cli.spec.model import Located, Model, valid
from hilc_cli.spec.quantities import Gain, LateralGain, PositiveWheelSpeed, Samples, Tolerance


class HybridGains(Model):
    """Scalars before the gain matrix."""

    l1: Gain = Field(description="of the previous iteration's error, e_i(k+1)")
    l2: Gain = Field(0.0, description="of the running iteration's error, e_{i+1}(k)")
    l3: Gain = Field(0.0, description="of the running iteration's error, e_{i+1}(k-1)")
    lateral: LateralGain = Field(
        0.0, description="kappa [rad/m]: heading error asked for by an error to the left; 0: none"
    )


class HybridController(Controller):
    """The hybrid iterative learning controller of Qiao et al. 2021."""

    in_lanes: ClassVar[bool] = True
    tied_to_trajectory: ClassVar[tuple[str, ...]] = ("h",)

    law: Literal["hybrid"] = "hybrid"
    gains: HybridGains
    gain_matrix: GainMatrixChoice = Field(
        "model", description="model: Eq. 45; unit: Eq. 56; or 2x3 entries affine in cos and sin"
    )
    gain_heading: GainHeading = Field(
        "measured", description="heading at which the gain matrix is taken"
    )
    compensation: Literal["auto", "on", "off"] = Field(
        "auto", description="auto: Eq. 21 if the run starts off the reference, else Eq. 17"
    )
    switch_tolerance: Tolerance = Field(
        1e-9, description="an initial error up to this, in m and rad, counts as none"
    )
    h: Samples | None = Field(
        None, description="length of the compensation in samples, 1 to n; default 200, or n if less"
    )
    b_w: PositiveWheelSpeed | None = Field(
        None, description="speed limit of the wheels [rad/s]; null for none"
    )

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """A compensation that is too long, and what the gain matrix cannot be."""
        matrix = valid(GainMatrixChoice, data.get("gain_matrix"))
        infinite = matrix_misfits(matrix, model)
        return [
            *length_misfits(valid(Samples, data.get("h")), reference),
            *(infinite or _lateral_misfits(valid(HybridGains, data.get("gains")), matrix, model)),
        ]

    def misfits_on(self, reference: Reference) -> list[Located]:
        """A compensation longer than the trajectory."""
        return length_misfits(self.h, reference)

    def compensates(self, setting: Setting) -> bool:
        """The position of Fig. 2's switch."""
        if self.compensation == "auto":
            return has_initial_error(
                setting.initial_error, setting.initial_bound, self.switch_tolerance
            )
        return self.compensation == "on"

    def law_for(self, setting: Setting) -> HybridLaw:
        """The law for the engines."""
        return HybridLaw(
            self.gains.l1,
            self.gains.l2,
            self.gains.l3,
            with_lateral_gain(gain_matrix(self.gain_matrix, setting.model), self.gains.lateral),
            self.gain_heading,
            self.compensates(setting),
            default_length(self.h, setting.reference),
        )

    def in_words(self, setting: Setting) -> str:
        """The position of Fig. 2's switch, and all gains."""
        compensates, gains = self.compensates(setting), self.gains
        law = "Eq. 21, compensating the initial error" if compensates else "Eq. 17"
        lateral = f", lateral {gains.lateral:g} rad/m" if gains.lateral else ""
        return f"{law}; l1 {gains.l1:g}, l2 {gains.l2:g}, l3 {gains.l3:g}{lateral}"

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": default_length(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """Gains that the compensated law does not have."""
        if self.compensates(setting) and (self.gains.l2 > 0 or self.gains.l3 > 0):
            return [
                "controller.gains.l2 and l3 are not used: with an initial error the law is "
                "Eq. 21, which has l1 only; set 'compensation: off' for Eq. 17"
            ]
        return []


def _lateral_misfits(gains: HybridGains | None, matrix: Any, model: Robot | None) -> list[Located]:
    """A lateral gain beside a matrix with which it would not be affine; any may be unknown."""
    if gains is None or gains.lateral == 0 or matrix is None or model is None:
        return []
    if has_constant_heading_column(gain_matrix(matrix, model)):
        return []
    problem = "needs a gain matrix whose heading entries have no cos and sin"
    return [(("gains", "lateral"), problem, "give 0, or other entries in the third column")]
