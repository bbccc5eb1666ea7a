"""The claims of Fig. 8: what the controller must know of the platform."""

from __future__ import annotations

from hilc_cli.paper.claim import Claim, Evidence, Finding, Verdict
from hilc_cli.paper.measuring import (
    NEARLY,
    NEARLY_WORDS,
    TRACKED,
    TRACKED_WORDS,
    count,
    errors_of,
    iterations_needed_by,
    percent,
    relative_error,
    shipped,
    tracking,
)
from hilc_cli.results.metrics import settled_at

_LONG = 1000  # iterations


def _without_parameters(evidence: Evidence) -> Finding:
    error = relative_error(evidence["fig8b"])
    verdict = tracking([error])
    experiment, informed = (
        shipped(evidence.reading, "fig8b", f"iterations={_LONG}", *values)
        for values in ((), ("controller.gain_matrix=model",))
    )
    errors, with_both = errors_of([experiment, informed])
    size = experiment.reference.size
    tracked_at = settled_at(errors, TRACKED * size)
    nearly, tracked = (settled_at(with_both, share * size) for share in (NEARLY, TRACKED))
    figures = (
        percent("maximum error (8b)", error),
        percent("that with R and B, smaller scalars (8a)", relative_error(evidence["fig8a"])),
        count("iterations to 5 % (8b)", iterations_needed_by(errors, size)),
        count("iterations to 1 % (8b)", tracked_at),
        count("iterations to 5 % with R and B, scalars of 8b", nearly),
        count("iterations to 1 % with R and B, scalars of 8b", tracked),
    )
    if verdict is Verdict.HOLDS:
        return Finding(verdict, figures)
    robot = experiment.robot
    along, turning = robot.wheel_radius, robot.wheel_radius / robot.half_track
    reason = (
        "The right shape is learned, but slowly: with R = B = 1 in the matrix the same scalars are "
        f"worth R = {along:g} of a gain along the path and R / B = {turning:.2g} in turning. After "
        f"100 iterations {100 * error:.1f} % are left; 1 % is reached {_when(tracked_at)}, "
        f"with R and B and the same scalars {_when(tracked)}."
    )
    return Finding(verdict, figures, reason)


def _when(iteration: int | None) -> str:
    return f"not in {_LONG} either" if iteration is None else f"after {iteration} iterations"


def _contradicting_matrix(evidence: Evidence) -> Finding:
    run = evidence["fig8c"]
    error = relative_error(run)
    start = float(run.metrics["max_position_error_m"][0]) / run.reference.size
    figures = (percent("maximum error (8c)", error), percent("that of iteration 0", start))
    if error > NEARLY:
        return Finding(Verdict.HOLDS, figures)
    verdict = Verdict.IN_PART if error > TRACKED else Verdict.FAILS
    reason = f"It comes as near as {100 * error:.1f} % of the path's size."
    return Finding(verdict, figures, reason)


CLAIMS = (
    Claim(
        "F8-1",
        "A controller that knows neither wheel radius nor track still tracks the circle.",
        "Section 4.2.3, finding 1; Figure 8a, b; Eq. 56",
        "maximum position error of iteration 100 by the path's size",
        f"holds: {TRACKED_WORDS}; in part: {NEARLY_WORDS}",
        _without_parameters,
    ),
    Claim(
        "F8-2",
        "A gain matrix that contradicts the kinematics does not track the circle.",
        "Section 4.2.3, finding 2; Figure 8b, c; Eq. 57",
        "maximum position error of iteration 100 by the path's size",
        f"holds: more than {NEARLY:.0%}; in part: more than {TRACKED:.0%}",
        _contradicting_matrix,
    ),
)
