"""``transient.csv``: predicted errors beside simulated ones."""

from __future__ import annotations

import csv
from itertools import zip_longest
from pathlib import Path

from hilc_cli.reference.sampled import Floats

TRANSIENT_FILE = "transient.csv"
TRANSIENT_HEADER = (
    "iteration",
    "predicted_max_position_error_m",
    "simulated_max_position_error_m",
)


def write_transient(path: Path, predicted: Floats, simulated: Floats | None = None) -> None:
    """Writes a row per iteration; what was not predicted, or not simulated, is empty.

    Args:
        path: The file.
        predicted: Largest position errors of iterations 0, 1, ... [m]; ``inf`` where they leave
            the finite numbers.
        simulated: Those of a simulation, if there is one.
    """
    columns = predicted.tolist(), [] if simulated is None else simulated.tolist()
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(TRANSIENT_HEADER)
        for iteration, errors in enumerate(zip_longest(*columns, fillvalue="")):
            writer.writerow((iteration, *errors))
