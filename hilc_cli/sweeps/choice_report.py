"""What ``hilc sweep`` tells of choices: the best ones by what may happen to them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.sweeps.choices import FIGURES
from hilc_cli.sweeps.data import BEST
from hilc_cli.wording import listed, printable

if TYPE_CHECKING:
    from rich.table import Table

    from hilc_cli.sweeps.choices import ChoiceTable
    from hilc_cli.sweeps.data import SweepData

_BEST = 5
"""Choices that are told."""


def choices_table(data: SweepData, choices: ChoiceTable) -> Table:
    """The best choices, with all figures of their cases."""
    from rich import box
    from rich.table import Table

    title = f"{len(choices):,} choices by their {choices.robust} {choices.metric}"
    ranked = choices.ranked()
    more = len(choices) - len(ranked[:_BEST])
    table = Table(
        title=f"{title}, over {printable(listed(data.over))}",
        caption=f"{more:,} more are in choices.csv" if more else None,
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        title_justify="left",
        title_style="bold",
    )
    for head in ("choice", *map(printable, choices.values), *FIGURES, "diverged", "worst case"):
        table.add_column(head, justify="right")
    for number in ranked[:_BEST]:
        values = [printable(shown(value)) for value in choices.choice(number).values()]
        figures = [_number(float(choices.figures[name][number])) for name in FIGURES]
        diverged = f"{choices.diverged[number]} of {choices.cases[number]}"
        table.add_row(str(number), *values, *figures, diverged, str(choices.worst_case[number]))
    return table


def choices_document(data: SweepData, choices: ChoiceTable, folder: Path) -> dict[str, Any]:
    """Returns the same for a JSON document; a figure that is infinite is null."""
    ranked = choices.ranked()
    best = [
        {
            "choice": number,
            "values": choices.choice(number),
            **{name: _finite(float(choices.figures[name][number])) for name in FIGURES},
            "cases": int(choices.cases[number]),
            "diverged": int(choices.diverged[number]),
            "worst_case": int(choices.worst_case[number]),
        }
        for number in ranked[:_BEST]
    ]
    return {
        "over": list(data.over),
        "robust": choices.robust,
        "choices": len(choices),
        "ranked": len(ranked),
        "best": best,
        "scenario": str(folder / BEST) if ranked else None,
    }


def shown(value: object) -> str:
    """A value of a key as a table shows it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _number(number: float) -> str:
    return f"{number:.6g}" if math.isfinite(number) else "inf"


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None
