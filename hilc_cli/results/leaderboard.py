"""What became of each law in each case, and the tables of that: of all runs, and law by law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from hilc_cli.results.comparison import Column, ComparisonTable, Row, Value

_LARGEST, _MEAN = "Largest errors of the second half", "Mean errors of the second half"
_WHOLE, _REST = "Largest errors of the whole path", "Runs, speed and time"


@dataclass(frozen=True, slots=True)
class Entry:
    """One law in one case.

    Errors are position errors over the second half of the trajectory, unless something else is
    said. A run that diverges has infinite errors from there on.

    Attributes:
        case: Name of the case.
        belief: Name of what the controller believes.
        disturbance: Name of the disturbance.
        law: Name of the law.
        max_m: Largest error after each number of iterations that is looked at [m].
        mean_m: Mean error, likewise [m].
        whole_max_m: Largest error over the whole path, likewise [m].
        settled_at: First iteration from which on the largest error keeps the tolerance; None if
            the last does not.
        peak_m: Largest error over the whole path in any iteration [m].
        fastest_wheel_rad_s: Largest wheel speed in any iteration [rad/s].
        speed_limit_rad_s: b_w [rad/s]; None for no limit.
        diverged_at: The iteration that left the finite numbers; None if none did.
        seconds_per_iteration: Processor time of the whole program for an iteration [s].
    """

    case: str
    belief: str
    disturbance: str
    law: str
    max_m: tuple[float, ...]
    mean_m: tuple[float, ...]
    whole_max_m: tuple[float, ...]
    settled_at: int | None
    peak_m: float
    fastest_wheel_rad_s: float
    speed_limit_rad_s: float | None
    diverged_at: int | None
    seconds_per_iteration: float

    @property
    def keeps_limit(self) -> bool:
        """Whether no wheel was faster than the limit in any sample of any iteration."""
        limit = math.inf if self.speed_limit_rad_s is None else self.speed_limit_rad_s
        return self.fastest_wheel_rad_s <= limit


@dataclass(frozen=True, slots=True, eq=False)
class LeaderboardData:
    """The entries of a leaderboard.

    Attributes:
        name: Of the leaderboard.
        after: Numbers of iterations after which errors are told.
        tolerance: Largest error that counts as reached [m].
        entries: Cases in their order; of each the beliefs, the disturbances, and the laws.
    """

    name: str
    after: tuple[int, ...]
    tolerance: float
    entries: tuple[Entry, ...]

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws in their order."""
        return tuple(dict.fromkeys(entry.law for entry in self.entries))

    @property
    def disturbances(self) -> tuple[str, ...]:
        """Names of the disturbances in their order."""
        return tuple(dict.fromkeys(entry.disturbance for entry in self.entries))

    def of(self, law: str, disturbance: str) -> list[Entry]:
        """The entries of a law with a disturbance."""
        return [
            entry for entry in self.entries if entry.law == law and entry.disturbance == disturbance
        ]

    @property
    def settings(self) -> tuple[tuple[str, str], ...]:
        """Beliefs with disturbances in their order."""
        return tuple(dict.fromkeys((entry.belief, entry.disturbance) for entry in self.entries))


def entries_table(data: LeaderboardData) -> ComparisonTable:
    """All entries, a row each."""
    columns = [
        *(Column(name, name.capitalize(), name.capitalize()) for name in _NAMES),
        *_error_columns(data.after, "max_position_error", "Largest error", "Max.", _LARGEST),
        *_error_columns(data.after, "mean_position_error", "Mean error", "Mean", _MEAN),
        *_error_columns(
            data.after, "whole_path_max_error", "Largest error, whole path", "Whole", _WHOLE
        ),
        Column(
            "iterations_to_tolerance", f"Iterations to {data.tolerance:g} m", "To tolerance",
            absent="never", section=_REST, is_ranked=True,
        ),
        Column(
            "peak_max_position_error_m", "Peak error", "Peak error", "m", section=_REST,
            is_ranked=True,
        ),
        Column("fastest_wheel_rad_s", "Fastest wheel", "Fastest wheel", "rad/s", section=_REST),
        Column("speed_limit_rad_s", "Speed limit", "Speed limit", "rad/s", absent="none",
               section=_REST),
        Column("speed_limit_kept", "Speed limit kept", "Limit kept", section=_REST),
        Column("diverged_at", "Diverged in iteration", "Diverged", absent="no", section=_REST),
        Column("time_per_iteration_s", "Time per iteration", "Time", "ms", digits=3, scale=1e3,
               section=_REST),
    ]  # fmt: skip
    groups = list(dict.fromkeys((e.case, e.belief, e.disturbance) for e in data.entries))
    rows = tuple(
        Row(
            (
                *(entry.case, entry.belief, entry.disturbance, entry.law),
                *entry.max_m,
                *entry.mean_m,
                *entry.whole_max_m,
                entry.settled_at,
                entry.peak_m,
                entry.fastest_wheel_rad_s,
                entry.speed_limit_rad_s,
                "yes" if entry.keeps_limit else "no",
                entry.diverged_at,
                entry.seconds_per_iteration,
            ),
            groups.index((entry.case, entry.belief, entry.disturbance)),
            may_be_best=entry.diverged_at is None,
        )
        for entry in data.entries
    )
    note = (
        "Max. and Mean are over the second half of the trajectory, Whole over all of it, after so "
        "many iterations."
    )
    title = f"All runs of {data.name}"
    return ComparisonTable(title, tuple(columns), rows, note, "the best law in that case")


def laws_table(data: LeaderboardData, disturbance: str) -> ComparisonTable:
    """The laws, a row each, over all cases and beliefs with a disturbance."""
    columns = [Column("law", "Law", "Law")]
    for what, word, section in (("max", "Largest", _LARGEST), ("mean", "Mean", _MEAN)):
        for kind in ("median", "worst"):
            columns += [
                Column(
                    f"{kind}_{what}_position_error_after_{count}_m",
                    f"{word} error after {counted(count)}, {kind}", f"{kind.capitalize()} {count}",
                    "m", digits=3, section=section, is_ranked=True,
                )
                for count in data.after
            ]  # fmt: skip
    within = f"{data.tolerance:g} m"
    columns += [
        Column("runs", "Runs", "Runs", section=_REST),
        Column("reached", f"Runs that reach {within}", "Reached", section=_REST),
        Column(
            "median_iterations_to_tolerance", f"Iterations to {within}, median of these",
            "To tolerance", digits=3, absent="-", section=_REST,
        ),
        Column("worst_peak_m", "Worst peak error, whole path", "Peak", "m", digits=3,
               section=_REST, is_ranked=True),
        Column("limit_kept", "Runs that keep the speed limit", "Limit kept", section=_REST),
        Column("diverged", "Runs that diverge", "Diverged", section=_REST),
        Column("median_time_per_iteration_s", "Time per iteration, median", "Time", "ms",
               digits=3, scale=1e3, section=_REST),
    ]  # fmt: skip
    rows = tuple(Row(_law_values(law, data.of(law, disturbance))) for law in data.laws)
    note = (
        "Errors are the largest and the mean position errors over the second half of the "
        "trajectory, after so many iterations; median and worst are over the runs."
    )
    title = f"{data.name}, disturbance {disturbance}"
    return ComparisonTable(title, tuple(columns), rows, note, "the best law")


def settings_table(data: LeaderboardData) -> ComparisonTable:
    """The worst error after the last number of iterations, by law, belief and disturbance."""
    columns = [Column("law", "Law", "Law")]
    columns += [
        Column(
            f"{belief}-{disturbance}", f"Belief {belief}, disturbance {disturbance}",
            f"{belief} {disturbance}", "m", digits=3, section="Errors", is_ranked=True,
        )
        for belief, disturbance in data.settings
    ]  # fmt: skip
    rows = []
    for law in data.laws:
        worst: list[Value] = [
            max(entry.max_m[-1] for entry in data.of(law, disturbance) if entry.belief == belief)
            for belief, disturbance in data.settings
        ]
        rows.append(Row((law, *worst)))
    title = f"{data.name}: worst error after {counted(data.after[-1])}"
    return ComparisonTable(title, tuple(columns), tuple(rows), "", "the best law")


def counted(iterations: int) -> str:
    """So many iterations, in words."""
    return f"{iterations} iteration{'' if iterations == 1 else 's'}"


_NAMES = ("case", "belief", "disturbance", "law")


def _error_columns(
    after: Sequence[int], name: str, title: str, short: str, section: str
) -> list[Column]:
    return [
        Column(
            f"{name}_after_{count}_m", f"{title} after {counted(count)}", f"{short} {count}", "m",
            section=section, is_ranked=True,
        )
        for count in after
    ]  # fmt: skip


def _law_values(law: str, entries: Sequence[Entry]) -> tuple[Value, ...]:
    largest = list(zip(*(entry.max_m for entry in entries), strict=True))
    mean = list(zip(*(entry.mean_m for entry in entries), strict=True))

    reached = [entry.settled_at for entry in entries if entry.settled_at is not None]
    return (
        law,
        *map(median, largest),
        *map(max, largest),
        *map(median, mean),
        *map(max, mean),
        len(entries),
        len(reached),
        float(median(reached)) if reached else None,
        max(entry.peak_m for entry in entries),
        sum(entry.keeps_limit for entry in entries),
        sum(entry.diverged_at is not None for entry in entries),
        median(entry.seconds_per_iteration for entry in entries),
    )
