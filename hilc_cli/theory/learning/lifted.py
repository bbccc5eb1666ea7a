"""One learning update as a linear operator on the input of a whole iteration."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.norms import (
    SingularValue,
    SpectralRadius,
    estimated_radius,
    largest_singular_value,
)
from hilc_cli.theory.learning.recursion import (
    DriftRecursion,
    ErrorRecursion,
    Linearisation,
    linearise,
)
from hilc_cli.theory.linear_law import LearningUpdate, linear_law
from hilc_cli.theory.matrices import GainParts, times


class LinearPass(NamedTuple):
    """One iteration of the linearised experiment.

    Attributes:
        inputs: u_i - u_d [rad/s], shape (n, 2).
        errors: e_i [m, m, rad], shape (n + 1, 3).
    """

    inputs: Floats
    errors: Floats


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
        update: What is learned from the iteration before.
        l2: Gain of e_{i+1}(k); 0 with compensation, and in law pid.
        l3: Gain of e_{i+1}(k-1), likewise.
        start: e_i(0), the initial error of every iteration [m, m, rad], shape (3,).
        first_input: u_0 - u_d [rad/s], shape (n, 2).
        added: What every iteration adds to what is learned [rad/s], likewise; None for nothing.

    Source:
        Qiao et al. 2021, Eqs. 8, 17 and 21, linearised.
    """

    plant: Linearisation
    gains: Floats
    update: LearningUpdate
    l2: float
    l3: float
    start: Floats
    first_input: Floats
    added: Floats | None

    def __init__(self, experiment: Experiment) -> None:
        """Linearises an experiment.

        Args:
            experiment: The experiment.

        Raises:
            UsageError: The linear theory does not speak of its law.
        """
        law, reference = linear_law(experiment), experiment.reference
        self.plant = linearise(experiment)
        self.gains = np.asfortranarray(GainParts.of(law.matrix).at(reference.heading[:-1]))
        self.update = law.update(self.gains)
        self.l2, self.l3 = law.feedback
        self.start = np.array(
            [
                reference.x[0] - experiment.initial_pose[0],
                reference.y[0] - experiment.initial_pose[1],
                reference.heading[0] - experiment.initial_pose[2],
            ]
        )
        initial = np.array([experiment.initial_left, experiment.initial_right]).T
        self.first_input = initial - self.plant.feedforward
        self.added = self.update.constant(self.first_input, self.plant.feedforward)
        self._learn_in_first = experiment.learn_in_first
        self._constant = np.asfortranarray(np.vstack([self.start, self.plant.residual]))
        self._undriven = np.zeros_like(self._constant)
        self._open = DriftRecursion(self.plant.states)
        self._closed: DriftRecursion | ErrorRecursion = self._open
        if self.has_feedback:
            with np.errstate(over="ignore", invalid="ignore"):  # absurd gains: nothing is finite
                loop = self.plant.inputs @ self.gains
                before = -self.l3 * loop if self.l3 else None
                self._closed = ErrorRecursion(self.plant.states - self.l2 * loop, before)

    @property
    def samples(self) -> int:
        """Number of sampling intervals n."""
        return len(self.gains)

    @property
    def has_feedback(self) -> bool:
        """Whether the law acts on errors of the running iteration."""
        return self.l2 != 0 or self.l3 != 0

    def apply(self, inputs: Floats) -> Floats:
        """T times an input.

        Args:
            inputs: Shape (n, 2) [rad/s].

        Returns:
            Shape (n, 2) [rad/s].
        """
        errors = self._open.solve(self._driven(self._undriven, inputs))
        return self._fed_back(self.update.learned(inputs, errors), self._undriven).inputs

    def adjoint(self, inputs: Floats) -> Floats:
        """The transpose of T times an input.

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
            inputs = inputs - times(plant, self._closed.solve_transposed(weighted)[1:])
        learned, errors = self.update.transposed(inputs)
        result: Floats = learned - times(plant, self._open.solve_transposed(errors)[1:])
        return result

    def first(self) -> LinearPass:
        """Iteration 0: the initial input as it is, or with the law's feedback."""
        if self._learn_in_first:
            return self.next(LinearPass(self.first_input, self._undriven))
        errors = self._open.solve(self._driven(self._constant, self.first_input))
        return LinearPass(self.first_input, errors)

    def next(self, previous: LinearPass) -> LinearPass:
        """The iteration after a given one.

        Args:
            previous: The iteration that is learned from.
        """
        learned = self.update.learned(previous.inputs, previous.errors)
        if self.added is not None:
            learned = learned + self.added
        return self._fed_back(learned, self._constant)

    def closed_loop(self, right: Floats) -> Floats:
        """The errors of the plant with the law's feedback, of many right sides at once.

        Args:
            right: What is added to the error of each sample, shape (n + 1, 3, m).

        Returns:
            The errors, shape (n + 1, 3, m).
        """
        return self._closed.solve(right)

    def spectral_radius(self) -> float:
        """The value of `spectral_radius_found`."""
        return self.spectral_radius_found().value

    def spectral_radius_found(self) -> SpectralRadius:
        """The largest absolute eigenvalue of T: below 1 the iteration converges in the end.

        T is block lower triangular with the blocks kept I - c d G_k B_k, c the gain of e(k+1),
        whatever the feedback. With a Q-filter it is not, and the radius is estimated.
        """
        if self.update.smooths:
            return estimated_radius(self.apply, (self.samples, 2))
        gains = self._loop_gains()
        if gains is None:
            return SpectralRadius(math.inf)
        return SpectralRadius(float(np.abs(self.update.kept - gains).max()))

    def contraction(self) -> float:
        """1 less the spectral radius, above 0 where the iteration converges in the end.

        Without a Q-filter it is exact to rounding of its own size, where the spectral radius
        itself cannot be told from 1; minus infinity where the blocks of T leave the finite numbers.
        """
        if self.update.smooths:
            return 1 - self.spectral_radius()
        gains, kept = self._loop_gains(), self.update.kept
        if gains is None:
            return -math.inf
        # 1 - |a - g| = (1 - |a - g|^2) / (1 + |a - g|) = (1 - a^2 + 2 a Re g - |g|^2) / (...)
        both = 1 + np.abs(kept - gains)
        less = gains.real * ((2 * kept - gains.real) / both) - gains.imag * (gains.imag / both)
        return float(((1 - kept) * (1 + kept) / both + less).min())

    def largest_singular_value(self) -> float:
        """The value of `largest_singular_value_found`."""
        return self.largest_singular_value_found().value

    def largest_singular_value_found(self) -> SingularValue:
        """The most by which T may lengthen an input; if below 1 the convergence is monotone.

        Length is the root of the sum of squares over both wheels and all samples. Of the errors
        there is no such number, since they have no common unit.

        Returns:
            The value, and how surely it is known: a lower bound if the search was given up.
        """
        return largest_singular_value(self.apply, self.adjoint, (self.samples, 2))

    def _loop_gains(self) -> NDArray[np.complex128] | None:
        """The eigenvalues of c d G_k B_k, shape (n, 2); None beyond the finite numbers."""
        with np.errstate(over="ignore", invalid="ignore"):
            products = self.update.next_gain * (self.gains @ self.plant.inputs)
        if not np.isfinite(products).all():
            return None
        return np.linalg.eigvals(products).astype(np.complex128)

    def _driven(self, constant: Floats, inputs: Floats) -> Floats:
        """The right side of the error's recursion for a given input."""
        right = constant.copy(order="K")
        right[1:] -= times(self.plant.inputs, inputs)
        return right

    def _fed_back(self, learned: Floats, constant: Floats) -> LinearPass:
        """An iteration whose input is what was learned before it, and the feedback in it."""
        errors = self._closed.solve(self._driven(constant, learned))
        if not self.has_feedback:
            return LinearPass(learned, errors)
        now = errors[:-1]
        before = np.zeros_like(now)
        before[1:] = errors[:-2]
        fed = self.l2 * now + self.l3 * before  # Eq. 17, the terms of the running iteration
        return LinearPass(learned + times(self.gains, fed), errors)
