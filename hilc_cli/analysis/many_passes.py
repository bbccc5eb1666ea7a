"""Many passes over the trajectory side by side, each with a seed of its own.

For laws whose passes do not learn from each other, or have learned what there is to learn: the law
acts on what is measured in the running pass alone. Plant, readings and limit are those of the
engines, nothing is linearised; a sample of all passes is a few operations on arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.analysis.noise_draws import NoiseDraws
from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import advance, step_gains

ManyWheels = Callable[[int, Floats, Floats, Floats, Floats, Floats], tuple[Floats, Floats]]
"""A `WheelController` of many passes at once, shape (passes,) each."""

SEEDS = 100
"""Passes of each kind that is disturbed."""
_BLOCK = 64  # samples whose disturbances are drawn at once


@dataclass(frozen=True, slots=True)
class Kind:
    """What some passes have in common.

    Attributes:
        state: Whether the state is disturbed.
        output: Whether the readings are.
        initial_pose: Whether the start is.
        count: Number of such passes.
    """

    state: bool = False
    output: bool = False
    initial_pose: bool = False
    count: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Passes:
    """Passes of one kind, shape (passes,) each.

    Attributes:
        position_m: Largest position error [m].
        at_limit: Share of the samples at which the limit acts.
        change_rad_s: RMS change from one sample to the next of what their wheel speeds have beside
            those of the first pass of all [rad/s].
    """

    position_m: Floats
    at_limit: Floats
    change_rad_s: Floats


def many_passes(experiment: Experiment, wheels: ManyWheels, kinds: Sequence[Kind]) -> list[Passes]:
    """Drives all passes.

    All start at the experiment's initial pose. Kinds are disturbed by the same draws, so that what
    differs between them is not chance.

    Args:
        experiment: The experiment; its law and its iterations are not looked at.
        wheels: Wheel speeds from what is measured, before the limit.
        kinds: The passes.

    Returns:
        What each kind of pass does; infinite or not-a-number where it leaves the finite numbers.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return _driven(experiment, wheels, kinds)


def _driven(experiment: Experiment, wheels: ManyWheels, kinds: Sequence[Kind]) -> list[Passes]:
    reference, robot, limit = experiment.reference, experiment.robot, experiment.speed_limit
    gains = step_gains(robot.wheel_radius, robot.signed_half_track, reference.sample_time)
    n, source = reference.samples, experiment.disturbance
    counts = [kind.count for kind in kinds]
    state = _Draws(source.state, [kind.state for kind in kinds], counts, 1)
    output = _Draws(source.output, [kind.output for kind in kinds], counts, 2)
    initial = _Draws(source.initial_pose, [kind.initial_pose for kind in kinds], counts, 3)
    x, y, heading = np.repeat(np.array([experiment.initial_pose]).T, sum(counts), axis=1)
    if (noise := initial.at(0)) is not None:
        x, y, heading = x + noise[0], y + noise[1], heading + noise[2]
    desired = np.stack([reference.x, reference.y, reference.heading], axis=1).tolist()
    furthest, held, changes = np.zeros((3, len(x)))
    before: tuple[Floats, Floats] | None = None
    for k, (desired_x, desired_y, desired_heading) in enumerate(desired):
        error_x, error_y, error_heading = desired_x - x, desired_y - y, desired_heading - heading
        # Not-a-number is kept by the larger of two numbers.
        furthest = np.maximum(furthest, error_x * error_x + error_y * error_y)
        if k == n:
            break
        cos, sin = np.cos(heading), np.sin(heading)
        if (noise := output.at(k)) is None:
            left, right = wheels(k, cos, sin, error_x, error_y, error_heading)
        else:
            measured = heading + noise[2]
            left, right = wheels(
                k,
                np.cos(measured),
                np.sin(measured),
                error_x - noise[0],
                error_y - noise[1],
                error_heading - noise[2],
            )
        if limit < math.inf:
            fastest = np.maximum(np.abs(left), np.abs(right))
            over = fastest > limit
            if over.any():
                scale = np.where(over, limit / fastest, 1.0)  # Eq. 25
                left, right, held = left * scale, right * scale, held + over
        beside = left - left[0], right - right[0]
        if before is not None:
            changes += (beside[0] - before[0]) ** 2 + (beside[1] - before[1]) ** 2
        before = beside
        distance, turn = gains[0] * (left + right), gains[1] * (left - right)
        x, y, heading = advance(x, y, heading, cos, sin, distance, turn)
        if (noise := state.at(k)) is not None:
            x, y, heading = x + noise[0], y + noise[1], heading + noise[2]
    columns = np.sqrt(furthest), held / n, np.sqrt(changes / (2 * max(n - 1, 1)))
    kinds_of_columns = [np.split(column, np.cumsum(counts)[:-1]) for column in columns]
    return [Passes(*parts) for parts in zip(*kinds_of_columns, strict=True)]


class _Draws:
    """Draws of one disturbance for all passes, some of which do not have it."""

    def __init__(
        self, source: Bounded, has: Sequence[bool], counts: Sequence[int], key: int
    ) -> None:
        """For kinds of so many passes each, and whether each kind has it."""
        # Block by block, of which a repeated disturbance would be the same.
        self._noise = NoiseDraws(replace(source, repeat=False), 1 + max(counts), key)
        self._active = source.active and any(has)
        # Each pass of a kind that has it takes a draw of its own, the others the first, which is 0.
        self._which = np.concatenate(
            [
                np.arange(count) + 1 if h else np.zeros(count, int)
                for h, count in zip(has, counts, strict=True)
            ]
        )
        self._block: list[Floats] = []

    def at(self, k: int) -> Floats | None:
        """Of sample k, asked for in order: shape (3, passes); None if there is none."""
        if not self._active:
            return None
        if k % _BLOCK == 0:
            drawn = self._noise.drawn(_BLOCK)
            assert drawn is not None  # it is active
            self._block = list(drawn[:, :, self._which])
        return self._block[k % _BLOCK]
