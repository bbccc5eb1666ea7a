"""The scenarios of cases: validated values put into their places, fast.

A sweep may have a million cases. A section of the scenario is copied only if one of its values is
another than in the case before, and what no key leads into is the same in all of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel

from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.variation import Value
from hilc_cli.yaml_input.nodes import PathKeys

_Model = TypeVar("_Model", bound=BaseModel)
_KeyTree = dict[str | int, Any]
"""A tree of keys: for each part the whole key, or what lies below it."""


class CaseSpecs:
    """Puts the values of cases into a scenario, one case after another.

    Attributes:
        base: The scenario with the values that are not varied.
    """

    def __init__(self, base: ScenarioSpec, keys: Iterable[str]) -> None:
        """Takes what is varied.

        Args:
            base: The scenario with the values that are not varied.
            keys: Dotted keys, none of which leads into the value of another one.
        """
        self.base = base
        self._sections = [_Section(name, below) for name, below in _tree(keys).items()]
        self._copies = _Copies()

    def of(self, values: Mapping[str, Value], **parts: BaseModel) -> ScenarioSpec:
        """The scenario of a case.

        Args:
            values: Valid ones by key; of keys that are left out the scenario's own.
            parts: Whole sections in the place of the scenario's.
        """
        changes: dict[Any, Any] = dict(parts)
        fields = self.base.__dict__
        for section in self._sections:
            changes[section.name] = section.of(fields[section.name], values)
        return self._copies.of(self.base, changes)


class _Section:
    """A section of a scenario, or a key of its own, with the values of one case after another."""

    def __init__(self, name: Any, below: _KeyTree | str) -> None:
        self.name = name
        self._part = None if isinstance(below, str) else _Part(below)
        self._keys = tuple(_keys(below))
        self._values: tuple[object, ...] = ()
        self._before: Any = None
        self._made: Any = None

    def of(self, before: Any, values: Mapping[str, Value]) -> Any:
        """The section with values in their places.

        Args:
            before: The section without them.
            values: Of this section and of others.
        """
        if self._part is None:
            return values.get(self._keys[0], before)
        own = tuple([values.get(key, _LEFT_OUT) for key in self._keys])
        if before is self._before and own == self._values and _same_types(own, self._values):
            return self._made
        self._made = self._part.of(before, values)
        self._before, self._values = before, own
        return self._made


_LEFT_OUT = object()


def _same_types(some: tuple[object, ...], others: tuple[object, ...]) -> bool:
    """Whether equal values are of equal types: 1, 1.0 and true are equal, but not the same."""
    return list(map(type, some)) == list(map(type, others))


def _tree(keys: Iterable[str]) -> _KeyTree:
    """Keys as a tree: what they share is then gone through once."""
    tree: _KeyTree = {}
    for key in keys:
        branch = tree
        *above, last = parts(key)
        for part in above:
            below = branch.setdefault(part, {})
            assert isinstance(below, dict)  # no key leads into the value of another one
            branch = below
        branch[last] = key
    return tree


def _keys(below: _KeyTree | str) -> list[str]:
    """The whole keys in a tree."""
    if isinstance(below, str):
        return [below]
    return [key for part in below.values() for key in _keys(part)]


class _Part:
    """A part of a scenario with the values of one case after another."""

    def __init__(self, below: _KeyTree) -> None:
        self._keys = {at: key for at, key in below.items() if isinstance(key, str)}
        self._parts = {at: _Part(tree) for at, tree in below.items() if at not in self._keys}
        self._copies = _Copies()

    def of(self, part: Any, values: Mapping[str, Value]) -> Any:
        """The part with values in their places, all else as it was."""
        is_list = isinstance(part, tuple | list)  # to ask for a model takes far longer
        fields: Mapping[Any, Any] = dict(enumerate(part)) if is_list else part.__dict__
        changes: dict[Any, Any] = {at: values.get(k, fields[at]) for at, k in self._keys.items()}
        for at, below in self._parts.items():
            changes[at] = below.of(fields[at], values)
        return tuple({**fields, **changes}.values()) if is_list else self._copies.of(part, changes)


class _Copies:
    """Makes copies of models in which always the same fields are others."""

    def __init__(self) -> None:
        self._before: Any = None
        self._fields_set: set[str] = set()

    def of(self, model: _Model, changes: Mapping[Any, Any]) -> _Model:
        """What ``model_copy`` gives of a model without private attributes, in half its time."""
        if model.__pydantic_private__ is not None:
            return model.model_copy(update=changes)
        if model.__pydantic_fields_set__ is not self._before:
            self._before = model.__pydantic_fields_set__
            self._fields_set = self._before.union(changes)
        copy = _new(model.__class__)
        _set(copy, "__dict__", {**model.__dict__, **changes})
        _set(copy, "__pydantic_fields_set__", self._fields_set)
        _set(copy, "__pydantic_extra__", model.__pydantic_extra__)
        _set(copy, "__pydantic_private__", None)
        return copy


_new = object.__new__
_set = object.__setattr__  # models are frozen


def parts(key: str) -> PathKeys:
    """The parts of a dotted key; numbers are places in a list."""
    return tuple(int(part) if part.isdecimal() else part for part in key.split("."))


def value_at(part: Any, keys: PathKeys) -> Any:
    """What stands at a path in a valid scenario."""
    for key in keys:
        part = getattr(part, str(key)) if isinstance(part, BaseModel) else part[key]
    return part
