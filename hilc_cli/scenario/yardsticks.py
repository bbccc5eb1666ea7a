"""What the figures that a law tells of itself are held against."""

from __future__ import annotations

from hilc_cli.laws.norm_optimal.law import RATIO
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.results.learning import BELIEVED, MODEL, TRUE
from hilc_cli.scenario.experiment import Scenario


def yardsticks_of(scenario: Scenario) -> dict[str, dict[str, float]]:
    """Values to hold the law's figures against.

    Returns:
        By column of ``learning.csv``, and then by name: ``true``, as the robot is, ``believed``,
        as the law takes it to be at first, and what the law has of its own, such as ``h``.
    """
    controller, setting = scenario.spec.controller, scenario.setting
    robot, model = scenario.spec.robot.robot(), setting.model
    believed = setting.drivetrain or Drivetrain(model.wheel_radius, model.wheel_radius)
    known = {
        "wheel_radius_m": {TRUE: robot.wheel_radius, BELIEVED: model.wheel_radius},
        "half_track_m": {TRUE: robot.half_track, BELIEVED: model.half_track},
        RATIO: {
            TRUE: robot.wheel_radius / robot.half_track,
            BELIEVED: model.wheel_radius / model.half_track,
        },
        **{
            column: {TRUE: value, BELIEVED: believed.figures[column]}
            for column, value in scenario.spec.robot.figures().items()
        },
        **controller.yardsticks(setting),
    }
    told = {column.removeprefix(MODEL) for column in controller.figures()}
    return {column: values for column, values in known.items() if column in told}
