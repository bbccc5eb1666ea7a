"""How much noise jerks the wheels, and how often it drives them to their limit."""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.many_passes import Passes

_OFTEN = 0.05  # of the samples: more is warned of


@dataclass(frozen=True, slots=True)
class WheelNoise:
    """What disturbances make of the wheel speeds in the last iteration.

    Attributes:
        change_rad_s: By how much it changes a wheel's speed from one sample to the next, RMS
            [rad/s].
        at_limit: Share of the samples at which the limit acts.
        undisturbed: The same without disturbances.
    """

    change_rad_s: float
    at_limit: float
    undisturbed: float

    @classmethod
    def of(cls, quiet: Passes, disturbed: Passes) -> WheelNoise:
        """From passes without and with disturbances."""
        return cls(
            float((disturbed.change_rad_s**2).mean() ** 0.5),
            float(disturbed.at_limit.mean()),
            float(quiet.at_limit.mean()),
        )


def wheel_findings(found: WheelNoise | None, remedy: str) -> Findings:
    """What that means for the experiment.

    Args:
        found: None if nothing is disturbed.
        remedy: What makes it less.
    """
    if found is None or not found.at_limit - found.undisturbed > _OFTEN:
        return Findings()
    without = f", {100 * found.undisturbed:.2g} % without it" if found.undisturbed else ""
    return Findings(
        warnings=(
            f"noise drives the wheels to their limit in {100 * found.at_limit:.2g} % of the "
            f"samples{without}, and changes their speed by {found.change_rad_s:.2g} rad/s (RMS) "
            f"from sample to sample: {remedy}",
        )
    )
