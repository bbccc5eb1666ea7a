"""Lists of whole numbers on the command line: ``0,1,5..10,100``."""

from __future__ import annotations

import re
from dataclasses import dataclass

from hilc_cli.errors import UsageError

_PART = re.compile(r"\s*(\d{1,9})\s*(?:\.\.\s*(\d{1,9})\s*)?")


@dataclass(frozen=True, slots=True)
class WholeNumbers:
    """Single numbers, and ranges with their ends."""

    single: tuple[int, ...]
    ranges: tuple[range, ...]

    def __contains__(self, number: int) -> bool:
        return number in self.single or any(number in part for part in self.ranges)


def parse_whole_numbers(option: str, text: str) -> WholeNumbers:
    """The numbers that a list of numbers and ranges names, ends included.

    Args:
        option: The option that holds it, for the error message.
        text: The list.

    Raises:
        UsageError: It has another form.
    """
    single: list[int] = []
    ranges: list[range] = []
    for part in text.split(","):
        match = _PART.fullmatch(part)
        if match is None:
            raise UsageError(f"{option} {text}: must be whole numbers such as 0,1,5..10,100")
        first = int(match[1])
        if match[2] is None:
            single.append(first)
        elif int(match[2]) < first:
            raise UsageError(f"{option} {text}: '{part.strip()}' is no range from low to high")
        else:
            ranges.append(range(first, int(match[2]) + 1))
    return WholeNumbers(tuple(single), tuple(ranges))
