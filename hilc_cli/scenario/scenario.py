"""What a scenario file says."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    Field,
    PlainSerializer,
    PlainValidator,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance, Triple
from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.laws.parameters import Controller
from hilc_cli.laws.registry import ControllerSpec, controller_model
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.parameters import RobotSpec
from hilc_cli.plants.registry import RobotSection
from hilc_cli.reference.limits import TimingError, WheelLimits, Wheels
from hilc_cli.reference.sampled import Reference
from hilc_cli.scenario.believed import ModelSpec
from hilc_cli.scenario.other_words import OF_POSE
from hilc_cli.scenario.safety import SafetySpec
from hilc_cli.scenario.sweep_section import SweepSpec
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.yaml_input.expressions import PLAIN
from hilc_cli.yaml_input.model import (
    Flag,
    Located,
    Model,
    Name,
    Text,
    located,
    together,
    valid,
    wrong,
    wrong_at,
)
from hilc_cli.yaml_input.quantities import (
    Angle,
    AngleBound,
    Coordinate,
    Iterations,
    LengthBound,
    PositiveWheelSpeed,
    Quantity,
    Seed,
)

if TYPE_CHECKING:
    from hilc_cli.reference.profiled import Profile

Bounds = tuple[LengthBound, LengthBound, AngleBound]


class BoundedSpec(Model):
    """A random pose offset that never exceeds its bound."""

    bound: Bounds = Field((0.0, 0.0, 0.0), description="of x [m], y [m] and heading [rad]")
    distribution: Distribution = "uniform"
    standard_deviation: Bounds | None = Field(
        None,
        description="of truncated-normal before it is cut off at the bound; default: bound / 3",
    )
    repeat: Flag = Field(False, description="the same numbers in every iteration")

    @model_validator(mode="after")
    def _deviation_fits(self) -> Self:
        if self.standard_deviation is None:
            return self
        if self.distribution == "uniform":
            raise wrong_at(
                ("standard_deviation",),
                "has no meaning for a uniform distribution",
                "remove it or set 'distribution: truncated-normal'",
            )
        for index, (deviation, bound) in enumerate(
            zip(self.standard_deviation, self.bound, strict=True)
        ):
            if bound > 0 and deviation == 0:
                raise wrong_at(
                    ("standard_deviation", index),
                    "must be above 0",
                    "give a number above 0 or set this bound to 0",
                )
        return self

    def bounded(self) -> Bounded:
        """The offset for the engines."""
        x, y, heading = self.bound
        deviation: Triple = self.standard_deviation or (x / 3, y / 3, heading / 3)
        return Bounded(self.bound, self.distribution, deviation, self.repeat)


class DisturbanceSpec(Model):
    """Disturbances of the state (beta), the measured output (alpha) and the initial pose."""

    seed: Seed = Field(0, description="the same seed gives the same numbers everywhere")
    state: BoundedSpec = Field(BoundedSpec(), description="beta of Eq. 11, added at every step")
    output: BoundedSpec = Field(
        BoundedSpec(), description="alpha of Eq. 11: what the controller sees, not what is"
    )
    initial_pose: BoundedSpec = Field(
        BoundedSpec(), description="added to the initial pose of each iteration"
    )

    @property
    def active(self) -> bool:
        """Whether anything is disturbed."""
        sources = (self.state, self.output, self.initial_pose)
        return any(source.bounded().active for source in sources)

    def disturbance(self) -> Disturbance:
        """The disturbances for the engines."""
        return Disturbance(
            self.seed, self.state.bounded(), self.output.bounded(), self.initial_pose.bounded()
        )


EVERY_UP_TO = 5
AUTOMATIC = 24

RecordedIterations = Literal["auto", "all"] | Collection[int]


def recorded_iterations(choice: RecordedIterations, last: int) -> frozenset[int]:
    """The iterations whose samples are kept; the first and the last always are.

    ``auto`` keeps every one of the first few and then about two dozen at equal ratios, since
    learning changes the path most at the start.

    Args:
        choice: ``auto``, ``all``, or the iterations themselves.
        last: Number of the last iteration.
    """
    if choice == "all":
        return frozenset(range(last + 1))
    if choice == "auto":
        if last < AUTOMATIC:
            return frozenset(range(last + 1))
        ratios = np.geomspace(EVERY_UP_TO, last, AUTOMATIC - EVERY_UP_TO)
        kept = {*range(EVERY_UP_TO), *(round(ratio) for ratio in ratios.tolist())}
    else:
        kept = {int(iteration) for iteration in choice}
    return frozenset({0, last, *kept})


_ITERATION = Quantity(PLAIN, "100", least=0, whole=True)
_RECORD_SCHEMA: dict[str, object] = {
    "anyOf": [
        {"enum": ["auto", "all"]},
        {"type": "array", "items": {"type": "integer", "minimum": 0}},
    ]
}
_RECORD_REMEDY = "give auto, all, or a list of iterations such as [0, 10, 100]"


def _recorded(value: object) -> RecordedIterations:
    if value in ("auto", "all"):
        return value
    if not isinstance(value, list):
        raise wrong("is no choice of iterations", _RECORD_REMEDY)
    iterations: list[int] = []
    problems: list[Located] = []
    for index, item in enumerate(value):
        try:
            iterations.append(int(_ITERATION(item)))
        except PydanticCustomError as error:
            problems += [((index, *at), problem, remedy) for at, problem, remedy in located(error)]
    if problems:
        raise together(problems)
    return tuple(iterations)


class RecordSpec(Model):
    """What is kept beside the metrics, which are kept of every iteration."""

    iterations: Annotated[
        RecordedIterations,
        PlainValidator(_recorded),
        PlainSerializer(lambda choice: choice if isinstance(choice, str) else list(choice)),
        WithJsonSchema(_RECORD_SCHEMA),
    ] = Field(
        "auto", description="iterations whose samples are kept; the first and the last always are"
    )
    gravity_center: Flag = Field(
        False, description="write the path of the gravity centre (Eq. 7) as well"
    )


DEFAULT_ITERATIONS = 100


def _believed(data: Mapping[str, Any]) -> Robot | None:
    """The platform as the controller believes it to be, if that is valid."""
    robot, model = data.get("robot"), data.get("model") or ModelSpec()
    if isinstance(robot, RobotSpec) and isinstance(model, ModelSpec):
        return model.model(robot.robot())
    return None


def _wheel_limits(data: Mapping[str, Any]) -> WheelLimits | None:
    """What a timing takes of the scenario, if that is valid."""
    believed, controller = _believed(data), data.get("controller")
    law = controller_model(controller)
    if believed is None or law is None:
        return None
    limit = law.model_fields["b_w"].default
    given = controller.get("b_w") if isinstance(controller, Mapping) else controller
    if isinstance(given, Controller):
        limit = given.b_w
    elif given is not None:
        limit = valid(PositiveWheelSpeed, given)
        if limit is None:
            return None
    safety = data.get("safety") or SafetySpec()
    if not isinstance(safety, SafetySpec):
        return None
    model = data.get("model") or ModelSpec()
    return _limits_of(believed, safety.limits([limit], [model.motor.acceleration]))


def _limits_of(believed: Robot, limits: SafetyLimits) -> WheelLimits:
    wheels = Wheels(believed.wheel_radius, believed.half_track)
    return WheelLimits(wheels, limits.wheel_speed, limits.wheel_acceleration)


def _reference_of(data: Mapping[str, Any]) -> tuple[Reference | None, list[Located]]:
    """The reference of a scenario, if it has one, and why it has none."""
    trajectory = data.get("trajectory")
    if not isinstance(trajectory, TrajectorySpec):
        return None, []
    if trajectory.timing is None:
        return trajectory.reference(), []
    limits = _wheel_limits(data)
    if limits is None:
        return None, []
    try:
        return trajectory.reference(limits), []
    except TimingError as error:
        return None, [misfit_of_timing(error)]


def misfit_of_timing(error: TimingError) -> Located:
    """Returns what a timing lacks, at its key."""
    problem, _, remedy = str(error).partition("; ")
    return ("trajectory", "timing", *([error.field] if error.field else [])), problem, remedy


def _misfits_of_path(data: Mapping[str, Any]) -> list[Located]:
    """Returns what the timing lacks, and what the law asks of path and believed platform."""
    reference, misfits = _reference_of(data)
    controller = data.get("controller")
    law = controller_model(controller)
    if law is None or not isinstance(controller, Mapping):
        return misfits
    return misfits + [
        (("controller", *at), problem, remedy)
        for at, problem, remedy in law.relations(controller, reference, _believed(data))
    ]


def _misfits_of_record(data: Mapping[str, Any]) -> list[Located]:
    """Returns recorded iterations beyond the last one."""
    record = data.get("record")
    last = valid(Iterations, data.get("iterations", DEFAULT_ITERATIONS))
    if not isinstance(record, RecordSpec) or last is None or isinstance(record.iterations, str):
        return []
    problem = f"must be at most the last iteration, {last}"
    remedy = f"give whole numbers from 0 to {last}"
    return [
        (("record", "iterations", index), problem, remedy)
        for index, iteration in enumerate(record.iterations)
        if iteration > last
    ]


_OTHER_KEYS = {
    **dict.fromkeys(("laps", "passes", "trials", "repetitions"), "their number is iterations"),
    "noise": "its bounds are in disturbance.state, disturbance.output and disturbance.initial_pose",
}


class InitialPoseSpec(Model):
    """Where each iteration starts; what is left out is as in the trajectory's start."""

    other_names = OF_POSE

    x: Coordinate | None = Field(None, description="m")
    y: Coordinate | None = Field(None, description="m")
    heading: Angle | None = Field(None, description="rad")


class ScenarioSpec(Model):
    """An experiment: the reference, the plant, what the controller believes, and the law."""

    other_names = _OTHER_KEYS

    name: Name
    description: Text = ""
    trajectory: TrajectorySpec
    robot: RobotSection
    model: ModelSpec = ModelSpec()
    initial_pose: InitialPoseSpec = InitialPoseSpec()
    iterations: Iterations = Field(
        DEFAULT_ITERATIONS, description="learning updates N; iterations 0..N are run"
    )
    initial_input: Text = Field(
        "zero", description="zero, feedforward, or the path of an input CSV file"
    )
    initial_trial: Literal["open-loop", "feedback"] | None = Field(
        None,
        description="feedback: iteration 0 already runs the law; default: open-loop, "
        "but feedback with a law that does not learn",
    )
    controller: ControllerSpec
    disturbance: DisturbanceSpec = DisturbanceSpec()
    record: RecordSpec = RecordSpec()
    safety: SafetySpec | None = Field(None, description="limits of every plan for a robot")
    sweep: SweepSpec | None = Field(None, description="what 'hilc sweep' varies")

    looked_at = ("trajectory", "robot", "model", "record", "safety")

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """What does not fit together, whatever else is wrong."""
        own = super().misfits(data)
        return [*own, *_misfits_of_path(data), *_misfits_of_record(data)]

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine can run it."""
        is_ideal = self.model.drivetrain(self.robot.robot()) is None
        return self.robot.in_lanes and self.controller.in_lanes and is_ideal

    @property
    def wheel_limits(self) -> WheelLimits:
        """What the trajectory's timing takes of the believed robot."""
        believed = self.model.model(self.robot.robot())
        return _limits_of(believed, self.safety_limits)

    @property
    def safety_limits(self) -> SafetyLimits:
        """Limits of every plan for a robot, of each the smallest that is given anywhere."""
        safety, motor = self.safety or SafetySpec(), self.model.motor
        return safety.limits([self.controller.b_w], [motor.acceleration])

    @property
    def reference(self) -> Reference:
        """The sampled trajectory, as fast as its timing and this scenario's robot allow.

        Raises:
            TimingError: As for `TrajectorySpec.reference`; not in a scenario that has been read.
        """
        return self.trajectory.reference(None if self._is_timed else self.wheel_limits)

    @property
    def profile(self) -> Profile | None:
        """When it is where by its timing; None if its segments have their times."""
        return None if self._is_timed else self.trajectory.profile(self.wheel_limits)

    @property
    def _is_timed(self) -> bool:
        """Whether the segments have their times, of whatever robot."""
        return self.trajectory.timing is None

    @property
    def learns_in_first(self) -> bool:
        """Whether iteration 0 already runs the law."""
        if self.initial_trial is None:
            return not self.controller.learns
        return self.initial_trial == "feedback"

    @property
    def start_pose(self) -> Triple:
        """Pose at which each iteration starts [m, m, rad], before its disturbance."""
        given, (x, y, heading) = self.initial_pose, self.trajectory.start_pose
        return (
            x if given.x is None else given.x,
            y if given.y is None else given.y,
            heading if given.heading is None else given.heading,
        )

    @property
    def initial_error(self) -> Triple:
        """Start of the reference less the initial pose [m, m, rad]."""
        start_x, start_y, start_heading = self.trajectory.start_pose
        x, y, heading = self.start_pose
        return (start_x - x, start_y - y, start_heading - heading)
