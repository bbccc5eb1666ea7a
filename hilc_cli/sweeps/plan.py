"""What a sweep is to compute, in full: any worker can do its part of it.

A value is validated like one in a file before anything runs, which takes about a millisecond. A
case of a sweep then only puts validated values in their place (`cases.py`).
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.errors import HilcError, InvalidInputError
from hilc_cli.numba_loading import DISABLED
from hilc_cli.reference.limits import TimingError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE, MAX_ERROR, MAX_ERROR_SECOND_HALF, PEAK
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.making import ExperimentMaker
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.scenario.sweep_section import Robust, SweepSpec, axis_text
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.sweeps.cases import CaseSpecs
from hilc_cli.sweeps.changes import TRAJECTORY, changes_path, root, validated
from hilc_cli.sweeps.data import SEED_KEY
from hilc_cli.sweeps.happenings import CrossedCases, cases_of
from hilc_cli.variation import Axis, Cases, Value, axis_to_data
from hilc_cli.version import __version__
from hilc_cli.wording import in_short, listed
from hilc_cli.yaml_input.nodes import Place, Source
from hilc_cli.yaml_input.tree import to_yaml

_WITHOUT_EFFECT = (
    "name",
    "description",
    "record",
    "sweep",
    "trajectory.name",
    "trajectory.description",
    "trajectory.closed",
)

CANNOT_BE_MADE = (HilcError, ValueError, ArithmeticError)
"""What making the experiment of a case raises if its values do not fit together."""
_MOST_SAMPLES = 1_000_000
"""The most samples of all trajectories that are kept for the cases to come."""

_FULL = 0.8
"""Share of lanes that cases on the same trajectory have to fill, to share them."""


@dataclass(frozen=True, eq=False, repr=False)
class Plan:
    """A sweep, every value validated.

    Attributes:
        scenario: With the values that are not varied.
        spec: What each key takes, whole numbers and units resolved, how cases are made of the
            keys, and what is wanted of them.
        trajectories: Of axis ``trajectory``, by name.
    """

    scenario: Scenario
    spec: SweepSpec
    trajectories: Mapping[str, TrajectorySpec] = field(default_factory=dict)

    def __reduce__(self) -> tuple[Any, ...]:
        """What a worker needs; what is kept for later cases is left behind."""
        return type(self), (self.scenario, self.spec, self.trajectories)

    def __repr__(self) -> str:
        what = "search" if self.searches else "sweep"
        title = f"Plan of a {what} of {self.name!r}: {len(self.cases)} cases"
        happen = [f"over: {listed(self.over)}"] if self.over else []
        return in_short(title, f"varied: {listed(self.axes)}", *happen)

    @property
    def name(self) -> str:
        """The scenario's name."""
        return self.scenario.name

    @property
    def axes(self) -> Mapping[str, Axis]:
        """Values by key."""
        return self.spec.vary

    @cached_property
    def in_lanes(self) -> bool:
        """Whether the batch engine does it; if not, cases run one by one and take longer."""
        specs = [self.scenario.spec]
        for key, axis in self.axes.items():
            if root(key) in ("robot", "model") or key == "controller.safety_net":
                # Of which one value may make another plant or law than another.
                specs += [self.case({key: end}).spec for end in axis.ends]
        return all(spec.in_lanes for spec in specs) and not DISABLED

    @cached_property
    def changes_path(self) -> Sequence[str]:
        """Keys on which the reference of a case may depend."""
        base = self.scenario.spec
        specs = [base.model_copy(update={TRAJECTORY: path}) for path in self.trajectories.values()]
        return [
            key for key in self.axes if any(changes_path(spec, key) for spec in specs or [base])
        ]

    @cached_property
    def own_references(self) -> bool:
        """Whether each lane of the batch engine gets a reference of its own.

        It does where cases next to each other are on different trajectories: too few on the same
        one would share lanes. It follows from the plan alone, since last digits depend on it.
        """
        keys = self.changes_path
        if not keys:
            return False
        if not isinstance(self.cases, Cases) or self.cases.sampling != "grid":
            return True
        last = max(list(self.axes).index(key) for key in keys)
        alike = math.prod(self.cases.shape[last + 1 :])
        return alike < _FULL * LANES * math.ceil(alike / LANES)

    @property
    def path_size(self) -> float:
        """Size of the trajectory [m]; the largest if several are tried."""
        spec = self.scenario.spec
        paths = self.trajectories.values() or [spec.trajectory]
        # A path's time may need the scenario's wheels.
        return max(spec.model_copy(update={"trajectory": path}).reference.size for path in paths)

    @cached_property
    def cases(self) -> Cases | CrossedCases:
        """All cases; of a search as many points drawn from its ranges, with which it begins."""
        spec, sample = self.spec, "sobol" if self.searches else self.spec.sample
        return cases_of(self.axes, sample, spec.cases or 0, spec.seed, self.over, spec.happenings)

    @property
    def over(self) -> tuple[str, ...]:
        """The varied keys that are not chosen but happen, in the order of the axes."""
        over = self.spec.over or ()
        return tuple(key for key in self.axes if key in over)

    @property
    def chosen(self) -> tuple[str, ...]:
        """The other keys, of which each combination is a choice."""
        return tuple(key for key in self.axes if key not in self.over)

    @property
    def robust(self) -> Robust:
        """The figure of its cases by which a choice is ranked."""
        return self.spec.robust or "worst"

    @property
    def choices(self) -> int:
        """How many choices there are; without keys that happen each case is one."""
        cases = self.cases
        if isinstance(cases, CrossedCases):
            return len(cases.choices)
        counts = zip(self.axes, cases.shape, strict=True) if self.over else ()
        return math.prod(n for key, n in counts if key not in self.over) if counts else len(cases)

    @property
    def happenings(self) -> int:
        """How many cases each choice has."""
        return len(self.cases) // self.choices

    @property
    def bands(self) -> bool:
        """Whether the errors of all iterations are kept: if asked for, or if seeds vary."""
        return self.spec.bands or SEED_KEY in self.axes

    @property
    def most_iterations(self) -> int:
        """The largest number of iterations of any case."""
        axis = self.axes.get("iterations")
        if axis is None:
            return self.scenario.spec.iterations
        return max(int(end) for end in axis.ends if end is not None)

    @property
    def searches(self) -> bool:
        """Whether each case follows from the results of those before it."""
        return self.spec.minimise is not None

    def case(self, values: Mapping[str, Value]) -> Scenario:
        """The scenario with these values.

        Raises:
            InvalidInputError: They do not fit together.
        """
        spec = self._spec(values)
        return replace(self.scenario, spec=spec, initial_input=self._given_input(values))

    def experiment(self, values: Mapping[str, Value]) -> Experiment:
        """The experiment with these values.

        Raises:
            InvalidInputError: They do not fit together.
            ValueError: An entry of the gain matrix is not finite.
        """
        spec, given = self._spec(values), self._given_input(values)
        try:
            reference = self._maker.reference(spec)
        except TimingError as error:
            path = ".".join(filter(None, (TRAJECTORY, "timing", error.field)))
            raise InvalidInputError.of("", path, str(error)) from None
        for at, problem, remedy in spec.controller.misfits_on(reference):
            path = ".".join(map(str, ("controller", *at)))
            raise InvalidInputError.of("", path, f"{problem}; {remedy}")
        if given is not None and len(given[0]) != reference.samples:
            message = f"has {len(given[0])} samples, but the trajectory has {reference.samples}"
            raise InvalidInputError.of("", "initial_input", message)
        return self._maker.experiment(spec, given)

    def _spec(self, values: Mapping[str, Value]) -> ScenarioSpec:
        """What the scenario of a case says."""
        of_path = {key: values[key] for key in self._path_keys if key in values}
        if not of_path:
            return self._specs.of(values)
        return self._specs.of(values, trajectory=self._trajectory(of_path))

    def _given_input(self, values: Mapping[str, Value]) -> tuple[Floats, Floats] | None:
        """The first input of a file that the scenario names, if the case has no other one."""
        return None if "initial_input" in values else self.scenario.initial_input

    def _trajectory(self, values: Mapping[str, Value]) -> TrajectorySpec:
        given = tuple(values.values())
        if given not in self._paths:
            kept = sum(path.kept_samples for path in self._paths.values())
            if kept > _MOST_SAMPLES:
                self._paths.clear()
            spec, name = self.scenario.spec, values.get(TRAJECTORY)
            if name is not None:
                spec = spec.model_copy(update={TRAJECTORY: self.trajectories[str(name)]})
            place = Place(Source("the trajectory", Path(), has_lines=False))
            changes = [(key, value, place) for key, value in values.items() if key != TRAJECTORY]
            path = validated(spec, changes).trajectory if changes else spec.trajectory
            self._paths[given] = path
        return self._paths[given]

    @cached_property
    def _path_keys(self) -> tuple[str, ...]:
        """The varied keys of the trajectory."""
        return tuple(key for key in self.axes if root(key) == TRAJECTORY)

    @cached_property
    def _specs(self) -> CaseSpecs:
        """Puts values outside the trajectory in their places."""
        others = [key for key in self.axes if root(key) != TRAJECTORY]
        return CaseSpecs(self.scenario.spec, others)

    @cached_property
    def _maker(self) -> ExperimentMaker:
        """Makes the experiments of all cases."""
        return ExperimentMaker()

    @cached_property
    def _paths(self) -> dict[tuple[Value, ...], TrajectorySpec]:
        """Trajectories of cases by what they are made of, kept for the cases to come."""
        return {}

    def warnings(self) -> list[str]:
        """What is legal but probably not meant."""
        scenario, fullest = self.scenario, self._fullest()
        # Of a law that does not learn it is warned if there is nothing to see in any case.
        found = (scenario if scenario.spec.controller.learns else fullest).warnings()
        if SEED_KEY in self.axes and not fullest.spec.disturbance.active:
            found.append("disturbance.seed varies, but there is no disturbance: all bounds are 0")
        if SEED_KEY in self.axes and self.searches and SEED_KEY not in self.over:
            found.append(
                "disturbance.seed varies: the search will find lucky disturbances, not good "
                "values; --over disturbance.seed tries each choice with all of them"
            )
        found += _followed(self)
        return found + _hidden_by_initial_error(self)

    def _fullest(self) -> Scenario:
        """The scenario with the most iterations and the largest disturbances of any case."""
        largest = {
            key: axis.ends[-1]
            for key, axis in self.axes.items()
            if key == "iterations" or (key.startswith("disturbance.") and ".bound." in key)
        }
        return self.case(largest)

    def resolved(self) -> dict[str, Any]:
        """The scenario with its sweep and its files as plain data.

        Values that follow from others, such as the model's from the robot's, are not filled in:
        they vary with those.
        """
        data = self.scenario.inlined()
        # A search has no sampling, and ranks by what it minimises.
        without = {"vary", "sample", "metric"} if self.searches else {"vary"}
        sweep = self.spec.model_dump(mode="json", exclude=without, exclude_none=True)
        sweep["vary"] = {key: axis_text(axis) for key, axis in self.axes.items()}
        if self.trajectories:
            sweep["vary"][TRAJECTORY] = [
                path.model_dump(mode="json", exclude_none=True)
                for path in self.trajectories.values()
            ]
        return {**data, "sweep": sweep}

    def resolved_yaml(self) -> str:
        """A scenario file with which ``hilc sweep`` gives the same results."""
        return to_yaml(self.resolved())

    def checksum(self) -> str:
        """SHA-256 of all that the results depend on, the version of this program included."""
        data = self.resolved()
        for key in keys_without_effect(self.scenario.spec):
            *above, last = key.split(".")
            part = data
            for name in above:
                part = part[name]
            part.pop(last, None)
        # In order: which values a case has depends on it.
        data["axes"] = [[key, axis_to_data(axis)] for key, axis in self.axes.items()]
        data["paths"] = [path.model_dump(mode="json") for path in self.trajectories.values()]
        data["bands"], data["tolerance"] = self.bands, self.spec.tolerance
        libraries = self.scenario.spec.robot.libraries
        if libraries:
            data["libraries"] = {name: version(name) for name in libraries}
        if self.searches:
            data["searched"] = [self.spec.minimise, self.spec.cases, self.spec.seed]
            data["optuna"], data["scipy"] = version("optuna"), version("scipy")
        elif self.spec.sample != "grid":
            data["drawn"] = [self.spec.sample, self.spec.cases, self.spec.seed]
        if self.over:
            data["over"] = [self.over, self.spec.robust, self.spec.happenings, self.spec.seed]
        digest = hashlib.sha256(f"{__version__}\n{json.dumps(data, sort_keys=True)}".encode())
        for wheel in self.scenario.initial_input or ():
            digest.update(wheel.tobytes())
        return digest.hexdigest()


def keys_without_effect(spec: ScenarioSpec) -> tuple[str, ...]:
    """Keys on which the results of a case do not depend."""
    return (*_WITHOUT_EFFECT, *(f"robot.{key}" for key in spec.robot.without_effect))


_START = ("initial_pose", TRAJECTORY)
_BOUND = "disturbance.initial_pose"
_NONE = 1e-9  # [m]; less is rounding


def least_initial_error(plan: Plan) -> float:
    """What the position error of the first sample is at least, in all iterations of all cases.

    Returns:
        Distance of the initial pose from the trajectory's start, less what its disturbance may
        take away [m]; 0 if cases may start from different poses.
    """
    if any(root(key) in _START or key.startswith(_BOUND) for key in plan.axes):
        return 0.0
    spec = plan.scenario.spec
    offset, bound = spec.initial_error[:2], spec.disturbance.initial_pose.bound[:2]
    return math.hypot(*(max(0.0, abs(o) - b) for o, b in zip(offset, bound, strict=True)))


def _followed(plan: Plan) -> list[str]:
    """Sizes of the robot that happen, and that the controller would know at once."""
    model = plan.scenario.spec.model
    believed = {
        "wheel_radius": model.wheel_radius is not None,
        "half_track": model.half_track is not None or model.wheel_separation is not None,
    }
    believed["wheel_separation"] = believed["half_track"]
    sizes = (key.split(".")[1] for key in plan.over if root(key) == "robot" and "." in key)
    return [
        f"robot.{size} may happen, but the controller believes whatever it is: give model.{size}"
        for size in dict.fromkeys(sizes)
        if size in believed and not believed[size] and f"model.{size}" not in plan.axes
    ]


def _hidden_by_initial_error(plan: Plan) -> list[str]:
    """Warnings of a metric or a tolerance that the initial error alone decides."""
    least, spec = least_initial_error(plan), plan.spec
    if least <= _NONE:
        return []
    option = "--metric" if spec.minimise is None else "--minimise"
    found = []
    if spec.tolerance is not None and least > spec.tolerance:
        problem = f"no case can settle within the tolerance of {spec.tolerance:g} m: "
        problem += f"its maximum error is at least the initial error of {least:.3g} m"
        if spec.metric == ITERATIONS_TO_TOLERANCE:
            problem += f"; {option} {MAX_ERROR_SECOND_HALF} tells cases apart"
        found.append(problem)
    if spec.metric in (MAX_ERROR, PEAK):
        found.append(
            f"{spec.metric} is at least the initial error of {least:.3g} m in every case, however "
            f"good it is; {option} {MAX_ERROR_SECOND_HALF} tells cases apart"
        )
    return found
