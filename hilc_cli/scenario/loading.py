"""Makes a valid scenario of YAML, of overrides, and of the files that they name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from pydantic import ValidationError

from hilc_cli.errors import HilcError, InvalidInputError, Problem
from hilc_cli.plug_ins import trusting
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.reading import MAX_CSV_BYTES
from hilc_cli.results.tables import read_input
from hilc_cli.scenario.experiment import NAMED_INPUTS, Scenario
from hilc_cli.scenario.identified import with_identified
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.shipped_files import SCENARIOS
from hilc_cli.yaml_input.model import Model, model_in
from hilc_cli.yaml_input.nodes import MapNode, Node, PathKeys, Place, Scalar, nearest, to_data
from hilc_cli.yaml_input.problems import problems_of
from hilc_cli.yaml_input.reading import (
    Inputs,
    apply_override,
    data_override,
    mistaken,
    parse_override,
)

Overrides = Mapping[str, object] | Sequence[str]
_RADIUS = ("robot", "wheel_radius")


ScenarioSource = Scenario | str | Path | Mapping[str, object]
"""A scenario, or what one can be read from: a file, ``example:NAME``, or its content as data."""


def as_scenario(source: ScenarioSource) -> Scenario:
    """The scenario itself, or what it is read from, read.

    Raises:
        HilcError: As for `load_scenario`.
    """
    return source if isinstance(source, Scenario) else load_scenario(source)


def load_scenario(
    source: str | Path | Mapping[str, object], overrides: Overrides = (), *, trust: bool = False
) -> Scenario:
    """Reads and validates a scenario with everything that it refers to.

    Args:
        source: A file, ``-`` for standard input, ``example:NAME``, or what would stand in a file as
            a dictionary, whose paths start from the working folder.
        overrides: Values by dotted key, or texts ``KEY=VALUE`` as on the command line.
        trust: Whether classes that the scenario names as ``package.module:Class`` may be imported.

    Raises:
        InvalidInputError: The scenario or its trajectory is not valid; names every problem.
        UsageError: There is no such file.
        FileAccessError: A file cannot be read.
    """
    inputs = Inputs()
    tree = inputs.tree(source)
    changes = _changes(overrides)
    _check_kind(tree)
    assert isinstance(tree, MapNode)  # _check_kind
    for keys, value in changes:
        tree = _with_both_radii(tree, keys)
        tree = apply_override(tree, keys, value, inputs.with_trajectory, _default)
    problems: list[Problem] = []
    try:
        tree = inputs.with_trajectory(tree)
    except InvalidInputError as error:
        problems = list(error.problems)
    tree = with_identified(tree, inputs.file)
    with trusting(trust):
        spec = _validated(tree, problems, inputs.problems)
    return Scenario(
        spec, _initial_input(spec, tree, inputs), dict(inputs.checksums), _sweep_places(spec, tree)
    )


def _default(keys: Sequence[str]) -> object:
    """What a key of a scenario is if it is left out; None if that is nothing, or not known."""
    part: type[Model] | None = ScenarioSpec
    value: object = None
    for key in keys:
        field = None if part is None else part.model_fields.get(key)
        if field is None:
            return None
        part = model_in(field.annotation)
        value = field.get_default(call_default_factory=True)
    return value if isinstance(value, tuple) else None


def _with_both_radii(tree: MapNode, keys: Sequence[str]) -> MapNode:
    """The scenario, with its one wheel radius as that of each wheel if a key leads to one."""
    node, place, found = nearest(tree, _RADIUS)
    is_one = found and isinstance(node, Scalar) and node.value is not None
    if not is_one or tuple(keys[:2]) != _RADIUS or len(keys) == len(_RADIUS):
        return tree
    wheels = ("left", "right")
    both = MapNode(place, dict.fromkeys(wheels, node), dict.fromkeys(wheels, place))
    return apply_override(tree, _RADIUS, both, lambda same: same)


def _changes(overrides: Overrides) -> list[tuple[tuple[str, ...], Node]]:
    if isinstance(overrides, str):
        overrides = [overrides]
    if isinstance(overrides, Mapping):
        return [data_override(key, value) for key, value in overrides.items()]
    problems: list[Problem] = []
    changes = []
    for text in overrides:
        try:
            changes.append(parse_override(text))
        except InvalidInputError as error:
            problems.extend(error.problems)
    if problems:
        raise InvalidInputError(problems)
    return changes


def _check_kind(tree: Node) -> None:
    assert isinstance(tree, MapNode)  # anything else has been refused
    message = mistaken(tree.entries, SCENARIOS)
    if message is not None:
        raise InvalidInputError([Problem(str(tree.place), "", message)])


def _validated(
    tree: MapNode, trajectory_problems: list[Problem], yaml_problems: list[Problem]
) -> ScenarioSpec:
    """The scenario, if there is no problem in it and none has been found before."""
    data = to_data(tree)
    assert isinstance(data, dict)  # of a mapping
    if trajectory_problems:
        # Its problems are known; what else is wrong is to be told with them.
        del data["trajectory"]
    try:
        spec = ScenarioSpec.model_validate(data)
    except ValidationError as error:
        found = problems_of(error, tree, ScenarioSpec)
        if trajectory_problems:
            found = [problem for problem in found if problem.path != "trajectory"]
        raise InvalidInputError([*yaml_problems, *trajectory_problems, *found]) from None
    if yaml_problems:
        raise InvalidInputError(yaml_problems)
    return spec


def _sweep_places(spec: ScenarioSpec, tree: MapNode) -> dict[tuple[str, str], Place]:
    """Where each key of the section ``sweep`` stands, and the values of each varied key."""
    if spec.sweep is None:
        return {}
    places: dict[tuple[str, str], PathKeys] = {
        ("sweep", key): ("sweep", key) for key in spec.sweep.model_fields_set
    }
    places |= {("vary", key): ("sweep", "vary", key) for key in spec.sweep.vary}
    return {name: nearest(tree, keys)[1] for name, keys in places.items()}


def _initial_input(
    spec: ScenarioSpec, tree: MapNode, inputs: Inputs
) -> tuple[Floats, Floats] | None:
    """The wheel speeds of the input file that the scenario names, if it names one."""
    if spec.initial_input in NAMED_INPUTS:
        return None
    node = tree.entries["initial_input"]
    assert isinstance(node, Scalar)  # validated as text
    path = node.place.source.folder / spec.initial_input
    reference = spec.trajectory.reference()
    try:
        content = inputs.file(path, MAX_CSV_BYTES)
        return read_input(path, content, reference.samples, reference.sample_time)
    except HilcError as error:
        choices = f"{error} (initial_input is {', '.join(NAMED_INPUTS)} or such a file)"
        raise InvalidInputError([Problem(str(node.place), "initial_input", choices)]) from None
