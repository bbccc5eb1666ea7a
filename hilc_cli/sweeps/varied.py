"""A scenario of which some keys change from case to case.

A value is validated like one in a file before anything runs, which takes about a millisecond. A
case of a sweep then only puts validated values in their place, which takes some microseconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import HilcError, InvalidInputError, Problem
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.variation.axes import Axis, Value
from hilc_cli.yaml_input.nodes import MapNode, Node, PathKeys, Place, Source, from_data, to_data
from hilc_cli.yaml_input.problems import problems_of
from hilc_cli.yaml_input.reading import apply_override

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
    return as_scenario(with_changes(spec, changes), kept)


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


def as_scenario(tree: MapNode, kept: Mapping[str, BaseModel] | None = None) -> ScenarioSpec:
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


_Places = dict[str | int, Any]
"""A tree of keys: for each part the whole key, or what lies below it."""

TRAJECTORY = "trajectory"
WITHOUT_EFFECT = (
    "name",
    "description",
    "record",
    "sweep",
    "robot.gravity_center",
    "robot.friction",
    "trajectory.name",
    "trajectory.description",
    "trajectory.closed",
    "trajectory.corners",
)
"""Keys on which the results of a case do not depend."""

CANNOT_BE_MADE = (HilcError, ValueError, ArithmeticError)
"""What making the experiment of a case raises if its values do not fit together."""
_MOST_SAMPLES = 1_000_000
"""The most samples of all trajectories that are kept for the cases to come."""


@dataclass(slots=True)
class Varied:
    """A scenario and the keys that vary, all values validated.

    Attributes:
        scenario: With the values that are not varied.
        axes: Values by key, whole numbers and units resolved.
        trajectories: Of axis ``trajectory``, by name.
    """

    scenario: Scenario
    axes: Mapping[str, Axis]
    trajectories: Mapping[str, TrajectorySpec] = field(default_factory=dict)
    _paths: dict[tuple[Value, ...], TrajectorySpec] = field(default_factory=dict, repr=False)
    _places: _Places = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._places = _places(key for key in self.axes if root(key) != TRAJECTORY)

    def __reduce__(self) -> tuple[Any, ...]:
        """What a worker needs; what is kept for later cases is left behind."""
        return Varied, (self.scenario, self.axes, self.trajectories)

    def case(self, values: Mapping[str, Value]) -> Scenario:
        """The scenario with these values.

        Raises:
            InvalidInputError: They do not fit together.
        """
        spec = self.scenario.spec
        of_path = {key: value for key, value in values.items() if root(key) == TRAJECTORY}
        if of_path:
            spec = spec.model_copy(update={TRAJECTORY: self._trajectory(of_path)})
        spec = _with_values(spec, self._places, values)
        given = None if "initial_input" in values else self.scenario.initial_input
        return replace(self.scenario, spec=spec, initial_input=given)

    def experiment(self, values: Mapping[str, Value]) -> Experiment:
        """The experiment with these values.

        Raises:
            InvalidInputError: They do not fit together.
            ValueError: An entry of the gain matrix is not finite.
        """
        scenario = self.case(values)
        reference, given = scenario.spec.trajectory.reference(), scenario.initial_input
        samples = reference.samples
        for at, problem, remedy in scenario.spec.controller.misfits_on(reference):
            path = ".".join(map(str, ("controller", *at)))
            raise InvalidInputError([Problem("", path, f"{problem}; {remedy}")])
        if given is not None and len(given[0]) != samples:
            message = f"has {len(given[0])} samples, but the trajectory has {samples}"
            raise InvalidInputError([Problem("", "initial_input", message)])
        return scenario.experiment()

    def _trajectory(self, values: Mapping[str, Value]) -> TrajectorySpec:
        given = tuple(values.values())
        if given not in self._paths:
            kept = sum(path.reference().samples for path in self._paths.values())
            if kept > _MOST_SAMPLES:
                self._paths.clear()
            self._paths[given] = self._new_trajectory(values)
        return self._paths[given]

    def _new_trajectory(self, values: Mapping[str, Value]) -> TrajectorySpec:
        spec = self.scenario.spec
        name = values.get(TRAJECTORY)
        if name is not None:
            spec = spec.model_copy(update={TRAJECTORY: self.trajectories[str(name)]})
        changes = [(key, value) for key, value in values.items() if key != TRAJECTORY]
        if not changes:
            return spec.trajectory
        place = Place(Source("the trajectory", Path(), has_lines=False))
        return validated(spec, [(key, value, place) for key, value in changes]).trajectory


def _places(keys: Iterable[str]) -> _Places:
    """Keys as a tree: what they have in common is then gone through once."""
    tree: _Places = {}
    for key in keys:
        branch = tree
        *above, last = parts(key)
        for part in above:
            below = branch.setdefault(part, {})
            assert isinstance(below, dict)  # no key leads into the value of another one
            branch = below
        branch[last] = key
    return tree


def _with_values(part: Any, places: _Places, values: Mapping[str, Value]) -> Any:
    """The part with validated values in their places, all else as it was."""
    changes: dict[Any, Any] = {}
    for at, place in places.items():
        if isinstance(place, str):
            if place in values:
                changes[at] = values[place]
        else:
            below = getattr(part, str(at)) if isinstance(part, BaseModel) else part[at]
            changes[at] = _with_values(below, place, values)
    if isinstance(part, BaseModel):
        return part.model_copy(update=changes)
    return tuple(changes.get(index, old) for index, old in enumerate(part))
