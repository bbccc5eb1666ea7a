"""A sweep from what a scenario says of it and what is asked for beside that."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hilc_cli.errors import InvalidInputError, Problem, UsageError
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import ScenarioSource, as_scenario
from hilc_cli.scenario.scenario import RecordSpec
from hilc_cli.scenario.sweep_section import CompleteSweepSpec, SweepSpec, read_axis, shown_axis
from hilc_cli.sweeps.changes import root
from hilc_cli.sweeps.checked_values import CheckedValues
from hilc_cli.sweeps.happenings import CrossedCases
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.search import require_optuna
from hilc_cli.yaml_input.nodes import (
    MapNode,
    Node,
    PathKeys,
    Place,
    Scalar,
    Source,
    from_data,
    to_data,
)
from hilc_cli.yaml_input.problems import problems_of
from hilc_cli.yaml_input.quantities import MOST_CASES
from hilc_cli.yaml_input.reading import parts_of_key

_MOST_TRIED = 10_000
"""Cases of a search: the time that it takes to think of the next one grows with their number."""
_REPLACES = {"minimise": ("sample", "metric"), "sample": ("minimise",)}
"""Keys of the section that make way for one that is given."""


def plan_sweep(
    scenario: ScenarioSource,
    vary: Mapping[str, object] | Sequence[str] = (),
    *,
    sample: str | None = None,
    cases: int | None = None,
    seed: int | None = None,
    tolerance: float | str | None = None,
    bands: bool | None = None,
    metric: str | None = None,
    minimise: str | None = None,
    over: str | Sequence[str] | None = None,
    robust: str | None = None,
    happenings: int | None = None,
) -> Plan:
    """Validates a sweep; what is not given is as the scenario's section ``sweep`` says.

    Args:
        scenario: From `load_scenario`, or what it takes: ``example:NAME``, a file, a dictionary.
        vary: Values by dotted key: a list, or a text such as ``0.1:10:20:log``; or texts
            ``KEY=VALUES`` as on the command line. They replace those of the same key in the
            scenario, and are added to the others.
        sample: grid (default), random or sobol.
        cases: How many points random and sobol draw, or a search tries; with ``over`` how many
            choices.
        seed: Of the drawing, or of the search.
        tolerance: Maximum error for iterations_to_tolerance [m].
        bands: Whether to keep quantiles of the error, iteration by iteration.
        metric: By which the cases are ranked and drawn.
        minimise: Search the ranges for the case in which this metric is smallest.
        over: Varied keys that are not chosen but happen, one by one or with commas between them:
            each choice of the others meets all of their values.
        robust: The figure of its cases by which a choice is ranked: worst (default), q95 or mean.
        happenings: How many points are drawn from the ranges of these keys; without, they are
            every combination of their values.

    Raises:
        InvalidInputError: A key or value is not valid; names every problem.
        UsageError: Nothing is varied, or the package for a search is not installed.
    """
    options = {
        "sample": sample,
        "cases": cases,
        "seed": seed,
        "tolerance": tolerance,
        "bands": bands,
        "metric": metric,
        "minimise": minimise,
        "over": ",".join([over] if isinstance(over, str) else over) if over is not None else None,
        "robust": robust,
        "happenings": happenings,
    }
    loaded = as_scenario(scenario)
    tree = _tree(
        loaded, _nodes(vary), {k: value for k, value in options.items() if value is not None}
    )
    # Which samples a run records has no effect on a sweep, and is not to limit its iterations.
    updates: dict[str, Any] = {"record": RecordSpec(), "sweep": None}
    for section in ("robot", "model"):
        below = [key.partition(".")[2] for key in _axis_nodes(tree) if root(key) == section]
        updates[section] = getattr(loaded.spec, section).with_keys(below)
    spec = loaded.spec.model_copy(update=updates)
    base = replace(loaded, spec=spec)
    try:
        asked = CompleteSweepSpec.model_validate(to_data(tree))
    except ValidationError as error:
        problems = [_told(problem) for problem in problems_of(error, tree, SweepSpec)]
        unread = {details["loc"] for details in error.errors()}
        raise InvalidInputError([*problems, *_others(base, tree, unread)]) from None
    if not asked.vary:
        raise UsageError(
            "nothing is varied; give --vary KEY=VALUES, such as --vary controller.gains.l1=0:1:11, "
            "or a section 'sweep:' in the scenario"
        )
    checked = CheckedValues(base, asked.vary, _places(tree))
    axes = {key: checked.axes[key] for key in asked.vary}
    changes = {"vary": axes, "metric": asked.minimise or asked.metric}
    plan = Plan(base, asked.model_copy(update=changes), checked.trajectories)
    _check_size(plan)
    if plan.searches:
        require_optuna()
    return plan


def _told(problem: Problem) -> Problem:
    """The problem by the key that its author has written: in the file it is below ``sweep``."""
    if problem.where.startswith(("--", "vary ")):
        return replace(problem, path=problem.path.removeprefix("vary."))
    return replace(problem, path=f"sweep.{problem.path}")


def _check_size(plan: Plan) -> None:
    tried, what = plan.spec.cases or 0, "choices" if plan.over else "cases"
    if plan.searches and tried > _MOST_TRIED:
        raise UsageError(
            f"the search has {tried:,} {what}, of which at most {_MOST_TRIED:,} can be "
            "tried; give fewer, or draw them with --sample and --cases"
        )
    cases = plan.cases.count  # more than there may be are too many for `len`
    if cases <= MOST_CASES:
        return
    if isinstance(plan.cases, CrossedCases):
        raise UsageError(
            f"{plan.cases.choices.count:,} choices with {plan.cases.happenings.count:,} happenings "
            f"are {cases:,} cases, of which at most {MOST_CASES:,} can be run; give fewer, or draw "
            "some with --cases and --happenings"
        )
    raise UsageError(
        f"the grid has {cases:,} cases, of which at most {MOST_CASES:,} can be run; "
        "give fewer values, or draw some with --sample and --cases"
    )


def _others(scenario: Scenario, tree: MapNode, unread: Collection[PathKeys]) -> list[Problem]:
    """What is wrong with the values of keys that can be read, beside those that cannot."""
    axes = {}
    for key, node in _axis_nodes(tree).items():
        with suppress(ValueError):
            if ("vary", key) not in unread:
                axes[key] = read_axis(to_data(node))
    try:
        CheckedValues(scenario, axes, _places(tree))
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
        if own.get("over") is not None:
            own["over"] = list(own["over"])
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


def _nodes(variations: Mapping[str, object] | Sequence[str]) -> dict[str, Node]:
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
