"""The differential-drive platform: wheel speeds to motion and back, and the motor speed limit.

The functions work on plain numbers (or arrays of them), so that every engine can call them.
They take the half track *signed*: positive where a faster left wheel turns the platform left,
as Eq. 2 of the paper is printed, negative where a faster right wheel does (ROS REP-103). The two
conventions differ by nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from hilc_cli.reference.sampled import Floats, Reference

Number = TypeVar("Number", float, Floats)

TurnConvention = Literal["paper", "rep103"]


@dataclass(frozen=True, slots=True)
class Robot:
    """Structural parameters of a platform: the true one, or the one a controller believes in."""

    wheel_radius: float  # R_c [m]; of unequal wheels the mean
    half_track: float  # B_c as Eq. 2 uses it [m]
    turn_convention: TurnConvention = "paper"
    gravity_center: tuple[float, float] = (0.0, 0.0)  # D_cx, D_cy [m]

    @property
    def signed_half_track(self) -> float:
        """Half track [m], negative in the convention of REP-103."""
        return self.half_track if self.turn_convention == "paper" else -self.half_track


def wheel_speeds_from_twist(
    speed: Number, yaw_rate: Number, wheel_radius: float, signed_half_track: float
) -> tuple[Number, Number]:
    """Left and right wheel speed [rad/s] that give a forward speed [m/s] and yaw rate [rad/s].

    Source:
        Qiao et al. 2021, Eq. 2 solved for the wheels.
    """
    turning = signed_half_track * yaw_rate
    return (speed + turning) / wheel_radius, (speed - turning) / wheel_radius


def euler_step(
    x: float,
    y: float,
    heading: float,
    cos_heading: float,
    sin_heading: float,
    left: float,
    right: float,
    distance_gain: float,
    turn_gain: float,
) -> tuple[float, float, float]:
    """Pose of the wheel midpoint one sample later, without disturbance.

    Forward Euler with the heading at the start of the sample; the heading is never wrapped.

    Args:
        x: Position [m].
        y: Position [m].
        heading: Heading [rad].
        cos_heading: Cosine of the heading, computed by the caller its own way.
        sin_heading: Sine of the heading.
        left: Speed of the left wheel [rad/s].
        right: Speed of the right wheel [rad/s].
        distance_gain: d_k R_c / 2 [m s], see `step_gains`.
        turn_gain: d_k R_c / (2 B_c) [s], see `step_gains`.

    Source:
        Qiao et al. 2021, Eqs. 6 and 8 with the control matrix of Eq. 9.
    """
    distance, turn = distance_gain * (left + right), turn_gain * (left - right)
    return advance(x, y, heading, cos_heading, sin_heading, distance, turn)


def advance(
    x: Number,
    y: Number,
    heading: Number,
    cos_heading: Number,
    sin_heading: Number,
    distance: Number,
    turn: Number,
) -> tuple[Number, Number, Number]:
    """Pose after a step straight ahead, then a turn.

    Args:
        x: Position [m].
        y: Position [m].
        heading: Heading [rad].
        cos_heading: Cosine of the heading.
        sin_heading: Sine of the heading.
        distance: Length of the step [m].
        turn: Turn [rad].

    Source:
        Qiao et al. 2021, Eqs. 6 and 8 with the control matrix of Eq. 9.
    """
    return x + distance * cos_heading, y + distance * sin_heading, heading + turn


def step_gains(
    wheel_radius: float, signed_half_track: float, sample_time: float
) -> tuple[float, float]:
    """What sum and difference of the wheel speeds move in one sample: d_k R / 2, d_k R / (2 B).

    Args:
        wheel_radius: R_c [m].
        signed_half_track: B_c [m], see the module's text for its sign.
        sample_time: d_t [s].

    Returns:
        Distance per sum [m s] and turn per difference [s].

    Source:
        Qiao et al. 2021, Eq. 2, and the constant factors of d_k B(q_k) in Eqs. 8 and 9.
    """
    return (
        sample_time * wheel_radius / 2,
        sample_time * wheel_radius / (2 * signed_half_track),
    )


def drifting_step(
    x: float,
    y: float,
    heading: float,
    cos_heading: float,
    sin_heading: float,
    distance: float,
    turn: float,
    drift_ahead: float,
    drift_left: float,
    drift_turn: float,
) -> tuple[float, float, float]:
    """Pose after `advance` and a drift of the platform in its own frame.

    Args:
        x: Position [m].
        y: Position [m].
        heading: Heading [rad].
        cos_heading: Cosine of the heading.
        sin_heading: Sine of the heading.
        distance: Length of the step [m].
        turn: Turn [rad].
        drift_ahead: Drift along the heading [m].
        drift_left: Drift to its left [m].
        drift_turn: Drift of the heading [rad].
    """
    ahead = distance + drift_ahead
    return (
        x + (ahead * cos_heading - drift_left * sin_heading),
        y + (ahead * sin_heading + drift_left * cos_heading),
        heading + (turn + drift_turn),
    )


def driven_path(
    start: tuple[Number, Number, Number],
    left: Floats,
    right: Floats,
    robot: Robot,
    sample_time: float,
    disturbance: Floats | None = None,
) -> tuple[Floats, Floats, Floats]:
    """Returns where wheel speeds lead: `euler_step` for all samples of one pass, or of m, at once.

    Args:
        start: Pose at sample 0: x [m], y [m], heading [rad]; of m passes each of shape (m,).
        left: Speeds of the left wheel [rad/s], shape (n,), or (n, m).
        right: Speeds of the right wheel [rad/s], likewise.
        robot: The platform.
        sample_time: d_t [s].
        disturbance: beta of x, y and heading in each sample, shape (n, 3), or (n, 3, m).

    Returns:
        x [m], y [m] and heading [rad], shape (n + 1,), or (n + 1, m), each; infinite or
        not-a-number from where they leave the finite numbers.

    Source:
        Qiao et al. 2021, Eqs. 6 and 8 with the control matrix of Eq. 9.
    """
    distance_gain, turn_gain = step_gains(robot.wheel_radius, robot.signed_half_track, sample_time)
    noise = (None,) * 3 if disturbance is None else np.moveaxis(disturbance, 1, 0)
    heading = _running_sum(start[2], turn_gain * (left - right), noise[2])
    distance = distance_gain * (left + right)
    x = _running_sum(start[0], distance * np.cos(heading[:-1]), noise[0])  # Eq. 8
    y = _running_sum(start[1], distance * np.sin(heading[:-1]), noise[1])
    return x, y, heading


def _running_sum(start: Number, steps: Floats, noise: Floats | None) -> Floats:
    """Returns the sums from a start on, in the order of a loop."""
    sums = np.empty((len(steps) + 1, *steps.shape[1:]))
    sums[0], sums[1:] = start, steps
    if noise is not None:
        sums[1:] += noise
    return np.cumsum(sums, axis=0, out=sums)


class Linearisation(NamedTuple):
    """The change of a pose in one sample, to first order in the pose and the wheel speeds.

    Attributes:
        states: A_k, what a change of the pose becomes, shape (n, 3, 3).
        inputs: d_k B_k, what a change of the wheel speeds [rad/s] adds to it, shape (n, 3, 2).
    """

    states: Floats
    inputs: Floats


def control_matrices(robot: Robot, headings: Floats) -> Floats:
    """B(q) at headings of any shape, without the sample time.

    Returns:
        Matrices from wheel speeds [rad/s] to motion [m/s, m/s, rad/s], shape (..., 3, 2).

    Source:
        Qiao et al. 2021, Eq. 9.
    """
    angle = np.asarray(headings)
    cos, sin = np.cos(angle), np.sin(angle)
    turning = np.full_like(cos, 1 / robot.signed_half_track)
    matrices = np.stack([cos, cos, sin, sin, turning, -turning], axis=-1)
    values: Floats = robot.wheel_radius / 2 * matrices.reshape(*angle.shape, 3, 2)
    return values


def limit_wheel_speeds(left: float, right: float, bound: float) -> tuple[float, float]:
    """Wheel speeds scaled together, where the faster one exceeds the bound, so that it keeps it.

    The print of Eq. 25 compares without absolute values, which would let a fast reversing wheel
    pass; the bound of Eq. 14 is on the absolute speed, and so it is here.

    Args:
        left: Demanded speed of the left wheel [rad/s].
        right: Demanded speed of the right wheel [rad/s].
        bound: b_w [rad/s], > 0; infinity for no limit.

    Source:
        Qiao et al. 2021, Eqs. 14 and 25.
    """
    if -bound <= left <= bound and -bound <= right <= bound:
        return left, right
    scale = bound / max(abs(left), abs(right))
    # The product may round to a hair above the bound.
    return (
        min(max(left * scale, -bound), bound),
        min(max(right * scale, -bound), bound),
    )


def limit_wheel_means(mean: float, half_difference: float, bound: float) -> tuple[float, float]:
    """What `limit_wheel_speeds` does, of the wheel speeds' mean and half their difference.

    The faster of mean + half_difference and mean - half_difference has the absolute value
    |mean| + |half_difference|. In these numbers the turn does not depend on the position, so that
    its feedback is short.

    Args:
        mean: (left + right) / 2 [rad/s].
        half_difference: (left - right) / 2 [rad/s].
        bound: b_w [rad/s], > 0; infinity for no limit.

    Source:
        Qiao et al. 2021, Eqs. 14 and 25.
    """
    fastest = abs(mean) + abs(half_difference)
    scale = 1.0 if fastest <= bound else bound / fastest
    return mean * scale, half_difference * scale


def gravity_center_position(
    x: Number, y: Number, cos_heading: Number, sin_heading: Number, offset: tuple[float, float]
) -> tuple[Number, Number]:
    """Position of the gravity centre [m] for a pose of the wheel midpoint.

    Args:
        x: Position of the wheel midpoint [m].
        y: Position of the wheel midpoint [m].
        cos_heading: Cosine of the heading.
        sin_heading: Sine of the heading.
        offset: D_cx, D_cy [m] in the platform's frame.

    Source:
        Qiao et al. 2021, Eq. 7.
    """
    ahead, aside = offset
    return (
        x + cos_heading * ahead - sin_heading * aside,
        y + sin_heading * ahead + cos_heading * aside,
    )


def feedforward(reference: Reference, model: Robot) -> tuple[Floats, Floats]:
    """Wheel speeds that cover each step of the reference: its chord and its turn in one sample.

    Run through the forward Euler plant, the steps have the reference's lengths and turns, but
    each starts along the tangent instead of the chord: on a circle the result is the reference
    turned about its start by half a step.

    Args:
        reference: The trajectory to follow.
        model: The platform as the controller believes it to be.

    Returns:
        Left and right wheel speeds [rad/s], shape (n,) each.
    """
    speed, yaw_rate = reference_twist(reference)
    return wheel_speeds_from_twist(speed, yaw_rate, model.wheel_radius, model.signed_half_track)


def reference_twist(reference: Reference) -> tuple[Floats, Floats]:
    """Forward speed [m/s] and yaw rate [rad/s] of each step of a reference, shape (n,) each.

    The chord and the turn of a step, by the sample time.
    """
    chord = np.hypot(np.diff(reference.x), np.diff(reference.y))
    turn = np.diff(reference.heading)
    return chord / reference.sample_time, turn / reference.sample_time
