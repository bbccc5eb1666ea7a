"""The values of each varied key, validated where they will stand."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from hilc_cli.errors import MOST_PROBLEMS, InvalidInputError, Problem
from hilc_cli.results.tables import value_text
from hilc_cli.scenario.experiment import NAMED_INPUTS, Scenario
from hilc_cli.scenario.path_files import with_path_files
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.sweeps.cases import parts, value_at
from hilc_cli.sweeps.changes import (
    TRAJECTORY,
    Change,
    changes_path,
    root,
    scenario_of,
    validated,
    with_changes,
)
from hilc_cli.sweeps.plan import keys_without_effect
from hilc_cli.variation import Axis, Choices, Range, Value
from hilc_cli.yaml_input.nodes import Place
from hilc_cli.yaml_input.reading import Inputs

_CHOICES = {"controller.law": "law", "robot.plant": "plant"}
"""Keys that choose which others there are, and what they choose."""
_MOST_CORNERS = 64


class CheckedValues:
    """The values that a sweep puts into a scenario, validated.

    Every value of a list and both ends of a range are validated beside the first values of the
    other keys, then the corners of the box that they span, as far as these are few.

    Attributes:
        axes: The values by key, with whole numbers and units resolved.
        trajectories: Those among them, by name.

    Raises:
        InvalidInputError: A key is unknown, or a value not valid; tells all problems.
    """

    def __init__(
        self, scenario: Scenario, axes: Mapping[str, Axis], places: Mapping[str, Place]
    ) -> None:
        given = None if "initial_input" in axes else scenario.initial_input
        self.spec = scenario.spec
        self.places = places  # where the values of each key stand
        self.input_samples = None if given is None else len(given[0])
        self.axes: dict[str, Axis] = {}
        self.trajectories: dict[str, TrajectorySpec] = {}
        self.problems: list[Problem] = []
        self.add_all(axes)
        self.corners()
        if self.problems:
            raise InvalidInputError(dict.fromkeys(self.problems))

    def add_all(self, axes: Mapping[str, Axis]) -> None:
        """Validates the values of each key beside the first values of the others."""
        # What varies need not fit the scenario's trajectory, only those that it meets.
        controller = self.spec.controller
        tied = [key for key in controller.tied_to_trajectory if f"controller.{key}" in axes]
        if tied:
            controller = controller.model_copy(update=dict.fromkeys(tied))
            self.spec = self.spec.model_copy(update={"controller": controller})
        if TRAJECTORY in axes:
            self._add(TRAJECTORY, axes[TRAJECTORY])
            first = next(iter(self.trajectories.values()), self.spec.trajectory)
            self.spec = self.spec.model_copy(update={TRAJECTORY: first})
        others = {key: axis for key, axis in axes.items() if key != TRAJECTORY}
        self._start_from(
            [(key, _written_ends(axis)[0], self.places[key]) for key, axis in others.items()]
        )
        for key, axis in others.items():
            self._add(key, axis)

    def _start_from(self, changes: Sequence[Change]) -> None:
        """Puts first values into the scenario: together if they fit, otherwise those that do."""
        try:
            self.spec = validated(self.spec, changes)
        except InvalidInputError:
            if len(changes) > 1:
                for change in changes:
                    self._start_from([change])

    def _add(self, key: str, axis: Axis) -> None:
        place = self.places[key]
        try:
            without = keys_without_effect(self.spec)
            if any(key == other or key.startswith(f"{other}.") for other in without):
                message = "has no effect on the results; vary another key"
                raise InvalidInputError.of(place, key, message)
            if key in _CHOICES:
                what = _CHOICES[key]
                message = f"cannot be varied, since each {what} has parameters of its own; "
                message += f"make a scenario for each {what}"
                raise InvalidInputError.of(place, key, message)
            if key == TRAJECTORY:
                self.axes[key] = self._trajectories(axis, place)
            elif isinstance(axis, Choices):
                self.axes[key] = self._choices(key, axis, place)
            else:
                self.axes[key] = self._range(key, axis, place)
        except InvalidInputError as error:
            self.problems.extend(error.problems)

    def corners(self) -> None:
        """Validates outermost values together, if each of them is valid by itself."""
        if self.problems:
            return
        axes = {key: axis for key, axis in self.axes.items() if key != TRAJECTORY}
        every = [[(key, end, self.places[key]) for end in axis.ends] for key, axis in axes.items()]
        corners = list(itertools.islice(itertools.product(*every), _MOST_CORNERS))
        last = tuple(ends[-1] for ends in every)
        for corner in corners if last in corners else [*corners, last]:
            for path in self.trajectories.values() or [self.spec.trajectory]:
                spec = self.spec.model_copy(update={TRAJECTORY: path})
                try:
                    self._check_input(validated(spec, corner))
                except InvalidInputError as error:
                    self.problems.extend(error.problems)
                    return

    def _check_input(self, spec: ScenarioSpec) -> None:
        """Whether the scenario's input file fits the trajectory."""
        if self.input_samples is None or spec.reference.samples == self.input_samples:
            return
        key = next(key for key in self.places if changes_path(spec, key))
        message = f"has {spec.reference.samples} samples in {spec.trajectory.name}, but the initial"
        message += f" input has {self.input_samples}; set initial_input to zero or feedforward"
        at = TRAJECTORY if root(key) == TRAJECTORY else key
        raise InvalidInputError.of(self.places[key], at, message)

    def _choices(self, key: str, axis: Choices, place: Place) -> Choices:
        found: dict[Value, None] = {}
        problems: list[Problem] = []
        for value in axis.values:
            try:
                valid = self._choice(key, value, place)
            except InvalidInputError as error:
                problems.extend(error.problems)
                if len(problems) >= MOST_PROBLEMS:
                    break
                continue
            if valid in found:
                message = f"has the value {value_text(valid)} more than once; remove one"
                problems.append(Problem(str(place), key, message))
            found[valid] = None
        if problems:
            raise InvalidInputError(problems)
        return Choices(tuple(found))

    def _choice(self, key: str, value: Any, place: Place) -> Value:
        if isinstance(value, Mapping):
            message = "must hold single values, got a mapping; vary the keys below it"
            raise InvalidInputError.of(place, key, message)
        if key == "initial_input" and value not in NAMED_INPUTS:
            message = f"must be zero or feedforward in a sweep, got '{value}'"
            raise InvalidInputError.of(place, key, message)
        valid = value_at(validated(self.spec, [(key, value, place)]), parts(key))
        given: Value = value
        return valid if isinstance(valid, bool | int | float | str) else given

    def _range(self, key: str, axis: Range, place: Place) -> Range:
        ends = Choices(tuple(dict.fromkeys(_written_ends(axis))))
        found = self._choices(key, ends, place).values
        if not all(isinstance(end, int | float) and not isinstance(end, bool) for end in found):
            raise InvalidInputError.of(place, key, "takes no numbers; give a list of values")
        whole = axis.spacing != "integer" and all(isinstance(end, int) for end in found)
        return replace(axis, whole=whole)

    def _trajectories(self, axis: Axis, place: Place) -> Choices:
        inputs = Inputs()
        problems: list[Problem] = []
        for value in axis.values if isinstance(axis, Choices) else (None,):
            try:
                if not isinstance(value, str | Mapping):
                    message = "must be a list of trajectory files; give their paths"
                    raise InvalidInputError.of(place, TRAJECTORY, message)
                tree = inputs.with_trajectory(with_changes(self.spec, [(TRAJECTORY, value, place)]))
                path = scenario_of(with_path_files(tree, inputs)[0]).trajectory
                if path.name in self.trajectories:
                    message = f"has two trajectories named {path.name}; give them different names"
                    raise InvalidInputError.of(place, TRAJECTORY, message)
            except InvalidInputError as error:
                problems.extend(error.problems)
            else:
                self.trajectories[path.name] = path
        if inputs.problems or problems:
            raise InvalidInputError([*inputs.problems, *problems])
        return Choices(tuple(self.trajectories))


def _written_ends(axis: Axis) -> Sequence[Value]:
    """First and last value, or all words, as their author wrote them."""
    return axis.ends if isinstance(axis, Choices) else axis.written or axis.ends
