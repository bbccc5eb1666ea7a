"""What a name may be: it becomes part of paths, tables and pictures, so it is harmless in all."""

from __future__ import annotations

import re

from hilc_cli.errors import UsageError, printable, shortened

# No dot first, with which hidden folders begin, drafts among them, and no hyphen, with which
# options and formulas do.
NAME_PATTERN = r"^[A-Za-z0-9_][A-Za-z0-9._-]*$"
LONGEST_NAME = 100


def name_from(value: object, where: str) -> str:
    """A name as a folder that may come from anybody says it.

    Args:
        value: What stands in the place of the name.
        where: That place, for the message.

    Raises:
        UsageError: It is no name.
    """
    if (
        isinstance(value, str)
        and len(value) <= LONGEST_NAME
        and re.fullmatch(NAME_PATTERN, value)
        and not value.endswith("\n")  # which $ lets pass
    ):
        return value
    shown = printable(shortened(repr(value), 60))
    raise UsageError(f"{where}: is no name, got {shown}; {name_remedy(value)}")


def name_remedy(text: object) -> str:
    """What to do about a text that is to be a name and is none."""
    if isinstance(text, str) and text.startswith("-"):
        return "begin with a letter or digit: options and formulas begin with '-'"
    if isinstance(text, str) and text.startswith("."):
        return "begin with a letter or digit: hidden files and folders begin with '.'"
    return "use letters, digits, '.', '_' and '-'"
