"""The tables of a leaderboard: of all runs, law by law, and by belief and disturbance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median

from hilc_cli.comparisons.table import Column, ComparisonTable, Row, Value
from hilc_cli.leaderboards.entries import Entry, LeaderboardData
from hilc_cli.wording import counted

NAMES = ("case", "belief", "disturbance", "law")
"""Columns that say what a run is of."""

ERRORS = {
    "max_m": "max_position_error_second_half",
    "mean_m": "mean_position_error_second_half",
    "whole_max_m": "max_position_error",
}
"""What the columns of the errors after each number of iterations begin with, by their attribute."""

OTHERS = {
    "within_at": "first_iteration_within_tolerance",
    "within_share": "share_within_since",
    "settled_at": "iterations_to_tolerance",
    "peak_m": "peak_max_position_error_m",
    "fastest_wheel_rad_s": "fastest_wheel_rad_s",
    "speed_limit_rad_s": "speed_limit_rad_s",
    "keeps_limit": "speed_limit_kept",
    "diverged_at": "diverged_at",
    "seconds_per_iteration": "time_per_iteration_s",
}
"""The columns behind them, by their attribute."""

_REST = "Runs, speed and time"
_PEAK_NOTE = (
    "The peak is the largest error over the whole path in any iteration but 0, which mostly is "
    "the first input alone."
)


def error_name(what: str, count: int) -> str:
    """The column of an error after so many iterations."""
    return f"{ERRORS[what]}_after_{count}_m"


def entries_table(data: LeaderboardData) -> ComparisonTable:
    """All entries, a row each."""
    within = f"{data.tolerance:g} m"
    columns = [
        *(Column(name, name.capitalize(), name.capitalize()) for name in NAMES),
        *_error_columns(data.after, "max_m", "Largest error", "Max.", _largest(data)),
        *_error_columns(data.after, "mean_m", "Mean error", "Mean", _mean(data)),
        *_error_columns(
            data.after, "whole_max_m", "Largest error, whole path", "Max.",
            f"Largest errors of the whole path after {_counts(data.after)}",
        ),
        Column(
            OTHERS["within_at"], f"First iteration within {within}", f"To {within}",
            absent="never", section=_REST, is_ranked=True,
        ),
        Column(
            OTHERS["within_share"], f"Within {within} since then", "Within since", "%",
            digits=3, scale=100.0, absent="-", section=_REST,
        ),
        Column(
            OTHERS["settled_at"], f"Stays within {within} from iteration", "Stays from",
            absent="never", section=_REST, is_ranked=True,
        ),
        Column(
            OTHERS["peak_m"], "Peak error from iteration 1 on", "Peak error", "m", section=_REST,
            absent="-", is_ranked=True,
        ),
        Column(OTHERS["fastest_wheel_rad_s"], "Fastest wheel", "Fastest wheel", "rad/s",
               section=_REST),
        Column(OTHERS["speed_limit_rad_s"], "Speed limit", "Speed limit", "rad/s", absent="none",
               section=_REST),
        Column(OTHERS["keeps_limit"], "Speed limit kept", "Limit kept", absent="-",
               section=_REST),
        Column(OTHERS["diverged_at"], "Diverged in iteration", "Diverged", absent="no",
               section=_REST),
        Column(OTHERS["seconds_per_iteration"], "Time per iteration", "Time", "ms", digits=3,
               scale=1e3, section=_REST),
    ]  # fmt: skip
    groups = list(dict.fromkeys((e.case, e.belief, e.disturbance) for e in data.entries))
    rows = []
    for entry in data.entries:
        others = [getattr(entry, what) for what in OTHERS]
        values = (
            *(getattr(entry, name) for name in NAMES),
            *(error for what in ERRORS for error in getattr(entry, what)),
            *({True: "yes", False: "no"}[v] if isinstance(v, bool) else v for v in others),
        )
        group = groups.index((entry.case, entry.belief, entry.disturbance))
        rows.append(Row(values, group, may_be_best=entry.diverged_at is None))
    note = (
        f"To {within} is the first iteration whose largest error of the second half is within "
        f"{within}, Within since the share of the iterations from there to the last that are, and "
        f"Stays from the iteration from which on all are. {_PEAK_NOTE}"
    )
    title = f"All runs of {data.name}"
    return ComparisonTable(title, tuple(columns), tuple(rows), note, "the best law in that case")


def laws_table(data: LeaderboardData, disturbance: str) -> ComparisonTable:
    """The laws, a row each, over all cases and beliefs with a disturbance."""
    columns = [Column("law", "Law", "Law")]
    for what, word, section in (
        ("max", "Largest", _largest(data)),
        ("mean", "Mean", _mean(data)),
    ):
        for kind in ("median", "worst"):
            columns += [
                Column(
                    f"{kind}_{what}_position_error_second_half_after_{count}_m",
                    f"{word} error after {counted(count, 'iteration')}, {kind}",
                    f"{kind.capitalize()} after {count}",
                    "m", digits=3, section=section, is_ranked=True,
                )
                for count in data.after
            ]  # fmt: skip
    within = f"{data.tolerance:g} m"
    columns += [
        Column("runs", "Runs", "Runs", section=_REST),
        Column("reached", f"Runs that reach {within}", "Reached", section=_REST),
        Column(
            "median_first_iteration_within_tolerance", f"First iteration within {within}, median",
            f"To {within}", digits=3, absent="-", section=_REST,
        ),
        Column(
            "median_share_within_since", f"Within {within} since then, median", "Within since",
            "%", digits=3, scale=100.0, absent="-", section=_REST,
        ),
        Column("worst_peak_m", "Worst peak error, whole path", "Peak", "m", digits=3, absent="-",
               section=_REST, is_ranked=True),
        Column("limit_kept", "Runs that keep the speed limit", "Limit kept", absent="-",
               section=_REST),
        Column("diverged", "Runs that diverge", "Diverged", section=_REST),
        Column("median_time_per_iteration_s", "Time per iteration, median", "Time", "ms",
               digits=3, scale=1e3, section=_REST),
    ]  # fmt: skip
    rows = tuple(Row(_law_values(law, data.of(law, disturbance))) for law in data.laws)
    note = (
        "Errors are the largest and the mean position errors over the second half of the "
        "trajectory; median and worst are over the runs. A run has reached "
        f"{within} if its largest error is within it in any iteration; the first such iteration "
        f"(To {within}) and the share of the iterations from there to the last that are within it "
        f"(Within since) are medians over these runs. {_PEAK_NOTE}"
    )
    title = f"{data.name}, disturbance {disturbance}"
    return ComparisonTable(title, tuple(columns), rows, note, "the best law")


def settings_table(data: LeaderboardData) -> ComparisonTable:
    """The worst error after the last number of iterations, by law, belief and disturbance."""
    columns = [Column("law", "Law", "Law")]
    columns += [
        Column(
            # A name has no slash, so that this cannot be that of another pair.
            f"{belief}/{disturbance}", f"Belief {belief}, disturbance {disturbance}",
            f"{belief}, {disturbance}", "m", digits=3, section="By belief and disturbance",
            is_ranked=True,
        )
        for belief, disturbance in data.settings
    ]  # fmt: skip
    worst = _worst_errors(data)
    rows = [
        Row((law, *(worst[law, belief, disturbance] for belief, disturbance in data.settings)))
        for law in data.laws
    ]
    title = (
        f"{data.name}, worst error of the second half after {counted(data.after[-1], 'iteration')}"
    )
    return ComparisonTable(title, tuple(columns), tuple(rows), "", "the best law")


def cases_table(data: LeaderboardData) -> ComparisonTable:
    """The worst error after the last number of iterations, by law, disturbance and case."""
    pairs = list(dict.fromkeys((entry.disturbance, entry.case) for entry in data.entries))
    columns = [
        Column("law", "Law", "Law"),
        *(
            Column(
                f"{case}/{disturbance}", f"Case {case}, disturbance {disturbance}", case, "m",
                digits=3, section=f"By case, disturbance {disturbance}", is_ranked=True,
            )
            for disturbance, case in pairs
        ),
    ]  # fmt: skip
    rows = []
    for law in data.laws:
        worst = dict.fromkeys(pairs, 0.0)
        for disturbance, case in pairs:
            errors = [each.max_m[-1] for each in data.of(law, disturbance) if each.case == case]
            worst[disturbance, case] = max(errors, default=math.nan)
        rows.append(Row((law, *worst.values())))
    title = (
        f"{data.name}, error of the second half after {counted(data.after[-1], 'iteration')}, case "
        "by case"
    )
    note = "" if len(data.settings) == len(data.disturbances) else "The worst of all beliefs."
    return ComparisonTable(title, tuple(columns), tuple(rows), note, "the best law")


def settings_records(data: LeaderboardData) -> list[dict[str, Value]]:
    """The worst error of each law by belief and disturbance, a record each with the names apart."""
    name = f"worst_{error_name('max_m', data.after[-1])}"
    return [
        {"law": law, "belief": belief, "disturbance": disturbance, name: worst}
        for (law, belief, disturbance), worst in _worst_errors(data).items()
    ]


def _counts(after: Sequence[int]) -> str:
    """Several numbers of iterations, in words."""
    return ", ".join([*map(str, after[:-1]), counted(after[-1], "iteration")])


def _largest(data: LeaderboardData) -> str:
    return f"Largest errors of the second half after {_counts(data.after)}"


def _mean(data: LeaderboardData) -> str:
    return f"Mean errors of the second half after {_counts(data.after)}"


def _error_columns(
    after: Sequence[int], what: str, title: str, short: str, section: str
) -> list[Column]:
    return [
        Column(
            error_name(what, count), f"{title} after {counted(count, 'iteration')}",
            f"{short} after {count}", "m", section=section, is_ranked=True,
        )
        for count in after
    ]  # fmt: skip


def _worst_errors(data: LeaderboardData) -> dict[tuple[str, str, str], float]:
    """Over the cases, by law, belief and disturbance."""
    worst: dict[tuple[str, str, str], float] = {}
    for law in data.laws:
        for belief, disturbance in data.settings:
            entries = [entry for entry in data.of(law, disturbance) if entry.belief == belief]
            worst[law, belief, disturbance] = max(entry.max_m[-1] for entry in entries)
    return worst


def _law_values(law: str, entries: Sequence[Entry]) -> tuple[Value, ...]:
    largest = list(zip(*(entry.max_m for entry in entries), strict=True))
    mean = list(zip(*(entry.mean_m for entry in entries), strict=True))

    reached = [entry.within_at for entry in entries if entry.within_at is not None]
    shares = [entry.within_share for entry in entries if entry.within_share is not None]
    peaks = [entry.peak_m for entry in entries if entry.peak_m is not None]
    kept = [entry.keeps_limit for entry in entries if entry.keeps_limit is not None]
    middle = median(reached) if reached else 0
    return (
        law,
        *map(median, largest),
        *map(max, largest),
        *map(median, mean),
        *map(max, mean),
        len(entries),
        len(reached),
        (int(middle) if middle == int(middle) else middle) if reached else None,
        median(shares) if shares else None,
        max(peaks, default=None),
        sum(kept) if kept else None,
        sum(entry.diverged_at is not None for entry in entries),
        median(entry.seconds_per_iteration for entry in entries),
    )
