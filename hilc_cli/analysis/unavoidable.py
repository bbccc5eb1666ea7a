"""What no law can avoid where the wheels are too slow for the reference."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hilc_cli.analysis.expected_error import ExpectedError
from hilc_cli.analysis.extent import extent
from hilc_cli.analysis.feasibility import Feasibility
from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.open_loop import open_loop_error, unlearned_error
from hilc_cli.analysis.outcome import CLEARLY, NEAR, STAYS
from hilc_cli.engine.experiment import Experiment
from hilc_cli.robot import Robot

_MOST_POINTS = 400  # of the reference that are looked at in pairs


def least_error(experiment: Experiment) -> float:
    """A position error that no wheel speeds within the limit can stay below [m].

    Between two samples a platform moves by the wheels' fastest speed times the time at most; where
    the reference moves further, at least half of the difference is left at one of the two. The
    second half of the path has to be reached from the initial pose.
    """
    reference = experiment.reference
    step = experiment.robot.wheel_radius * experiment.speed_limit * reference.sample_time
    if not math.isfinite(step):
        return 0.0
    samples = np.unique(np.linspace(0, reference.samples, _MOST_POINTS).astype(int))
    x, y = reference.x[samples], reference.y[samples]
    apart = np.hypot(x[:, None] - x, y[:, None] - y)
    between = (apart - step * np.abs(samples[:, None] - samples)).max() / 2
    later = samples >= reference.samples / 2
    from_start = np.hypot(x - experiment.initial_pose[0], y - experiment.initial_pose[1])
    reached = (from_start - step * samples)[later].max()
    return max(0.0, float(between), float(reached))


def with_what_is_left(
    found: Findings,
    feasibility: Feasibility,
    experiment: Experiment,
    model: Robot,
    expected: ExpectedError | None,
) -> Findings:
    """Findings of a reference that asks too much of the wheels, judged by what that leaves.

    It cannot work if no law can halve the error that is there without learning, be it that of
    iteration 0 or of the feedforward of the believed platform, or if theory says that the law will
    not. Else what is too fast is a warning: a corner that takes some samples more than it should
    leaves a small error, and everything else can be learned. What the tyres do not hold stays a
    failure.

    Args:
        found: As the limits alone have it.
        feasibility: What was looked at.
        experiment: The experiment.
        model: The platform as the controller believes it to be.
        expected: What is expected of the last iteration, if that is known.
    """
    limits = replace(feasibility.limits, wheel_speed=math.inf)
    only_wheels = replace(feasibility, limits=limits).feasible
    if not found.failures or not only_wheels:
        return found
    unlearned = unlearned_error(experiment, model)
    if not experiment.learn_in_first:
        unlearned = min(unlearned, open_loop_error(experiment))
    least, small = least_error(experiment), NEAR * extent(experiment)
    if least > max(unlearned / CLEARLY, small):
        return found
    if expected is not None and expected.unsure is None and _starts_on(experiment):
        least = max(least, expected.final_m)
        if least > max(STAYS * unlearned, small):
            return found
    if expected is not None and expected.unsure is None:
        left = f"about {max(least, expected.final_m):.2g} m of error is left"
    elif least > small:
        left = f"at least {least:.2g} m of error is left"
    else:
        left = "how much of error is left is not known (--simulate)"
    return Findings(
        warnings=(
            *(f"{text}; as it is, {left}" for text in found.failures),
            *found.warnings,
        )
    )


def _starts_on(experiment: Experiment) -> bool:
    """Whether the platform starts on the reference."""
    reference, pose = experiment.reference, experiment.initial_pose
    off = math.hypot(reference.x[0] - pose[0], reference.y[0] - pose[1])
    return off <= NEAR * extent(experiment)
