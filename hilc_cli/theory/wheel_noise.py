"""How much noise jerks the wheels, and how often it drives them to their limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeGuard

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.theory.findings import Findings, Rows, active_sources
from hilc_cli.theory.matrices import starts_off

_ROUNDING = 1e-9  # relative: within it a wheel is at its limit
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
    def of_seeds(cls, change_rad_s: Floats, at_limit: Floats) -> WheelNoise | None:
        """Returns what passes of many seeds tell.

        Args:
            change_rad_s: RMS change of each from sample to sample beside the first [rad/s].
            at_limit: Share of its samples at which the limit acts.

        Returns:
            None if the first, which is not disturbed, is like all others, or one is not finite.
        """
        if not change_rad_s.any() or not np.isfinite(change_rad_s).all():
            return None
        change = np.sqrt((change_rad_s[1:] ** 2).mean())
        return cls(float(change), float(at_limit[1:].mean()), float(at_limit[0]))


def changes_beside_first(inputs: Floats) -> Floats:
    """The RMS change of wheel speeds from sample to sample beside those of the first pass [rad/s].

    Args:
        inputs: Shape (n, 2, passes) [rad/s].

    Returns:
        Shape (passes,).
    """
    changes = np.diff(inputs - inputs[:, :, :1], axis=0)
    found: Floats = np.sqrt((changes**2).sum(axis=(0, 1)) / (2 * max(len(changes), 1)))
    return found


def seen_in(trial: Trial, experiment: Experiment) -> WheelNoise | None:
    """Returns the same as it has happened, beside the wheel speeds that the trajectory asks for.

    From an initial pose that is off the trajectory, the second half is looked at: before that the
    wheels may be at their limit to get there. The change is that of most samples (by the median),
    so that jumps which answer the path's own do not count.

    Args:
        trial: The last iteration.
        experiment: What was simulated.

    Returns:
        None if nothing is disturbed.
    """
    reference = experiment.reference
    if not active_sources(experiment.disturbance):
        return None
    looked_at = slice(reference.samples // 2 if starts_off(experiment) else 0, None)
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
    """Returns what it means for the experiment that this is foretold, and what makes it less."""
    if not _is_often(found):
        return Findings()
    without = f", {_percent(found.undisturbed)} without it" if found.undisturbed else ""
    return Findings(
        warnings=(
            f"noise drives the wheels to their limit in {_percent(found.at_limit)} of the "
            f"samples{without}, and changes their speed by {found.change_rad_s:.2g} rad/s (RMS) "
            f"from sample to sample: {remedy}",
        )
    )


def seen_warnings(found: WheelNoise | None) -> list[str]:
    """Returns what `seen_in` has found to have happened, and what it may come from."""
    if not _is_often(found):
        return []
    needed = f", {_percent(found.undisturbed)} of which the trajectory itself needs"
    return [
        f"in the last iteration the wheels are at their limit in {_percent(found.at_limit)} of the "
        f"samples{needed if found.undisturbed else ''}, and their speed jumps by about "
        f"{found.change_rad_s:.2g} rad/s (RMS) from sample to sample: 'hilc check' tells how much "
        "of that is noise; lower the gains that act on it, or smooth it"
    ]


def _is_often(found: WheelNoise | None) -> TypeGuard[WheelNoise]:
    """Returns whether disturbances are to blame for more than a few samples at the limit."""
    return found is not None and found.at_limit - found.undisturbed > _OFTEN


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def wheel_rows(found: WheelNoise | None) -> Rows:
    """Returns what disturbances make of the wheel speeds; nothing without any."""
    if found is None:
        return []
    without = f", {found.undisturbed:.1%} undisturbed" if found.undisturbed else ""
    return [
        (
            "Wheel noise",
            f"{found.change_rad_s:.3g} rad/s RMS in a sample; {found.at_limit:.1%} of the samples "
            f"at the limit{without}",
        )
    ]


def wheel_document(found: WheelNoise | None) -> dict[str, object]:
    """Returns what disturbances make of the wheel speeds as JSON."""
    if found is None:
        return {}
    return {
        "wheel_noise_rms_change_rad_s": found.change_rad_s,
        "share_at_limit": found.at_limit,
        "share_at_limit_undisturbed": found.undisturbed,
    }
