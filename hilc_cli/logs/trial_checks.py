"""What a trial must keep to be one: logs that are none are refused, with the reason."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.logs.fitting import Drive
from hilc_cli.logs.log import Log, RefusedTrialError, WheelSpeeds
from hilc_cli.logs.planned import PlannedPass, held_means
from hilc_cli.reference.sampled import Floats, Reference

_STANDS = 0.05  # share of the path's size that a robot moves at least
_UNLIKE = 0.5  # share of the plan's power by which what was sent may differ
_NEARER = 0.3  # share of a path's error that is left once it is mirrored
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


def check_commands(log: Log, sent: WheelSpeeds) -> None:
    """Refuses a log in which nothing was sent."""
    if not np.abs(sent.both).max(initial=0.0) > 0:
        raise RefusedTrialError(
            f"{log.path}: all its commands are 0; check that the plan was sent, or leave them out"
        )


def check_alike(log: Log, sent: WheelSpeeds, plan: PlannedPass, start: float) -> None:
    """Refuses a log whose commands are not those of the plan, which began at a time [s]."""
    reference = plan.reference
    edges = np.arange(-plan.before, reference.samples + 1.0) * reference.sample_time
    left, right = held_means(sent, start, edges)
    power = float(plan.left @ plan.left + plan.right @ plan.right)
    off = float(((left - plan.left) ** 2).sum() + ((right - plan.right) ** 2).sum())
    if off > _UNLIKE * power:
        raise RefusedTrialError(
            f"{log.path}: its commands are not those of the plan: where they are most like it, at "
            f"{start:.3f} s, they differ by {math.sqrt(off / max(power, 1e-300)):.0%} of it (RMS); "
            "check that it is the log of this plan"
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
            f"{most:.2g} m (safety.max_error){_meant(reference, own, float(away[worst]))}"
        )


def _meant(reference: Reference, own: Floats, away: float) -> str:
    """What may have happened to a path that is another one: a mirrored one tells it."""
    start = reference.poses[0]
    cos, sin = math.cos(start[2]), math.sin(start[2])
    x, y = own[:, 0] - start[0], own[:, 1] - start[1]
    ahead, left = cos * x + sin * y, cos * y - sin * x
    for kind, side_ahead, side_left in (
        ("mirrored it is near: are left and right wheel swapped?", 1, -1),
        ("driven backward it is near: does the robot drive backward?", -1, 1),
    ):
        tried_x = start[0] + side_ahead * cos * ahead - side_left * sin * left
        tried_y = start[1] + side_ahead * sin * ahead + side_left * cos * left
        if np.hypot(tried_x - reference.x, tried_y - reference.y).max() < _NEARER * away:
            return f"; {kind}"
    return ""
