"""A sweep from what a scenario says of it and what is asked for beside that."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hilc_cli.errors import InvalidInputError, Problem, UsageError
from hilc_cli.spec.nodes import MapNode, Node, Place, Scalar, Source, from_data, to_data
from hilc_cli.spec.problems import problems_of
from hilc_cli.spec.sweep import SweepSpec
from hilc_cli.spec.valid import Scenario
from hilc_cli.spec.varied import Varied, vary

Variations = Mapping[str, object] | Sequence[str]


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
        spec = SweepSpec.model_validate(to_data(tree))
    except ValidationError as error:
        problems = problems_of(error, tree, SweepSpec)
        raise InvalidInputError(
            replace(problem, path=problem.path.removeprefix("vary.")) for problem in problems
        ) from None
    if not spec.vary:
        raise UsageError(
            "nothing is varied; give --vary KEY=VALUES, such as --vary controller.gains.l1=0:1:11, "
            "or a section 'sweep:' in the scenario"
        )
    keys = tree.entries["vary"]
    assert isinstance(keys, MapNode)  # made so below
    return vary(scenario, spec.vary, {key: keys.entries[key].place for key in spec.vary}), spec


def _tree(
    scenario: Scenario, variations: Mapping[str, Node], given: Mapping[str, object]
) -> MapNode:
    """Both together as the tree of one section."""
    own: dict[str, Any] = {}
    if scenario.spec.sweep is not None:
        own = dict(scenario.spec.sweep)
        if given.get("sample", own["sample"]) == "grid":
            del own["cases"]  # it belongs to the sampling that has been replaced
    here = _place("the scenario's sweep")
    axes: dict[str, Node] = {
        # The values have been read before: they stand in for their text.
        key: Scalar(scenario.sweep_places.get(key, here), axis, str(axis))
        for key, axis in own.pop("vary", {}).items()
    }
    axes.update(variations)
    nodes: dict[str, Node] = {"vary": MapNode(here, axes, {k: n.place for k, n in axes.items()})}
    for key, value in own.items():
        nodes[key] = from_data(value, here)
    for key, value in given.items():
        nodes[key] = from_data(value, _place(f"--{key} {value}"))
    return MapNode(here, nodes, {key: node.place for key, node in nodes.items()})


def _nodes(variations: Variations) -> dict[str, Node]:
    if isinstance(variations, Mapping):
        return {key: from_data(value, _place(f"vary {key}")) for key, value in variations.items()}
    nodes: dict[str, Node] = {}
    problems = []
    for text in [variations] if isinstance(variations, str) else variations:
        key, equals, values = text.partition("=")
        key, place = key.strip(), _place(f"--vary {text}")
        if not equals or not all(key.split(".")) or not values.strip():
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
