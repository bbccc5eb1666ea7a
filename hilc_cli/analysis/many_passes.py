"""Many passes over the trajectory side by side, each with a seed of its own.

For laws whose passes do not learn from each other, or have learned what there is to learn: the law
acts on what is measured in the running pass alone. Plant, readings and limit are those of the
engines, nothing is linearised; a sample of all passes is a few operations on arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hilc_cli.disturbance.streams import Bounded, scaled
from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import advance, step_gains

ManyWheels = Callable[[int, Floats, Floats, Floats, Floats, Floats], tuple[Floats, Floats]]
"""A `WheelController` of many passes at once, shape (passes,) each."""

SEEDS = 100
"""Passes of each kind that is disturbed."""
_BLOCK = 64  # samples whose disturbances are drawn at once
_SEED = 20210401  # of the draws, which are those of no run


@dataclass(frozen=True, slots=True)
class Kind:
    """What some passes have in common.

    Attributes:
        start: Pose at which they start [m, m, rad], before its disturbance.
        state: Whether the state is disturbed.
        output: Whether the readings are.
        initial_pose: Whether the start is.
        count: Number of such passes.
    """

    start: tuple[float, float, float]
    state: bool = False
    output: bool = False
    initial_pose: bool = False
    count: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Passes:
    """Passes of one kind, shape (passes,) unless it is said otherwise.

    Attributes:
        position_m: Largest position error [m].
        end_m: Position error at the end [m].
        heading_rad: Largest error of the heading [rad].
        at_limit: Share of the samples at which the limit acts.
        change_rad_s: RMS change from one sample to the next of what their wheel speeds have beside
            those of the first kind's first pass [rad/s].
        poses: The first pass, shape (n + 1, 3).
    """

    position_m: Floats
    end_m: Floats
    heading_rad: Floats
    at_limit: Floats
    change_rad_s: Floats
    poses: Floats


def many_passes(experiment: Experiment, wheels: ManyWheels, kinds: Sequence[Kind]) -> list[Passes]:
    """Drives all passes.

    Kinds are disturbed by the same draws, so that what differs between them is not chance.

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
    firsts = (np.cumsum(counts) - counts).tolist()
    state = _Draws(source.state, [kind.state for kind in kinds], counts, 1)
    output = _Draws(source.output, [kind.output for kind in kinds], counts, 2)
    initial = _Draws(source.initial_pose, [kind.initial_pose for kind in kinds], counts, 3)
    starts = np.repeat([kind.start for kind in kinds], counts, axis=0).T
    x, y, heading = starts if (off := initial.at(0)) is None else starts + off
    desired = np.stack([reference.x, reference.y, reference.heading], axis=1)
    kept = np.empty((n + 1, 3, len(kinds)))
    furthest, turned, held, changes = np.zeros((4, len(x)))
    before: tuple[Floats, Floats] | None = None
    for k in range(n + 1):
        kept[k] = x[firsts], y[firsts], heading[firsts]
        error_x, error_y, error_heading = (
            wanted - found
            for wanted, found in zip(desired[k].tolist(), (x, y, heading), strict=True)
        )
        squared = error_x * error_x + error_y * error_y
        # Not-a-number is kept by the larger of two numbers.
        furthest, turned = np.maximum(furthest, squared), np.maximum(turned, np.abs(error_heading))
        if k == n:
            break
        cos, sin = np.cos(heading), np.sin(heading)
        seen, seen_cos, seen_sin = (error_x, error_y, error_heading), cos, sin
        if (noise := output.at(k)) is not None:
            seen = error_x - noise[0], error_y - noise[1], error_heading - noise[2]
            seen_cos, seen_sin = np.cos(heading + noise[2]), np.sin(heading + noise[2])
        left, right = wheels(k, seen_cos, seen_sin, *seen)
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
    change = np.sqrt(changes / (2 * max(n - 1, 1)))
    end, held = np.sqrt(squared), held / n
    found = []
    for which, first in enumerate(firsts):
        of = slice(first, first + counts[which])
        found.append(
            Passes(
                np.sqrt(furthest[of]), end[of], turned[of], held[of], change[of], kept[:, :, which]
            )
        )
    return found


class _Draws:
    """Draws of one disturbance for all passes, some of which do not have it."""

    def __init__(
        self, source: Bounded, has: Sequence[bool], counts: Sequence[int], stream: int
    ) -> None:
        self._source, self._most = source, max(counts)
        self._random = np.random.default_rng([_SEED, stream])
        self._active = source.active and any(has)
        # Each pass of a kind that has it takes one draw of its own, the others take none of it.
        self._draw = np.concatenate([np.arange(count) for count in counts])
        self._share = np.repeat(np.array(has, dtype=float), counts)
        self._block = np.empty(0)

    def at(self, k: int) -> Floats | None:
        """Of sample k, asked for in order: shape (3, passes); None if there is none."""
        if not self._active:
            return None
        if k % _BLOCK == 0:
            # Open at both ends, as the engines' are.
            unit = self._random.uniform(1e-12, 1 - 1e-12, (3, _BLOCK, self._most))
            source = self._source
            self._block = np.stack(
                [
                    scaled(one, source.distribution, bound, deviation)
                    for one, bound, deviation in zip(
                        unit, source.bound, source.deviation, strict=True
                    )
                ],
                axis=1,
            )
        drawn: Floats = self._block[k % _BLOCK][:, self._draw] * self._share
        return drawn
