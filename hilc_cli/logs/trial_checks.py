"""What a trial must keep to be one: logs that are none are refused, with the reason."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.logs.fitting import Drive
from hilc_cli.logs.log import Log, RefusedTrialError
from hilc_cli.logs.planned import PlannedPass
from hilc_cli.reference.sampled import Floats, Reference

_STANDS = 0.05  # share of the path's size that a robot moves at least
_SMALLEST = 0.1  # [m]: smaller paths are taken for that large


@dataclass(frozen=True, slots=True)
class Limits:
    """What a trial must keep to be one.

    Attributes:
        max_error: Largest distance from the path in the trial's own start frame [m]; None: half
            of the path's longer side.
        max_start_distance: From the planned start [m]; None: a tenth of the path's longer side, and
            at least 0.1 m.
        max_start_turn: From the planned heading at the start [rad].
        max_missing: How much of the pass may be missing at either end [s].
    """

    max_error: float | None = None
    max_start_distance: float | None = None
    max_start_turn: float = 0.5
    max_missing: float = 0.3


def check_moves(log: Log, plan: PlannedPass) -> None:
    """Refuses a log in which the robot stands still."""
    reference = plan.reference
    noise = Drive(log.poses.times, log.poses.readings, plan.times, plan.left).reading_noise
    spread = [float(np.ptp(log.poses.x)), float(np.ptp(log.poses.y))]
    turned = 0.0 if log.poses.heading is None else float(np.ptp(log.poses.heading))
    wanted, wanted_turn = reference.size, float(np.ptp(reference.heading))
    moves = max(spread) > max(_STANDS * wanted, 10 * noise[0])
    turns = turned > max(_STANDS * wanted_turn, 10 * noise[1]) and wanted_turn > 0
    if not moves and not (turns and wanted < _SMALLEST):
        raise RefusedTrialError(
            f"{log.path}: the robot stands still: it moves {max(spread):.2g} m where the plan goes "
            f"over {wanted:.3g} m; check that the robot listens, and that this is the right log"
        )


def check_whole(log: Log, plan: PlannedPass, start: float, limits: Limits) -> None:
    """Refuses a log that does not hold the whole pass, which began at a time [s]."""
    first, last = float(log.poses.times[0]), float(log.poses.times[-1])
    late, early = first - start, start + plan.end - last
    if late > limits.max_missing:
        raise RefusedTrialError(
            f"{log.path}: its poses begin {late:.2f} s after the plan (at {start:.3f} s); start "
            "recording before the robot moves"
        )
    if early > limits.max_missing:
        raise RefusedTrialError(
            f"{log.path}: is cut off: its poses end {early:.2f} s before the plan does (at "
            f"{start + plan.end:.3f} s); record until the robot stands"
        )


def check_start(log: Log, reference: Reference, start: Floats, limits: Limits) -> None:
    """Refuses a trial that starts elsewhere than planned, at a pose of shape (3,)."""
    most = limits.max_start_distance
    if most is None:
        most = max(0.1 * reference.size, _SMALLEST)
    wanted = reference.poses[0]
    away = math.hypot(start[0] - wanted[0], start[1] - wanted[1])
    if away > most:
        raise RefusedTrialError(
            f"{log.path}: starts at {start[0]:.3f}, {start[1]:.3f} m, {away:.2g} m from the "
            f"planned start at {wanted[0]:.3f}, {wanted[1]:.3f} m; put the robot within "
            f"{most:.2g} m"
        )
    turned = abs(float(start[2] - wanted[2]))
    if turned > limits.max_start_turn:
        raise RefusedTrialError(
            f"{log.path}: starts with a heading of {start[2]:.3f} rad, {turned:.2g} rad from the "
            f"planned {wanted[2]:.3f} rad; turn the robot to within {limits.max_start_turn:g} rad"
        )


def check_path(log: Log, reference: Reference, own: Floats, limits: Limits) -> None:
    """Refuses a trial that drives another path.

    Args:
        log: For messages.
        reference: The path.
        own: Poses at its samples in the frame of their own start, shape (n + 1, 3).
        limits: What a trial must keep.
    """
    most = limits.max_error
    if most is None:
        most = max(reference.size / 2, _SMALLEST)
    away = np.hypot(own[:, 0] - reference.x, own[:, 1] - reference.y)
    worst = int(np.argmax(away))
    if away[worst] > most:
        raise RefusedTrialError(
            f"{log.path}: drives another path: {away[worst]:.2g} m away from the planned one at "
            f"{worst * reference.sample_time:.2f} s, both from their starts; the most is "
            f"{most:.2g} m (safety.max_error)"
        )
