"""Iterations in which the wheels' sum learns from the position, their difference from the heading.

So it is where a gain matrix of the form of Eq. 45 acts on the errors of the iteration before. Such
iterations are those of `LiftedIteration` in half the time, which counts where there are thousands.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.lifted import LiftedIteration, LinearPass


class KinematicPass(NamedTuple):
    """One iteration of the linearised experiment.

    Attributes:
        sums: Left plus right wheel of u_i - u_d [rad/s], shape (n,).
        differences: Left less right wheel, likewise.
        position: x and, as imaginary part, y of e_i [m], shape (n + 1,).
        heading: The heading of e_i [rad], shape (n + 1,).
    """

    sums: Floats
    differences: Floats
    position: NDArray[np.complex128]
    heading: Floats

    @property
    def inputs(self) -> Floats:
        """As in `LinearPass`."""
        sums, differences = self.sums, self.differences
        return np.array([sums + differences, sums - differences]).T / 2

    @property
    def x(self) -> Floats:
        """As in `LinearPass`."""
        return self.position.real

    @property
    def y(self) -> Floats:
        """As in `LinearPass`."""
        return self.position.imag


Pass = LinearPass | KinematicPass


def passes(lifted: LiftedIteration) -> Iterator[Pass]:
    """Yields the iterations of an experiment from the first on, without an end."""
    return _kinematic(lifted) if _is_kinematic(lifted) else _as_they_are(lifted)


def _as_they_are(lifted: LiftedIteration) -> Iterator[LinearPass]:
    current = lifted.first()
    while True:
        yield current
        current = lifted.next(current)


def _is_kinematic(lifted: LiftedIteration) -> bool:
    left, right = lifted.gains[:, 0], lifted.gains[:, 1]
    mixes = (left[:, 2] != -right[:, 2]).any() or (left[:, :2] != right[:, :2]).any()
    return lifted.law.learns_ahead and not lifted.has_feedback and not mixes


def _kinematic(lifted: LiftedIteration) -> Iterator[KinematicPass]:
    plant, n = lifted.plant, lifted.samples
    (left, right), (x, y, heading) = (array.T for array in lifted.first())
    sums, differences = left + right, left - right
    position, heading = x + 1j * y, heading.copy()
    gains = 2 * lifted.law.next_gain * lifted.gains[:, 0]
    of_position, of_heading = gains[:, :2].copy(), gains[:, 2].copy()
    left, right = _learned_alike(lifted).T
    added_sums, added_differences = left + right, left - right
    adds = left.any() or right.any()
    move_x, move_y, move_heading = np.ascontiguousarray(-plant.inputs[:, :, 0].T)
    turn_x, turn_y = np.ascontiguousarray(plant.states[:, :2, 2].T)
    undriven = np.cumsum(np.vstack([lifted.start, plant.residual]), axis=0)
    undriven_position = undriven[:, 0] + 1j * undriven[:, 1]
    undriven_heading = undriven[:, 2].copy()
    # What is summed up to errors, each from zero on, and room for what it is made of.
    steps, turns = np.zeros(n + 1, np.complex128), np.zeros(n + 1)
    pairs, part, other = np.empty((n, 2)), np.empty(n), np.empty(n)
    while True:
        yield KinematicPass(sums, differences, position, heading)
        np.multiply(of_position, position.view(np.float64).reshape(-1, 2)[1:], out=pairs)
        np.add(pairs[:, 0], pairs[:, 1], out=part)
        sums = sums + part
        np.multiply(of_heading, heading[1:], out=part)
        differences = differences + part
        if adds:
            sums += added_sums
            differences += added_differences
        np.multiply(move_heading, differences, out=turns[1:])
        heading = np.add.accumulate(turns)
        heading += undriven_heading
        before = heading[:-1]
        np.multiply(move_x, sums, out=part)
        np.multiply(turn_x, before, out=other)
        np.add(part, other, out=steps.real[1:])
        np.multiply(move_y, sums, out=part)
        np.multiply(turn_y, before, out=other)
        np.add(part, other, out=steps.imag[1:])
        position = np.add.accumulate(steps)
        position += undriven_position


def _learned_alike(lifted: LiftedIteration) -> Floats:
    """Returns what each iteration learns alike: of the initial error, or from nothing."""
    errors = np.zeros((lifted.samples + 1, 3))
    errors[0] = lifted.start
    learned = lifted.law.learned(np.zeros((lifted.samples, 2)), errors)
    return learned if lifted.added is None else learned + lifted.added
