"""The best step of commands along a motion where no limit is in the way: all in machine code."""

from __future__ import annotations

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.linear_quadratic import change_of_cost, factorised, solved
from hilc_cli.laws.norm_optimal.motor import Motor, body_step
from hilc_cli.laws.norm_optimal.motor_motion import linearised, linearised_at_once
from hilc_cli.laws.norm_optimal.motor_quadratic import ORDER, change_of_motors, factorise, solve
from hilc_cli.reference.sampled import Floats


def _around(
    poses: Floats,
    inputs: Floats,
    target: Floats,
    pose_weights: Floats,
    easy: Floats,
    command: Floats,
    speed_limit: float,
    delayed: int,
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """How the cost of a motion changes, and how much room commands have about theirs.

    Args:
        poses: Of the motion, shape (n + 1, 3).
        inputs: Its commands [rad/s], shape (n, 2).
        target: As for `motor_plan.stepped`, as all that follow.
        pose_weights: Likewise.
        easy: Likewise.
        command: Likewise.
        speed_limit: b_w [rad/s].
        delayed: Whole samples until a command arrives.

    Returns:
        Derivatives by the poses, shape (n + 1, 3); and of the commands, by the sample at which they
        arrive, shape (n, 2) each: weights, derivatives, and bounds of their changes [rad/s].
    """
    n = len(inputs)
    pose_slopes = np.empty((n + 1, 3))
    weights, slopes = np.empty((n, 2)), np.zeros((n, 2))
    lowest, highest = np.empty((n, 2)), np.empty((n, 2))
    for k in range(n + 1):
        for i in range(3):
            pose_slopes[k, i] = pose_weights[i] * (poses[k, i] - target[k, i])
    for k in range(n):
        for wheel in range(2):
            if k < delayed:  # held by its weight alone, as what comes too late to arrive
                weights[k, wheel] = command[k, wheel]
                lowest[k, wheel], highest[k, wheel] = -speed_limit, speed_limit
                continue
            own, weight = inputs[k - delayed, wheel], command[k - delayed, wheel]
            weights[k, wheel] = weight
            slopes[k, wheel] = weight * (own - easy[k - delayed, wheel])
            lowest[k, wheel], highest[k, wheel] = -speed_limit - own, speed_limit - own
    return pose_slopes, weights, slopes, lowest, highest


around = cached(_around)


def _sent_earlier(arriving: Floats, delayed: int) -> Floats:
    """What is to arrive at each sample, by the sample at which it is sent; 0 after the last one."""
    n = len(arriving)
    sent = np.zeros((n, 2))
    for k in range(n - delayed):
        for wheel in range(2):
            sent[k, wheel] = arriving[k + delayed, wheel]
    return sent


sent_earlier = cached(_sent_earlier)


def _is_between(changes: Floats, lowest: Floats, highest: Floats) -> bool:
    for k in range(len(changes)):
        for wheel in range(2):
            if not lowest[k, wheel] <= changes[k, wheel] <= highest[k, wheel]:
                return False
    return True


is_between = compiled(_is_between)


def _free_at_once(
    poses: Floats,
    inputs: Floats,
    motor: Motor,
    sample_time: float,
    lead: float,
    target: Floats,
    pose_weights: Floats,
    easy: Floats,
    command: Floats,
    speed_limit: float,
    delayed: int,
) -> tuple[bool, Floats, float]:
    """The best step of commands without limits: all in one, since most plans need nothing else.

    Of wheels that do at once what they are told. The arguments are those of `_linearised` and of
    `_around`.

    Returns:
        Whether the limit is in the way; if not the changes, shape (n, 2), and what they gain.
    """
    n = len(inputs)
    pose_slopes, weights, slopes, lowest, highest = around(
        poses, inputs, target, pose_weights, easy, command, speed_limit, delayed
    )
    motion = linearised_at_once(poses, inputs, motor, sample_time, lead)
    everywhere, changes = np.empty((n + 1, 2)), np.empty((n, 2))
    for k in range(n + 1):
        everywhere[k, 0], everywhere[k, 1] = pose_weights[0], pose_weights[2]
    factors = np.empty((n, 2, 3)), np.empty((n, 3))
    factorised(motion, everywhere, weights, factors[0], factors[1])
    solved(motion, factors[0], factors[1], pose_slopes, slopes, changes)
    if not is_between(changes, lowest, highest):
        return True, changes, 0.0
    gain = -change_of_cost(motion, everywhere, weights, pose_slopes, slopes, changes)
    return False, sent_earlier(changes, delayed), gain


def _free_of_motors(
    poses: Floats,
    inputs: Floats,
    motor: Motor,
    sample_time: float,
    lead: float,
    target: Floats,
    pose_weights: Floats,
    easy: Floats,
    command: Floats,
    speed_limit: float,
    delayed: int,
) -> tuple[bool, Floats, float]:
    """The same of all other wheels."""
    n = len(inputs)
    pose_slopes, weights, slopes, lowest, highest = around(
        poses, inputs, target, pose_weights, easy, command, speed_limit, delayed
    )
    motion = linearised(poses, inputs, motor, sample_time, lead)
    gains, inverses = np.empty((n, 2, ORDER)), np.empty((n, 3))
    factorise(motion, pose_weights, weights, gains, inverses)
    changes = solve(motion, gains, inverses, pose_slopes, slopes)
    if not is_between(changes, lowest, highest):
        return True, changes, 0.0
    gain = -change_of_motors(motion, pose_weights, weights, pose_slopes, slopes, changes)
    return False, sent_earlier(changes, delayed), gain


_PARTS = [body_step, linearised, factorised, factorise]
free_at_once = cached(_free_at_once, parts=_PARTS)
free_of_motors = cached(_free_of_motors, parts=_PARTS)
