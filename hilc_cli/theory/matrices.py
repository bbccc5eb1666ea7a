"""The matrices that the theory is made of: B of the plant, L of the law, at given headings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.plants.kinematic import control_matrices, driven_path, feedforward
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.reference.sampled import Floats

_NONE = 1e-9  # of a start that differs by less [m and rad], by rounding only


def knows_plant(experiment: Experiment) -> bool:
    """Returns whether theory speaks of the plant: it is all made of the motion of Eq. 8.

    A plant that inherits from the paper's may move otherwise, so that it is another one.
    """
    return type(experiment.plant) is KinematicPlant


def known_plant(experiment: Experiment) -> KinematicPlant:
    """Returns the experiment's plant.

    Raises:
        UsageError: Theory does not speak of it.
    """
    if not knows_plant(experiment):
        raise UsageError("theory does not know the plant: it is all made of the motion of Eq. 8")
    return cast("KinematicPlant", experiment.plant)


class GainParts(NamedTuple):
    """A gain matrix as constant + cos * cos(heading) + sin * sin(heading), each of shape (2, 3)."""

    constant: Floats
    cos: Floats
    sin: Floats

    @classmethod
    def of(cls, matrix: GainMatrix) -> GainParts:
        """Returns the parts of a law's gain matrix."""
        parts = np.array(matrix.coefficients).reshape(2, 3, 3)
        return cls(parts[..., 0], parts[..., 1], parts[..., 2])

    @property
    def derivative(self) -> GainParts:
        """The derivative by the heading, again of that form."""
        return GainParts(np.zeros((2, 3)), self.sin, -self.cos)

    def at(self, headings: Floats) -> Floats:
        """Returns the matrix at headings of any shape, shape (..., 2, 3)."""
        angle = np.asarray(headings)[..., np.newaxis, np.newaxis]
        values: Floats = self.constant + np.cos(angle) * self.cos + np.sin(angle) * self.sin
        return values


class Desired(NamedTuple):
    """The input u_d that the theory compares with, and what it leaves of the reference.

    Attributes:
        inputs: u_d, the feedforward of the true robot, left and right [rad/s], shape (n, 2).
        mismatch: q_d(k+1) - q_d(k) - d_k B(q_d(k)) u_d(k) [m, m, rad], shape (n, 3): the Euler
            plant steps along the tangent, a sampled arc along the chord.
    """

    inputs: Floats
    mismatch: Floats


def starts_off(experiment: Experiment) -> bool:
    """Returns whether the initial pose differs from the reference's by more than rounding."""
    off = experiment.reference.poses[0] - experiment.initial_pose
    return bool(np.abs(off).max() > _NONE)


def desired_motion(experiment: Experiment) -> Desired:
    """Returns u_d and its mismatch; Eq. 26 takes the mismatch for zero."""
    reference, robot = experiment.reference, experiment.robot
    inputs = np.column_stack(feedforward(reference, robot))
    control = control_matrices(robot, reference.heading[:-1])
    steps = reference.sample_time * np.einsum("kij,kj->ki", control, inputs)
    return Desired(inputs, np.diff(reference.poses, axis=0) - steps)


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
    """Returns the plant, as it really is, to first order about reference and feedforward.

    Raises:
        UsageError: Theory does not know the plant.
    """
    reference, desired = experiment.reference, desired_motion(experiment)
    left, right = desired.inputs.T
    states, inputs = known_plant(experiment).linearisation(
        reference.heading[:-1], left, right, reference.sample_time
    )
    feedforward_inputs, residual = map(np.asfortranarray, desired)
    return Linearisation(feedforward_inputs, states, inputs, residual)


def driven_errors(
    experiment: Experiment,
    left: Floats,
    right: Floats,
    start: Floats | None = None,
    state: Floats | None = None,
) -> tuple[Floats, Floats]:
    """Returns the errors in x and in y of the exact plant that drives wheel speeds [m].

    Args:
        experiment: Its reference and its platform.
        left: Speeds of the left wheel [rad/s], as `driven_path` takes them.
        right: Speeds of the right wheel [rad/s].
        start: Poses at sample 0 of m passes, shape (3, m); the initial pose of one if not given.
        state: What disturbs the state.
    """
    reference, robot = experiment.reference, experiment.robot
    x, y, heading = np.array(experiment.initial_pose) if start is None else start
    x, y, _ = driven_path((x, y, heading), left, right, robot, reference.sample_time, state)
    return (reference.x - x.T).T, (reference.y - y.T).T


def times(matrices: Floats, vectors: Floats) -> Floats:
    """Returns each matrix times its vectors: shapes (n, a, b) and (n, b, ...) to (n, a, ...)."""
    product: Floats = np.einsum("kab,kb...->ka...", matrices, vectors)
    return product
