"""What a scenario file says."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import Field

from hilc_cli.disturbance.streams import Triple
from hilc_cli.laws.registry import ControllerSpec, controller_model
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.parameters import RobotSpec
from hilc_cli.plants.registry import RobotSection
from hilc_cli.scenario.disturbance import DisturbanceSpec
from hilc_cli.scenario.record import RecordSpec
from hilc_cli.scenario.robot import ModelSpec
from hilc_cli.scenario.sweep_section import SweepSpec
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.yaml_input.model import Located, Model, Name, Text, valid
from hilc_cli.yaml_input.quantities import Angle, Coordinate, Iterations

DEFAULT_ITERATIONS = 100


def misfits(data: Mapping[str, Any]) -> list[Located]:
    """What does not fit together in the plain data of a scenario.

    Args:
        data: The scenario, not yet validated or valid.
    """
    return [
        *_controller(data),
        *_recorded_iterations(
            data.get("record"),
            valid(Iterations, data.get("iterations", DEFAULT_ITERATIONS)),
        ),
    ]


def _controller(data: Mapping[str, Any]) -> list[Located]:
    """What the law's parameters ask of the trajectory and of the believed platform."""
    controller = data.get("controller")
    law = controller_model(controller)
    if law is None or not isinstance(controller, Mapping):
        return []
    trajectory = data.get("trajectory")
    reference = trajectory.reference() if isinstance(trajectory, TrajectorySpec) else None
    return [
        (("controller", *at), problem, remedy)
        for at, problem, remedy in law.relations(controller, reference, _believed(data))
    ]


def _believed(data: Mapping[str, Any]) -> Robot | None:
    robot, model = data.get("robot"), data.get("model") or ModelSpec()
    if not isinstance(robot, RobotSpec) or not isinstance(model, ModelSpec):
        return None
    return model.model(robot.robot())


def _recorded_iterations(record: object, last: int | None) -> list[Located]:
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
    sweep: SweepSpec | None = Field(None, description="what 'hilc sweep' varies")

    looked_at = ("trajectory", "robot", "model", "record")

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """What does not fit together, whatever else is wrong."""
        return [*super().misfits(data), *misfits(data)]

    @property
    def learns_in_first(self) -> bool:
        """Whether iteration 0 already runs the law."""
        if self.initial_trial is None:
            return not self.controller.learns
        return self.initial_trial == "feedback"

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
