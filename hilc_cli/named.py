"""Mappings whose errors tell what is there, and results that show themselves in a few lines."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar

from hilc_cli.errors import UnknownNameError

_Key = TypeVar("_Key")
_Value = TypeVar("_Value")
_WIDTH = 100


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


def listed(names: Iterable[Any], most: int = 12) -> str:
    """Some names behind one another, and how many more there are."""
    texts = [str(name) for name in names]
    more = f", and {len(texts) - most} more" if len(texts) > most else ""
    return ", ".join(texts[:most]) + more


def in_short(title: str, *lines: str) -> str:
    """What a result shows of itself: a title and lines below it, each cut where it is long."""
    texts = [title, *(f"  {line}" for line in lines)]
    return "\n".join(t if len(t) <= _WIDTH else f"{t[: _WIDTH - 3]}..." for t in texts)


def wrapped(title: str, *texts: str) -> str:
    """A title and sentences below it, each in as many lines as it needs."""
    lines = [
        textwrap.fill(text, _WIDTH, initial_indent="  ", subsequent_indent="    ") for text in texts
    ]
    return "\n".join([title, *lines])


def counted(count: int, name: str) -> str:
    """``1 segment``, ``2 segments``."""
    return f"{count} {name}" if count == 1 else f"{count} {name}s"
