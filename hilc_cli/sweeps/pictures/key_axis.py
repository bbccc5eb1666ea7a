"""The axis of a varied key: where its values lie, and how it is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels
from hilc_cli.reference.sampled import Floats
from hilc_cli.scenario.units import unit_of
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.picking import Integers, distinct
from hilc_cli.variation import Choices, Value

LONGEST_NAME = 32


def short_names(keys: Sequence[str]) -> dict[str, str]:
    """Returns the last part of each key, or as many parts as tell it from the others.

    A place in a list goes with the name of the list: ``bound.0``.
    """
    names: dict[str, str] = {}
    for key in keys:
        parts = key.split(".")
        least = 2 if parts[-1].isdigit() else 1
        endings = (".".join(parts[-count:]) for count in range(least, len(parts) + 1))
        others = [f".{other}" for other in keys if other != key]
        name = next(
            (e for e in endings if not any(other.endswith(f".{e}") for other in others)), key
        )
        names[key] = labels.shortened(name, LONGEST_NAME)
    return names


def key_labels(keys: Sequence[str]) -> dict[str, str]:
    """Returns what axes call the keys of a sweep: their short names with their units."""
    names = short_names(keys)
    return {key: labels.with_unit(name, unit_of(key)) for key, name in names.items()}


def key_labels_in_lines(keys: Sequence[str], longest: int) -> dict[str, str]:
    """Returns the same in at most two lines of so many characters, for keys side by side."""
    names = short_names(keys)
    return {key: _in_lines(name, unit_of(key), longest) for key, name in names.items()}


def _in_lines(name: str, unit: str, longest: int) -> str:
    """A name with its unit in at most two lines, broken at a dot or before the unit if it can."""
    label = labels.with_unit(name, unit)
    if len(label) <= longest:
        return label
    breaks = [place + 1 for place, letter in enumerate(name) if letter == "."]
    breaks += [len(name) + 1] if unit else []
    fitting = [
        b for b in breaks if len(label[:b].rstrip()) <= longest and len(label) - b <= longest
    ]
    if not fitting:
        label = labels.with_unit(labels.shortened(name, 2 * longest - 12), unit)
        return f"{label[:longest]}\n{label[longest:]}"
    place = min(fitting, key=lambda b: abs(2 * b - len(label)))
    return f"{label[:place].rstrip()}\n{label[place:]}"


LONGEST_WORD = 24


def value_text(value: Value, digits: int = 4, longest: int = LONGEST_WORD) -> str:
    """A value as the scenario would have it, numbers rounded and long words shortened."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, str):
        return labels.shortened(value, longest)
    if isinstance(value, int) and abs(value) < 10**7:
        return labels.number_text(value)
    return labels.number_text(float(value), digits)


def shortened_words(words: Sequence[str], longest: int) -> list[str]:
    """Words of at most so many letters; what they have in common goes first."""
    if max(map(len, words)) <= longest:
        return list(words)
    if len(words) > 1:
        first = _alike(words)
        while first and words[0][first - 1].isdigit():
            first -= 1  # numbers stay whole
        last = _alike([word[:first:-1] for word in words])
        words = [
            ("…" if first > 1 else word[:first])
            + word[first : len(word) - last]
            + ("…" if last > 1 else word[len(word) - last :])
            for word in words
        ]
    return [labels.shortened(word, longest) for word in words]


def _alike(words: Sequence[str]) -> int:
    """How many letters all words have in common from the first on."""
    alike = takewhile(lambda letters: len(set(letters)) == 1, zip(*words, strict=False))
    return len(list(alike))


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
        """Ends of the axis: a little before the first value and a little after the last."""
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
            labels.set_logarithmic(axis, *limits, most=most)
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
        positions = np.asarray(values, dtype=np.float64)
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
