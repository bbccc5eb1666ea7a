"""``cases.parquet``: the table of the cases in a form that data tools read fast."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.errors import MissingPackageError
from hilc_cli.results.sweep import WHOLE_COLUMNS, SweepData
from hilc_cli.results.sweep_tables import CASE, value_text

_BLOCK = 100_000


def write_parquet(path: Path, data: SweepData, go_on: Callable[[], None]) -> None:
    """Writes the columns of ``cases.csv``, block by block; empty cells are null.

    Args:
        path: The file.
        data: The results.
        go_on: Called between blocks; may raise to stop.

    Raises:
        MissingPackageError: The package for that is not installed.
    """
    pyarrow, parquet = require_parquet()
    writer = None
    try:
        for first in range(0, len(data), _BLOCK):
            go_on()
            block = slice(first, min(first + _BLOCK, len(data)))
            columns = {CASE: pyarrow.array(np.arange(block.start, block.stop))}
            for key, values in data.values.items():
                part = values[block]
                # Numbers beside words, or beside nothing, are words: a column has one type.
                words = None if isinstance(part, np.ndarray) else [value_text(v) for v in part]
                columns[key] = pyarrow.array(part if words is None else words)
            for name, column in data.columns.items():
                numbers = pyarrow.array(column[block], from_pandas=True)  # nan becomes null
                columns[name] = numbers.cast(pyarrow.int64()) if name in WHOLE_COLUMNS else numbers
            table = pyarrow.table(columns)
            writer = writer or parquet.ParquetWriter(path, table.schema)
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()


def require_parquet() -> tuple[Any, Any]:
    """The package that writes Parquet.

    Raises:
        MissingPackageError: It is not installed.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingPackageError("--format parquet", "pyarrow", "parquet") from None
    return pyarrow, parquet
