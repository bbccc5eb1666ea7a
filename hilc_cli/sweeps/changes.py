"""Values put into a scenario, with what comes of them validated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import BaseModel, ValidationError

from hilc_cli.errors import InvalidInputError
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.variation import Value
from hilc_cli.yaml_input.nodes import MapNode, Node, Place, Source, from_data, to_data
from hilc_cli.yaml_input.problems import problems_of
from hilc_cli.yaml_input.reading import apply_override

TRAJECTORY = "trajectory"

Change = tuple[str, Value, Place]
"""A key, its value, and where that stands."""


def validated(spec: ScenarioSpec, changes: Sequence[Change]) -> ScenarioSpec:
    """The scenario with values put in.

    What no change leads into is not validated again: to build a long path takes its time.

    Raises:
        InvalidInputError: They are not valid there; names every problem.
    """
    changed = {root(key) for key, _, _ in changes} | {"controller"}  # whose law looks at the others
    kept = {key: part for key, part in spec if isinstance(part, BaseModel) and key not in changed}
    return scenario_of(with_changes(spec, changes), kept)


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


def scenario_of(tree: MapNode, kept: Mapping[str, BaseModel] | None = None) -> ScenarioSpec:
    """The scenario of a tree, if it is valid.

    Args:
        tree: The scenario.
        kept: Parts that are valid already, in the place of those in the tree.

    Raises:
        InvalidInputError: It is not; names every problem.
    """
    data = to_data(tree)
    assert isinstance(data, dict)  # of a mapping
    try:
        return ScenarioSpec.model_validate({**data, **(kept or {})})
    except ValidationError as error:
        raise InvalidInputError(problems_of(error, tree, ScenarioSpec)) from None


def changes_path(spec: ScenarioSpec, key: str) -> bool:
    """Whether the reference of a case may depend on a key that is varied."""
    of_timing = root(key) in ("robot", "model") or key == "controller.b_w"
    return root(key) == TRAJECTORY or (of_timing and spec.trajectory.timing is not None)


def root(key: str) -> str:
    """The first part of a dotted key."""
    return key.partition(".")[0]
