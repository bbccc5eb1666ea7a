"""Disturbances of many seeds side by side, for estimates, and what is to be said of their effect.

On the path, and on the wheels, which noise jerks and drives to their limit. None of the seeds is
that of a run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, TypeGuard

import numpy as np

from hilc_cli.disturbance.streams import Bounded, Disturbance, scaled
from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.theory.findings import (
    ExpectedError,
    Findings,
    Rows,
    active_sources,
    extent,
    share_of_path,
)
from hilc_cli.theory.learning.outcome import CLEARLY, NEAR
from hilc_cli.theory.matrices import driven_errors, starts_off

_SMALLEST = 1e-10  # of a probability, as a random word of a run has it
SEEDS = 17
"""Side by side, the first of them without disturbances."""


class NoiseDraws:
    """Draws of one disturbance, iteration after iteration."""

    def __init__(self, source: Bounded, seeds: int, key: int) -> None:
        """The first of the seeds is not disturbed.

        Args:
            source: What is drawn from.
            seeds: How many are drawn side by side.
            key: Another one for each disturbance.
        """
        self._source, self._seeds = source, seeds
        # Loaded where something is drawn only.
        self._random = np.random.default_rng(key) if source.active else None
        self._kept: Floats | None = None

    def drawn(self, samples: int) -> Floats | None:
        """Offsets of the next iteration, shape (samples, 3, seeds); None for no disturbance."""
        source = self._source
        if self._random is None:
            return None
        if source.repeat and self._kept is not None:
            return self._kept
        found = np.zeros((samples, 3, self._seeds))
        for axis, (bound, deviation) in enumerate(zip(source.bound, source.deviation, strict=True)):
            units = self._random.uniform(_SMALLEST, 1 - _SMALLEST, (samples, self._seeds - 1))
            found[:, axis, 1:] = scaled(units, source.distribution, bound, deviation)
        self._kept = found
        return found


class DisturbanceDraws:
    """Draws of all three disturbances of an experiment."""

    def __init__(self, disturbance: Disturbance, seeds: int) -> None:
        """Draws for so many seeds, the first of which is not disturbed."""
        self.start = NoiseDraws(disturbance.initial_pose, seeds, 1)
        self.state = NoiseDraws(disturbance.state, seeds, 2)
        self.output = NoiseDraws(disturbance.output, seeds, 3)


@dataclass(frozen=True, slots=True, eq=False)
class Passes:
    """Passes side by side, the first of which is not disturbed; shape (passes,) each.

    Attributes:
        position_m: Largest position error [m].
        change_rad_s: RMS change from one sample to the next of what their wheel speeds have beside
            those of the first pass [rad/s].
        at_limit: Share of the samples at which the limit acts.
    """

    position_m: Floats
    change_rad_s: Floats
    at_limit: Floats


def deviations(noise: Bounded) -> tuple[float, float, float]:
    """Returns the standard deviations of the components of a disturbance [m, m, rad]."""
    x, y, heading = (
        _deviation(noise.distribution == "uniform", bound, deviation)
        for bound, deviation in zip(noise.bound, noise.deviation, strict=True)
    )
    return x, y, heading


def _deviation(is_uniform: bool, bound: float, deviation: float) -> float:
    if is_uniform or bound == 0:
        return bound / math.sqrt(3)
    if deviation == 0:
        return 0.0
    z = bound / deviation  # of a normal that is cut off at +- z standard deviations
    density = math.exp(-z * z / 2) / math.sqrt(2 * math.pi)
    kept = 1 - 2 * z * density / math.erf(z / math.sqrt(2))
    return min(deviation * math.sqrt(max(0.0, kept)), bound / math.sqrt(3))


def open_loop_error(experiment: Experiment, inputs: tuple[Floats, Floats] | None = None) -> float:
    """Returns the largest of `open_loop_errors`."""
    return float(open_loop_errors(experiment, inputs).max())


def open_loop_errors(experiment: Experiment, inputs: tuple[Floats, Floats] | None = None) -> Floats:
    """Returns position errors of given wheel speeds within the limit, without disturbances [m].

    Args:
        experiment: The experiment.
        inputs: Left and right [rad/s]; those of iteration 0 if not given.

    Returns:
        Shape (n + 1,).
    """
    left, right = inputs or (experiment.initial_left, experiment.initial_right)
    fastest = np.maximum(np.abs(left), np.abs(right))
    scale = np.ones(len(fastest))
    beyond = fastest > experiment.speed_limit
    scale[beyond] = experiment.speed_limit / fastest[beyond]
    errors: Floats = np.hypot(*driven_errors(experiment, scale * left, scale * right))
    return errors


def spread_of_start(reference: Reference, start: Bounded) -> Floats:
    """The RMS position error of each sample that a disturbed start alone makes [m], shape (n + 1,).

    A start that is off moves the whole path rigidly, as long as nobody steers.
    """
    x, y, heading = deviations(start)
    away = np.hypot(reference.x - reference.x[0], reference.y - reference.y[0])
    found: Floats = np.sqrt(x**2 + y**2 + (heading * away) ** 2)
    return found


class Remedies(NamedTuple):
    """What a law's user can do about each disturbance: only what the law has, and not done yet."""

    start: str
    readings: str
    state: str


def noise_findings(
    experiment: Experiment, found: ExpectedError, remedies: Remedies, *, learns: bool = True
) -> Findings:
    """Returns warnings of disturbances whose effect is not small beside the path.

    Args:
        experiment: With its disturbances.
        found: What each of them makes of the last iteration.
        remedies: What can be done about them with the experiment's law.
        learns: Whether the law learns from an iteration for the next one.
    """
    if found.final_m > max(CLEARLY * found.first_m, NEAR * extent(experiment)):
        return Findings()  # learning goes wrong by itself
    told = [
        (_of_start(experiment, found), remedies.start),
        (_of_readings(experiment, found, learns), remedies.readings),
        (_of_state(experiment, found), remedies.state),
    ]
    return Findings(warnings=tuple(f"{text}; {remedy}" for text, remedy in told if text))


def unsure_findings(experiment: Experiment, found: ExpectedError | None) -> Findings:
    """Returns a warning where the error of the last iteration is not known beforehand."""
    if found is None or found.unsure is None:
        return Findings()
    last = f"of iteration {experiment.iterations}"
    return Findings.warning(
        f"the error {last} cannot be foretold, since {found.unsure}: see what a simulation "
        "says (--simulate), or change the gains"
    )


def _of_start(experiment: Experiment, found: ExpectedError) -> str:
    start = experiment.disturbance.initial_pose
    if not start.active:
        return ""
    spread = float(spread_of_start(experiment.reference, start).max())
    passing = 0.0 if start.repeat else spread
    if max(passing, found.of_start_m) <= NEAR * extent(experiment):
        return ""
    anew = "the same way in each iteration" if start.repeat else "anew in each iteration"
    return (
        f"disturbance.initial_pose swings the whole path: {spread:.2g} m (RMS) off where it is "
        f"worst, {share_of_path(spread, experiment)}, {anew} and before anything is learned; "
        f"{_by_the_end(found.of_start_m, spread)}"
    )


def _of_readings(experiment: Experiment, found: ExpectedError, learns: bool) -> str:
    output = experiment.disturbance.output
    if not output.active or found.of_readings_m <= NEAR * extent(experiment):
        return ""
    x, y, heading = deviations(output)
    read = math.hypot(x, y)
    return (
        f"disturbance.output is {'learned from' if learns else 'followed'} as if it were an error: "
        f"readings are {read:.2g} m and {heading:.2g} rad (RMS) off; "
        f"{_by_the_end(found.of_readings_m, read)}, "
        f"{share_of_path(found.of_readings_m, experiment)}"
    )


def _of_state(experiment: Experiment, found: ExpectedError) -> str:
    if not experiment.disturbance.state.active or found.of_state_m <= NEAR * extent(experiment):
        return ""
    return (
        f"disturbance.state makes up to {found.of_state_m:.2g} m of the last iteration's error, "
        f"{share_of_path(found.of_state_m, experiment)}"
    )


def _by_the_end(error: float, before: float) -> str:
    """Returns what is left of a disturbance in the last iteration, beside what it was."""
    if before > 0 and error > 3 * before:
        return f"learning makes up to {error:.2g} m of it by the last iteration"
    return f"in the last iteration it makes up to {error:.2g} m"


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
    so that jumps which answer the path's own do not count. None if nothing is disturbed.
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
    return Findings.warning(
        f"noise drives the wheels to their limit in {_percent(found.at_limit)} of the "
        f"samples{without}, and changes their speed by {found.change_rad_s:.2g} rad/s (RMS) "
        f"from sample to sample: {remedy}"
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
