"""What a scenario file says."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from hilc_cli.disturbance.streams import Triple
from hilc_cli.spec.controllers import ControllerSpec
from hilc_cli.spec.disturbance import DisturbanceSpec
from hilc_cli.spec.model import Located, Model, Name, Text
from hilc_cli.spec.quantities import Angle, Coordinate, Iterations
from hilc_cli.spec.record import RecordSpec
from hilc_cli.spec.relations import DEFAULT_ITERATIONS, misfits
from hilc_cli.spec.robot import ModelSpec, RobotSpec
from hilc_cli.spec.sweep import SweepSpec
from hilc_cli.spec.trajectory import TrajectorySpec

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
    robot: RobotSpec
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
