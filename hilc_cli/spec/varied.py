"""A scenario of which some keys change from case to case.

A value is validated like one in a file before anything runs, which takes about a millisecond. A
case of a sweep then only puts validated values in their place, which takes some microseconds.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import InvalidInputError, Problem
from hilc_cli.spec.nodes import MapNode, Node, PathKeys, Place, Scalar, Source, from_data, to_data
from hilc_cli.spec.overrides import apply_override
from hilc_cli.spec.problems import problems_of
from hilc_cli.spec.reading import Inputs
from hilc_cli.spec.record import RecordSpec
from hilc_cli.spec.scenario import ScenarioSpec
from hilc_cli.spec.trajectory import TrajectorySpec
from hilc_cli.spec.valid import NAMED_INPUTS, Scenario
from hilc_cli.variation.axes import Axis, Choices, Range, Value

_Places = dict[str | int, Any]
"""By part of a key: the whole key, or the places below."""

TRAJECTORY = "trajectory"
_WITHOUT_EFFECT = ("name", "description", "record", "sweep")
_MOST_CORNERS = 64
_MOST_PATHS = 1000
"""Trajectories that are kept for the cases to come."""


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
        self._places = _places(key for key in self.axes if _root(key) != TRAJECTORY)

    def __reduce__(self) -> tuple[Any, ...]:
        """What a worker needs; what is kept for later cases is left behind."""
        return Varied, (self.scenario, self.axes, self.trajectories)

    def case(self, values: Mapping[str, Value]) -> Scenario:
        """The scenario with these values.

        Raises:
            InvalidInputError: They do not fit together.
        """
        spec = self.scenario.spec
        of_path = {key: value for key, value in values.items() if _root(key) == TRAJECTORY}
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
        samples = scenario.spec.trajectory.reference().samples
        h, given = scenario.spec.controller.h, scenario.initial_input
        if h is not None and h > samples:
            message = f"is {h}, but the trajectory has {samples} samples"
            raise InvalidInputError([Problem("", "controller.h", message)])
        if given is not None and len(given[0]) != samples:
            message = f"has {len(given[0])} samples, but the trajectory has {samples}"
            raise InvalidInputError([Problem("", "initial_input", message)])
        return scenario.experiment()

    def _trajectory(self, values: Mapping[str, Value]) -> TrajectorySpec:
        given = tuple(values.values())
        if given not in self._paths:
            if len(self._paths) >= _MOST_PATHS:
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
        return _validated(spec, [(key, value, place) for key, value in changes]).trajectory


def vary(scenario: Scenario, axes: Mapping[str, Axis], places: Mapping[str, Place]) -> Varied:
    """Checks the values that a sweep puts into a scenario.

    Every value of a list and both ends of a range are validated by themselves, then the corners
    of the box that they span, as far as these are few. All problems are told.

    Args:
        scenario: The scenario.
        axes: Values by dotted key.
        places: Where the values of each key stand, for messages and relative paths.

    Raises:
        InvalidInputError: A key is unknown, or a value not valid.
    """
    # Which samples a run records has no effect on a sweep, and is not to limit its iterations.
    spec = scenario.spec.model_copy(update={"record": RecordSpec(), "sweep": None})
    base = replace(scenario, spec=spec)
    checked = _Checked(spec)
    for key, axis in axes.items():
        checked.add(key, axis, places[key])
    checked.corners(places)
    if checked.problems:
        raise InvalidInputError(dict.fromkeys(checked.problems))
    return Varied(base, checked.axes, checked.trajectories)


class _Checked:
    """The axes found valid so far."""

    def __init__(self, spec: ScenarioSpec) -> None:
        self.spec = spec
        self.axes: dict[str, Axis] = {}
        self.trajectories: dict[str, TrajectorySpec] = {}
        self.problems: list[Problem] = []

    def add(self, key: str, axis: Axis, place: Place) -> None:
        """Validates the values of one key by themselves."""
        try:
            if _root(key) in _WITHOUT_EFFECT:
                message = "has no effect on the results; vary another key"
                raise InvalidInputError([Problem(str(place), key, message)])
            if key == TRAJECTORY:
                self.axes[key] = self._trajectories(axis, place)
            elif isinstance(axis, Choices):
                self.axes[key] = self._choices(key, axis, place)
            else:
                self.axes[key] = self._range(key, axis, place)
        except InvalidInputError as error:
            self.problems.extend(error.problems)

    def corners(self, places: Mapping[str, Place]) -> None:
        """Validates outermost values together, if each of them is valid by itself."""
        axes = {key: axis for key, axis in self.axes.items() if key != TRAJECTORY}
        if self.problems or len(axes) + len(self.trajectories) < 2:
            return
        every = [[(key, end, places[key]) for end in axis.ends] for key, axis in axes.items()]
        corners = itertools.islice(itertools.product(*every), _MOST_CORNERS)
        for corner in (*corners, tuple(ends[-1] for ends in every)):
            for path in self.trajectories.values() or [self.spec.trajectory]:
                spec = self.spec.model_copy(update={TRAJECTORY: path})
                try:
                    _validated(spec, corner)
                except InvalidInputError as error:
                    self.problems.extend(error.problems)
                    return

    def _choices(self, key: str, axis: Choices, place: Place) -> Choices:
        found: list[Value] = []
        for value in axis.values:
            if key == "initial_input" and value not in NAMED_INPUTS:
                message = f"must be zero or feedforward in a sweep, got '{value}'"
                raise InvalidInputError([Problem(str(place), key, message)])
            valid = _value_at(_validated(self.spec, [(key, value, place)]), _keys(key))
            found.append(valid if isinstance(valid, bool | int | float | str) else value)
        twice = next((value for value in found if found.count(value) > 1), None)
        if twice is not None:
            message = f"has the value {twice} more than once; remove one"
            raise InvalidInputError([Problem(str(place), key, message)])
        return Choices(tuple(found))

    def _range(self, key: str, axis: Range, place: Place) -> Range:
        ends: Sequence[Value] = axis.written or axis.ends
        found = [_value_at(_validated(self.spec, [(key, end, place)]), _keys(key)) for end in ends]
        if not all(isinstance(end, int | float) and not isinstance(end, bool) for end in found):
            message = "takes no numbers; give a list of values"
            raise InvalidInputError([Problem(str(place), key, message)])
        whole = axis.spacing != "integer" and all(isinstance(end, int) for end in found)
        return replace(axis, whole=whole)

    def _trajectories(self, axis: Axis, place: Place) -> Choices:
        inputs = Inputs()
        for value in axis.values if isinstance(axis, Choices) else (None,):
            if not isinstance(value, str):
                message = "must be a list of trajectory files"
                raise InvalidInputError([Problem(str(place), TRAJECTORY, message)])
            tree = inputs.with_trajectory(_tree(self.spec, [(TRAJECTORY, value, place)]))
            path = _model(tree).trajectory
            if path.name in self.trajectories:
                message = f"has two trajectories named {path.name}; give them different names"
                raise InvalidInputError([Problem(str(place), TRAJECTORY, message)])
            self.trajectories[path.name] = path
        if inputs.problems:
            raise InvalidInputError(inputs.problems)
        return Choices(tuple(self.trajectories))


def _validated(spec: ScenarioSpec, changes: Sequence[tuple[str, Value, Place]]) -> ScenarioSpec:
    """The scenario with values put in as by ``--set``."""
    return _model(_tree(spec, changes))


def _tree(spec: ScenarioSpec, changes: Sequence[tuple[str, Value, Place]]) -> MapNode:
    place = changes[0][2] if changes else Place(Source("", Path(), has_lines=False))
    tree: Node = from_data(spec.model_dump(mode="json", exclude_none=True), place)
    assert isinstance(tree, MapNode)  # of a model
    for key, value, where in changes:
        node = Scalar(where, value, "null" if value is None else str(value))
        tree = apply_override(tree, tuple(key.split(".")), node, lambda same: same)
    return tree


def _model(tree: MapNode) -> ScenarioSpec:
    try:
        return ScenarioSpec.model_validate(to_data(tree))
    except ValidationError as error:
        raise InvalidInputError(problems_of(error, tree, ScenarioSpec)) from None


def _root(key: str) -> str:
    return key.partition(".")[0]


def _keys(key: str) -> PathKeys:
    return tuple(int(part) if part.isdecimal() else part for part in key.split("."))


def _value_at(part: Any, keys: PathKeys) -> Any:
    for key in keys:
        part = getattr(part, str(key)) if isinstance(part, BaseModel) else part[key]
    return part


def _places(keys: Iterable[str]) -> _Places:
    """Keys as a tree: what they have in common is then gone through once."""
    tree: _Places = {}
    for key in keys:
        branch = tree
        *above, last = _keys(key)
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
            changes[at] = values[place]
        else:
            below = getattr(part, str(at)) if isinstance(part, BaseModel) else part[at]
            changes[at] = _with_values(below, place, values)
    if isinstance(part, BaseModel):
        return part.model_copy(update=changes)
    return tuple(changes.get(index, old) for index, old in enumerate(part))
