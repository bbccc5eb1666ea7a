"""YAML as a tree that knows where each value stands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from hilc_cli.wording import printable, shortened

PathKeys = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Source:
    """Where a piece of YAML comes from.

    Attributes:
        label: What error messages call it: the file as the user named it, or the option.
        folder: The folder that relative paths in it start from.
        has_lines: Whether line and column tell the user something.
    """

    label: str
    folder: Path
    has_lines: bool = True


@dataclass(frozen=True, slots=True)
class Place:
    """A position in a source; line and column count from 1."""

    source: Source
    line: int = 1
    column: int = 1

    def __str__(self) -> str:
        if not self.source.has_lines:
            return self.source.label
        return f"{self.source.label}:{self.line}:{self.column}"


@dataclass(frozen=True, slots=True)
class Scalar:
    """A single value, its text as it was written, and whether in double quotes."""

    place: Place
    value: str | int | float | bool | None
    text: str
    quoted: bool = False


@dataclass(frozen=True, slots=True)
class ListNode:
    """A sequence."""

    place: Place
    items: tuple[Node, ...] = ()


@dataclass(frozen=True, slots=True)
class MapNode:
    """A mapping with its keys in order."""

    place: Place
    entries: Mapping[str, Node] = field(default_factory=dict)
    key_places: Mapping[str, Place] = field(default_factory=dict)


Node = Scalar | ListNode | MapNode


def to_data(node: Node) -> object:
    """The tree as plain dictionaries, lists and values."""
    if isinstance(node, Scalar):
        return node.value
    if isinstance(node, ListNode):
        return [to_data(item) for item in node.items]
    return {key: to_data(value) for key, value in node.entries.items()}


def from_data(data: object, place: Place) -> Node:
    """Plain dictionaries, lists and values as a tree that stands at one place."""
    if isinstance(data, Mapping):
        entries = {str(key): from_data(value, place) for key, value in data.items()}
        return MapNode(place, entries, dict.fromkeys(entries, place))
    if hasattr(data, "tolist"):  # a NumPy array or number
        data = data.tolist()
    if isinstance(data, str) or data is None or isinstance(data, bool | int | float):
        return Scalar(place, data, "null" if data is None else str(data))
    if isinstance(data, Sequence):
        return ListNode(place, tuple(from_data(item, place) for item in data))
    return Scalar(place, str(data), str(data))


def describe(node: Node, most: int = 40) -> str:
    """A value as an error message shows it, shortened."""
    if isinstance(node, ListNode):
        return f"a list of {len(node.items)}"
    if isinstance(node, MapNode):
        return "a mapping"
    if node.value is None:
        return "nothing"
    shown = printable(shortened(node.text, most))
    return f"'{shown}'" if isinstance(node.value, str) else shown


def nearest(node: Node, keys: PathKeys) -> tuple[Node, Place, bool]:
    """The node at a path of keys and list indices, or the deepest one on the way to it.

    Returns:
        The node, the place to point at, and whether the whole path was there.
    """
    place = node.place
    for key in keys:
        if isinstance(node, MapNode) and key in node.entries:
            place = node.key_places[str(key)]
            node = node.entries[str(key)]
            if not isinstance(node, MapNode):
                place = node.place
        elif isinstance(node, ListNode) and isinstance(key, int) and key < len(node.items):
            node = node.items[key]
            place = node.place
        else:
            return node, place, False
    return node, place, True


def with_entry(node: MapNode, key: str, value: Node, place: Place) -> MapNode:
    """The mapping with one entry replaced or added."""
    return replace(
        node,
        entries={**node.entries, key: value},
        key_places={**node.key_places, key: place},
    )
