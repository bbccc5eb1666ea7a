"""What disturbances make of a pass, and what learning makes of them, in sentences."""

from __future__ import annotations

import math
from typing import NamedTuple

from hilc_cli.analysis.expected_error import ExpectedError
from hilc_cli.analysis.extent import extent
from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.noise_draws import deviations
from hilc_cli.analysis.open_loop import spread_of_start
from hilc_cli.analysis.outcome import CLEARLY, NEAR
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Law
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw


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
