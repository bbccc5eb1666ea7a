"""The plant linearised along its reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.feedforward import feedforward
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.robot import Robot, step_gains


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """e(k+1) = A_k e(k) - d B_k (u(k) - u_d(k)) + rho(k), with e the reference less the pose.

    To first order in e and u - u_d. The columns of errors are x [m], y [m] and heading [rad],
    those of inputs the left and right wheel [rad/s].

    Attributes:
        cos: Cosine of the reference's heading at samples 0..n-1, shape (n,).
        sin: Its sine, shape (n,).
        feedforward: u_d, the feedforward of the true robot [rad/s], shape (n, 2).
        states: A_k, shape (n, 3, 3).
        inputs: d B_k, shape (n, 3, 2) [m s, m s, s].
        residual: rho(k) [m, m, rad], shape (n, 3): what u_d leaves of each step of the reference,
            since it drives the chord's length along the tangent.

    Source:
        Qiao et al. 2021, Eqs. 8 and 9, differentiated.
    """

    cos: Floats
    sin: Floats
    feedforward: Floats
    states: Floats
    inputs: Floats
    residual: Floats


def linearise(reference: Reference, robot: Robot) -> Linearisation:
    """The plant to first order about the reference and the feedforward.

    Args:
        reference: The trajectory.
        robot: The platform as it really is.
    """
    heading = reference.heading[:-1]
    cos, sin = np.cos(heading), np.sin(heading)
    left, right = feedforward(reference, robot)
    distance_gain, turn_gain = step_gains(
        robot.wheel_radius, robot.signed_half_track, reference.sample_time
    )
    distance = distance_gain * (left + right)  # d v_k [m]
    steps = reference.samples
    states = np.zeros((steps, 3, 3))
    states[:] = np.eye(3)
    states[:, 0, 2] = -distance * sin
    states[:, 1, 2] = distance * cos
    inputs = np.empty((steps, 3, 2))  # Eq. 9
    inputs[:, 0] = distance_gain * cos[:, np.newaxis]
    inputs[:, 1] = distance_gain * sin[:, np.newaxis]
    inputs[:, 2] = turn_gain, -turn_gain
    residual = np.column_stack(
        [
            np.diff(reference.x) - distance * cos,
            np.diff(reference.y) - distance * sin,
            np.diff(reference.heading) - turn_gain * (left - right),
        ]
    )
    return Linearisation(cos, sin, np.column_stack([left, right]), states, inputs, residual)


def gains_along(matrix: GainMatrix, cos: Floats, sin: Floats) -> Floats:
    """The gain matrix at given headings.

    Args:
        matrix: The gain matrix.
        cos: Cosines of the headings, shape (n,).
        sin: Sines, shape (n,).

    Returns:
        G_k, shape (n, 2, 3).
    """
    affine = np.array(matrix.coefficients).reshape(2, 3, 3)
    gains: Floats = np.einsum("wea,ka->kwe", affine, np.column_stack([np.ones_like(cos), cos, sin]))
    return gains


def hybrid_law(experiment: Experiment) -> HybridLaw:
    """The experiment's law.

    Raises:
        UsageError: It is another one than the hybrid law.
    """
    if not isinstance(experiment.law, HybridLaw):
        raise UsageError("the theory of learning knows the hybrid law only")
    return experiment.law
