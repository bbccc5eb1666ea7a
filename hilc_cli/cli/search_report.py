"""What ``hilc sweep --minimise`` tells of the best case."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.errors import printable
from hilc_cli.results.search import BEST

if TYPE_CHECKING:
    from rich.table import Table

    from hilc_cli.api import SweepSummary
    from hilc_cli.results.search import AsItIs
    from hilc_cli.results.sweep_summary import BestCase

_NOTHING = "-"


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
        found = _NOTHING if best is None else shown(best.values[key])
        table.add_row(*map(printable, (key, shown(value), found)))
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


def shown(value: object) -> str:
    """A value of a key as a table shows it."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _best(summary: SweepSummary) -> BestCase | None:
    return summary.best[0] if summary.best else None


def _number(number: float) -> str:
    return f"{number:.6g}" if math.isfinite(number) else _NOTHING
