"""A linear recursion of the error along the trajectory, solved as one banded system."""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dtbtrs

from hilc_cli.reference.sampled import Floats


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
            right: r, shape (n + 1, 3).

        Returns:
            e, shape (n + 1, 3); infinite or not-a-number from where it leaves the finite numbers.
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
        solution, _ = dtbtrs(
            self._bands, right.reshape(-1, 1), uplo=b"L", trans=transposed, diag=b"U"
        )
        errors: Floats = solution.reshape(-1, 3)
        return errors
