"""What a name may be: it becomes part of paths, tables and pictures, so it is harmless in all."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TypeVar

from hilc_cli.errors import UnknownNameError
from hilc_cli.wording import in_short, listed

# No dot first, with which hidden folders begin, drafts among them, and no hyphen, with which
# options and formulas do.
NAME_PATTERN = r"^[A-Za-z0-9_][A-Za-z0-9._-]*$"
LONGEST_NAME = 100


def check_name(value: str) -> str:
    """A name as a folder that may come from anybody says it.

    Raises:
        ValueError: It is no name.
    """
    # fullmatch, since $ lets a line break pass.
    if len(value) > LONGEST_NAME or not re.fullmatch(NAME_PATTERN[:-1], value):
        raise ValueError(f"is no name; {name_remedy(value)}")
    return value


def name_remedy(text: object) -> str:
    """What to do about a text that is to be a name and is none."""
    if isinstance(text, str) and text.startswith("-"):
        return "begin with a letter or digit: options and formulas begin with '-'"
    if isinstance(text, str) and text.startswith("."):
        return "begin with a letter or digit: hidden files and folders begin with '.'"
    return "use letters, digits, '.', '_' and '-'"


_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


class Named(Mapping[_Key, _Value]):
    """A mapping that says what it has when it is asked for something else."""

    __slots__ = ("_values", "_what")

    def __init__(self, what: str, values: Mapping[_Key, _Value]) -> None:
        """Takes over a mapping.

        Args:
            what: What its keys are, such as ``metric``.
            values: The mapping.
        """
        self._what = what
        self._values = values

    def __getitem__(self, key: _Key) -> _Value:
        """The value of a key.

        Raises:
            UnknownNameError: There is none; names the keys that there are.
        """
        try:
            return self._values[key]
        except KeyError:
            raise UnknownNameError(self._what, key, self._values) from None

    def __iter__(self) -> Iterator[_Key]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return in_short(f"{len(self)} by {self._what}: {listed(self)}")


def named(what: str, values: Mapping[_Key, _Value]) -> Named[_Key, _Value]:
    """The mapping as a `Named` one; one that is stays as it is."""
    return values if isinstance(values, Named) else Named(what, values)
