"""The tables of a leaderboard, from made-up entries."""

from __future__ import annotations

import math
from dataclasses import replace

from hilc_cli.results.comparison_tables import csv_text
from hilc_cli.results.leaderboard import (
    Entry,
    LeaderboardData,
    entries_table,
    laws_table,
    settings_table,
)

ENTRY = Entry(
    *("bend", "exact", "none", "slow"),
    max_m=(3.0, 0.5),
    mean_m=(2.0, 0.25),
    whole_max_m=(4.0, 1.0),
    settled_at=None,
    peak_m=5.0,
    fastest_wheel_rad_s=180.0,
    speed_limit_rad_s=180.0,
    diverged_at=None,
    seconds_per_iteration=0.5,
)
FAST = replace(ENTRY, law="fast", max_m=(0.5, 0.004), settled_at=2)


def data(*entries: Entry) -> LeaderboardData:
    return LeaderboardData("test", (1, 8), 0.01, entries)


def test_row_of_a_run_has_all_its_numbers() -> None:
    header, row = csv_text(entries_table(data(ENTRY))).splitlines()
    assert header == (
        "case,belief,disturbance,law,"
        "max_position_error_after_1_m,max_position_error_after_8_m,"
        "mean_position_error_after_1_m,mean_position_error_after_8_m,"
        "whole_path_max_error_after_1_m,whole_path_max_error_after_8_m,"
        "iterations_to_tolerance,peak_max_position_error_m,fastest_wheel_rad_s,"
        "speed_limit_rad_s,speed_limit_kept,diverged_at,time_per_iteration_s"
    )
    assert row == "bend,exact,none,slow,3.0,0.5,2.0,0.25,4.0,1.0,,5.0,180.0,180.0,yes,,0.5"


def test_limit_is_kept_up_to_its_very_value() -> None:
    assert ENTRY.keeps_limit
    assert not replace(ENTRY, fastest_wheel_rad_s=math.nextafter(180, 181)).keeps_limit
    assert replace(ENTRY, speed_limit_rad_s=None).keeps_limit


def test_laws_are_told_by_median_and_worst_of_their_runs() -> None:
    runs = [
        ENTRY,
        replace(
            ENTRY, case="circle", max_m=(7.0, 0.1), mean_m=(1.0, 0.05), peak_m=6.0, settled_at=4
        ),
        replace(ENTRY, case="line", max_m=(5.0, 0.2), fastest_wheel_rad_s=181.0, settled_at=8),
        replace(
            FAST,
            max_m=(math.inf, math.inf),
            mean_m=(0.5, math.inf),
            diverged_at=3,
            settled_at=None,
        ),
    ]
    noisy = [replace(run, disturbance="noise", peak_m=99.0) for run in runs]
    table = laws_table(data(*runs, *noisy), "none")
    assert table.values("law") == ["slow", "fast"]
    assert table.values("median_max_position_error_after_1_m") == [5.0, math.inf]
    assert table.values("worst_max_position_error_after_8_m") == [0.5, math.inf]
    assert table.values("median_mean_position_error_after_1_m") == [2.0, 0.5]
    assert table.values("median_mean_position_error_after_8_m") == [0.25, math.inf]
    assert table.values("worst_mean_position_error_after_1_m") == [2.0, 0.5]
    assert table.values("reached") == [2, 0]
    assert table.values("median_iterations_to_tolerance") == [6.0, None]
    assert table.values("worst_peak_m") == [6.0, 5.0]
    assert table.values("limit_kept") == [2, 1]
    assert table.values("diverged") == [0, 1]


def test_worst_errors_by_belief_and_disturbance() -> None:
    wrong = replace(ENTRY, belief="wrong", disturbance="noise", max_m=(9.0, 0.75))
    others = [replace(FAST, belief="wrong", disturbance="noise"), replace(ENTRY, case="line")]
    table = settings_table(data(ENTRY, FAST, wrong, *others))
    assert [row.values for row in table.rows] == [("slow", 0.5, 0.75), ("fast", 0.004, 0.004)]
    assert [column.name for column in table.columns] == ["law", "exact-none", "wrong-noise"]
    assert table.best(1) == {1}
