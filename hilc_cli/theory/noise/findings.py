"""What disturbances make of a pass, and what learning makes of them, in sentences."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Law
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.feasibility.feasibility import Feasibility
from hilc_cli.theory.findings import ExpectedError, Findings, extent
from hilc_cli.theory.law_theory import knows_plant
from hilc_cli.theory.learning.outcome import CLEARLY, NEAR, STAYS
from hilc_cli.theory.noise.draws import (
    deviations,
    open_loop_error,
    spread_of_start,
    unlearned_error,
)


def share_of_path(error: float, experiment: Experiment) -> str:
    """An error as a share of the path's size, or as a multiple of it."""
    sizes = error / extent(experiment)
    share = f"{100 * sizes:.2g} % of" if sizes < 1 else f"{sizes:.3g} times"
    return f"{share} the path's size"


class Remedies(NamedTuple):
    """What a law's user can do about each disturbance, after what is done about its cause."""

    start: str
    readings: str
    state: str


def _remedies(law: Law) -> Remedies:
    """By law: only what it has, and has not done yet."""
    place, read, drive = "place the robot better", "measure better", "make it smaller"
    if isinstance(law, FeedbackLaw):
        stiffer = "raise controller.gains"
        return Remedies(
            f"{place}, or {stiffer}", f"{read}, or lower controller.gains", f"{drive}, or {stiffer}"
        )
    if isinstance(law, NormOptimalLaw):
        if law.parameters.feedback == "none":
            feedback = "set controller.feedback: lqr"
            return Remedies(
                f"{place}, or {feedback}", f"{read}, or raise iterations", f"{drive}, or {feedback}"
            )
        weights = "controller.feedback_weights"
        return Remedies(
            f"{place}, or lower {weights}",
            f"{read}, raise {weights}, or set 'feedback: none'",
            f"{drive}, or lower {weights}",
        )
    feedback = ""
    if not (isinstance(law, HybridLaw) and not law.compensation and (law.l2 > 0 or law.l3 > 0)):
        feedback = ", or take a law with feedback within the iteration"
    return Remedies(f"{place}{feedback}", "lower the gains", f"lower the gains{feedback}")


def noise_findings(
    experiment: Experiment, found: ExpectedError, *, learns: bool = True
) -> Findings:
    """Warnings of disturbances whose effect is not small beside the path.

    Args:
        experiment: With its disturbances.
        found: What each of them makes of the last iteration.
        learns: Whether the law learns from an iteration for the next one.
    """
    if found.final_m > max(CLEARLY * found.first_m, NEAR * extent(experiment)):
        return Findings()  # learning goes wrong by itself
    return Findings(
        warnings=(
            *_of_start(experiment, found),
            *_of_readings(experiment, found, learns),
            *_of_state(experiment, found),
        )
    )


def unsure_findings(experiment: Experiment, found: ExpectedError | None) -> Findings:
    """A warning where the error of the last iteration is not known beforehand.

    Args:
        experiment: The experiment.
        found: What is expected, if anything is.
    """
    if found is None or found.unsure is None:
        return Findings()
    last = f"of iteration {experiment.iterations}"
    return Findings(
        warnings=(
            f"the error {last} cannot be foretold, since {found.unsure}: see what a simulation "
            "says (--simulate), or change the gains",
        )
    )


def _of_start(experiment: Experiment, found: ExpectedError) -> list[str]:
    start = experiment.disturbance.initial_pose
    if not start.active:
        return []
    spread = float(spread_of_start(experiment.reference, start).max())
    passing = 0.0 if start.repeat else spread
    if max(passing, found.of_start_m) <= NEAR * extent(experiment):
        return []
    anew = "the same way in each iteration" if start.repeat else "anew in each iteration"
    return [
        f"disturbance.initial_pose swings the whole path: {spread:.2g} m (RMS) off where it is "
        f"worst, {share_of_path(spread, experiment)}, {anew} and before anything is learned; "
        f"{_by_the_end(found.of_start_m, spread)}; {_remedies(experiment.law).start}"
    ]


def _of_readings(experiment: Experiment, found: ExpectedError, learns: bool) -> list[str]:
    output = experiment.disturbance.output
    if not output.active or found.of_readings_m <= NEAR * extent(experiment):
        return []
    x, y, heading = deviations(output)
    read = math.hypot(x, y)
    return [
        f"disturbance.output is {'learned from' if learns else 'followed'} as if it were an error: "
        f"readings are {read:.2g} m and {heading:.2g} rad (RMS) off; "
        f"{_by_the_end(found.of_readings_m, read)}, "
        f"{share_of_path(found.of_readings_m, experiment)}; {_remedies(experiment.law).readings}"
    ]


def _of_state(experiment: Experiment, found: ExpectedError) -> list[str]:
    state = experiment.disturbance.state
    if not state.active or found.of_state_m <= NEAR * extent(experiment):
        return []
    return [
        f"disturbance.state makes up to {found.of_state_m:.2g} m of the last iteration's error, "
        f"{share_of_path(found.of_state_m, experiment)}; {_remedies(experiment.law).state}"
    ]


def _by_the_end(error: float, before: float) -> str:
    """What is left of a disturbance in the last iteration, beside what it was."""
    if before > 0 and error > 3 * before:
        return f"learning makes up to {error:.2g} m of it by the last iteration"
    return f"in the last iteration it makes up to {error:.2g} m"


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
    if not knows_plant(experiment):
        return found
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
