"""What a scenario says of the controller: a law by its name, with the law's own parameters."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from hilc_cli.laws.compensation import has_initial_error
from hilc_cli.laws.hybrid import GainHeading, HybridLaw
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Robot
from hilc_cli.spec.gain_matrix import GainMatrixChoice, gain_matrix
from hilc_cli.spec.model import Model
from hilc_cli.spec.quantities import Gain, PositiveWheelSpeed, Samples, Tolerance

DEFAULT_H = 200  # the paper's choice in situation 3


class HybridGains(Model):
    """Scalars before the gain matrix."""

    l1: Gain = Field(description="of the previous iteration's error, e_i(k+1)")
    l2: Gain = Field(0.0, description="of the running iteration's error, e_{i+1}(k)")
    l3: Gain = Field(0.0, description="of the running iteration's error, e_{i+1}(k-1)")


class HybridController(Model):
    """The hybrid iterative learning controller of Qiao et al. 2021."""

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

    def compensates(
        self, initial_error: tuple[float, float, float], bound: tuple[float, float, float]
    ) -> bool:
        """The position of Fig. 2's switch.

        Args:
            initial_error: Start of the reference less the initial pose.
            bound: Bound of the initial pose's disturbance.
        """
        if self.compensation == "auto":
            return has_initial_error(initial_error, bound, self.switch_tolerance)
        return self.compensation == "on"

    def resolved_h(self, samples: int) -> int:
        """Length of the compensation on a trajectory of so many samples."""
        return min(DEFAULT_H, samples) if self.h is None else self.h

    def law_for(self, model: Robot, reference: Reference, *, compensation: bool) -> HybridLaw:
        """The law for the engines.

        Args:
            model: The platform as the controller believes it to be.
            reference: The trajectory.
            compensation: The position of Fig. 2's switch.
        """
        return HybridLaw(
            self.gains.l1,
            self.gains.l2,
            self.gains.l3,
            gain_matrix(self.gain_matrix, model),
            self.gain_heading,
            compensation,
            self.resolved_h(reference.samples),
        )
