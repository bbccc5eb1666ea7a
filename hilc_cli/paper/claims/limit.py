"""The claims of Fig. 7: what the speed limit does."""

from __future__ import annotations

import numpy as np

from hilc_cli.paper.claim import Claim, Evidence, Figure, Finding, Verdict
from hilc_cli.paper.measuring import (
    NEARLY,
    count,
    errors_of,
    fewer,
    iterations_needed,
    iterations_needed_by,
    kinks,
    percent,
    relative_error,
    roughness,
    shipped,
)
from hilc_cli.results.run import RunData

_FREE, _LIMITED = ("fig7a", "fig7c"), ("fig7b", "fig7d")
_PAIRS = tuple(zip(_FREE, _LIMITED, strict=True))
_BOUND = 180.0  # u_max of Eq. 44 [rad/s]


def _fastest(run: RunData) -> float:
    return float(max(np.abs(run.last.left).max(), np.abs(run.last.right).max()))


def _limit_is_kept(evidence: Evidence) -> Finding:
    names = (*_FREE, *_LIMITED)
    speeds = {name: _fastest(evidence[name]) for name in names}
    leave = [speeds[name] > _BOUND for name in _FREE]
    of_all = {
        name: float(evidence[name].metrics["max_wheel_speed_rad_s"].max()) for name in _LIMITED
    }
    figures = (
        *(
            Figure(f"fastest wheel in iteration 100 ({name[3:]})", speeds[name], "rad/s")
            for name in names
        ),
        *(
            Figure(f"fastest wheel of all iterations ({name[3:]})", speed, "rad/s")
            for name, speed in of_all.items()
        ),
    )
    keep = [speed <= _BOUND for speed in of_all.values()]
    if all(leave) and all(keep):
        return Finding(Verdict.HOLDS, figures)
    told = [
        f"{name[3:]} stays in range without the limit, at {speeds[name]:.0f} rad/s at most"
        for name, leaves in zip(_FREE, leave, strict=True)
        if not leaves
    ]
    if not all(keep):
        told.append("with the limit the speeds leave it")
    verdict = Verdict.IN_PART if all(keep) else Verdict.FAILS
    return Finding(verdict, figures, f"{'; '.join(told).capitalize()}.")


def _fewer_iterations(evidence: Evidence) -> Finding:
    figures = [
        count(f"needed ({name[3:]})", iterations_needed(evidence[name]))
        for pair in _PAIRS
        for name in pair
    ]
    # Situations 9 and 10 differ in l1 too: the same gains tell what the limit does.
    limited = shipped(evidence.reading, "fig7c", f"controller.b_w={_BOUND:g}")
    same_gains = iterations_needed_by(errors_of([limited])[0], limited.reference.size)
    figures.append(count("needed with the gains of 7c and the limit", same_gains))
    better = [
        *(fewer(iterations_needed(evidence[b]), iterations_needed(evidence[a])) for a, b in _PAIRS),
        fewer(same_gains, iterations_needed(evidence["fig7c"])),
    ]
    if all(better):
        return Finding(Verdict.HOLDS, tuple(figures))
    verdict = Verdict.IN_PART if any(better) else Verdict.FAILS
    pairs = (*(f"{b[3:]} against {a[3:]}" for a, b in _PAIRS), "7c with it and without")
    worse = ", ".join(pair for pair, is_better in zip(pairs, better, strict=True) if not is_better)
    reason = f"The number is no lower with the limit in {worse}."
    if better[-1] and not better[1]:
        reason += " The pair 7c, 7d has another l1 as well: with the same gains it is lower."
    return Finding(verdict, tuple(figures), reason)


def _rougher_but_better(evidence: Evidence) -> Finding:
    figures: list[Figure] = []
    rougher, better = [], []
    for pair in _PAIRS:
        runs = [evidence[name] for name in pair]
        for name, run in zip(pair, runs, strict=True):
            figures += [
                Figure(f"RMS change from sample to sample ({name[3:]})", roughness(run), "rad/s"),
                Figure(f"RMS second difference ({name[3:]})", kinks(run), "rad/s"),
                percent(f"maximum error ({name[3:]})", relative_error(run)),
            ]
        free, limited = runs
        rougher += [roughness(limited) > roughness(free), kinks(limited) > kinks(free)]
        better.append(relative_error(limited) < relative_error(free))
    if all(rougher) and all(better):
        return Finding(Verdict.HOLDS, tuple(figures))
    told = []
    measures = {"RMS change": rougher[::2], "RMS second difference": rougher[1::2]}
    for measure, grows in measures.items():
        values = [
            f"{figure.value:.3g} rad/s ({figure.name[-3:-1]})"
            for figure in figures
            if figure.name.startswith(measure)
        ]
        how = "is" if all(grows) else "is not" if not any(grows) else "is not always"
        told.append(f"The {measure} {how} larger with the limit: {', '.join(values)}.")
    if rougher[1] and not rougher[0]:
        told.append(
            "The limit cuts off the waves that learning builds up without it, and puts corners "
            "where a wheel meets it."
        )
    if not all(better):
        told.append("The error is not smaller in every pair.")
    verdict = Verdict.IN_PART if any(rougher) or any(better) else Verdict.FAILS
    return Finding(verdict, tuple(figures), " ".join(told))


CLAIMS = (
    Claim(
        "F7-1",
        "Without the limit the wheel speeds leave the motors' range, with it they stay inside.",
        "Section 4.2.2, finding 1; Figure 7a2, c2 (text), a2-d2",
        "largest absolute wheel speed of iteration 100 against 180 rad/s; with the limit, of all "
        "iterations",
        "holds: beyond it in both situations without the limit, within it in both with; in part: "
        "within it with the limit only",
        _limit_is_kept,
    ),
    Claim(
        "F7-2",
        "With the limit fewer iterations are needed.",
        "Section 4.2.2, finding 2; Figure 7a3, b3, c3, d3",
        f"iterations until the error stays within {NEARLY:.0%} of the circle's size, for the two "
        "pairs of the paper and for the gains of 7c with and without limit",
        "holds: fewer with the limit in all three comparisons; in part: in some",
        _fewer_iterations,
    ),
    Claim(
        "F7-3",
        "With the limit the wheel speeds are less smooth, and the error is smaller.",
        "Section 4.2.2, finding 3; Figure 7a2-d3",
        "RMS change and RMS second difference of the wheel speeds from sample to sample, and the "
        "maximum error, of iteration 100",
        "holds: both measures of roughness are larger and the error smaller with the limit, in "
        "both pairs; in part: some of these",
        _rougher_but_better,
    ),
)
