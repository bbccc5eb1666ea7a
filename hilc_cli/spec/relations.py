"""What parts of a scenario ask of each other, checked on those parts that are valid by themselves.

So a wrong value in one place does not hide that two others do not fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hilc_cli.robot import Robot
from hilc_cli.spec.controllers import controller_model
from hilc_cli.spec.model import Located, valid
from hilc_cli.spec.quantities import Iterations
from hilc_cli.spec.record import RecordSpec
from hilc_cli.spec.robot import ModelSpec, RobotSpec
from hilc_cli.spec.trajectory import TrajectorySpec

DEFAULT_ITERATIONS = 100


def misfits(data: Mapping[str, Any]) -> list[Located]:
    """What does not fit together in the plain data of a scenario.

    Args:
        data: The scenario, not yet validated or valid.
    """
    return [
        *_controller(data),
        *_recorded_iterations(
            valid(RecordSpec, data.get("record")),
            valid(Iterations, data.get("iterations", DEFAULT_ITERATIONS)),
        ),
    ]


def _controller(data: Mapping[str, Any]) -> list[Located]:
    """What the law's parameters ask of the trajectory and of the believed platform."""
    controller = data.get("controller")
    law = controller_model(controller)
    if law is None or not isinstance(controller, Mapping):
        return []
    trajectory = valid(TrajectorySpec, data.get("trajectory"))
    reference = None if trajectory is None else trajectory.reference()
    return [
        (("controller", *at), problem, remedy)
        for at, problem, remedy in law.relations(controller, reference, _believed(data))
    ]


def _believed(data: Mapping[str, Any]) -> Robot | None:
    robot = valid(RobotSpec, data.get("robot"))
    model = valid(ModelSpec, data.get("model") or {})
    if robot is None or model is None:
        return None
    believed: Robot = model.model(robot.robot())
    return believed


def _recorded_iterations(record: RecordSpec | None, last: int | None) -> list[Located]:
    if record is None or last is None or isinstance(record.iterations, str):
        return []
    problem = f"must be at most the last iteration, {last}"
    remedy = f"give whole numbers from 0 to {last}"
    return [
        (("record", "iterations", index), problem, remedy)
        for index, iteration in enumerate(record.iterations)
        if iteration > last
    ]
