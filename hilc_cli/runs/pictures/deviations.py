"""What was learned as deviations in per cent: absolute numbers of many digits tell little."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hilc_cli.drawing import labels
from hilc_cli.results.learning import BELIEVED, TRUE, LearningTable, Quantity
from hilc_cli.results.run import RunData


def as_deviations(run: RunData, quantity: Quantity) -> RunData:
    """A run whose estimates of a quantity, and what they are held against, are deviations in %.

    They are deviations from the value that `base_of` tells, which must be there.
    """
    which = base_of([run], quantity)
    assert which is not None  # told by the caller
    held = run.yardsticks[quantity.column]
    base, table = held[which], LearningTable()
    series = [each for each in (quantity.alone, quantity.model) if each is not None]
    values, errors = ({each.value for each in series}, {each.error for each in series})
    for row in run.learning.rows():
        figures = dict(row)
        for name, figure in figures.items():
            if name in values:
                figures[name] = 100 * (figure - base) / abs(base)
            elif name in errors:
                figures[name] = 100 * figure / abs(base)
        table.append(figures)
    told = {name: 100 * (value - base) / abs(base) for name, value in held.items()}
    return replace(run, learning=table, yardsticks={**run.yardsticks, quantity.column: told})


def base_of(runs: Sequence[RunData], quantity: Quantity) -> str | None:
    """The yardstick from which estimates deviate: what is true, or what was believed at first.

    None if there is neither in one of the runs that tell of the quantity, or if it is zero.
    """
    held = [
        run.yardsticks.get(quantity.column, {})
        for run in runs
        if quantity.best.value in run.learning.names
    ]
    known = (
        which
        for which in (TRUE, BELIEVED)
        if all(np.isfinite(values.get(which, math.nan)) and values[which] for values in held)
    )
    return next(known, None)


def deviation_in_words(which: str, quantity: Quantity, runs: Sequence[RunData]) -> str:
    """Says in words what estimates deviate from."""
    bases = {
        run.yardsticks[quantity.column][which]
        for run in runs
        if quantity.best.value in run.learning.names
    }
    value = f" {labels.number_text(bases.pop(), 4)} {quantity.unit}".rstrip()
    told = {TRUE: "the true value", BELIEVED: "what was believed at first"}
    text = f"deviation from {told[which]}"
    return text if bases else f"{text},{value}"
