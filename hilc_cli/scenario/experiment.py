"""A valid scenario: as an experiment for the engines, and as resolved YAML."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from hilc_cli import plug_ins
from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.engine.robot_learning import RobotLearning, with_standstill
from hilc_cli.laws.parameters import Setting
from hilc_cli.laws.registry import OWN as LAWS
from hilc_cli.plants.registry import OWN as PLANTS
from hilc_cli.reference.sampled import Floats
from hilc_cli.scenario.identified import FROM
from hilc_cli.scenario.making import ExperimentMaker, first_input
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.theory.feasibility.demand import Demand, demand_of
from hilc_cli.theory.feasibility.feasibility import Feasibility, Limits
from hilc_cli.theory.feasibility.motors import acceleration_warnings, start_warnings
from hilc_cli.theory.feasibility.plausibility import implausible, is_plain
from hilc_cli.wording import in_short
from hilc_cli.yaml_input.nodes import Place
from hilc_cli.yaml_input.tree import to_yaml

NAMED_INPUTS = ("zero", "feedforward")
_FAR = 10.0  # times the size of the path, from which no robot comes to it
_MUCH = 0.1  # of a path's duration, for jumps of its curvature
INITIAL_INPUT_FILE = "initial-input.csv"
_DELAY = "model_delay_s"
"""What a law that finds out by itself how late inputs arrive tells."""
_LONGEST_DELAY = 0.4  # [s] that such a law can make up for
_ON_ARCS = 0.5  # lead of robots that drive, see `Setting.lead`


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Scenario:
    """A scenario that has been read and validated.

    Attributes:
        spec: What its author wrote, with defaults filled in.
        initial_input: Left and right wheel speeds of the input file that it names, if any.
        checksums: SHA-256 of each file that was read.
        sweep_places: Where ``("sweep", KEY)``, a key of the section ``sweep``, and ``("vary",
            KEY)``, the values of a varied key, stand.
        notes: What was done to the points of the path files that it names, one line each.
    """

    spec: ScenarioSpec
    initial_input: tuple[Floats, Floats] | None = None
    checksums: Mapping[str, str] = field(default_factory=dict)
    sweep_places: Mapping[tuple[str, str], Place] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        spec = self.spec
        title = f"Scenario {self.name!r}: {spec.trajectory.name}, {spec.iterations} iterations"
        return in_short(title, self.law_in_words)

    @property
    def name(self) -> str:
        """The scenario's name."""
        return self.spec.name

    @property
    def compensates(self) -> bool:
        """The position of Fig. 2's switch: whether the run compensates an initial error."""
        return self.spec.controller.compensates(self.setting)

    @property
    def law_in_words(self) -> str:
        """The law and its gains, in one line."""
        return self.spec.controller.in_words(self.setting)

    @property
    def plug_ins(self) -> dict[str, dict[str, Any]]:
        """What is not hilc's own in it, as manifests note it: package and version, or command."""
        law, robot = self.spec.controller.law, self.spec.robot
        found: dict[str, dict[str, Any]] = dict(plug_ins.packages_of("law", [law], LAWS))
        program = robot.program
        if program is None:
            return found | plug_ins.packages_of("plant", [robot.plant_name], PLANTS)
        return found | {robot.plant_name: program}

    @property
    def speed_limit(self) -> float | None:
        """b_w [rad/s]; None for no limit."""
        return self.spec.controller.b_w

    def experiment(self) -> Experiment:
        """The scenario with every number resolved."""
        return ExperimentMaker().experiment(self.spec, self.initial_input)

    def learner(self) -> Learning:
        """Returns the law at work, for trials that are driven elsewhere: nothing is simulated."""
        return Learning(self.experiment())

    def robot_learning(self) -> RobotLearning:
        """Returns the law at work on a real robot: its plans are within all limits."""
        spec, lead_in = self.spec, self.lead_in
        reference = with_standstill(spec.reference, lead_in)
        setting = replace(self.setting, reference=reference, lead=_ON_ARCS)
        left, right = (
            np.concatenate([np.zeros(reference.samples - len(wheel)), wheel])
            for wheel in first_input(spec, self.initial_input, setting)
        )
        limits = spec.safety_limits
        experiment = replace(
            self.experiment(),
            reference=reference,
            law=spec.controller.law_on(setting),
            initial_left=left,
            initial_right=right,
            speed_limit=limits.wheel_speed,
        )
        return RobotLearning(experiment, limits, lead_in)

    @property
    def lead_in(self) -> int:
        """Samples of standstill before a robot's trajectory, for inputs that arrive late."""
        longest = self.spec.model.motor.delay
        if _DELAY in self.spec.controller.figures():
            longest = max(longest, _LONGEST_DELAY)
        return math.ceil(longest / self.spec.trajectory.sample_time - 1e-9)

    @property
    def setting(self) -> Setting:
        """What the law may depend on beside its own parameters."""
        return ExperimentMaker().setting(self.spec)

    def warnings(self) -> list[str]:
        """What is legal but probably not meant."""
        demand = self.feasibility().demand
        found = [*self._implausible(demand), *self.spec.trajectory.warnings()]
        found += [*self._far_away(demand), *self.spec.controller.warnings(self.setting)]
        found += [*self._without_learning(), *self._slow_joints(), *self._of_motors(demand)]
        if abs(self.spec.initial_error[2]) > math.pi:
            heading = self.spec.start_pose[2]
            meant = f"; {heading:g} deg?" if is_plain(heading) else ""
            found.append(
                "initial_pose.heading differs by more than half a turn from the trajectory's "
                f"start; headings are not wrapped, so the robot will turn all the way back{meant}"
            )
        return found

    def _implausible(self, demand: Demand) -> list[str]:
        """Numbers that hardly anybody means."""
        spec, robot = self.spec, self.spec.robot.robot()
        headings = {"trajectory.start.heading": spec.trajectory.start_pose[2]}
        for index, segment in enumerate(spec.trajectory.segments):
            if segment.spline is not None and segment.spline.heading is not None:
                headings[f"trajectory.segments.{index}.spline.heading"] = segment.spline.heading
        if spec.initial_pose.heading is not None:
            headings["initial_pose.heading"] = spec.initial_pose.heading
        return implausible(demand, robot, spec.model.model(robot), headings)

    def _far_away(self, demand: Demand) -> list[str]:
        """A start that lies where the path does not, such as at 0 beside points in UTM."""
        x, y, _ = self.spec.trajectory.start_pose
        distance = math.hypot(*self.spec.initial_error[:2])
        size = max(demand.extent, 2 * self.spec.robot.robot().half_track)
        if distance <= _FAR * size:
            return []
        return [
            f"initial_pose is {distance:.4g} m from the trajectory's start at ({x:.9g}, {y:.9g}), "
            f"{distance / size:.2g} times the size of the path; give it in the path's coordinates"
        ]

    def _of_motors(self, demand: Demand) -> list[str]:
        """What motors, real or believed ones, cannot follow."""
        spec, drivetrain = self.spec, self.setting.drivetrain
        limits = {"robot.motor.acceleration": spec.robot.wheel_acceleration}
        if drivetrain is not None:
            limits["model.motor.acceleration"] = drivetrain.motor.acceleration
        key = min(limits, key=lambda key: limits[key])
        if drivetrain is None and limits[key] == math.inf:
            return []
        found = acceleration_warnings(demand, spec.robot.mean_wheel_radius, key, limits[key])
        return found if drivetrain is None else [*found, *start_warnings(demand, drivetrain.motor)]

    def _slow_joints(self) -> list[str]:
        """Jumps of the curvature that wheels can follow only nearly at rest."""
        profile = self.spec.profile
        if profile is None or profile.time_lost <= _MUCH * profile.fastest:
            return []
        worst = max(profile.jumps, key=lambda jump: round(jump.time_lost, 9))  # the first of them
        places, segments = len(profile.jumps), self.spec.trajectory.segment_names
        among = f", most of {places}" if places > 1 else ""
        return [
            f"trajectory.{segments[worst.segment]}: the curvature jumps by {worst.jump:.3g}/m "
            f"{worst.position:.4g} m along, which the wheels pass at {worst.speed:.3g} m/s for "
            f"timing.wheel_acceleration{among}; such jumps take {profile.time_lost:.3g} of "
            f"{profile.fastest:.4g} s: lead over by clothoids, or a spline"
        ]

    def _without_learning(self) -> list[str]:
        """What a law that does not learn makes no use of."""
        spec, law = self.spec, self.spec.controller
        if law.learns:
            return []
        found = []
        if spec.iterations > 1 and not spec.disturbance.active:
            found.append(
                f"all iterations will be the same: law {law.law} does not learn, and nothing is "
                "disturbed; set 'iterations: 0' for one"
            )
        if spec.learns_in_first and spec.initial_input != "zero":
            found.append(
                f"initial_input is not used: law {law.law} does not learn; "
                "set 'initial_trial: open-loop' to see it in iteration 0"
            )
        return found

    def feasibility(self) -> Feasibility:
        """What the trajectory demands of wheels and tyres, beside what they can do.

        Where numbers leave the range of floating point, they end as infinite: above any limit.
        """
        spec, robot = self.spec, self.spec.robot.robot()
        limit = math.inf if self.speed_limit is None else self.speed_limit
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            demand = demand_of(spec.reference, robot, spec.trajectory.segment_names)
        limits = Limits(limit, spec.robot.friction, spec.robot.wheel_load)
        return Feasibility(demand, robot, limits, profiled=spec.trajectory.timing is not None)

    def resolved(self) -> dict[str, Any]:
        """The scenario as plain data with every default, file and relation filled in."""
        spec = self.spec
        data = spec.model_dump(mode="json", exclude={"sweep"})
        robot = spec.robot.robot()
        model = spec.model.model(robot)
        data["trajectory"] = spec.trajectory.model_dump(mode="json", exclude_none=True)
        timing = spec.trajectory.timing
        if timing is not None:
            limits = spec.wheel_limits
            own = {
                "wheel_speed": limits.wheel_speed,
                "wheel_acceleration": limits.wheel_acceleration,
            }
            left_out = {
                key: limit
                for key, limit in own.items()
                if getattr(timing, key) is None and math.isfinite(limit)
            }
            limited = timing.model_copy(update=left_out)
            data["trajectory"]["timing"] = limited.model_dump(mode="json", exclude_none=True)
        if spec.safety is None:
            del data["safety"]
        data["robot"] = spec.robot.resolved()
        data["model"]["half_track"] = model.half_track
        del data["model"]["wheel_separation"]
        _without_usual(data, spec)
        drivetrain = spec.model.drivetrain(robot)
        data["model"]["wheel_radius"] = (
            model.wheel_radius
            if drivetrain is None or drivetrain.left_radius == drivetrain.right_radius
            else {"left": drivetrain.left_radius, "right": drivetrain.right_radius}
        )
        del data["model"][FROM]  # its numbers are in its place
        data["initial_pose"] = dict(zip(("x", "y", "heading"), spec.start_pose, strict=True))
        if self.initial_input is not None:
            data["initial_input"] = INITIAL_INPUT_FILE
        data["initial_trial"] = "feedback" if spec.learns_in_first else "open-loop"
        data["controller"] = spec.controller.resolved(spec.reference)
        for source in ("state", "output", "initial_pose"):
            disturbance = data["disturbance"][source]
            if disturbance["distribution"] == "uniform":
                del disturbance["standard_deviation"]
            else:
                bounded = getattr(spec.disturbance, source).bounded()
                disturbance["standard_deviation"] = list(bounded.deviation)
        return data

    def inlined(self) -> dict[str, Any]:
        """The scenario as plain data with its files in it.

        What its author has left out to follow from other values is left out here too.
        """
        data = self.spec.model_dump(mode="json", exclude={"sweep"}, exclude_none=True)
        if self.initial_input is not None:
            data["initial_input"] = INITIAL_INPUT_FILE
        _without_usual(data, self.spec)
        return data

    def resolved_yaml(self) -> str:
        """The resolved scenario as a scenario file that gives the same results."""
        return to_yaml(self.resolved())


def _without_usual(data: dict[str, Any], spec: ScenarioSpec) -> None:
    """Leaves out of a scenario what its robot and its model have as those of every scenario."""
    for section, part in (("robot", spec.robot), ("model", spec.model)):
        for key in part.only_if_given:
            if getattr(part, key) == type(part).model_fields[key].default:
                data[section].pop(key, None)


# Shown elsewhere: the speed limit is a figure of its own, the switch has a text of its own.
_ELSEWHERE = frozenset({"law", "b_w", "compensation", "switch_tolerance"})

# To the paper's law, which is told without them.
_ADDED = frozenset({"lateral", "derivative"})


def settings_of(scenario: Scenario) -> dict[str, str]:
    """Law, gains and start of a scenario, as a table of several runs tells them.

    Returns:
        ``law`` by its name; ``gains``, such as ``l1=0.5 l2=0 l3=0``: the law's own numbers, and
        its choices that are not the default ones; ``compensation``, on or off, of a law that has
        one; ``start_offset`` from the trajectory's start, in m and rad, if there is one.
    """
    controller = scenario.resolved()["controller"]
    fields = type(scenario.spec.controller).model_fields
    switched = "compensation" in controller
    left_out = _ELSEWHERE | ({"h"} if switched else set())
    own = {key: value for key, value in controller.items() if key not in left_out}
    numbers = _numbers(own)
    parts = [f"{name}={value:.10g}" for name, value in numbers if value or name not in _ADDED]
    parts += [
        f"{key}={str(value).lower() if isinstance(value, bool) else value}"
        for key, value in own.items()
        if isinstance(value, str | bool) and value != fields[key].default
    ]
    settings = {"law": str(controller["law"]), "gains": " ".join(parts)}
    if switched:
        on = f"on h={controller['h']}"
        settings["compensation"] = on if scenario.compensates else "off"
    # The initial error is the start of the reference less the initial pose.
    offset = zip(("x", "y", "heading"), scenario.spec.initial_error, ("m", "m", "rad"), strict=True)
    texts = [f"{name}={-error:.6g} {unit}" for name, error, unit in offset if error]
    if texts:
        settings["start_offset"] = " ".join(texts)
    return settings


def _numbers(data: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float]]:
    """The numbers in nested data by dotted name, without the word ``gains``."""
    for key, value in data.items():
        if isinstance(value, Mapping):
            yield from _numbers(value, above if key == "gains" else f"{above}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            yield f"{above}{key}", float(value)
