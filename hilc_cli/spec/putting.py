"""Values put into a valid scenario and validated there, as ``--set`` does with a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from hilc_cli.errors import InvalidInputError
from hilc_cli.spec.nodes import MapNode, Node, PathKeys, Place, Source, from_data, to_data
from hilc_cli.spec.overrides import apply_override
from hilc_cli.spec.problems import problems_of
from hilc_cli.spec.scenario import ScenarioSpec
from hilc_cli.variation.axes import Value

Change = tuple[str, Value, Place]
"""A key, its value, and where that stands."""


def validated(spec: ScenarioSpec, changes: Sequence[Change]) -> ScenarioSpec:
    """The scenario with values put in.

    Raises:
        InvalidInputError: They are not valid there; names every problem.
    """
    return as_scenario(with_changes(spec, changes))


def with_changes(spec: ScenarioSpec, changes: Sequence[Change]) -> MapNode:
    """The scenario as a tree, with values put in."""
    place = changes[0][2] if changes else Place(Source("", Path(), has_lines=False))
    tree: Node = from_data(spec.model_dump(mode="json", exclude_none=True), place)
    assert isinstance(tree, MapNode)  # of a model
    for key, value, where in changes:
        tree = apply_override(
            tree, tuple(key.split(".")), from_data(value, where), lambda same: same
        )
    return tree


def as_scenario(tree: MapNode) -> ScenarioSpec:
    """The scenario of a tree, if it is valid.

    Raises:
        InvalidInputError: It is not; names every problem.
    """
    try:
        return ScenarioSpec.model_validate(to_data(tree))
    except ValidationError as error:
        raise InvalidInputError(problems_of(error, tree, ScenarioSpec)) from None


def root(key: str) -> str:
    """The first part of a dotted key."""
    return key.partition(".")[0]


def parts(key: str) -> PathKeys:
    """The parts of a dotted key; numbers are places in a list."""
    return tuple(int(part) if part.isdecimal() else part for part in key.split("."))


def value_at(part: Any, keys: PathKeys) -> Any:
    """What stands at a path in a valid scenario."""
    for key in keys:
        part = getattr(part, str(key)) if isinstance(part, BaseModel) else part[key]
    return part
