"""Choices and happenings: cases in which some keys are chosen, and others happen to any choice.

Gains are chosen; errors of parameters and seeds of disturbances happen. Choices can be compared
only if all of them meet the same happenings.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from hilc_cli.variation import HAPPENINGS, Axis, Cases, ListedCases, Sampling, Value


@dataclass(frozen=True)
class CrossedCases:
    """Each choice with each happening: choice by choice, the happenings changing fastest.

    Attributes:
        axes: What each key takes, chosen or not, in the order in which they were given.
        choices: Combinations of the keys that are chosen.
        happenings: Combinations of the others, the same for all choices.
    """

    axes: Mapping[str, Axis]
    choices: Cases
    happenings: Cases

    sampling = "crossed"

    def __len__(self) -> int:
        return self.count

    @property
    def count(self) -> int:
        """Number of cases, which may be more than `len` can tell."""
        if self.happenings.sampling == "grid":  # which may be too many to be made
            return self.choices.count * self.happenings.count
        return self.choices.count * len(self._happenings)

    def values(self, first: int, last: int) -> list[dict[str, Value]]:
        """What each key is in cases ``first`` to ``last - 1``."""
        every = len(self._happenings)
        begin = first // every
        chosen = self.choices.values(begin, -(-last // every))
        rows = []
        for case in range(first, last):
            choice, happening = divmod(case, every)
            row = {**chosen[choice - begin], **self._happenings[happening]}
            rows.append({key: row[key] for key in self.axes})
        return rows

    def column(self, key: str) -> list[Value]:
        """What one key is in all cases."""
        if key in self.choices.axes:
            every = len(self._happenings)
            return [value for value in self.choices.column(key) for _ in range(every)]
        return [happening[key] for happening in self._happenings] * len(self.choices)

    def happened(self) -> list[tuple[Value, ...]]:
        """What each key that happens is in each happening."""
        return [tuple(happening.values()) for happening in self._happenings]

    def searched(self, choices: Sequence[tuple[Value, ...]]) -> ListedCases:
        """The cases of choices that a search has tried instead.

        Args:
            choices: What each chosen key is in each of them.
        """
        rows = []
        for values in choices:
            chosen = dict(zip(self.choices.axes, values, strict=True))
            for happening in self._happenings:
                row = {**chosen, **happening}
                rows.append(tuple(row[key] for key in self.axes))
        return ListedCases(self.axes, rows)

    @cached_property
    def _happenings(self) -> list[dict[str, Value]]:
        """All happenings, which are needed again for each choice; drawn twice counts once."""
        drawn = self.happenings.values(0, len(self.happenings))
        return list({tuple(happening.items()): happening for happening in drawn}.values())


def cases_of(
    axes: Mapping[str, Axis],
    sample: Sampling,
    drawn: int,
    seed: int,
    over: Collection[str] = (),
    happenings: int | None = None,
) -> Cases | CrossedCases:
    """All cases of a sweep.

    Args:
        axes: What each key takes, in the order in which they were given.
        sample: How the choices are made of their keys; all cases where nothing happens.
        drawn: How many of them are drawn; not used by a grid.
        seed: Of the drawing.
        over: The keys that happen.
        happenings: How many happenings are drawn; None for every combination of their values.

    Returns:
        A grid stays one, with its cases in the same order, whichever of its keys happen.
    """
    if not over or (sample == "grid" and happenings is None):
        return Cases(axes, sample, drawn, seed)
    chosen = {key: axis for key, axis in axes.items() if key not in over}
    happen = {key: axis for key, axis in axes.items() if key in over}
    drawing: Sampling = "grid"
    if happenings is not None:
        drawing = "random" if sample == "random" else "sobol"
    return CrossedCases(
        axes,
        Cases(chosen, sample, drawn, seed),
        Cases(happen, drawing, happenings or 0, seed, HAPPENINGS),
    )
