"""The tables of a leaderboard, from made-up entries."""

from __future__ import annotations

import math
from dataclasses import replace

from hilc_cli.comparisons.formats import csv_text, latex_text, markdown_text
from hilc_cli.leaderboards.entries import Entry, LeaderboardData
from hilc_cli.leaderboards.tables import (
    cases_table,
    entries_table,
    laws_table,
    settings_records,
    settings_table,
)
from tests.leaderboards.test_contests import ENTRY, FAST


def data(*entries: Entry) -> LeaderboardData:
    return LeaderboardData("test", (1, 8), 0.01, entries)


def test_row_of_a_run_has_all_its_numbers() -> None:
    header, slow, fast = csv_text(entries_table(data(ENTRY, FAST))).splitlines()
    assert header == (
        "case,belief,disturbance,law,"
        "max_position_error_second_half_after_1_m,max_position_error_second_half_after_8_m,"
        "mean_position_error_second_half_after_1_m,mean_position_error_second_half_after_8_m,"
        "max_position_error_after_1_m,max_position_error_after_8_m,"
        "first_iteration_within_tolerance,share_within_since,iterations_to_tolerance,"
        "peak_max_position_error_m,fastest_wheel_rad_s,"
        "speed_limit_rad_s,speed_limit_kept,diverged_at,time_per_iteration_s"
    )
    assert slow == "bend,exact,none,slow,3.0,0.5,2.0,0.25,4.0,1.0,,,,5.0,180.0,180.0,yes,,0.5"
    assert fast == (
        "bend,exact,none,fast,0.5,0.004,2.0,0.25,4.0,1.0,2,0.75,6,5.0,180.0,180.0,yes,,0.5"
    )


def test_laws_are_told_by_median_and_worst_of_their_runs() -> None:
    runs = [
        ENTRY,
        replace(
            ENTRY, case="circle", max_m=(7.0, 0.1), mean_m=(1.0, 0.05), peak_m=6.0,
            within_at=4, within_share=1.0, settled_at=4,
        ),
        replace(
            ENTRY, case="line", max_m=(5.0, 0.2), fastest_wheel_rad_s=181.0,
            within_at=7, within_share=0.5,
        ),
        replace(
            FAST, max_m=(math.inf, math.inf), mean_m=(0.5, math.inf), diverged_at=1,
            within_at=0, within_share=0.125, settled_at=None, peak_m=None,
        ),
    ]  # fmt: skip
    noisy = [replace(run, disturbance="noise", peak_m=99.0) for run in runs]
    table = laws_table(data(*runs, *noisy), "none")
    assert table.values("law") == ["slow", "fast"]
    assert table.values("median_max_position_error_second_half_after_1_m") == [5.0, math.inf]
    assert table.values("worst_max_position_error_second_half_after_8_m") == [0.5, math.inf]
    assert table.values("median_mean_position_error_second_half_after_1_m") == [2.0, 0.5]
    assert table.values("median_mean_position_error_second_half_after_8_m") == [0.25, math.inf]
    assert table.values("worst_mean_position_error_second_half_after_1_m") == [2.0, 0.5]
    assert table.values("reached") == [2, 1]
    assert table.values("median_first_iteration_within_tolerance") == [5.5, 0]
    assert table.values("median_share_within_since") == [0.75, 0.125]
    assert table.values("worst_peak_m") == [6.0, None]
    assert table.values("limit_kept") == [2, 1]
    assert table.values("diverged") == [0, 1]


def test_worst_errors_by_belief_and_disturbance() -> None:
    wrong = replace(ENTRY, belief="wrong", disturbance="noise", max_m=(9.0, 0.75))
    others = [replace(FAST, belief="wrong", disturbance="noise"), replace(ENTRY, case="line")]
    told = data(ENTRY, FAST, wrong, *others)
    table = settings_table(told)
    assert [row.values for row in table.rows] == [("slow", 0.5, 0.75), ("fast", 0.004, 0.004)]
    assert table.best(1) == {1}
    name = "worst_max_position_error_second_half_after_8_m"
    assert settings_records(told) == [
        {"law": "slow", "belief": "exact", "disturbance": "none", name: 0.5},
        {"law": "slow", "belief": "wrong", "disturbance": "noise", name: 0.75},
        {"law": "fast", "belief": "exact", "disturbance": "none", name: 0.004},
        {"law": "fast", "belief": "wrong", "disturbance": "noise", name: 0.004},
    ]


def test_errors_case_by_case_are_the_worst_of_all_beliefs() -> None:
    wrong = replace(ENTRY, belief="wrong", max_m=(9.0, 0.75))
    others = [replace(FAST, case="line"), replace(ENTRY, case="line", disturbance="noise")]
    told = data(ENTRY, FAST, wrong, *others, replace(ENTRY, case="line"))
    told = data(*told.entries, replace(FAST, case="line", disturbance="noise", max_m=(1.0, 2.0)))
    table = cases_table(told)
    assert [column.name for column in table.columns] == [
        "law",
        f"{ENTRY.case}/none",
        "line/none",
        "line/noise",
    ]
    assert [row.values for row in table.rows] == [
        ("slow", 0.75, 0.5, 0.5),
        ("fast", 0.004, 0.004, 2),
    ]
    assert table.best(1) == {1}
    assert table.best(3) == {0}
    assert table.note == "The worst of all beliefs."
    assert cases_table(data(ENTRY, FAST)).note == ""


def test_names_with_hyphens_are_not_mixed_up() -> None:
    pairs = (("a-b", "c", 0.5), ("a-b", "b-c", 0.1), ("a", "c", 0.2), ("a", "b-c", 0.25))
    told = data(
        *(replace(ENTRY, belief=b, disturbance=d, max_m=(1.0, worst)) for b, d, worst in pairs)
    )
    (record,) = settings_table(told).records()
    assert len(record) == 5
    found = {
        (
            each["belief"],
            each["disturbance"],
            each["worst_max_position_error_second_half_after_8_m"],
        )
        for each in settings_records(told)
    }
    assert found == set(pairs)


MARKDOWN = """\
**Largest errors of the second half after 1, 8 iterations [m]**

| Law | Median after 1 | Median after 8 | Worst after 1 | Worst after 8 |
| --- | ---: | ---: | ---: | ---: |
| a | 3.00 | 0.500 | 3.00 | 0.500 |
"""
LATEX = r"""
    \multicolumn{5}{l}{Largest errors of the second half after 1, 8 iterations [m]} \\
    \midrule
    & Median & Median & Worst & Worst \\
    & after & after & after & after \\
    Law & 1 & 8 & 1 & 8 \\
    \midrule
"""
REST = (
    "| Law | Runs | Reached | To 0.01 m | Within since [%] | Peak [m] | Limit kept | Diverged "
    "| Time [ms] |"
)


def test_titles_and_heads_tell_iterations_and_tolerance() -> None:
    laws = [replace(ENTRY, law=law) for law in "abcd"]
    runs = [*laws, replace(FAST, law="e", within_share=2 / 3)]
    table = laws_table(data(*runs), "none")
    text = markdown_text(table)
    assert text.startswith(MARKDOWN)
    assert "**Mean errors of the second half after 1, 8 iterations [m]**" in text
    assert REST in text
    assert "| e | 1 | 1 | 2 | 66.7 | 5.00 | 1 | 0 | 500 |" in text
    assert "| a | 1 | 0 | - | - | 5.00 | 1 | 0 | 500 |" in text
    assert LATEX in latex_text(table)
    assert "**By belief and disturbance [m]**" not in text
    runs += [replace(run, disturbance="noise") for run in runs]
    settings = markdown_text(settings_table(data(*runs)))
    assert settings.startswith("**By belief and disturbance [m]**\n\n| Law | exact, none | exact, ")


def test_no_limit_is_neither_kept_nor_broken() -> None:
    free = data(replace(ENTRY, speed_limit_rad_s=None))
    assert entries_table(free).values("speed_limit_kept") == [None]
    assert laws_table(free, "none").values("limit_kept") == [None]
    assert ",180.0,,,," in csv_text(entries_table(free))
