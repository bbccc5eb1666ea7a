"""A sweep from what a scenario says of it and what is asked for beside that."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hilc_cli.errors import MOST_PROBLEMS, InvalidInputError, Problem, UsageError
from hilc_cli.results.tables import value_text
from hilc_cli.scenario.experiment import NAMED_INPUTS, Scenario
from hilc_cli.scenario.loading import ScenarioSource, as_scenario
from hilc_cli.scenario.path_files import with_path_files
from hilc_cli.scenario.scenario import RecordSpec, ScenarioSpec
from hilc_cli.scenario.sweep_section import CompleteSweepSpec, SweepSpec, read_axis, shown_axis
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.sweeps.cases import parts, value_at
from hilc_cli.sweeps.happenings import CrossedCases
from hilc_cli.sweeps.plan import (
    TRAJECTORY,
    Change,
    Plan,
    changes_path,
    keys_without_effect,
    root,
    scenario_of,
    validated,
    with_changes,
)
from hilc_cli.sweeps.search import require_optuna
from hilc_cli.variation import Axis, Choices, Range, Value
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
from hilc_cli.yaml_input.reading import Inputs, parts_of_key

_CHOICES = {"controller.law": "law", "robot.plant": "plant"}
"""Keys that choose which others there are, and what they choose."""
_MOST_CORNERS = 64
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
    checked = _Checked(base, asked.vary, _places(tree))
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
        _Checked(scenario, axes, _places(tree))
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


class _Checked:
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
