"""What a leaderboard file says: laws, and the cases in which they are compared."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError, WrapValidator

from hilc_cli.errors import HilcError, InvalidInputError, Problem
from hilc_cli.laws.parameters import Controller
from hilc_cli.laws.registry import OWN, ControllerSpec
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plug_ins import packages_of, trusting
from hilc_cli.reference.limits import TimingError
from hilc_cli.scenario.believed import ModelSpec
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.scenario import DisturbanceSpec, RecordSpec, ScenarioSpec
from hilc_cli.shipped_files import LEADERBOARDS, PREFIX
from hilc_cli.wording import in_short, listed
from hilc_cli.yaml_input.model import Located, Model, Name, Text
from hilc_cli.yaml_input.nodes import MapNode, Node, nearest, to_data
from hilc_cli.yaml_input.problems import located_problem, problems_of
from hilc_cli.yaml_input.quantities import (
    Iterations,
    PositiveLength,
    PositiveNumber,
    PositiveWheelSpeed,
    such_as,
)
from hilc_cli.yaml_input.reading import Inputs, mistaken


class BeliefSpec(Model):
    """What the controller believes, as shares of what is true."""

    wheel_radius: PositiveNumber = Field(1.0, description="believed by true wheel radius")
    half_track: PositiveNumber = Field(1.0, description="believed by true half track")

    def model_of(self, robot: Robot) -> ModelSpec:
        """The believed platform."""
        return ModelSpec(
            wheel_radius=self.wheel_radius * robot.wheel_radius,
            half_track=self.half_track * robot.half_track,
        )


class CaseSpec(Model):
    """A case whose robot is another one than its scenario's."""

    scenario: Text = Field(description="path of a file, or example:NAME")
    robot: dict[str, Any] = Field(
        {}, description="keys of the robot in the place of the scenario's, such as motor"
    )


def _one_case(value: object, handler: object) -> Any:
    """Validates a case against what it seems to be, so that only that is told of."""
    kind = CaseSpec if isinstance(value, Mapping | CaseSpec) else Text
    return TypeAdapter(kind).validate_python(value)


Case = Annotated[Text | CaseSpec, WrapValidator(_one_case)]


class LeaderboardSpec(Model):
    """Laws, each to be run in every case with every belief and every disturbance."""

    name: Name
    description: Text = ""
    cases: dict[Name, Case] = Field(
        min_length=1,
        description="scenarios by name, of which trajectory, robot and start are taken: "
        "paths of files, or example:NAME, or {scenario, robot} for another robot",
    )
    beliefs: dict[Name, BeliefSpec] = Field(
        {"exact": BeliefSpec()}, min_length=1, description="what the controller believes, by name"
    )
    disturbances: dict[Name, DisturbanceSpec] = Field(
        {"none": DisturbanceSpec()}, min_length=1, description="disturbances by name"
    )
    laws: dict[Name, ControllerSpec] = Field(
        min_length=1, description="controllers by name, as in a scenario"
    )
    b_w: PositiveWheelSpeed | None = Field(
        None, description="speed limit of the wheels [rad/s], of laws that say none of their own"
    )
    initial_input: Literal["zero", "feedforward"] = Field(
        "zero", description="of iteration 0: zero or feedforward"
    )
    after: Annotated[tuple[Iterations, ...], Field(min_length=1, max_length=20)] = Field(
        (1, 2, 5, 10, 100), description="iterations whose errors are told; the last one ends a run"
    )
    tolerance: Annotated[float, such_as(PositiveLength, "0.01 or 1 cm")] = Field(
        0.01, description="maximum error [m] over the second half that counts as reached"
    )

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """Numbers of iterations that do not grow."""
        found, after = super().misfits(data), data.get("after")
        numbers = after if isinstance(after, list) else []
        if all(type(number) is int for number in numbers) and numbers != sorted(set(numbers)):
            found.append((("after",), "must be numbers that grow", "sort them, each once"))
        return found


@dataclass(frozen=True, slots=True)
class Contest:
    """One law in one case: its names, and the scenario to run."""

    case: str
    belief: str
    disturbance: str
    law: str
    scenario: Scenario


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Leaderboard:
    """A valid leaderboard.

    Attributes:
        spec: What its author wrote, with defaults filled in.
        cases: Its scenarios by name.
        checksums: SHA-256 of each file that was read.
    """

    spec: LeaderboardSpec
    cases: Mapping[str, Scenario]
    checksums: Mapping[str, str]

    def __repr__(self) -> str:
        title = f"Leaderboard {self.name!r}: {self.size} runs in {len(self.cases)} cases"
        return in_short(title, f"laws: {listed(self.spec.laws)}")

    @property
    def name(self) -> str:
        """The name of the leaderboard."""
        return self.spec.name

    @property
    def size(self) -> int:
        """Number of runs."""
        spec = self.spec
        return len(spec.cases) * len(spec.beliefs) * len(spec.disturbances) * len(spec.laws)

    def resolved(self) -> dict[str, Any]:
        """All that the results depend on as plain data, but for this program."""
        data = self.spec.model_dump(mode="json", exclude={"description"})
        parts = ("trajectory", "robot", "initial_pose")
        for name, scenario in self.cases.items():
            resolved = scenario.resolved()
            data["cases"][name] = {part: resolved[part] for part in parts}
        return data

    @property
    def plug_ins(self) -> dict[str, dict[str, Any]]:
        """What is not hilc's own in its laws and cases, as manifests note it."""
        laws = [controller.law for controller in self.spec.laws.values()]
        found: dict[str, dict[str, Any]] = dict(packages_of("law", laws, OWN))
        for case in self.cases.values():
            found |= case.plug_ins
        return found

    def checksum(self) -> str:
        """SHA-256 of what tells this leaderboard from others."""
        return hashlib.sha256(json.dumps(self.resolved()).encode()).hexdigest()

    def contests(self) -> Iterator[Contest]:
        """All runs: cases in their order; of each the beliefs, the disturbances, and the laws."""
        spec = self.spec
        every = product(
            self.cases.items(), spec.beliefs.items(), spec.disturbances.items(), spec.laws.items()
        )
        for (case, scenario), (belief, believed), (disturbance, disturbed), (law, own) in every:
            changes = {
                "disturbance": disturbed,
                "iterations": max(spec.after),
                "initial_input": spec.initial_input,
                "initial_trial": None,
                "record": RecordSpec(),
                "sweep": None,
            }
            made = Scenario(_spec_of(spec, scenario, own, believed).model_copy(update=changes))
            yield Contest(case, belief, disturbance, law, made)


def _spec_of(
    spec: LeaderboardSpec, scenario: Scenario, controller: Controller, believed: BeliefSpec
) -> ScenarioSpec:
    """A case's scenario with another law and belief."""
    limit = spec.b_w if controller.b_w is None else controller.b_w
    changes = {
        "controller": controller.model_copy(update={"b_w": limit}),
        "model": believed.model_of(scenario.spec.robot.robot()),
    }
    return scenario.spec.model_copy(update=changes)


def load_leaderboard(
    source: str | Path | Mapping[str, object], *, trust: bool = False
) -> Leaderboard:
    """Reads and validates a leaderboard with the scenarios that it names.

    Args:
        source: A file, ``-`` for standard input, ``example:leaderboard``, or what would stand in a
            file as a dictionary.
        trust: Whether classes that it names as ``package.module:Class`` may be imported.

    Raises:
        InvalidInputError: It is not valid, or one of its scenarios is not; names every problem.
        UsageError: There is no such file.
        FileAccessError: A file cannot be read.
    """
    inputs = Inputs()
    tree = inputs.tree(source, LEADERBOARDS)
    assert isinstance(tree, MapNode)  # anything else has been refused
    other = mistaken(tree.entries, LEADERBOARDS)
    if other is not None:
        raise InvalidInputError.of(tree.place, "", other)
    with trusting(trust):
        try:
            spec = LeaderboardSpec.model_validate(to_data(tree))
        except ValidationError as error:
            found = problems_of(error, tree, LeaderboardSpec)
            raise InvalidInputError([*inputs.problems, *found]) from None
    if inputs.problems:
        raise InvalidInputError(inputs.problems)
    cases = _cases(spec, tree, trust)
    problems = _misfits(spec, cases, tree)
    if problems:
        raise InvalidInputError(problems)
    checksums = dict(inputs.checksums)
    for scenario in cases.values():
        checksums.update(scenario.checksums)
    return Leaderboard(spec, cases, checksums)


def _cases(spec: LeaderboardSpec, tree: Node, trust: bool) -> dict[str, Scenario]:
    """The scenarios by name; what is wrong with one is told at the place where it is named."""
    cases: dict[str, Scenario] = {}
    problems: list[Problem] = []
    for name, case in spec.cases.items():
        _, place, _ = nearest(tree, ("cases", name))
        if isinstance(case, str):
            case = CaseSpec(scenario=case)
        text, robot = case.scenario, {f"robot.{key}": part for key, part in case.robot.items()}
        where = text if text.startswith(PREFIX) else place.source.folder / text
        try:
            cases[name] = load_scenario(where, robot, trust=trust)
        except InvalidInputError as error:
            problems += [_of_case(problem, tree, name, robot) for problem in error.problems]
        except HilcError as error:
            problems.append(Problem(str(place), f"cases.{name}", str(error)))
    if problems:
        raise InvalidInputError(problems)
    return cases


def _of_case(problem: Problem, tree: Node, case: str, robot: Mapping[str, object]) -> Problem:
    """Points at what a leaderboard says of a case's robot; the rest stands in the scenario."""
    if not any(problem.where == f"override {key}" for key in robot):
        return problem
    keys = ("cases", case, *problem.path.split("."))
    return Problem(str(nearest(tree, keys)[1]), ".".join(keys), problem.message)


def _misfits(spec: LeaderboardSpec, cases: dict[str, Scenario], tree: Node) -> list[Problem]:
    """What in a law's parameters does not fit a case; each key is told of once."""
    found: dict[tuple[object, ...], Problem] = {}
    for law, controller in spec.laws.items():
        data = to_data(nearest(tree, ("laws", law))[0])
        assert isinstance(data, dict)  # it is valid
        for case, scenario in cases.items():
            for belief, believed in spec.beliefs.items():
                made = _spec_of(spec, scenario, controller, believed)
                try:
                    reference = made.reference
                except TimingError as error:
                    # The case's own law bounds its profile, this one does not.
                    problem, _, remedy = str(error).partition("; ")
                    misfits: list[Located] = [(("b_w",), problem, remedy)]
                else:
                    model = made.model.model(made.robot.robot())
                    misfits = type(controller).relations(data, reference, model)
                for at, problem, remedy in misfits:
                    keys = ("laws", law, *at)
                    told = f"{problem} (case {case}, belief {belief})"
                    found.setdefault(keys, located_problem(tree, keys, told, remedy))
    return list(found.values())
