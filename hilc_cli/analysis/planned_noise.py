"""What noise makes of the wheel speeds of law norm-optimal, once it knows its platform."""

from __future__ import annotations

import numpy as np

from hilc_cli.analysis.many_passes import SEEDS, Kind, many_passes
from hilc_cli.analysis.matrices import desired_poses
from hilc_cli.analysis.wheel_noise import WheelNoise
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw, planned_rows, planned_wheels
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import step_gains


def planned_noise(experiment: Experiment, law: NormOptimalLaw) -> WheelNoise | None:
    """The wheel speeds of the law's regulator about the motion that learning leads to.

    That motion is the rectified reference of the true robot. What one pass teaches the next is left
    out: it is averaged over passes, while the regulator acts on each reading at once.

    Args:
        experiment: An experiment of the law.
        law: The law.

    Returns:
        What disturbances make of the wheels; None without any, or without a pass of the law.
    """
    source, opens = experiment.disturbance, not experiment.learn_in_first
    active = source.state.active or source.output.active or source.initial_pose.active
    if not active or (opens and not experiment.iterations):
        return None
    from hilc_cli.laws.norm_optimal.learner import (
        rectified_for,
        regulator_gains,
    )  # the compiler starts slowly

    reference, robot = experiment.reference, experiment.robot
    gains = step_gains(robot.wheel_radius, robot.signed_half_track, reference.sample_time)
    trajectory, start = desired_poses(experiment), np.array(experiment.initial_pose)
    way = rectified_for(law.parameters, trajectory, start, *gains, experiment.speed_limit)
    believed = robot if law.parameters.identify else law.model
    gains = step_gains(believed.wheel_radius, believed.signed_half_track, reference.sample_time)
    feedback = regulator_gains(law.parameters, way.motion, *gains)
    rows = planned_rows(way.inputs, feedback, way.motion - trajectory)

    def wheels(
        k: int, cos: Floats, sin: Floats, error_x: Floats, error_y: Floats, error_heading: Floats
    ) -> tuple[Floats, Floats]:
        return planned_wheels(rows[k], error_x, error_y, error_heading)

    pose = experiment.initial_pose
    kinds = [Kind(pose), Kind(pose, state=True, output=True, initial_pose=True, count=SEEDS)]
    return WheelNoise.of(*many_passes(experiment, wheels, kinds))
