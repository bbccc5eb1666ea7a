"""The controller and the plant written down once more, straight from the paper's matrices.

It shares no code with hilc: vectors and matrices where the program has plain numbers, the whole
of u = u + L1 e + L2 e + L3 e where the program sums the errors first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
MatrixOfHeading = Callable[[float, float], Floats]  # (cos, sin) -> 2x3


class Pass(NamedTuple):
    """One iteration: poses, shape (n + 1, 3), and limited inputs (left, right), shape (n, 2)."""

    poses: Floats
    inputs: Floats


def equation_9(wheel_radius: float, half_track: float) -> MatrixOfHeading:
    """B of Eq. 9, 3x2; REP-103 with a negative half track."""
    r, b = wheel_radius, half_track
    return lambda cos, sin: r / 2 * np.array([[cos, cos], [sin, sin], [1 / b, -1 / b]])


def equation_45(wheel_radius: float, half_track: float) -> MatrixOfHeading:
    """L1(k) of Eq. 45; Eq. 56 with both parameters 1; REP-103 with a negative half track."""
    r, b = wheel_radius, half_track
    return lambda cos, sin: np.array([[cos / r, sin / r, b / r], [cos / r, sin / r, -b / r]])


def equation_57(wheel_radius: float, half_track: float) -> MatrixOfHeading:
    """The matrix of Eq. 57 that contradicts the kinematics."""
    turning = half_track / wheel_radius
    return lambda cos, sin: np.array([[0.5, 0.2, turning], [cos, sin, -turning]])


def transcribe(
    *,
    reference_x: Floats,
    reference_y: Floats,
    reference_heading: Floats,
    sample_time: float,
    wheel_radius: float,
    half_track: float,
    gain_matrix: MatrixOfHeading,
    l1: float,
    l2: float,
    l3: float,
    compensation: bool,
    h: int,
    speed_limit: float | None,
    initial_pose: tuple[float, float, float],
    iterations: int,
    initial_left: Floats,
    initial_right: Floats,
    state_noise: Sequence[Floats | None] | None = None,
    output_noise: Sequence[Floats | None] | None = None,
    initial_pose_noise: Sequence[tuple[float, float, float]] | None = None,
    gain_heading: Literal["measured", "previous", "reference"] = "measured",
    learn_in_first: bool = False,
    derivative: float = 0.0,
) -> list[Pass]:
    """Iterations 0..N of Eqs. 8, 11, 17, 21, 22 and 25.

    Args:
        reference_x: y_d [m], shape (n + 1,).
        reference_y: y_d [m], shape (n + 1,).
        reference_heading: y_d [rad], shape (n + 1,).
        sample_time: d_t [s].
        wheel_radius: R_c of the plant [m].
        half_track: B_c of the plant as Eq. 9 uses it [m]; negative for REP-103.
        gain_matrix: The 2x3 matrix as a function of cos(q) and sin(q).
        l1: Scalar of e_i(k+1).
        l2: Scalar of e_{i+1}(k), not used with compensation.
        l3: Scalar of e_{i+1}(k-1), not used with compensation.
        compensation: Eq. 21 if true, Eq. 17 if not.
        h: Of Eq. 22 [samples].
        speed_limit: b_w [rad/s]; None for none.
        initial_pose: q(0) before its noise.
        iterations: N.
        initial_left: u_0, shape (n,).
        initial_right: u_0, shape (n,).
        state_noise: beta of each iteration, shape (n, 3) each.
        output_noise: alpha of each iteration, shape (n + 1, 3) each.
        initial_pose_noise: Offset of q(0) of each iteration.
        gain_heading: The "q" of Eq. 45.
        learn_in_first: Whether iteration 0 runs the law, from u_0 and no error.
        derivative: tau [s], where L1 acts on e + tau de/dt of the iteration before, and the
            compensation is taken times tau; 0 for the paper.
    """
    desired = np.column_stack([reference_x, reference_y, reference_heading])
    n = len(desired) - 1
    u_before = np.column_stack([initial_left, initial_right])
    y_before = desired.copy()  # no error is known before iteration 0
    passes: list[Pass] = []
    for i in range(iterations + 1):
        learns = i > 0 or learn_in_first
        alpha = output_noise[i] if output_noise is not None else None
        beta = state_noise[i] if state_noise is not None else None
        e_before = desired - y_before
        q = np.array(initial_pose, dtype=float)
        if initial_pose_noise is not None:
            q = q + initial_pose_noise[i]
        poses, outputs, inputs = np.empty((n + 1, 3)), np.empty((n + 1, 3)), np.empty((n, 2))
        poses[0] = q
        e_last = np.zeros(3)  # e(-1)
        for k in range(n):
            y = q if alpha is None else q + alpha[k]
            outputs[k] = y
            u = u_before[k]
            if learns:
                angle = {"measured": y[2], "previous": y_before[k, 2], "reference": desired[k, 2]}[
                    gain_heading
                ]
                gain = gain_matrix(math.cos(angle), math.sin(angle))
                past = e_before[k + 1]
                if derivative > 0:
                    past = past + derivative * (e_before[k + 1] - e_before[k]) / sample_time
                if compensation:  # Eq. 21 with Eq. 22
                    u = u + (l1 * gain) @ past
                    if k <= h:
                        theta = 2 / (sample_time * h) * (1 - k / h)
                        if derivative > 0:
                            theta = derivative * theta
                        u = u + math.exp(-k * sample_time) * theta * (l1 * gain) @ e_before[0]
                else:  # Eq. 17
                    e = desired[k] - y
                    u = u + (l1 * gain) @ past
                    if l2 or l3:
                        u = u + (l2 * gain) @ e + (l3 * gain) @ e_last
                    e_last = e
            if speed_limit is not None:  # Eq. 25 with the absolute values of Eq. 14
                fastest = max(abs(u[0]), abs(u[1]))
                if fastest > speed_limit:
                    u = u / fastest * speed_limit
            c, s = math.cos(q[2]), math.sin(q[2])
            control = np.array([[c, c], [s, s], [1 / half_track, -1 / half_track]])
            q = q + sample_time * wheel_radius / 2 * (control @ u)  # Eqs. 8 and 9
            if beta is not None:
                q = q + beta[k]  # Eq. 11
            inputs[k], poses[k + 1] = u, q
        outputs[n] = q if alpha is None else q + alpha[n]
        passes.append(Pass(poses, inputs))
        u_before, y_before = inputs, outputs
    return passes
