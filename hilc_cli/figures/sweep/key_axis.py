"""The axis of a varied key: where its values lie, and how it is drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hilc_cli.figures import labels, logarithmic
from hilc_cli.figures.sweep.picking import Integers, distinct
from hilc_cli.figures.sweep.words import shortened_words, value_text
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.sweep import SweepData
from hilc_cli.variation.axes import Choices, Value

_MARGIN = 0.03  # beside the outermost values, of the axis
_UNEVEN = 3  # largest by smallest gap from which on listed numbers get cells of one size
_FEW = 6  # values that get a tick each, if there is room
_LEAST_GAP = 0.4  # between words [inch]
_BESIDE = 9  # letters that have room to the left of a panel
_LETTERS_KEPT = 1000  # of a word
_CHARACTER = 0.06  # [inch], of a tick's label


@dataclass(frozen=True, slots=True, eq=False)
class KeyAxis:
    """Where the cases of a sweep lie on the axis of one key.

    Attributes:
        key: The key.
        positions: Of all cases, shape (cases,): the values themselves, or for words their places
            0, 1, ... in the order in which they were given.
        is_logarithmic: Whether equal ratios are equally far apart; positions then are positive.
        words: What stands at the places; empty for numbers.
    """

    key: str
    positions: Floats
    is_logarithmic: bool = False
    words: tuple[str, ...] = ()

    @property
    def flat(self) -> Floats:
        """Positions on paper: their logarithms where the axis is logarithmic."""
        return self.flattened(self.positions)

    def flattened(self, positions: Floats) -> Floats:
        """What lies on a straight ruler in place of positions."""
        return np.log10(positions) if self.is_logarithmic else positions

    def bent(self, flat: Floats) -> Floats:
        """Positions from places on the ruler."""
        return np.power(10.0, flat) if self.is_logarithmic else flat

    def edges(self, values: Floats) -> Floats:
        """Edges of cells around rising values, halfway between them; one more than values."""
        flat = self.flattened(values)
        if len(flat) == 1:
            half = 0.5 if self.words or self.is_logarithmic else 0.5 * abs(float(flat[0])) or 0.5
            return self.bent(np.array([flat[0] - half, flat[0] + half]))
        middles = (flat[:-1] + flat[1:]) / 2
        return self.bent(
            np.concatenate([[2 * flat[0] - middles[0]], middles, [2 * flat[-1] - middles[-1]]])
        )

    def limits(self) -> tuple[float, float]:
        """From a little before the first to a little after the last value."""
        if self.words:
            return -0.5, len(self.words) - 0.5
        values = np.array([self.positions.min(), self.positions.max()])
        if values[0] == values[1]:
            low, high = self.edges(values[:1])
            return float(low), float(high)
        ends = self.flattened(values)
        margin = _MARGIN * float(ends[1] - ends[0])
        low, high = self.bent(np.array([ends[0] - margin, ends[1] + margin]))
        return float(low), float(high)

    def show(self, axes: Axes, which: str, limits: tuple[float, float], length: float) -> None:
        """Sets up one axis of a panel.

        Args:
            axes: The panel.
            which: ``x`` or ``y``.
            limits: The ends.
            length: Of the axis [inch].
        """
        axis = axes.xaxis if which == "x" else axes.yaxis
        most = max(3, int(length / (0.6 if which == "x" else 0.4)))
        if self.is_logarithmic:
            logarithmic.set_scale(axis, *limits, most=most)
        else:
            (axes.set_xlim if which == "x" else axes.set_ylim)(limits)
            axis.set_major_locator(MaxNLocator(nbins=min(8, most), steps=[1, 2, 5, 10]))
            axis.set_major_formatter(labels.PlainFormatter())
        values, texts = self._own_ticks()
        if not texts:
            return
        ends = self.flattened(np.array(limits))
        gaps = np.diff(self.flattened(values)) / (ends[1] - ends[0]) * length
        gap = float(gaps.min(initial=length))
        if self.words:
            each = max(1, int(np.ceil(_LEAST_GAP / gap)))
            longest = max(4, int((each * gap - 0.1) / _CHARACTER)) if which == "x" else _BESIDE
            values, texts = values[::each], shortened_words(texts[::each], longest)
        elif gap < (_LEAST_GAP / 2 if which == "y" else _CHARACTER * max(map(len, texts)) + 0.1):
            return
        axis.set_ticks(values, labels=texts)
        axis.set_ticks([], minor=True)

    def _own_ticks(self) -> tuple[Floats, list[str]]:
        if self.words:
            return np.arange(len(self.words), dtype=np.float64), list(self.words)
        values = distinct(self.positions, _FEW)
        if values is None:
            return np.empty(0), []
        return values, [value_text(float(value)) for value in values]


def key_axis(data: SweepData, key: str, *, cells: bool = False) -> KeyAxis:
    """The axis of one key of a sweep.

    Args:
        data: The sweep.
        key: The key.
        cells: Each value has a cell of its own: numbers that were listed far from evenly are
            then set side by side like words, the smallest first.
    """
    axis, values = data.axes[key], data.values[key]
    if cells and isinstance(axis, Choices) and _is_uneven(axis):
        axis = Choices(tuple(sorted(axis.values)))  # type: ignore[type-var]  # numbers
    elif axis.is_numeric:
        positions = np.fromiter(values, dtype=np.float64, count=len(values))
        return KeyAxis(key, positions, axis.is_logarithmic)
    assert isinstance(axis, Choices)  # ranges are numeric
    places: dict[tuple[bool, Value], int] = {}
    for value in axis.values:
        places.setdefault(_told_apart(value), len(places))
    numbers: Integers = np.fromiter(
        (places[_told_apart(value)] for value in values), dtype=np.int64, count=len(values)
    )
    return KeyAxis(
        key,
        numbers.astype(np.float64),
        False,
        tuple(value_text(v, longest=_LETTERS_KEPT) for _, v in places),
    )


def _is_uneven(axis: Choices) -> bool:
    """Whether numbers are so far from evenly spread that some cells would be much larger."""
    if not axis.is_numeric or axis.count < 3:
        return False
    numbers = np.sort(np.array(axis.values, dtype=np.float64))
    gaps = np.diff(np.log(numbers) if axis.is_logarithmic else numbers)
    return bool(gaps.max() > _UNEVEN * gaps.min())


def _told_apart(value: Value) -> tuple[bool, Value]:
    """A dictionary takes true and 1 for the same."""
    return isinstance(value, bool), value
