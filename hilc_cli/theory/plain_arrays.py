"""What NumPy does for arrays of any kind, and loads what it has for masked ones first.

That takes a twentieth of a short command.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats


def median(values: Floats) -> float:
    """The median of numbers, of which there is at least one."""
    ordered = np.sort(values, axis=None)
    return float(ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2


def distinct(values: NDArray[Any]) -> NDArray[Any]:
    """The values that an array has, rising, each once."""
    # Only where they are counted as well it does not ask whether some are masked.
    return np.unique(values, return_counts=True)[0]
