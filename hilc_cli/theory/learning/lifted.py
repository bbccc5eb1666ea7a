"""One learning update as a linear operator on the input of a whole iteration."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.norms import (
    SingularValue,
    SpectralRadius,
    estimated_radius,
    largest_singular_value,
)
from hilc_cli.theory.linear_law import linear_law
from hilc_cli.theory.matrices import linearise, times


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
        self._turns = states[:, 0, 2] + 1j * states[:, 1, 2]

    def solve(self, right: Floats) -> Floats:
        """Returns the errors e.

        Args:
            right: r, shape (n + 1, 3), or (n + 1, 3, m) for m of them.

        Returns:
            e, of the same shape.
        """
        errors = np.empty_like(right)
        heading = np.add.accumulate(right[:, 2], axis=0, out=errors[:, 2])
        # As complex numbers x and y are summed up at the same time.
        position = np.empty(heading.shape, np.complex128)
        position.real, position.imag = right[:, 0], right[:, 1]
        position[1:] += (self._turns * heading[:-1].T).T
        np.add.accumulate(position, axis=0, out=position)
        errors[:, 0], errors[:, 1] = position.real, position.imag
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
        """Returns the errors e of r, both as in `DriftRecursion`.

        They are infinite or not-a-number from where they leave the finite numbers.
        """
        return self._solve(right, b"N")

    def solve_transposed(self, right: Floats) -> Floats:
        """Solves the transposed system: a recursion backwards along the trajectory."""
        return self._solve(right, b"T")

    def _solve(self, right: Floats, transposed: bytes) -> Floats:
        from scipy.linalg.lapack import dtbtrs  # starts slowly, and not every law has feedback

        many = right.reshape(3 * (self._steps + 1), -1)
        solution, _ = dtbtrs(self._bands, many, uplo=b"L", trans=transposed, diag=b"U")
        errors: Floats = np.asfortranarray(solution.reshape(right.shape))
        return errors


def _summed_backwards(values: Floats) -> Floats:
    """Returns the sums from each value to the last."""
    sums: Floats = np.cumsum(values[::-1])[::-1]
    return sums


class LinearPass(NamedTuple):
    """One iteration of the linearised experiment.

    Attributes:
        inputs: u_i - u_d [rad/s], shape (n, 2).
        errors: e_i [m, m, rad], shape (n + 1, 3).
    """

    inputs: Floats
    errors: Floats

    @property
    def x(self) -> Floats:
        """Errors in x [m], shape (n + 1,)."""
        return self.errors[:, 0]

    @property
    def y(self) -> Floats:
        """Errors in y [m], likewise."""
        return self.errors[:, 1]

    @property
    def heading(self) -> Floats:
        """Errors of the heading [rad], likewise."""
        return self.errors[:, 2]

    @property
    def sums(self) -> Floats:
        """Left plus right wheel of the inputs [rad/s], shape (n,)."""
        sums: Floats = self.inputs[:, 0] + self.inputs[:, 1]
        return sums


class LiftedIteration:
    """The map u_{i+1} - u_d = T (u_i - u_d) + f of an experiment, linearised along its reference.

    The plant is linear in e and u - u_d, and the gain matrix is taken at the reference's heading,
    whichever heading the law takes: the difference multiplies an error and is of second order. The
    speed limit and the disturbances are left out. f holds what does not change with the iteration:
    the initial error, and what the feedforward leaves of each step.

    T is square, of 2 n rows, and block lower triangular unless the law has a Q-filter, since an
    error depends on what was before it, and a law with feedback in the iteration looks back only.
    It is never formed: to apply it costs O(n), with a filter O(n log n).

    Attributes:
        plant: The linearised plant.
        gains: G_k, the gain matrix along the reference, shape (n, 2, 3).
        law: What learns from the iteration before.
        l2: Gain of e_{i+1}(k); 0 with compensation, and in law pid.
        l3: Gain of e_{i+1}(k-1), likewise.
        start: e_i(0), the initial error of every iteration [m, m, rad], shape (3,).
        first_input: u_0 - u_d [rad/s], shape (n, 2).
        open_loop: The recursion of the errors of a platform that nobody steers.
        closed_loop: The same with the law's feedback.
        added: What every iteration adds to what is learned [rad/s], likewise; None for nothing.

    Source:
        Qiao et al. 2021, Eqs. 8, 17 and 21, linearised.
    """

    def __init__(self, experiment: Experiment) -> None:
        """Linearises an experiment.

        Raises:
            UsageError: The linear theory does not speak of its law.
        """
        law, reference = linear_law(experiment), experiment.reference
        self.plant = linearise(experiment)
        self.law, self.gains = law, law.gains
        self.l2, self.l3 = law.feedback
        self.start = reference.poses[0] - experiment.initial_pose
        initial = np.array([experiment.initial_left, experiment.initial_right]).T
        self.first_input = initial - self.plant.feedforward
        self.added = self.law.constant(self.first_input, self.plant.feedforward)
        self._learn_in_first = experiment.learn_in_first
        self._constant = np.asfortranarray(np.vstack([self.start, self.plant.residual]))
        self._undriven = np.zeros_like(self._constant)
        self.open_loop = DriftRecursion(self.plant.states)
        self.closed_loop: DriftRecursion | ErrorRecursion = self.open_loop
        if self.has_feedback:
            with np.errstate(over="ignore", invalid="ignore"):  # absurd gains: nothing is finite
                loop = self.plant.inputs @ self.gains
                before = -self.l3 * loop if self.l3 else None
                self.closed_loop = ErrorRecursion(self.plant.states - self.l2 * loop, before)

    @property
    def samples(self) -> int:
        """Number of sampling intervals n."""
        return len(self.gains)

    @property
    def has_feedback(self) -> bool:
        """Whether the law acts on errors of the running iteration."""
        return self.l2 != 0 or self.l3 != 0

    def apply(self, inputs: Floats) -> Floats:
        """Returns T times an input.

        Args:
            inputs: Shape (n, 2) [rad/s].

        Returns:
            Shape (n, 2) [rad/s].
        """
        errors = self.open_loop.solve(self._driven(self._undriven, inputs))
        return self._fed_back(self.law.learned(inputs, errors), self._undriven).inputs

    def adjoint(self, inputs: Floats) -> Floats:
        """Returns the transpose of T times an input.

        Args:
            inputs: Shape (n, 2) [rad/s].

        Returns:
            Shape (n, 2) [rad/s].
        """
        plant = self.plant.inputs.transpose(0, 2, 1)
        if self.has_feedback:
            errors = times(self.gains.transpose(0, 2, 1), inputs)
            weighted = np.zeros_like(self._constant)
            weighted[:-1] = self.l2 * errors
            weighted[:-2] += self.l3 * errors[1:]
            inputs = inputs - times(plant, self.closed_loop.solve_transposed(weighted)[1:])
        learned, errors = self.law.transposed(inputs)
        result: Floats = learned - times(plant, self.open_loop.solve_transposed(errors)[1:])
        return result

    def first(self) -> LinearPass:
        """Returns iteration 0: the initial input as it is, or with the law's feedback."""
        if self._learn_in_first:
            return self.next(LinearPass(self.first_input, self._undriven))
        errors = self.open_loop.solve(self._driven(self._constant, self.first_input))
        return LinearPass(self.first_input, errors)

    def next(self, previous: LinearPass) -> LinearPass:
        """Returns the iteration after a given one, from which it learns."""
        learned = self.law.learned(previous.inputs, previous.errors)
        if self.added is not None:
            learned = learned + self.added
        return self._fed_back(learned, self._constant)

    def spectral_radius(self) -> SpectralRadius:
        """Returns the largest absolute eigenvalue of T: below 1 the iteration converges in the end.

        T is block lower triangular with the blocks kept I - c d G_k B_k, c the gain of e(k+1),
        whatever the feedback. With a Q-filter it is not, and the radius is estimated.
        """
        if self.law.smooths:
            return estimated_radius(self.apply, (self.samples, 2))
        with np.errstate(over="ignore", invalid="ignore"):
            products = self.law.next_gain * (self.gains @ self.plant.inputs)
        if not np.isfinite(products).all():
            return SpectralRadius(math.inf)
        return SpectralRadius(float(np.abs(self.law.kept - np.linalg.eigvals(products)).max()))

    def largest_singular_value(self) -> SingularValue:
        """The most by which T may lengthen an input; if below 1 the convergence is monotone.

        Length is the root of the sum of squares over both wheels and all samples. Of the errors
        there is no such number, since they have no common unit.

        Returns:
            The value, and how surely it is known: a lower bound if the search was given up.
        """
        return largest_singular_value(self.apply, self.adjoint, (self.samples, 2))

    def _driven(self, constant: Floats, inputs: Floats) -> Floats:
        """Returns the right side of the error's recursion for a given input."""
        right = constant.copy(order="K")
        right[1:] -= times(self.plant.inputs, inputs)
        return right

    def _fed_back(self, learned: Floats, constant: Floats) -> LinearPass:
        """An iteration whose input is what was learned before it, and the feedback in it."""
        errors = self.closed_loop.solve(self._driven(constant, learned))
        if not self.has_feedback:
            return LinearPass(learned, errors)
        now = errors[:-1]
        before = np.zeros_like(now)
        before[1:] = errors[:-2]
        fed = self.l2 * now + self.l3 * before  # Eq. 17, the terms of the running iteration
        return LinearPass(learned + times(self.gains, fed), errors)
