"""What a search found: the best of its cases beside the scenario as it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from hilc_cli.variation.axes import Value

BEST = "best.yaml"
"""The scenario of the best case, in the folder of a sweep that was a search."""


@dataclass(frozen=True, slots=True)
class AsItIs:
    """The scenario as it is, beside which the cases of a search are put.

    Attributes:
        values: What each varied key is in it; None where nothing stands for it.
        metric: What the search minimises; not-a-number if it diverges or has no such number.
    """

    values: Mapping[str, Value]
    metric: float

    def to_data(self) -> dict[str, Any]:
        """As plain data for a JSON document."""
        return {**asdict(self), "metric": self.metric if math.isfinite(self.metric) else None}

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> AsItIs:
        """What `to_data` has written.

        Raises:
            KeyError: Something is missing.
        """
        metric = data["metric"]
        return cls(dict(data["values"]), math.nan if metric is None else float(metric))
