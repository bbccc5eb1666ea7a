"""Readings of the paper by its claims: an independent simulation of every situation under each.

    python benchmarks/readings.py [--json FILE] [--write | --check]

The law as printed does not do what the paper's figures are said to show. This file tries what else
may have been meant, one change at a time, and scores each reading by ten claims. It shares no code
with hilc: paths, robot, law and limit are written here once more, all situations of all readings
side by side in NumPy arrays; the engines do not learn readings that nobody would use. --write puts
the table into docs/readings.md, which says what it means; --check tells by exit code 1 that another
one stands there.

Criteria, the same for all readings, stated before measuring. An error is the largest position
error of iteration 100 as a share of the longer side of the path's bounding box; with a wrong start
over the second half of the path. Held: at most 1 %; nearly: at most 5 %. A claim scores 2 if it
holds and 1 if it holds nearly:

- F3-1, F5-1: the worst of their paths; F4-2, F8-1: the circle's.
- F4-1: an offset above 1 % all through the second half, whose standard deviation is at most 25 %
  of its mean; nearly: above it, but varying more.
- F6-1: the iterations until the error stays within 5 % fall with each l1 of 0.1, 0.2, 0.5, 1, 2, 5
  and 10, and 25, 30 and 50 end above 5 %; nearly: one of the two, or 10 needs fewer than 0.1.
- F6-2: fewer iterations in 6d, 6e, 6g and 6h than in 6a; nearly: in some.
- F7-1: in iteration 100 wheels are faster than 180 rad/s without the limit, in both situations,
  and never with it; nearly: with it only.
- F7-2: with the limit fewer iterations in 7b than in 7a, in 7d than in 7c, and with 7c's gains;
  nearly: in some.
- F8-2: more than 5 % left; nearly: more than 1 %.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SAMPLE_TIME = 0.001  # [s]
RADIUS, HALF_TRACK, LIMIT = 0.2, 0.518, 180.0  # [m], [m], [rad/s], Eq. 44
COMPENSATED = 200  # h, samples
ITERATIONS = 100
HELD, NEARLY, FIXED = 0.01, 0.05, 0.25
PI = math.pi


# --- paths: x [m], y [m], heading [rad], shape (n + 1,) each -------------------------------------


def arc(
    center: tuple[float, float], radius: float, first: float, turn: float, time: float
) -> Floats:
    """Samples 1..n of a counterclockwise arc from the angle `first` on, shape (n, 3)."""
    angles = first + turn * np.arange(1, round(time / SAMPLE_TIME) + 1) * SAMPLE_TIME / time
    x, y = center[0] + radius * np.cos(angles), center[1] + radius * np.sin(angles)
    return np.stack([x, y, angles + PI / 2], axis=1)


def line(
    start: tuple[float, float], end: tuple[float, float], heading: float, time: float
) -> Floats:
    """Samples 1..n of a line, shape (n, 3)."""
    shares = np.arange(1, round(time / SAMPLE_TIME) + 1) * SAMPLE_TIME / time
    x, y = (a + shares * (b - a) for a, b in zip(start, end, strict=True))
    return np.stack([x, y, np.full_like(x, heading)], axis=1)


def path(start: tuple[float, float, float], *parts: Floats) -> Floats:
    return np.concatenate([np.array([start]), *parts])


PATHS = {
    "circle": path((10, 0, PI / 2), arc((0, 0), 10, 0, 2 * PI, 2)),
    "arc-and-line": path(
        (5, 0, PI / 2),
        arc((0, 0), 5, 0, PI, 0.5),
        line((-5, 0), (-5, -10), 3 * PI / 2, 1),
        arc((0, -10), 5, PI, PI, 0.5),
        line((5, -10), (5, 0), 5 * PI / 2, 1),
    ),
    "cardioid": path(
        (2.5, 0, PI / 2),
        arc((0, 0), 2.5, 0, PI, 0.5),
        arc((2.5, 0), 5, PI, PI, 1),
        arc((5, 0), 2.5, 2 * PI, PI, 0.5),
    ),
    "spiral": path(
        (3, 0, PI / 2),
        arc((0, 0), 3, 0, PI, 0.5),
        arc((0.5, 0), 3.5, PI, PI, 0.5),
        arc((0, 0), 4, 2 * PI, PI, 0.5),
        arc((0, 0), 4, 3 * PI, PI, 0.5),
    ),
}
SIZES = {name: float(np.ptp(p[:, :2], axis=0).max()) for name, p in PATHS.items()}


# --- what is run ---------------------------------------------------------------------------------

Rows = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass(frozen=True)
class Situation:
    """An experiment of the paper.

    Attributes:
        name: Of the figure's panel.
        path: A key of PATHS.
        gains: l1, l2, l3.
        matrix: The number of the equation that has the gain matrix: 45, 56 or 57.
        start: Initial pose; None for the path's.
        compensated: Whether Eq. 21 is run, not Eq. 17.
        limited: Whether the wheels have the limit.
    """

    name: str
    path: str
    gains: tuple[float, float, float]
    matrix: int = 45
    start: tuple[float, float, float] | None = None
    compensated: bool = False
    limited: bool = True


def situations() -> list[Situation]:
    """All that the ten claims need."""
    found = [Situation(f"3-{name}", name, (1, 0, 0)) for name in PATHS]
    inside = (9.0, 0.0, PI / 2)
    found += [
        Situation("4a", "circle", (0.5, 0.25, 0.25), start=inside),
        Situation("4b", "circle", (0.5, 0, 0), start=inside, compensated=True),
    ]
    starts = {
        "arc-and-line": (4.0, 0.0, PI / 2),
        "cardioid": (2.0, 0.0, 14 * PI / 15),
        "spiral": (2.5, 0.0, 31 * PI / 30),
    }
    found += [
        Situation(f"5-{name}", name, (0.5, 0, 0), start=start, compensated=True)
        for name, start in starts.items()
    ]
    found += [Situation(f"l1={l1:g}", "circle", (l1, 0, 0)) for l1 in (*USEFUL, *TOO_LARGE)]
    for letter, gains in zip("degh", [(0.5, 0), (1, 0), (1, 0.1), (1, 1)], strict=True):
        found.append(Situation(f"6{letter}", "circle", (0.1, *gains)))
    slow, fast, middle = (0.1, 0.25, 0.25), (1, 0.25, 0.25), (0.5, 0.25, 0.25)
    found += [
        Situation("7a", "circle", slow, limited=False),
        Situation("7b", "circle", slow),
        Situation("7c", "circle", fast, limited=False),
        Situation("7c-limited", "circle", fast),
        Situation("7d", "circle", middle),
        Situation("8a", "circle", slow),
        Situation("8b", "circle", (1, 0.5, 0.5), 56),
        Situation("8c", "circle", slow, 57),
    ]
    return found


USEFUL, TOO_LARGE = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0), (25.0, 30.0, 50.0)


@dataclass(frozen=True)
class Reading:
    """A way to read the paper.

    Attributes:
        name: Of the reading.
        changes: What it changes in the equations.
        proportional: a, where L1 acts on a e + tau de/dt of the last iteration.
        derivative: tau [s]; the compensation is taken times it where it is not zero.
        limits: Whether figures 3, 6 and 8 have the speed limit.
        scale: What all gains are multiplied by.
        compensation: What the compensation is multiplied by.
        track: What the half track of the plant is multiplied by; that of the law is as printed.
        heading: Where the gain matrix is taken: measured, reference.
        wrapped: Whether the heading error is taken between -pi and pi.
        scaled: Whether both wheels are scaled by the limit, or each is clipped by itself.
        goes_on: Whether a pass begins where the last one ended.
        starts: What the headings of the cardioid's and the spiral's wrong start are multiplied by.
    """

    name: str
    changes: str
    proportional: float = 1.0
    derivative: float = 0.0
    limits: bool = True
    scale: float = 1.0
    compensation: float = 1.0
    track: float = 1.0
    heading: str = "measured"
    wrapped: bool = False
    scaled: bool = True
    goes_on: bool = False
    starts: float = 1.0


LITERAL = Reading("literal", "nothing")
_UNLIMITED = "Eq. 25 for situations 2, 3, 8, 10 only"
_FULL_TRACK = "B of Eq. 2 is the wheels' distance: yaw rate R (w_l - w_r) / B"
_MIXED, _HALF = "L1 (e + tau de/dt) for L1 e, tau = 0.1 s", "L1 (e / 2 + tau de/dt) for L1 e"
_UNCOMPENSATED = "Eq. 21 without its last term"
_STARTS = "7 pi/15, 31 pi/60 for 14 pi/15, 31 pi/30"
DERIVATIVE = Reading("e + 0.1 s de/dt", _MIXED, derivative=0.1)
HALF = Reading("0.5 e + 0.1 s de/dt", _HALF, proportional=0.5, derivative=0.1)
READINGS = (
    LITERAL,
    Reading("no limit in figs. 3, 6, 8", _UNLIMITED, limits=False),
    Reading("gains over d_k", "L / d_k for L in Eqs. 17, 21", scale=1 / SAMPLE_TIME),
    Reading("compensation's sign", "- for the last + of Eq. 21", compensation=-1.0),
    Reading("no compensation", _UNCOMPENSATED, compensation=0.0),
    Reading("full track", _FULL_TRACK, track=0.5),
    Reading("reference heading", "Eq. 45 at the reference's heading", heading="reference"),
    Reading("wrapped heading", "heading errors between -pi and pi", wrapped=True),
    Reading("each wheel clipped by itself", "Eq. 25 for each wheel alone", scaled=False),
    Reading("passes go on from the last end", "q_{i+1}(0) = q_i(n)", goes_on=True),
    Reading("pure D", "L1 de/dt for L1 e", proportional=0.0, derivative=1.0),
    Reading("pure D, 0.1 s", "L1 tau de/dt for L1 e", proportional=0.0, derivative=0.1),
    Reading("pure D, 0.05 s", "L1 tau de/dt for L1 e", proportional=0.0, derivative=0.05),
    Reading(
        "pure D, gains over d_k",
        "L1 (e(k+1) - e(k)) / d_k for L1 e, L2 / d_k, L3 / d_k",
        proportional=0.0,
        derivative=SAMPLE_TIME,
        scale=1 / SAMPLE_TIME,
    ),
    DERIVATIVE,
    HALF,
    Reading(
        f"{DERIVATIVE.name}, no compensation",
        f"{_MIXED}; {_UNCOMPENSATED}",
        derivative=0.1,
        compensation=0.0,
    ),
    *(
        replace(
            reading,
            name=f"{reading.name}, halved starts",
            changes=_STARTS if reading is LITERAL else f"{reading.changes}; {_STARTS}",
            starts=0.5,
        )
        for reading in (LITERAL, DERIVATIVE, HALF)
    ),
)


@dataclass(frozen=True)
class Outcome:
    """What came of a situation.

    Attributes:
        largest: Largest position error of each iteration by the path's size, shape (101,).
        second_half: Of iteration 100, by the path's size, shape (about n / 2,).
        fastest: Largest wheel speed of iteration 100 [rad/s].
        fastest_ever: The same of all iterations.
    """

    largest: Floats
    second_half: Floats
    fastest: float
    fastest_ever: float


def simulate(cases: Sequence[tuple[Reading, Situation]]) -> list[Outcome]:
    """Runs cases whose paths have the same number of samples side by side.

    Each array has the cases as its last axis.
    """
    steps = len(PATHS[cases[0][1].path]) - 1

    def column(values: Sequence[float] | Sequence[Sequence[float]]) -> Floats:
        return np.array(values, dtype=np.float64)

    desired = np.stack([PATHS[s.path] for _, s in cases], axis=2)  # (n + 1, 3, cases)
    gains = column([[g * r.scale for g in s.gains] for r, s in cases]).T
    l1, l2, l3 = gains
    of_21 = np.array([s.compensated for _, s in cases])
    l2, l3 = np.where(of_21, 0.0, l2), np.where(of_21, 0.0, l3)
    proportional = column([r.proportional for r, _ in cases])
    derivative = column([r.derivative for r, _ in cases])
    k = np.arange(steps)
    theta = np.where(k <= COMPENSATED, 2 / (SAMPLE_TIME * COMPENSATED) * (1 - k / COMPENSATED), 0.0)
    factor = of_21 * column([r.compensation * (r.derivative or 1.0) for r, _ in cases])
    weights = (np.exp(-k * SAMPLE_TIME) * theta)[:, np.newaxis] * factor  # (n, cases)
    half_track = HALF_TRACK * column([r.track for r, _ in cases])
    at_reference = np.array([r.heading == "reference" for r, _ in cases])
    wrapped = np.array([r.wrapped for r, _ in cases])
    scaled = np.array([r.scaled for r, _ in cases])
    goes_on = np.array([r.goes_on for r, _ in cases])
    limit = column(
        [
            LIMIT if s.limited and (r.limits or s.name[0] not in "368l") else math.inf
            for r, s in cases
        ]
    )
    # Rows of the gain matrix: entries are constant + cos * c + sin * s.
    matrices = {45: (0.0, 1 / RADIUS, HALF_TRACK / RADIUS), 56: (0.0, 1.0, 1.0)}
    along = column([matrices.get(s.matrix, (0, 1.0, 0))[1] for _, s in cases])
    turning = column([matrices.get(s.matrix, (0, 0, HALF_TRACK / RADIUS))[2] for _, s in cases])
    contradicts = np.array([s.matrix == 57 for _, s in cases])  # its left row is (0.5, 0.2, B / R)
    sizes = column([SIZES[s.path] for _, s in cases])

    def start_of(reading: Reading, situation: Situation) -> tuple[float, float, float]:
        if situation.start is None:
            x, y, heading = PATHS[situation.path][0]
            return x, y, heading
        x, y, heading = situation.start
        turned = situation.path in ("cardioid", "spiral")
        return x, y, heading * (reading.starts if turned else 1.0)

    start = column([start_of(r, s) for r, s in cases]).T
    left, right = np.zeros((steps, len(cases))), np.zeros((steps, len(cases)))
    errors = np.zeros((steps + 1, 3, len(cases)))
    largest = np.empty((ITERATIONS + 1, len(cases)))
    fastest_ever = np.zeros(len(cases))
    distance = np.empty((steps + 1, len(cases)))
    for iteration in range(ITERATIONS + 1):
        closed = float(iteration > 0)
        past = l1 * (
            proportional * errors[1:]
            + derivative * np.diff(errors, axis=0) / SAMPLE_TIME
            + weights[:, np.newaxis] * errors[0]
        )
        feedback, before_gain = closed * l2, closed * l3
        state = start.copy()
        before = np.zeros_like(state)
        for sample in range(steps):
            error = desired[sample] - state
            error[2] = np.where(wrapped, np.mod(error[2] + PI, 2 * PI) - PI, error[2])
            distance[sample] = np.hypot(error[0], error[1])
            cos, sin = np.cos(state[2]), np.sin(state[2])
            total = closed * past[sample] + feedback * error + before_gain * before
            errors[sample], before = error, error
            gain_heading = np.where(at_reference, desired[sample, 2], state[2])
            forward = np.cos(gain_heading) * total[0] + np.sin(gain_heading) * total[1]
            turn = turning * total[2]
            other = 0.5 * total[0] + 0.2 * total[1]
            left_speed = left[sample] + np.where(contradicts, other, along * forward) + turn
            right_speed = right[sample] + along * forward - turn
            faster = np.maximum(np.abs(left_speed), np.abs(right_speed))
            over = np.maximum(faster / limit, 1.0)
            left_speed = np.where(scaled, left_speed / over, np.clip(left_speed, -limit, limit))
            right_speed = np.where(scaled, right_speed / over, np.clip(right_speed, -limit, limit))
            left[sample], right[sample] = left_speed, right_speed
            speed = RADIUS * (left_speed + right_speed) / 2
            state[0] += SAMPLE_TIME * speed * cos
            state[1] += SAMPLE_TIME * speed * sin
            state[2] += SAMPLE_TIME * RADIUS * (left_speed - right_speed) / (2 * half_track)
        error = desired[steps] - state
        error[2] = np.where(wrapped, np.mod(error[2] + PI, 2 * PI) - PI, error[2])
        errors[steps], distance[steps] = error, np.hypot(error[0], error[1])
        largest[iteration] = distance.max(axis=0) / sizes
        fastest = np.maximum(np.abs(left).max(axis=0), np.abs(right).max(axis=0))
        fastest_ever = np.maximum(fastest_ever, fastest)
        start = np.where(goes_on, state, start)
    later = distance[steps - steps // 2 :] / sizes
    return [
        Outcome(largest[:, c].copy(), later[:, c].copy(), float(fastest[c]), float(fastest_ever[c]))
        for c in range(len(cases))
    ]


def needed(outcome: Outcome) -> float:
    """First iteration from which on the error stays within 5 %; infinite if there is none."""
    above = np.flatnonzero(~(outcome.largest <= NEARLY))
    first = int(above[-1]) + 1 if len(above) else 0
    return first if first <= ITERATIONS else math.inf


def by_size(error: float) -> int:
    """The score of an error that should be small."""
    return 2 if error <= HELD else 1 if error <= NEARLY else 0


def some(parts: Sequence[bool]) -> int:
    """The score of a claim with several parts."""
    return 2 if all(parts) else 1 if any(parts) else 0


def scores(found: Mapping[str, Outcome]) -> dict[str, int]:
    """The score of each claim, by the criteria above."""

    def last(name: str) -> float:
        return float(found[name].largest[-1])

    def later(name: str) -> float:
        return float(found[name].second_half.max())

    offset = found["4a"].second_half
    remains = bool(offset.min() > HELD)
    falls = all(
        needed(found[f"l1={b:g}"]) < needed(found[f"l1={a:g}"]) for a, b in pairwise(USEFUL)
    )
    fails = all(not last(f"l1={l1:g}") <= NEARLY for l1 in TOO_LARGE)
    fewer = needed(found["l1=10"]) < needed(found["l1=0.1"])
    within = all(found[name].fastest_ever <= LIMIT * (1 + 1e-9) for name in ("7b", "7d"))
    beyond = all(not found[name].fastest <= LIMIT for name in ("7a", "7c"))
    pairs = [("7b", "7a"), ("7d", "7c"), ("7c-limited", "7c")]
    return {
        "F3-1": by_size(max(last(f"3-{name}") for name in PATHS)),
        "F4-1": (2 if offset.std() <= FIXED * offset.mean() else 1) if remains else 0,
        "F4-2": by_size(later("4b")),
        "F5-1": by_size(max(later(f"5-{name}") for name in PATHS if name != "circle")),
        "F6-1": 2 if falls and fails else int(falls or fails or fewer),
        "F6-2": some([needed(found[f"6{x}"]) < needed(found["l1=0.1"]) for x in "degh"]),
        "F7-1": (2 if beyond else 1) if within else 0,
        "F7-2": some([needed(found[a]) < needed(found[b]) for a, b in pairs]),
        "F8-1": by_size(last("8b")),
        "F8-2": 2 if not last("8c") <= NEARLY else 1 if last("8c") > HELD else 0,
    }


def run(readings: Sequence[Reading]) -> dict[str, dict[str, Outcome]]:
    """All situations under each reading."""
    cases = list(product(readings, situations()))
    groups: dict[int, list[tuple[Reading, Situation]]] = {}
    for case in cases:
        groups.setdefault(len(PATHS[case[1].path]), []).append(case)
    found: dict[str, dict[str, Outcome]] = {reading.name: {} for reading in readings}
    for group in groups.values():
        with np.errstate(over="ignore", invalid="ignore"):
            outcomes = simulate(group)
        for (reading, situation), outcome in zip(group, outcomes, strict=True):
            found[reading.name][situation.name] = outcome
    return found


def table(readings: Sequence[Reading], rows: Mapping[str, Mapping[str, int]]) -> str:
    """The scores of readings as Markdown."""
    claims = list(rows[readings[0].name])
    lines = [
        "| reading | changes | " + " | ".join(claims) + " | sum |",
        "|---|---|" + "---:|" * (len(claims) + 1),
    ]
    for reading in readings:
        row = rows[reading.name]
        told = " | ".join(str(row[claim]) for claim in claims)
        lines.append(f"| {reading.name} | {reading.changes} | {told} | {sum(row.values())} |")
    return "\n".join(lines)


PAGE = Path(__file__).resolve().parents[1] / "docs" / "readings.md"
MARKED = re.compile(
    r"(?<=<!-- scores: by benchmarks/readings.py -->\n)(.*?)(?=<!-- end of scores -->)", re.DOTALL
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints the table, and keeps or compares the page's."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", type=Path, help="where the errors of all situations go")
    parser.add_argument("--write", action="store_true", help="put the table into docs/readings.md")
    parser.add_argument("--check", action="store_true", help="compare it with the one there")
    options = parser.parse_args(arguments)
    found = run(READINGS)
    made = table(READINGS, {reading.name: scores(found[reading.name]) for reading in READINGS})
    print(made)
    page = PAGE.read_text(encoding="utf-8")
    expected = MARKED.sub(lambda _: f"\n{made}\n\n", page)
    if options.write:
        PAGE.write_text(expected, encoding="utf-8")
    if options.json:
        figures = {
            name: {
                situation: {
                    "last_percent": 100 * float(outcome.largest[-1]),
                    "second_half_percent": 100 * float(outcome.second_half.max()),
                    "needed": None if math.isinf(needed(outcome)) else needed(outcome),
                }
                for situation, outcome in row.items()
            }
            for name, row in found.items()
        }
        options.json.write_text(json.dumps(figures, indent=1, allow_nan=True) + "\n")
    if options.check and page != expected:
        print(f"{PAGE.name} has another table; run with --write", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
