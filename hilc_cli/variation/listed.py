"""Cases whose values follow from no rule, but have been noted one by one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hilc_cli.variation.axes import Axis, Value


@dataclass(frozen=True, slots=True)
class ListedCases:
    """All cases of a search.

    Attributes:
        axes: What each key takes, in the order in which they were given.
        rows: What each key is in each case.
    """

    axes: Mapping[str, Axis]
    rows: Sequence[tuple[Value, ...]]

    sampling = "listed"

    def __len__(self) -> int:
        return len(self.rows)

    def column(self, key: str) -> list[Value]:
        """What one key is in all cases."""
        number = list(self.axes).index(key)
        return [row[number] for row in self.rows]
