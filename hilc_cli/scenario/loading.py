"""Makes a valid scenario of YAML, of overrides, and of the files that they name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

from pydantic import ValidationError, model_validator

from hilc_cli.errors import HilcError, InvalidInputError, Problem, UsageError
from hilc_cli.plug_ins import trusting
from hilc_cli.reference.limits import TimingError
from hilc_cli.reference.sampled import Floats
from hilc_cli.scenario.experiment import NAMED_INPUTS, Scenario
from hilc_cli.scenario.identified import with_identified
from hilc_cli.scenario.path_files import PathFile, path_notes, with_path_files
from hilc_cli.scenario.scenario import ScenarioSpec, misfit_of_timing
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.shipped_files import SCENARIOS, TRAJECTORIES
from hilc_cli.yaml_input.model import Model, model_in, together
from hilc_cli.yaml_input.nodes import (
    MapNode,
    Node,
    PathKeys,
    Place,
    Scalar,
    from_data,
    nearest,
    to_data,
    with_entry,
)
from hilc_cli.yaml_input.problems import problems_of
from hilc_cli.yaml_input.reading import (
    Inputs,
    apply_override,
    data_override,
    kind_of,
    mistaken,
    parse_override,
)

Overrides = Mapping[str, object] | Sequence[str | tuple[str, object]]
_RADII = (("robot", "wheel_radius"), ("model", "wheel_radius"))
_PATH, _PLANT = "trajectory", ("robot", "plant")
_KINDS = (SCENARIOS, TRAJECTORIES)

ScenarioSource = Scenario | str | Path | Mapping[str, object]
"""A scenario, or what one can be read from: a file, ``example:NAME``, or its content as data."""


def as_scenario(source: ScenarioSource) -> Scenario:
    """The scenario itself, or what it is read from, read.

    Raises:
        HilcError: As for `load_scenario`.
    """
    return load_scenario(source)


def refuse_overrides(name: str, overrides: Overrides) -> None:
    """Makes sure that nothing is to be changed of what has been read already.

    Raises:
        UsageError: Something is, which would be ignored.
    """
    if overrides:
        raise UsageError(
            f"{name}: has been read already, so that overrides come too late; give them to "
            "load_scenario with the file, the example or the dictionary that it was read from"
        )


def load_scenario(
    source: ScenarioSource, overrides: Overrides = (), *, trust: bool = False
) -> Scenario:
    """Reads and validates a scenario with everything that it refers to.

    Args:
        source: A file, ``-`` for standard input, ``example:NAME``, or what would stand in a file as
            a dictionary, whose paths start from the working folder. A scenario that has been read
            is returned as it is.
        overrides: Values by dotted key, or one by one in their order: pairs of both, or texts
            ``KEY=VALUE`` as on the command line.
        trust: Whether classes that the scenario names as ``package.module:Class`` may be imported.

    Raises:
        InvalidInputError: The scenario or its trajectory is not valid; names every problem.
        UsageError: There is no such file, or overrides are given of a scenario that has been read.
        FileAccessError: A file cannot be read.
    """
    if isinstance(source, Scenario):
        refuse_overrides(source.name, overrides)
        return source
    inputs = Inputs()
    return _scenario(inputs.tree(source), changes_of(overrides), inputs, trust=trust)


def load_path(
    source: str | Path | Mapping[str, object], overrides: Overrides = (), *, trust: bool = False
) -> tuple[Scenario | TrajectorySpec, tuple[str, ...]]:
    """Reads and validates a trajectory, or a scenario with everything that it refers to.

    Which of them it is follows from its keys. Of an example that there is of both kinds, the
    scenario is meant.

    Args:
        source: A file, ``-`` for standard input, ``example:NAME``, or what would stand in a file.
        overrides: As for `load_scenario`. Keys of a trajectory may do without ``trajectory.``.
        trust: As for `load_scenario`.

    Returns:
        It, and what was done to its files.

    Raises:
        InvalidInputError: The scenario or the trajectory is not valid; names every problem.
        UsageError: There is no such file.
        FileAccessError: A file cannot be read.
    """
    inputs = Inputs()
    tree = inputs.tree(source, *_KINDS)
    changes = changes_of(overrides)
    assert isinstance(tree, MapNode)  # anything else has been refused
    if kind_of(tree.entries, _KINDS) == SCENARIOS:
        scenario = _scenario(tree, changes, inputs, trust=trust)
        return scenario, tuple(scenario.notes)
    problems = [_of_scenario(keys, value) for keys, value in changes if _is_scenarios_own(keys)]
    if problems:
        raise InvalidInputError(problems)
    # As a part of a scenario, a trajectory gets the same keys, messages and files.
    whole = MapNode(tree.place, {_PATH: tree}, {_PATH: tree.place})
    for keys, value in changes:
        keys = keys if keys[0] == _PATH else (_PATH, *keys)
        whole = apply_override(whole, keys, value, lambda same: same)
    whole, files = with_path_files(whole, inputs)
    try:
        found = _Alone.model_validate(to_data(whole)).trajectory
    except ValidationError as error:
        raise InvalidInputError([*inputs.problems, *problems_of(error, whole, _Alone)]) from None
    if inputs.problems:
        raise InvalidInputError(inputs.problems)
    return found, tuple(path_notes(files, found))


class _Alone(Model):
    """A trajectory without a scenario around it."""

    trajectory: TrajectorySpec

    @model_validator(mode="after")
    def _has_its_time(self) -> Self:
        try:
            self.trajectory.reference()
        except TimingError as error:
            raise together([misfit_of_timing(error)]) from None
        return self


def _is_scenarios_own(keys: Sequence[str]) -> bool:
    """Whether a key is one of a scenario, and none of a trajectory."""
    of_scenario = ScenarioSpec.model_fields.keys() - {_PATH}
    return keys[0] in of_scenario - TrajectorySpec.model_fields.keys()


def _of_scenario(keys: Sequence[str], value: Node) -> Problem:
    message = "is a key of a scenario, and this is a trajectory; give a scenario"
    return Problem(str(value.place), ".".join(keys), message)


def _scenario(
    tree: Node, changes: Sequence[tuple[tuple[str, ...], Node]], inputs: Inputs, *, trust: bool
) -> Scenario:
    """The scenario that a tree holds after some changes."""
    assert isinstance(tree, MapNode)  # anything else has been refused
    message = mistaken(tree.entries, SCENARIOS)
    if message is not None:
        raise InvalidInputError.of(tree.place, "", message)
    for keys, value in changes:
        tree = _with_both_radii(tree, keys)
        tree = apply_override(tree, keys, value, inputs.with_trajectory, _default)
    problems: list[Problem] = []
    files: dict[int, PathFile] = {}
    try:
        tree, files = with_path_files(inputs.with_trajectory(tree), inputs)
    except InvalidInputError as error:
        problems = list(error.problems)
    tree = _with_program_folder(with_identified(tree, inputs.file))
    with trusting(trust):
        spec = _validated(tree, problems, inputs.problems)
    return Scenario(
        spec,
        _initial_input(spec, tree, inputs),
        dict(inputs.checksums),
        _sweep_places(spec, tree),
        tuple(path_notes(files, spec.trajectory, 2 * spec.robot.robot().half_track)),
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
    radius = tuple(keys[:2])
    if radius not in _RADII or len(keys) == len(radius):
        return tree
    node, place, found = nearest(tree, radius)
    if not found or not isinstance(node, Scalar) or node.value is None:
        return tree
    wheels = ("left", "right")
    both = MapNode(place, dict.fromkeys(wheels, node), dict.fromkeys(wheels, place))
    return apply_override(tree, radius, both, lambda same: same)


def _with_program_folder(tree: MapNode) -> MapNode:
    """The scenario, with the folder of the file that names its plant's program as that of it."""
    robot, plant = tree.entries.get("robot"), nearest(tree, _PLANT)[0]
    command = plant.entries.get("command") if isinstance(plant, MapNode) else None
    if not isinstance(robot, MapNode) or not isinstance(plant, MapNode) or command is None:
        return tree
    given = plant.entries.get("folder")
    below = "" if given is None else to_data(given) or ""
    if not isinstance(below, str):
        return tree  # which is told when it is validated
    place = command.place if given is None else given.place
    folder = from_data(str((place.source.folder / below).resolve()), place)
    plant = with_entry(plant, "folder", folder, place)
    robot = with_entry(robot, "plant", plant, robot.key_places["plant"])
    return with_entry(tree, "robot", robot, tree.key_places["robot"])


def changes_of(overrides: Overrides) -> list[tuple[tuple[str, ...], Node]]:
    """Keys and values of overrides.

    Raises:
        InvalidInputError: Texts are not like ``KEY=VALUE``; names every problem.
    """
    if isinstance(overrides, str):
        overrides = [overrides]
    if isinstance(overrides, Mapping):
        return [data_override(key, value) for key, value in overrides.items()]
    problems: list[Problem] = []
    changes = []
    for text in overrides:
        try:
            changes.append(parse_override(text) if isinstance(text, str) else data_override(*text))
        except InvalidInputError as error:
            problems.extend(error.problems)
    if problems:
        raise InvalidInputError(problems)
    return changes


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
    # Few scenarios start from the input of a file.
    from hilc_cli.results.reading import MAX_CSV_BYTES
    from hilc_cli.results.tables import read_input

    node = tree.entries["initial_input"]
    assert isinstance(node, Scalar)  # validated as text
    path = node.place.source.folder / spec.initial_input
    reference = spec.reference
    try:
        content = inputs.file(path, MAX_CSV_BYTES)
        return read_input(path, content, reference.samples, reference.sample_time)
    except HilcError as error:
        choices = f"{error} (initial_input is {', '.join(NAMED_INPUTS)} or such a file)"
        raise InvalidInputError.of(node.place, "initial_input", choices) from None
