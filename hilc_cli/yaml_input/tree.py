"""A bounded, safe YAML reader that keeps line and column of every value.

It composes its own tree from PyYAML's events, one at a time: nothing that a file can say makes
it recurse deeply, expand aliases without end, or construct objects.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import yaml

from hilc_cli.errors import InvalidInputError, Problem
from hilc_cli.yaml_input.nodes import ListNode, MapNode, Node, Place, Scalar, Source
from hilc_cli.yaml_input.syntax_errors import SYNTAX_HELP, explained, odd_character, told

_NULL = frozenset({"", "~", "null", "Null", "NULL"})
_TRUE = frozenset({"true", "True", "TRUE"})
_FALSE = frozenset({"false", "False", "FALSE"})
_INFINITE = re.compile(r"[-+]?\.(inf|Inf|INF)")
_NOT_A_NUMBER = frozenset({".nan", ".NaN", ".NAN"})
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")

LONGEST_NUMBER = 100
"""Longer digits stay text: no sensible number needs them, and converting them takes long."""


def resolve_plain(text: str) -> str | int | float | bool | None:
    """The value of an unquoted scalar."""
    if text in _NULL:
        return None
    if text in _TRUE:
        return True
    if text in _FALSE:
        return False
    if len(text) > LONGEST_NUMBER:
        return text
    if _DECIMAL.fullmatch(text):
        return int(text)
    if _OCTAL.fullmatch(text):
        return int(text[2:], 8)
    if _HEXADECIMAL.fullmatch(text):
        return int(text[2:], 16)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _INFINITE.fullmatch(text):
        return float("-inf" if text.startswith("-") else "inf")
    if text in _NOT_A_NUMBER:
        return float("nan")
    return text


MAX_BYTES = 1_000_000
MAX_DEPTH = 20
LONGEST_KEY = 200
MAX_VALUES = 50_000
"""Values in a file, each use of an alias counted with all that it stands for."""

_Loader: type = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_WHOLE_NUMBER = re.compile(r"[-+]?[0-9]+")


class _Stop(Exception):
    """Reading cannot go on."""


def parse_yaml(
    content: bytes,
    source: Source,
    problems: list[Problem] | None = None,
    *,
    show: bool = True,
) -> Node:
    """One YAML document as a tree.

    Args:
        content: The text in UTF-8.
        source: Where it comes from.
        problems: Takes what is wrong with single values, so that it can be told together with
            what validation finds in the rest; None: that is an error at once.
        show: Whether messages may tell what stands in the text.

    Raises:
        InvalidInputError: It is no UTF-8 or YAML, holds several documents, or exceeds a budget;
            or it holds duplicate keys, tags or merge keys, and there are no problems to add to.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        before = content[content.rfind(b"\n", 0, error.start) + 1 : error.start]
        column = len(before.decode("utf-8", "replace")) + 1
        byte = content[error.start]
        got = f", got byte 0x{byte:02x}" if show else ""
        message = f"is not UTF-8 text{got}; save the file as UTF-8"
        raise InvalidInputError.of(Place(source, line, column), "", message) from None
    composer = _Composer(source, show)
    tree: Node | None = None
    loader = _Loader(text)
    try:
        tree = composer.document(_events(loader))
    except _Stop:
        tree = None
    except yaml.MarkedYAMLError as error:
        line, column, message = explained(text, error)
        composer.problem(Place(source, line, column), message)
    except yaml.YAMLError as error:
        why = str(error).splitlines()[0]
        composer.problem(_unreadable(text, source), f"is not valid YAML: {why}; {SYNTAX_HELP}")
    finally:
        loader.dispose()
    if tree is None or (composer.problems and problems is None):
        raise InvalidInputError(composer.problems)
    if problems is not None:
        problems.extend(composer.problems)
    return tree


def _unreadable(text: str, source: Source) -> Place:
    """Where the first character stands that YAML does not allow."""
    match = yaml.reader.Reader.NON_PRINTABLE.search(text)
    if match is None:
        return Place(source)
    line = text.count("\n", 0, match.start()) + 1
    return Place(source, line, match.start() - text.rfind("\n", 0, match.start()))


def _events(loader: yaml.SafeLoader) -> Iterator[yaml.Event]:
    while loader.check_event():
        yield loader.get_event()  # type: ignore[no-untyped-call]


def _goes_on(number: yaml.Event, key: yaml.Event, value: yaml.Event) -> bool:
    """Whether a key with nothing behind it is what follows the comma of a number."""
    return (
        isinstance(number, yaml.ScalarEvent)
        and isinstance(key, yaml.ScalarEvent)
        and isinstance(value, yaml.ScalarEvent)
        and not value.value
        and _WHOLE_NUMBER.fullmatch(number.value) is not None
        and key.value[:1].isdecimal()
        and key.start_mark is not None
        and number.end_mark is not None
        and key.start_mark.index == number.end_mark.index + 1
    )


@dataclass(slots=True)
class _Composer:
    source: Source
    show: bool
    problems: list[Problem] = field(default_factory=list)
    values: int = 0
    anchors: dict[str, tuple[Node, int] | None] = field(default_factory=dict)  # None: unfinished

    def place(self, mark: yaml.error.Mark | yaml._yaml.Mark | None) -> Place:
        if mark is None:
            return Place(self.source)
        return Place(self.source, mark.line + 1, mark.column + 1)

    def problem(self, place: Place, message: str, path: str = "") -> None:
        self.problems.append(Problem(str(place), path if self.show else "", message))

    def stop(self, place: Place, message: str) -> _Stop:
        self.problem(place, message)
        return _Stop()

    def document(self, events: Iterator[yaml.Event]) -> Node:
        """The only document of a stream."""
        tree: Node | None = None
        for event in events:
            if isinstance(event, yaml.DocumentStartEvent):
                if tree is not None:
                    raise self.stop(
                        self.place(event.start_mark),
                        "holds a second YAML document; keep one document in a file",
                    )
                tree = self.node(next(events), events, ())
        if tree is None:
            raise self.stop(Place(self.source), "is empty; write a mapping of keys and values")
        return tree

    def node(self, event: yaml.Event, events: Iterator[yaml.Event], path: tuple[str, ...]) -> Node:
        place = self.place(event.start_mark)
        if len(path) > MAX_DEPTH:
            raise self.stop(place, f"is nested more than {MAX_DEPTH} deep; flatten it")
        if isinstance(event, yaml.AliasEvent):
            return self.alias(str(event.anchor), place)
        assert isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent)  # what is left
        before = self.values
        self.count(1, place)
        anchor: str | None = event.anchor
        if anchor is not None:
            self.anchors[anchor] = None
        if event.tag is not None:
            tag = f"the tag {event.tag}" if self.show else "a tag"
            self.problem(place, f"has {tag}; leave tags out", ".".join(path))
        node: Node
        if isinstance(event, yaml.ScalarEvent):
            value = resolve_plain(event.value) if event.implicit[0] else event.value
            node = Scalar(place, value, event.value, quoted=event.style == '"')
        elif isinstance(event, yaml.SequenceStartEvent):
            items: list[Node] = []
            while not isinstance(event := next(events), yaml.SequenceEndEvent):
                items.append(self.node(event, events, (*path, str(len(items)))))
            node = ListNode(place, tuple(items))
        else:
            node = self.mapping(place, events, path, in_braces=bool(event.flow_style))
        if anchor is not None:
            self.anchors[anchor] = (node, self.values - before)
        return node

    def mapping(
        self,
        place: Place,
        events: Iterator[yaml.Event],
        path: tuple[str, ...],
        *,
        in_braces: bool,
    ) -> MapNode:
        entries: dict[str, Node] = {}
        key_places: dict[str, Place] = {}
        before: tuple[str, yaml.Event] | None = None
        while not isinstance(event := next(events), yaml.MappingEndEvent):
            key_place = self.place(event.start_mark)
            if not isinstance(event, yaml.ScalarEvent):
                raise self.stop(key_place, "has a key that is no plain word; use words as keys")
            key: str = event.value
            here = (*path, key)
            if len(key) > LONGEST_KEY:
                raise self.stop(key_place, f"has a key of {len(key)} characters; shorten it")
            odd = odd_character(key)
            if odd is not None:
                key_place = replace(key_place, column=key_place.column + odd.start())
                raise self.stop(key_place, told(odd.group()))
            start = next(events)
            if in_braces and before is not None and _goes_on(before[1], event, start):
                # A decimal comma; what takes the number will say so.
                node = entries[before[0]]
                assert isinstance(node, Scalar)  # it goes on
                number = f"{node.text},{key}"
                entries[before[0]], before = Scalar(node.place, number, number), None
                continue
            before = (key, start)
            value = self.node(start, events, here)
            if key == "<<" and event.implicit[0]:
                self.problem(
                    key_place, "merge keys are not part of YAML 1.2; write the keys out", "<<"
                )
            elif key in entries:
                first = key_places[key].line
                self.problem(
                    key_place,
                    f"is given twice, first in line {first}; keep one of them",
                    ".".join(here),
                )
            else:
                entries[key], key_places[key] = value, key_place
        return MapNode(place, entries, key_places)

    def alias(self, anchor: str, place: Place) -> Node:
        name, defined = (f"*{anchor} ", f"&{anchor}") if self.show else ("", "one")
        if anchor not in self.anchors:
            raise self.stop(place, f"alias {name}has no anchor; define {defined} before it")
        found = self.anchors[anchor]
        if found is None:
            raise self.stop(place, f"alias {name}contains itself; write the value out")
        node, size = found
        self.count(size, place)
        return node

    def count(self, size: int, place: Place) -> None:
        self.values += size
        if self.values > MAX_VALUES:
            raise self.stop(place, f"holds more than {MAX_VALUES} values; shorten it")


class _Dumper(yaml.SafeDumper):
    """Quotes what YAML 1.2, in which hilc reads, would take for a number or a truth value."""


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    plain = isinstance(resolve_plain(text), str) and text.isprintable()
    style = None if plain else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _text)


def to_yaml(data: Any) -> str:
    """YAML text of dictionaries, lists and values, keys in their order."""
    return yaml.dump(
        data,
        Dumper=_Dumper,
        sort_keys=False,
        allow_unicode=True,
        width=10_000,
        default_flow_style=None,
    )
