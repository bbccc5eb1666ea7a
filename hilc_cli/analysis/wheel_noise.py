"""How much noise jerks the wheels, and how often it drives them to their limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.many_passes import Passes
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedforward import feedforward
from hilc_cli.results.trial import Trial

_ROUNDING = 1e-9  # relative: within it a wheel is at its limit
_NONE = 1e-9  # [m and rad]; of a start that differs by less, by rounding only
_TO_RMS = 1.4826  # the median of a normal's absolute value, times this, is its RMS
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


def seen_in(trial: Trial, experiment: Experiment) -> WheelNoise | None:
    """The same as it has happened, beside the wheel speeds that the trajectory asks for.

    From an initial pose that is off the trajectory, the second half is looked at: before that the
    wheels may be at their limit to get there. The change is that of most samples (by the median),
    so that jumps which answer the path's own do not count.

    Args:
        trial: The last iteration.
        experiment: What was simulated.

    Returns:
        None if nothing is disturbed.
    """
    reference, source = experiment.reference, experiment.disturbance
    if not (source.state.active or source.output.active or source.initial_pose.active):
        return None
    start = reference.x[0], reference.y[0], reference.heading[0]
    is_off = np.abs(np.subtract(start, experiment.initial_pose)).max() > _NONE
    looked_at = slice(reference.samples // 2 if is_off else 0, None)
    needed = np.stack(feedforward(reference, experiment.robot))[:, looked_at]
    driven = np.stack([trial.left, trial.right])[:, looked_at]
    changes = np.diff(driven - needed)
    limit = experiment.speed_limit * (1 - _ROUNDING)
    needs = np.abs(needed).max(axis=0) >= limit
    return WheelNoise(
        _TO_RMS * float(np.median(np.abs(changes))) if changes.size else 0.0,
        float(((np.abs(driven).max(axis=0) >= limit) | needs).mean()),
        float(needs.mean()),
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
