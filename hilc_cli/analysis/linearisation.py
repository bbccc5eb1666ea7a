"""The plant linearised along its reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.matrices import control_matrices, desired_motion
from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import step_gains


@dataclass(frozen=True, slots=True, eq=False)
class Linearisation:
    """e(k+1) = A_k e(k) - d B_k (u(k) - u_d(k)) + rho(k), with e the reference less the pose.

    To first order in e and u - u_d. The columns of errors are x [m], y [m] and heading [rad],
    those of inputs the left and right wheel [rad/s].

    Attributes:
        feedforward: u_d, the feedforward of the true robot [rad/s], shape (n, 2).
        states: A_k, shape (n, 3, 3).
        inputs: d B_k, shape (n, 3, 2) [m s, m s, s].
        residual: rho(k) [m, m, rad], shape (n, 3): what u_d leaves of each step of the reference,
            since it drives the chord's length along the tangent.

    Source:
        Qiao et al. 2021, Eqs. 8 and 9, differentiated.
    """

    feedforward: Floats
    states: Floats
    inputs: Floats
    residual: Floats


def linearise(experiment: Experiment) -> Linearisation:
    """The plant to first order about the reference and the feedforward.

    Args:
        experiment: Its reference, and the platform as it really is.
    """
    reference, robot = experiment.reference, experiment.robot
    headings = reference.heading[:-1]
    desired = desired_motion(experiment)
    distance_gain, _ = step_gains(
        robot.wheel_radius, robot.signed_half_track, reference.sample_time
    )
    distance = distance_gain * desired.inputs.sum(axis=1)  # d v_k [m]
    # Sample next to sample: products over all of them are several times as fast then.
    states = np.zeros((reference.samples, 3, 3), order="F")
    states[:] = np.eye(3)
    states[:, 0, 2] = -distance * np.sin(headings)
    states[:, 1, 2] = distance * np.cos(headings)
    inputs = reference.sample_time * control_matrices(robot, headings)
    return Linearisation(
        np.asfortranarray(desired.inputs),
        states,
        np.asfortranarray(inputs),
        np.asfortranarray(desired.mismatch),
    )
