"""Lists of whole numbers on the command line: ``0,1,5..10,100``."""

from __future__ import annotations

import re

from hilc_cli.errors import UsageError

LONGEST = 100_000
_PART = re.compile(r"\s*(\d{1,9})\s*(?:\.\.\s*(\d{1,9})\s*)?")


def parse_whole_numbers(option: str, text: str) -> list[int]:
    """The numbers that a list of numbers and ranges names, ends included.

    Args:
        option: The option that holds it, for the error message.
        text: The list.

    Raises:
        UsageError: It has another form.
    """
    numbers: list[int] = []
    for part in text.split(","):
        match = _PART.fullmatch(part)
        if match is None:
            raise UsageError(f"{option} {text}: must be whole numbers such as 0,1,5..10,100")
        first = int(match[1])
        last = first if match[2] is None else int(match[2])
        if last < first or len(numbers) + last - first >= LONGEST:
            raise UsageError(f"{option} {text}: '{part.strip()}' is no range from low to high")
        numbers.extend(range(first, last + 1))
    return numbers
