"""What ``hilc sweep --minimise`` tells of the best case."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.results.search import BEST
from hilc_cli.variation.axes import Range

if TYPE_CHECKING:
    from rich.table import Table

    from hilc_cli.api import SweepData, SweepSummary
    from hilc_cli.results.search import AsItIs
    from hilc_cli.results.sweep_summary import BestCase

_NOTHING = "-"
_NEAR = 0.01  # of the range


def search_table(summary: SweepSummary, as_it_is: AsItIs) -> Table:
    """The best case beside the scenario as it is, key by key."""
    from rich import box
    from rich.table import Table

    best = _best(summary)
    table = Table(
        title=f"Smallest {summary.metric}",
        box=box.SIMPLE_HEAD,
        title_justify="left",
        title_style="bold",
    )
    table.add_column("")
    table.add_column("as it is", justify="right")
    table.add_column("best" if best is None else f"best, case {best.case}", justify="right")
    of_best = math.nan if best is None else best.metric
    table.add_row(summary.metric, _number(as_it_is.metric), _number(of_best))
    for key, value in as_it_is.values.items():
        table.add_row(key, shown(value), _NOTHING if best is None else shown(best.values[key]))
    return table


def search_document(summary: SweepSummary, as_it_is: AsItIs, folder: Path) -> dict[str, Any]:
    """The same for a JSON document."""
    best = _best(summary)
    return {
        "minimise": summary.metric,
        "as_it_is": as_it_is.to_data(),
        "best": None if best is None else asdict(best),
        "scenario": None if best is None else str(folder / BEST),
    }


def search_notes(data: SweepData) -> list[str]:
    """What the user of a search might overlook."""
    if data.as_it_is is None:
        return []
    best = next(iter(data.ranked()), None)
    if best is None:
        return [f"no case has a value of {data.metric}, so there is no {BEST}"]
    if data.columns[data.metric][best] >= data.as_it_is.metric:
        return ["no case is better than the scenario as it is"]
    values = data.case(best)
    return [
        f"{key} of the best case is at the end of its range: a wider one may hold a better value"
        for key, axis in data.axes.items()
        if isinstance(axis, Range) and _is_at_end(axis, values[key])
    ]


def _is_at_end(axis: Range, value: object) -> bool:
    """Whether a value is hardly farther from an end of the range than a search can tell."""
    assert isinstance(value, int | float)  # of a range
    low, number, high = axis.low, float(value), axis.high
    if axis.spacing == "log":
        low, number, high = math.log(low), math.log(number), math.log(high)
    return min(number - low, high - number) < _NEAR * (high - low)


def shown(value: object) -> str:
    """A value of a key as a table shows it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _best(summary: SweepSummary) -> BestCase | None:
    return summary.best[0] if summary.best else None


def _number(number: float) -> str:
    return f"{number:.6g}" if math.isfinite(number) else _NOTHING
