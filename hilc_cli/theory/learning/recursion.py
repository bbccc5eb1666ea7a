"""Linear recursions of the error along the trajectory, solved for all samples at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.matrices import desired_motion


class DriftRecursion:
    """e(k+1) = A_k e(k) + r(k+1), from e(0) = r(0): a platform that nobody steers.

    A_k is the identity and what an error of the heading moves in x and in y. So the heading's error
    is a sum, and those of the position are two more.
    """

    def __init__(self, states: Floats) -> None:
        """Takes what a heading error moves.

        Args:
            states: A_k, shape (n, 3, 3).
        """
        self._moves = [np.ascontiguousarray(states[:, axis, 2]) for axis in range(2)]

    def solve(self, right: Floats) -> Floats:
        """The errors e.

        Args:
            right: r, shape (n + 1, 3).

        Returns:
            e, shape (n + 1, 3).
        """
        errors = np.empty_like(right)
        heading = np.cumsum(right[:, 2], out=errors[:, 2])
        for axis, moves in enumerate(self._moves):
            steps = right[:, axis].copy()
            steps[1:] += moves * heading[:-1]
            np.cumsum(steps, out=errors[:, axis])
        return errors

    def solve_transposed(self, right: Floats) -> Floats:
        """Solves the transposed system: a recursion backwards along the trajectory.

        Args:
            right: Shape (n + 1, 3).

        Returns:
            The solution, shape (n + 1, 3).
        """
        solution = np.empty_like(right)
        turning = right[:, 2].copy()
        for axis, moves in enumerate(self._moves):
            later = _summed_backwards(right[:, axis])
            solution[:, axis] = later
            turning[:-1] += moves * later[1:]
        solution[:, 2] = _summed_backwards(turning)
        return solution


class ErrorRecursion:
    """e(k+1) = M_k e(k) + N_k e(k-1) + r(k+1), from e(0) = r(0) and e(-1) = 0.

    Written for all samples at once it is a unit lower triangular system of 3 (n + 1) equations
    with at most eight diagonals below the main one: nothing needs to be factorised, and solving
    it, or its transpose, costs O(n).
    """

    def __init__(self, now: Floats, before: Floats | None = None) -> None:
        """Puts the diagonals together.

        Args:
            now: M_k, shape (n, 3, 3).
            before: N_k, shape (n, 3, 3), of which N_0 is not used; None for zero.
        """
        self._steps = len(now)
        diagonals = 6 if before is None else 9
        # Entry (i, j) of the matrix is at [i - j, j]; the main diagonal is never read.
        self._bands = np.zeros((diagonals, 3 * (self._steps + 1)), order="F")
        for row in range(3):
            for column in range(3):
                below = 3 + row - column
                self._bands[below, column:-3:3] = -now[:, row, column]
        if before is not None:
            for row in range(3):
                for column in range(3):
                    below = 6 + row - column
                    self._bands[below, column:-6:3] -= before[1:, row, column]

    def solve(self, right: Floats) -> Floats:
        """The errors e.

        Args:
            right: r, shape (n + 1, 3), or (n + 1, 3, m) for m of them.

        Returns:
            e, of the same shape; infinite or not-a-number from where it leaves the finite numbers.
        """
        return self._solve(right, b"N")

    def solve_transposed(self, right: Floats) -> Floats:
        """Solves the transposed system: a recursion backwards along the trajectory.

        Args:
            right: Shape (n + 1, 3).

        Returns:
            The solution, shape (n + 1, 3).
        """
        return self._solve(right, b"T")

    def _solve(self, right: Floats, transposed: bytes) -> Floats:
        from scipy.linalg.lapack import dtbtrs  # starts slowly, and not every law has feedback

        many = right.reshape(3 * (self._steps + 1), -1)
        solution, _ = dtbtrs(self._bands, many, uplo=b"L", trans=transposed, diag=b"U")
        errors: Floats = np.asfortranarray(solution.reshape(right.shape))
        return errors


def _summed_backwards(values: Floats) -> Floats:
    """Sums from each value to the last."""
    sums: Floats = np.cumsum(values[::-1])[::-1]
    return sums


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
        experiment: Its reference, and the plant as it really is.

    Raises:
        UsageError: The plant has no linearisation.
    """
    reference, desired = experiment.reference, desired_motion(experiment)
    left, right = desired.inputs.T
    steps = experiment.plant.linearisation(
        reference.heading[:-1], left, right, reference.sample_time
    )
    if steps is None:
        raise UsageError("the linear theory does not know the plant")
    return Linearisation(
        np.asfortranarray(desired.inputs), *steps, np.asfortranarray(desired.mismatch)
    )
