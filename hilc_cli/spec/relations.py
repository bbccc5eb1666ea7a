"""What parts of a scenario ask of each other, checked on those parts that are valid by themselves.

So a wrong value in one place does not hide that two others do not fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from hilc_cli.robot import Robot
from hilc_cli.spec.gain_matrix import GainMatrixChoice, gain_matrix
from hilc_cli.spec.model import Located, located
from hilc_cli.spec.quantities import Iterations, Samples
from hilc_cli.spec.record import RecordSpec
from hilc_cli.spec.robot import ModelSpec, RobotSpec
from hilc_cli.spec.trajectory import TrajectorySpec

DEFAULT_ITERATIONS = 100


def misfits(data: Mapping[str, Any]) -> list[Located]:
    """What does not fit together in the plain data of a scenario.

    Args:
        data: The scenario, not yet validated or valid.
    """
    controller = data.get("controller")
    controller = controller if isinstance(controller, Mapping) else {}
    return [
        *_length_of_compensation(
            _valid(TrajectorySpec, data.get("trajectory")), _valid(Samples, controller.get("h"))
        ),
        *_recorded_iterations(
            _valid(RecordSpec, data.get("record")),
            _valid(Iterations, data.get("iterations", DEFAULT_ITERATIONS)),
        ),
        *_matrix(
            _valid(GainMatrixChoice, controller.get("gain_matrix")),
            _valid(RobotSpec, data.get("robot")),
            _valid(ModelSpec, data.get("model") or {}),
        ),
    ]


def _valid(kind: Any, value: Any) -> Any:
    """The value of a part that is there and valid by itself; None otherwise."""
    if value is None:
        return None
    try:
        return TypeAdapter(kind).validate_python(value)
    except ValidationError:
        return None


def _length_of_compensation(trajectory: TrajectorySpec | None, h: int | None) -> list[Located]:
    if trajectory is None or h is None:
        return []
    samples = trajectory.reference().samples
    if h <= samples:
        return []
    problem = f"must be at most the trajectory's {samples} samples"
    return [(("controller", "h"), problem, f"give a whole number from 1 to {samples}")]


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


def _matrix(choice: Any, robot: RobotSpec | None, model: ModelSpec | None) -> list[Located]:
    """Entries that this R and B make infinite."""
    if choice is None or robot is None or model is None:
        return []
    believed: Robot = model.model(robot.robot())
    try:
        gain_matrix(choice, believed)
    except PydanticCustomError as error:
        return [
            (("controller", "gain_matrix", *at), problem, remedy)
            for at, problem, remedy in located(error)
        ]
    return []
