"""PID-type learning written down once more: vectors, matrices, sums and cosines.

It shares no code with hilc. The Q-filter is that of a signal which is mirrored at its ends without
end: its eigenvectors are cosines, and the Butterworth filter run forth and back multiplies each by
the square of its gain.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from tests.transcription import Floats, MatrixOfHeading, Pass


def smoothed(signal: Floats, cutoff: float, sample_time: float) -> Floats:
    """The signal, shape (n, columns), through the mirrored Butterworth filter of second order."""
    n = len(signal)
    j, k = np.arange(n), np.arange(n)
    cosines = np.cos(np.pi * np.outer(j, k + 0.5) / n)
    cosines /= np.linalg.norm(cosines, axis=1, keepdims=True)
    # The bilinear transform takes the frequency f to tan(pi f d_t).
    gain = 1 / (1 + (np.tan(np.pi * j / (2 * n)) / math.tan(math.pi * cutoff * sample_time)) ** 4)
    filtered: Floats = cosines.T @ (gain[:, None] * (cosines @ signal))
    return filtered


def transcribe_pid(
    *,
    desired: Floats,
    sample_time: float,
    wheel_radius: float,
    half_track: float,
    gain_matrix: MatrixOfHeading,
    kp: float,
    ki: float,
    kd: float,
    forgetting: float,
    cutoff: float | None,
    rectifying: int | None,
    gain_heading: Literal["measured", "previous", "reference"],
    speed_limit: float,
    initial_pose: tuple[float, float, float],
    initial_input: Floats,
    iterations: int,
    output_noise: Sequence[Floats | None],
) -> list[Pass]:
    """Iterations 0..N, the first in open loop.

    Args:
        desired: Reference, shape (n + 1, 3).
        sample_time: d_t [s].
        wheel_radius: R of the plant [m].
        half_track: B of the plant [m]; negative for REP-103.
        gain_matrix: The 2x3 matrix as a function of cos and sin.
        kp: Gain of the error.
        ki: Gain of its sum.
        kd: Gain of its derivative.
        forgetting: gamma.
        cutoff: Of the Q-filter [Hz]; None for none.
        rectifying: Length of the rectifying pulse in samples; None for none.
        gain_heading: Heading at which the matrix is taken.
        speed_limit: b_w [rad/s]; infinity for none.
        initial_pose: q(0).
        initial_input: u_0, shape (n, 2).
        iterations: N.
        output_noise: Of each iteration, shape (n + 1, 3).
    """
    n = len(desired) - 1
    passes: list[Pass] = []
    learned, outputs_before = initial_input, desired
    for i in range(iterations + 1):
        error = desired - outputs_before
        base = (1 - forgetting) * learned + forgetting * initial_input
        weighted = np.zeros((n, 3))
        for k in range(n):
            weighted[k] += kp * error[k + 1]
            weighted[k] += ki * sample_time * error[: k + 2].sum(axis=0)
            weighted[k] += kd * (error[k + 1] - error[k]) / sample_time
            if rectifying is not None and k < rectifying:
                # The area of 2 / T (1 - t / T) over the sample, by the sample.
                begin, end = k / rectifying, (k + 1) / rectifying
                area = (2 * end - end**2) - (2 * begin - begin**2)
                weighted[k] += kd * area / sample_time * error[0]
        if cutoff is not None:
            base = smoothed(base, cutoff, sample_time)
            weighted = smoothed(weighted, cutoff, sample_time)
        alpha = output_noise[i]
        q = np.array(initial_pose, dtype=float)
        poses, outputs, inputs = np.empty((n + 1, 3)), np.empty((n + 1, 3)), np.empty((n, 2))
        poses[0] = q
        for k in range(n):
            y = q if alpha is None else q + alpha[k]
            outputs[k] = y
            u = initial_input[k]
            if i > 0:
                angle = {
                    "measured": y[2],
                    "previous": outputs_before[k, 2],
                    "reference": desired[k, 2],
                }[gain_heading]
                u = base[k] + gain_matrix(math.cos(angle), math.sin(angle)) @ weighted[k]
            u = u / max(1.0, np.abs(u).max() / speed_limit)
            c, s = math.cos(q[2]), math.sin(q[2])
            control = np.array([[c, c], [s, s], [1 / half_track, -1 / half_track]])
            q = q + sample_time * wheel_radius / 2 * (control @ u)
            inputs[k], poses[k + 1] = u, q
        outputs[n] = q if alpha is None else q + alpha[n]
        passes.append(Pass(poses, inputs))
        learned, outputs_before = inputs, outputs
    return passes
