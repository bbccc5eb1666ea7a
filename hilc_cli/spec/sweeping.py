"""A sweep from what a scenario says of it and what is asked for beside that."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hilc_cli.errors import InvalidInputError, Problem, UsageError
from hilc_cli.spec.axis import read_axis, shown_axis
from hilc_cli.spec.checked_values import vary
from hilc_cli.spec.nodes import MapNode, Node, PathKeys, Place, Scalar, Source, from_data, to_data
from hilc_cli.spec.overrides import parts_of_key
from hilc_cli.spec.problems import problems_of
from hilc_cli.spec.quantities import MOST_CASES
from hilc_cli.spec.sweep import CompleteSweepSpec, SweepSpec
from hilc_cli.spec.valid import Scenario
from hilc_cli.spec.varied import Varied
from hilc_cli.variation.cases import Cases

Variations = Mapping[str, object] | Sequence[str]

_MOST_TRIED = 10_000
"""Cases of a search: the time that it takes to think of the next one grows with their number."""
_REPLACES = {"minimise": ("sample", "metric"), "sample": ("minimise",)}
"""Keys of the section that make way for one that is given."""


def plan_of(
    scenario: Scenario, variations: Variations = (), options: Mapping[str, object] | None = None
) -> tuple[Varied, SweepSpec]:
    """What is varied and how, with every value validated.

    Args:
        scenario: May have a section ``sweep`` of its own.
        variations: Values by dotted key, or texts ``KEY=VALUES`` as on the command line; they
            replace those of the same key in the scenario, and are added to the others.
        options: Other keys of the section ``sweep``; None stands for what the scenario says.

    Raises:
        InvalidInputError: A value is not valid; names every problem.
        UsageError: Nothing is varied.
    """
    given = {key: value for key, value in (options or {}).items() if value is not None}
    tree = _tree(scenario, _nodes(variations), given)
    try:
        spec = CompleteSweepSpec.model_validate(to_data(tree))
    except ValidationError as error:
        problems = [_told(problem) for problem in problems_of(error, tree, SweepSpec)]
        unread = {details["loc"] for details in error.errors()}
        raise InvalidInputError([*problems, *_others(scenario, tree, unread)]) from None
    if not spec.vary:
        raise UsageError(
            "nothing is varied; give --vary KEY=VALUES, such as --vary controller.gains.l1=0:1:11, "
            "or a section 'sweep:' in the scenario"
        )
    varied = vary(scenario, spec.vary, _places(tree))
    if spec.minimise is not None:
        _check_budget(spec.cases or 0)
        return varied, spec.model_copy(update={"metric": spec.minimise})
    if spec.sample == "grid":
        _check_size(Cases(varied.axes))
    return varied, spec


def _told(problem: Problem) -> Problem:
    """The problem by the key that its author has written: in the file it is below ``sweep``."""
    if problem.where.startswith(("--", "vary ")):
        return replace(problem, path=problem.path.removeprefix("vary."))
    return replace(problem, path=f"sweep.{problem.path}")


def _check_size(grid: Cases) -> None:
    cases = math.prod(grid.shape)
    if cases > MOST_CASES:
        raise UsageError(
            f"the grid has {cases:,} cases, of which at most {MOST_CASES:,} can be run; "
            "give fewer values, or draw some with --sample and --cases"
        )


def _check_budget(cases: int) -> None:
    if cases > _MOST_TRIED:
        raise UsageError(
            f"the search has {cases:,} cases, of which at most {_MOST_TRIED:,} can be tried; "
            "give fewer, or draw them with --sample and --cases"
        )


def _others(scenario: Scenario, tree: MapNode, unread: Collection[PathKeys]) -> list[Problem]:
    """What is wrong with the values of keys that can be read, beside those that cannot."""
    axes = {}
    for key, node in _axis_nodes(tree).items():
        with suppress(ValueError):
            if ("vary", key) not in unread:
                axes[key] = read_axis(to_data(node))
    try:
        vary(scenario, axes, _places(tree))
    except InvalidInputError as error:
        return list(error.problems)
    return []


def _axis_nodes(tree: MapNode) -> Mapping[str, Node]:
    keys = tree.entries["vary"]
    assert isinstance(keys, MapNode)  # made so below
    return keys.entries


def _places(tree: MapNode) -> dict[str, Place]:
    return {key: node.place for key, node in _axis_nodes(tree).items()}


def _tree(
    scenario: Scenario, variations: Mapping[str, Node], given: Mapping[str, object]
) -> MapNode:
    """Both together as the tree of one section."""
    own: dict[str, Any] = {}
    section = scenario.spec.sweep
    if section is not None:
        replaced = [key for chosen, keys in _REPLACES.items() if chosen in given for key in keys]
        if given.get("sample") == "grid":
            replaced.append("cases")  # it belongs to the sampling that has been replaced
        # What the section leaves out is not there to contradict what is given.
        written = [key for key in SweepSpec.model_fields if key in section.model_fields_set]
        own = {key: getattr(section, key) for key in written if key not in replaced}
    here = _place("the scenario's sweep")
    axes: dict[str, Node] = {
        # The values have been read before: they stand in for their text.
        key: Scalar(scenario.sweep_places.get(("vary", key), here), axis, shown_axis(axis))
        for key, axis in own.pop("vary", {}).items()
    }
    axes.update(variations)
    nodes: dict[str, Node] = {"vary": MapNode(here, axes, {k: n.place for k, n in axes.items()})}
    for key, value in own.items():
        nodes[key] = from_data(value, scenario.sweep_places.get(("sweep", key), here))
    for key, value in given.items():
        nodes[key] = from_data(value, _place(f"--{key} {value}"))
    return MapNode(here, nodes, {key: node.place for key, node in nodes.items()})


def _nodes(variations: Variations) -> dict[str, Node]:
    if isinstance(variations, Mapping):
        for key in variations:
            parts_of_key(key, "vary")
        return {key: from_data(value, _place(f"vary {key}")) for key, value in variations.items()}
    nodes: dict[str, Node] = {}
    problems = []
    for text in [variations] if isinstance(variations, str) else variations:
        key, equals, values = text.partition("=")
        key, place = key.strip(), _place(f"--vary {text}")
        if not all(parts_of_key(key, "--vary")) or not equals or not values.strip():
            message = "must read KEY=VALUES, such as controller.gains.l1=0:1:11"
            problems.append(Problem(str(place), "", message))
        elif key in nodes:
            problems.append(Problem(str(place), key, "is varied more than once; give it once"))
        nodes[key] = Scalar(place, values.strip(), values.strip())
    if problems:
        raise InvalidInputError(problems)
    return nodes


def _place(label: str) -> Place:
    return Place(Source(label, Path(), has_lines=False))
