"""Where learning comes to rest: the iteration after which the law changes the input no more."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.disturbance.streams import Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.gain_matrix import Coefficients, wheel_correction
from hilc_cli.plants.kinematic import euler_step, step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.linear_law import linear_law

ROUNDING = 1e-12
"""A determinant that is smaller, as a share of the products it is made of, counts as zero."""


@dataclass(frozen=True, slots=True, eq=False)
class FixedPoint:
    """The iteration that an update repeats.

    Attributes:
        errors: e(k), reference less pose [m, m, rad], shape (n + 1, 3); infinite from where it
            leaves the finite numbers.
        inputs: The wheel speeds that hold it [rad/s], shape (n, 2), likewise.
    """

    errors: Floats
    inputs: Floats

    @property
    def is_finite(self) -> bool:
        """Whether it stays within the finite numbers."""
        return bool(np.isfinite(self.errors).all())

    @property
    def position_error_m(self) -> Floats:
        """Distance from the reference at each sample [m], shape (n + 1,)."""
        with np.errstate(over="ignore"):
            distance: Floats = np.hypot(self.errors[:, 0], self.errors[:, 1])
        return distance

    @property
    def max_position_error_m(self) -> float:
        """Largest distance from the reference [m]."""
        return float(self.position_error_m.max())

    @property
    def end_position_error_m(self) -> float:
        """Distance from the reference at its end [m]."""
        return float(self.position_error_m[-1])

    @property
    def max_wheel_speed_rad_s(self) -> float:
        """Largest absolute wheel speed [rad/s]; beyond the speed limit it cannot be driven."""
        return float(np.abs(self.inputs).max())


def fixed_point(experiment: Experiment) -> FixedPoint | None:
    """The fixed point of Eq. 17 or 21, or of law pid: at each sample the correction is zero.

    From sample to sample this is a linear equation for the two wheel speeds, since the pose at
    sample k is known: nothing is linearised. The law sees the two components G_k e of an error. In
    those Eq. 17 rests where l1 e(k+1) + l2 e(k) + l3 e(k-1) = 0, which grows from sample to sample
    unless the roots of l1 z^2 + l2 z + l3 are inside the unit circle, and Eq. 21 where
    e(k+1) = -w(k) e(0), with w the weight of the compensation. The third component is what the
    plant makes of it. Law pid rests where its weighted error and what it forgets cancel.

    Whether learning gets there is another question: in the end if the spectral radius of
    `LiftedIteration` is below 1, but perhaps not in any number of iterations that one would run.

    Args:
        experiment: The experiment; its speed limit and its disturbances are left out.

    Returns:
        The fixed point; None if there is none, or more than one: nothing is learned from the
        previous iteration, or the gain matrix is blind to a motion of the platform at some sample.
        None as well if the law has a Q-filter, with which samples depend on later ones.

    Raises:
        UsageError: The linear theory does not speak of the experiment's law.
    """
    law, reference, robot = linear_law(experiment), experiment.reference, experiment.robot
    steps = reference.samples
    distance_gain, turn_gain = step_gains(
        robot.wheel_radius, robot.signed_half_track, reference.sample_time
    )
    desired = reference.poses.tolist()
    errors, inputs = np.full((steps + 1, 3), math.inf), np.full((steps, 2), math.inf)
    pose = experiment.initial_pose
    errors[0] = now = _less(desired[0], pose)
    weighed = law.weighed_errors(now)
    if weighed is None:
        return None
    first = np.column_stack([experiment.initial_left, experiment.initial_right]).tolist()
    gain, coefficients = law.next_gain, law.along.coefficients
    for k in range(steps):
        past = weighed(k, _less(desired[k + 1], pose), now)  # were the wheels at rest
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        gain_heading = desired[k][2] if law.gain_heading == "reference" else pose[2]
        speeds = _speeds_at_rest(
            coefficients[k],
            math.cos(gain_heading),
            math.sin(gain_heading),
            past,
            (gain * distance_gain * cos, gain * distance_gain * sin, gain * turn_gain),
            law.forgotten,
            first[k],
        )
        if speeds is None:
            return None
        pose = euler_step(*pose, cos, sin, *speeds, distance_gain, turn_gain)
        if not all(math.isfinite(value) for value in (*pose, *speeds)):
            break
        now = _less(desired[k + 1], pose)
        errors[k + 1], inputs[k] = now, speeds
    return FixedPoint(errors, inputs)


def _speeds_at_rest(
    coefficients: Coefficients,
    cos: float,
    sin: float,
    error: Triple,
    motion: Triple,
    forgotten: float,
    first: tuple[float, float],
) -> tuple[float, float] | None:
    """Returns the wheel speeds (left, right) of which the law changes nothing.

    Args:
        coefficients: Of the gain matrix.
        cos: Cosine of the heading at which it is taken.
        sin: Sine of that heading.
        error: An error [m, m, rad], times gains.
        motion: What 1 rad/s of the left wheel takes from it; the right wheel turns the other way.
        forgotten: gamma.
        first: u_0 [rad/s].

    Returns:
        The speeds [rad/s]; None if the matrix does not tell the two wheels apart.
    """
    along_x, along_y, turn = motion
    # G (error - motion_left left - motion_right right) = gamma (u - u_0) by Cramer's rule.
    a, c = wheel_correction(coefficients, cos, sin, along_x, along_y, turn)
    b, d = wheel_correction(coefficients, cos, sin, along_x, along_y, -turn)
    e, f = wheel_correction(coefficients, cos, sin, *error)
    a, d = a + forgotten, d + forgotten
    e, f = e + forgotten * first[0], f + forgotten * first[1]
    determinant = a * d - b * c
    if abs(determinant) <= ROUNDING * (abs(a * d) + abs(b * c)):
        return None
    return (e * d - b * f) / determinant, (a * f - e * c) / determinant


def _less(desired: Triple, pose: Triple) -> Triple:
    """Returns the error of a pose [m, m, rad]."""
    return desired[0] - pose[0], desired[1] - pose[1], desired[2] - pose[2]
