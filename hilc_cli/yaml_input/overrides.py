"""``--set KEY=VALUE``: values put into a scenario's tree before it is validated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from hilc_cli.errors import InvalidInputError, Problem, shortened
from hilc_cli.yaml_input.nodes import (
    ListNode,
    MapNode,
    Node,
    Place,
    Scalar,
    Source,
    from_data,
    with_entry,
)
from hilc_cli.yaml_input.tree import LONGEST_KEY, parse_yaml

_SHOWN_OF_LONG_KEYS = 40


def parse_override(text: str) -> tuple[tuple[str, ...], Node]:
    """Keys and value of ``KEY=VALUE``, the value read as YAML.

    Raises:
        InvalidInputError: There is no key or no equals sign, or the value is no YAML.
    """
    key, equals, value = text.partition("=")
    source = _source(f"--set {text}")
    keys = parts_of_key(key.strip(), "--set")
    if not equals or not all(keys):
        message = "must read KEY=VALUE, such as controller.gains.l1=0.5"
        raise InvalidInputError([Problem(source.label, "", message)])
    if not value.strip():
        return keys, Scalar(Place(source), None, "null")
    try:
        return keys, parse_yaml(value.encode("utf-8", "surrogateescape"), source)
    except InvalidInputError as error:
        problems = [replace(problem, path=key.strip()) for problem in error.problems]
        raise InvalidInputError(problems) from None


def parts_of_key(key: str, option: str) -> tuple[str, ...]:
    """The parts of a dotted key; some may be empty.

    Args:
        key: The key.
        option: What it has been given with.

    Raises:
        InvalidInputError: It is so long that it is no key, whatever it says.
    """
    if len(key) > LONGEST_KEY:
        shown = f"{option} {shortened(key, _SHOWN_OF_LONG_KEYS)}"
        message = f"has a key of {len(key)} characters; give keys with dots between them, such as "
        raise InvalidInputError([Problem(shown, "", f"{message}controller.gains.l1")])
    return tuple(key.split("."))


def data_override(key: str, value: object) -> tuple[tuple[str, ...], Node]:
    """Keys and value of an override that comes from Python."""
    keys = parts_of_key(key, "override")
    place = Place(_source(f"override {key}"))
    if not all(keys):
        message = "must be keys with dots between them, such as controller.gains.l1"
        raise InvalidInputError([Problem(str(place), "", message)])
    return keys, from_data(value, place)


def apply_override(
    tree: MapNode,
    keys: tuple[str, ...],
    value: Node,
    inline: Callable[[MapNode], MapNode],
    default: Callable[[tuple[str, ...]], object] = lambda keys: None,
) -> MapNode:
    """The tree with one value replaced or added.

    Args:
        tree: The scenario.
        keys: Keys and list indices on the way to the value; missing mappings are added.
        value: The value.
        inline: Puts the trajectory in the place of its path, for keys that lead into it.
        default: What a list that is not in the tree is by default, for keys that lead into it.

    Raises:
        InvalidInputError: The way leads through a value that has no keys, or past a list's end.
    """
    if len(keys) > 1 and keys[0] == "trajectory":
        tree = inline(tree)
    changed = _put(tree, keys, value, (), default)
    assert isinstance(changed, MapNode)  # a mapping stays one
    return changed


def _put(
    node: Node | None,
    keys: tuple[str, ...],
    value: Node,
    above: tuple[str, ...],
    default: Callable[[tuple[str, ...]], object],
) -> Node:
    if not keys:
        return value
    key, rest = keys[0], keys[1:]
    here = (*above, key)
    if node is None and key.isdecimal():
        known = default(above)
        node = None if known is None else from_data(known, value.place)
    if node is None or (isinstance(node, Scalar) and node.value is None):
        node = MapNode(value.place)
    if isinstance(node, MapNode):
        return with_entry(
            node, key, _put(node.entries.get(key), rest, value, here, default), value.place
        )
    path = ".".join(here)
    if isinstance(node, ListNode):
        if key.isdecimal() and int(key) < len(node.items):
            items = list(node.items)
            items[int(key)] = _put(items[int(key)], rest, value, here, default)
            return replace(node, items=tuple(items))
        last = len(node.items) - 1
        message = f"is no entry of the list; give a number from 0 to {last}"
    else:
        message = f"cannot be set, since {'.'.join(above)} is a single value; set that instead"
    raise InvalidInputError([Problem(str(value.place), path, message)])


def _source(label: str) -> Source:
    return Source(label, Path(), has_lines=False)
