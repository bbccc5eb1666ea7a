"""The claims of the paper, each with what is measured and when it counts as holding."""

from __future__ import annotations

from hilc_cli.paper.claim import Claim, Evidence, Figure, Finding, Verdict

_WITHIN = 0.01  # of the path's size
_FIG3 = ("fig3-circle", "fig3-arc-and-line", "fig3-cardioid", "fig3-spiral")


def _judge_tracking(evidence: Evidence) -> Finding:
    figures, kept = [], []
    for name in _FIG3:
        run = evidence[name]
        share = run.metrics.row(-1)["max_position_error_m"] / run.reference.size
        figures.append(Figure(f"final maximum error, {run.reference.name}", 100 * share, "%"))
        kept.append(share <= _WITHIN)
    if all(kept):
        return Finding(Verdict.HOLDS, tuple(figures))
    verdict = Verdict.IN_PART if any(kept) else Verdict.FAILS
    return Finding(
        verdict,
        tuple(figures),
        f"The error stays above 1 % of the path's size on {kept.count(False)} of 4 trajectories.",
    )


def _judge_limit(evidence: Evidence) -> Finding:
    figures, kept = [], []
    for name, limited in (("fig7a", False), ("fig7b", True), ("fig7c", False), ("fig7d", True)):
        fastest = float(evidence[name].metrics["max_wheel_speed_rad_s"].max())
        figures.append(Figure(f"fastest wheel of all iterations, {name}", fastest, "rad/s"))
        kept.append((fastest <= 180.0 * (1 + 1e-12)) == limited)
    if all(kept):
        return Finding(Verdict.HOLDS, tuple(figures))
    verdict = Verdict.IN_PART if any(kept) else Verdict.FAILS
    return Finding(verdict, tuple(figures), "Not every run is on its side of 180 rad/s.")


CLAIMS: tuple[Claim, ...] = (
    Claim(
        "F3-1",
        "The P-type law tracks all four trajectories after 100 iterations",
        "Section 4.1.1, remark 1; Figure 3",
        "Maximum position error of the last iteration by the longer side of the path's box",
        "Holds if it is at most 1 % on all four trajectories, in part if on some",
        _judge_tracking,
    ),
    Claim(
        "F7-1",
        "Without the limit the speeds leave the motors' range, with it they stay inside",
        "Section 4.2.2, remark 1; Figure 7",
        "Largest wheel speed of all iterations",
        "Holds if it is above 180 rad/s in situations 7 and 9 and not in 8 and 10",
        _judge_limit,
    ),
)
