"""The tables of a sweep for data frames: cases, and choices and bands if there are any."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hilc_cli.results.frames import Columns, Tables, whole_where_known
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.case_table import CASE
from hilc_cli.sweeps.choices import FIGURES, ChoiceTable, choices_of
from hilc_cli.sweeps.data import Bands, SweepData
from hilc_cli.sweeps.side_tables import BANDS_HEADER, CHOICE


def sweep_tables(data: SweepData) -> Tables:
    """The tables of a sweep that there are, by the names of their CSV files."""
    tables: dict[str, Callable[[], Columns]] = {"cases": lambda: _cases(data)}
    if data.over:
        tables["choices"] = lambda: _choices(choices_of(data))
    spread = data.bands
    if spread is not None:
        tables["bands"] = lambda: _bands(spread)
    return tables


def _cases(data: SweepData) -> Columns:
    metrics = {
        name: whole_where_known(column) if CASE_COLUMNS[name].whole else column
        for name, column in data.columns.items()
    }
    return {CASE: np.arange(len(data)), **data.values, **metrics}


def _bands(spread: Bands) -> Columns:
    iterations = np.arange(len(spread.cases))
    columns = [iterations, whole_where_known(spread.cases), *spread.quantiles.T]
    return dict(zip(BANDS_HEADER, columns, strict=True))


def _choices(table: ChoiceTable) -> Columns:
    figures = {f"{figure}_{table.metric}": table.figures[figure] for figure in FIGURES}
    known = {
        "worst_case": np.where(table.worst_case < 0, np.nan, table.worst_case),
        "rank": np.where(table.rank > 0, table.rank, np.nan),
    }
    return {
        CHOICE: np.arange(len(table)),
        **table.values,
        **figures,
        **{"cases": table.cases, "diverged": table.diverged, "failed": table.failed},
        **{name: whole_where_known(column) for name, column in known.items()},
    }
