"""The cells of a heat map: two keys cut the plane into rectangles, each a group of cases."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.path import Path

from hilc_cli.figures.sweep.key_axis import KeyAxis
from hilc_cli.figures.sweep.picking import Groups, Integers, Outcome, Results, grouped
from hilc_cli.reference.sampled import Floats

MOST_CELLS = 300
"""Along an axis; more are narrower than a pixel."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """A grid of cells.

    Attributes:
        x_edges: Shape (columns + 1,).
        y_edges: Shape (rows + 1,).
        groups: The cases of each cell, row by row from the bottom, shape (rows * columns,).
        merged: How many values of the two keys share a cell: (1, 1) unless there are too many.
    """

    x_edges: Floats
    y_edges: Floats
    groups: Groups
    merged: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.y_edges) - 1, len(self.x_edges) - 1

    @property
    def medians(self) -> Floats:
        """Of the metric, shape (rows, columns)."""
        return self.groups.medians.reshape(self.shape)

    @property
    def outcomes(self) -> Integers:
        """Of Outcome, shape (rows, columns); -1 where there is no case at all."""
        return self.groups.outcomes.reshape(self.shape)

    def outline(self, outcome: Outcome) -> Path:
        """The cells of one outcome as one path, neighbours in a row together."""
        rectangles = []
        for row, cells in enumerate(self.outcomes == outcome):
            steps = np.flatnonzero(np.diff(np.concatenate([[0], cells.astype(np.int8), [0]])))
            bottom, top = self.y_edges[row], self.y_edges[row + 1]
            for first, last in zip(steps[::2], steps[1::2], strict=True):
                left, right = self.x_edges[first], self.x_edges[last]
                corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
                rectangles.append(Path([*corners, corners[0]], closed=True))
        return Path.make_compound_path(*rectangles)


def cells_of(x: KeyAxis, y: KeyAxis, results: Results) -> Cells:
    """Cuts the plane of two keys halfway between their values.

    Args:
        x: The key along x.
        y: The key along y.
        results: Of all cases.
    """
    column, x_edges, x_merged = _cut(x)
    row, y_edges, y_merged = _cut(y)
    columns, rows = len(x_edges) - 1, len(y_edges) - 1
    groups = grouped(results, row * columns + column, rows * columns)
    outcomes = groups.outcomes.copy()
    outcomes[np.bincount(row * columns + column, minlength=rows * columns) == 0] = -1
    groups = Groups(groups.counts, groups.quantiles, outcomes)
    return Cells(x_edges, y_edges, groups, (x_merged, y_merged))


def _cut(axis: KeyAxis) -> tuple[Integers, Floats, int]:
    """The cell of each case along an axis, the edges, and how many values share a cell."""
    values, place = np.unique(axis.positions, return_inverse=True)
    edges = axis.edges(values)
    merged = -(-len(values) // MOST_CELLS)
    return place // merged, np.append(edges[:-1:merged], edges[-1]), merged
