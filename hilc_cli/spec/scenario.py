"""What a scenario file says."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, PlainSerializer, PlainValidator, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from hilc_cli.disturbance.streams import Triple
from hilc_cli.results.recording import RecordedIterations
from hilc_cli.spec.controller import HybridController
from hilc_cli.spec.disturbance import DisturbanceSpec
from hilc_cli.spec.expressions import PLAIN
from hilc_cli.spec.gain_matrix import gain_matrix
from hilc_cli.spec.model import Flag, Located, Model, Name, Text, located, together, wrong
from hilc_cli.spec.quantities import Angle, Coordinate, Iterations, Quantity
from hilc_cli.spec.robot import ModelSpec, RobotSpec
from hilc_cli.spec.trajectory import TrajectorySpec

_ITERATION = Quantity(PLAIN, "100", least=0, whole=True)
_RECORD_SCHEMA: dict[str, object] = {
    "anyOf": [
        {"enum": ["auto", "all"]},
        {"type": "array", "items": {"type": "integer", "minimum": 0}},
    ]
}
_RECORD_REMEDY = "give auto, all, or a list of iterations such as [0, 10, 100]"


class InitialPoseSpec(Model):
    """Where each iteration starts; what is left out is as in the trajectory's start."""

    x: Coordinate | None = Field(None, description="m")
    y: Coordinate | None = Field(None, description="m")
    heading: Angle | None = Field(None, description="rad")


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


class ScenarioSpec(Model):
    """An experiment: the reference, the plant, what the controller believes, and the law."""

    name: Name
    description: Text = ""
    trajectory: TrajectorySpec
    robot: RobotSpec
    model: ModelSpec = ModelSpec()
    initial_pose: InitialPoseSpec = InitialPoseSpec()
    iterations: Iterations = Field(100, description="learning updates N; iterations 0..N are run")
    initial_input: Text = Field(
        "zero", description="zero, feedforward, or the path of an input CSV file"
    )
    initial_trial: Literal["open-loop", "feedback"] = Field(
        "open-loop", description="feedback: iteration 0 already runs the law"
    )
    controller: HybridController
    disturbance: DisturbanceSpec = DisturbanceSpec()
    record: RecordSpec = RecordSpec()

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        problems: list[Located] = []
        samples = self.trajectory.reference().samples
        if self.controller.h is not None and self.controller.h > samples:
            problems.append(
                (
                    ("controller", "h"),
                    f"must be at most the trajectory's {samples} samples",
                    f"give a whole number from 1 to {samples}",
                )
            )
        if not isinstance(self.record.iterations, str):
            for index, iteration in enumerate(self.record.iterations):
                if iteration > self.iterations:
                    problems.append(
                        (
                            ("record", "iterations", index),
                            f"must be at most the last iteration, {self.iterations}",
                            f"give whole numbers from 0 to {self.iterations}",
                        )
                    )
        try:
            gain_matrix(self.controller.gain_matrix, self.model.model(self.robot.robot()))
        except PydanticCustomError as error:
            problems += [
                (("controller", "gain_matrix", *at), problem, remedy)
                for at, problem, remedy in located(error)
            ]
        if problems:
            raise together(problems)
        return self

    @property
    def start_pose(self) -> Triple:
        """Pose at which each iteration starts [m, m, rad], before its disturbance."""
        given, start = self.initial_pose, self.trajectory.start
        return (
            start.x if given.x is None else given.x,
            start.y if given.y is None else given.y,
            start.heading if given.heading is None else given.heading,
        )

    @property
    def initial_error(self) -> Triple:
        """Start of the reference less the initial pose [m, m, rad]."""
        start = self.trajectory.start
        x, y, heading = self.start_pose
        return (start.x - x, start.y - y, start.heading - heading)
