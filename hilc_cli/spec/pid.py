"""Parameters of PID-type learning."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import Field

from hilc_cli.laws.gain_heading import GainHeading
from hilc_cli.laws.pid import PidLaw
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Robot
from hilc_cli.spec.controller import Controller, Setting, default_length, length_misfits
from hilc_cli.spec.gain_matrix import GainMatrixChoice, gain_matrix, matrix_misfits
from hilc_cli.spec.model import Located, Model, valid
from hilc_cli.spec.quantities import (
    Duration,
    Frequency,
    Gain,
    GainPerSecond,
    PositiveWheelSpeed,
    Samples,
    Share,
)


class PidGains(Model):
    """Scalars before the gain matrix; what is left out is 0."""

    kp: Gain = Field(0.0, description="of the previous iteration's error, e_i(k+1)")
    ki: GainPerSecond = Field(0.0, description="of its sum times d_t, up to sample k+1 [1/s]")
    kd: Duration = Field(0.0, description="of its change by d_t, from sample k to k+1 [s]")


class PidController(Controller):
    """PID-type iterative learning with a forgetting factor and a Q-filter."""

    tied_to_trajectory: ClassVar[tuple[str, ...]] = ("h", "cutoff")

    law: Literal["pid"]
    gains: PidGains
    forgetting: Share = Field(0.0, description="gamma: share of u_0 in what is learned from")
    cutoff: Frequency | None = Field(
        None, description="of the zero-phase low-pass Q-filter [Hz]; null for none"
    )
    rectifying: Literal["off", "on"] = Field(
        "off", description="on: kd acts against the initial error, too, spread over h samples"
    )
    h: Samples | None = Field(
        None, description="length of the rectifying in samples, 1 to n; default 200, or n if less"
    )
    gain_matrix: GainMatrixChoice = Field(
        "model", description="model: Eq. 45; unit: Eq. 56; or 2x3 entries affine in cos and sin"
    )
    gain_heading: GainHeading = Field(
        "measured", description="heading at which the gain matrix is taken"
    )
    b_w: PositiveWheelSpeed | None = Field(
        None, description="speed limit of the wheels [rad/s]; null for none"
    )

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """What is too long or too fast for the trajectory, and what the matrix cannot be."""
        return [
            *length_misfits(valid(Samples, data.get("h")), reference),
            *_cutoff_misfits(valid(Frequency, data.get("cutoff")), reference),
            *matrix_misfits(valid(GainMatrixChoice, data.get("gain_matrix")), model),
        ]

    def misfits_on(self, reference: Reference) -> list[Located]:
        """What is too long or too fast for a trajectory."""
        return [*length_misfits(self.h, reference), *_cutoff_misfits(self.cutoff, reference)]

    def law_for(self, setting: Setting) -> PidLaw:
        """The law for the engines."""
        return PidLaw(
            self.gains.kp,
            self.gains.ki,
            self.gains.kd,
            self.forgetting,
            gain_matrix(self.gain_matrix, setting.model),
            self.gain_heading,
            self.cutoff,
            default_length(self.h, setting.reference) if self.rectifying == "on" else None,
        )

    def in_short(self) -> str:
        """What is not 0, for a title."""
        gains = self.gains
        parts = [
            (gains.kp, f"kp {gains.kp:g}"),
            (gains.ki, f"ki {gains.ki:g} 1/s"),
            (gains.kd, f"kd {gains.kd:g} s"),
            (self.forgetting, f"forgetting {self.forgetting:g}"),
            (self.cutoff, f"cut-off {self.cutoff:g} Hz" if self.cutoff else ""),
        ]
        return ", ".join(["pid", *(text for value, text in parts if value)])

    def in_words(self, setting: Setting) -> str:
        """All gains, and what else shapes the learning."""
        gains = self.gains
        words = f"PID-type learning; kp {gains.kp:g}, ki {gains.ki:g} 1/s, kd {gains.kd:g} s"
        if self.forgetting:
            words += f", forgetting {self.forgetting:g}"
        if self.cutoff is not None:
            words += f", cut-off {self.cutoff:g} Hz"
        if self.rectifying == "on":
            words += f", rectifying over {default_length(self.h, setting.reference)} samples"
        return words

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": default_length(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """Parameters without effect."""
        gains = self.gains
        if gains.kp == gains.ki == gains.kd == 0:
            return ["controller.gains are all 0: nothing is learned; give kp, ki or kd"]
        if self.rectifying == "on" and gains.kd == 0:
            return ["controller.rectifying has no effect: it acts through gains.kd, which is 0"]
        return []


def _cutoff_misfits(cutoff: float | None, reference: Reference | None) -> list[Located]:
    """What is wrong with a cut-off for a trajectory's sample time; either may be unknown."""
    if cutoff is None or reference is None:
        return []
    nyquist = 0.5 / reference.sample_time
    if cutoff < nyquist:
        return []
    problem = f"must be below {nyquist:g} Hz, half the sampling frequency of the trajectory"
    return [(("cutoff",), problem, "give a lower one, or null for no filter")]
