"""Entries of a leaderboard, from made-up numbers."""

from __future__ import annotations

import math
from dataclasses import replace

from hilc_cli.leaderboards.contests import Entry

ENTRY = Entry(
    *("bend", "exact", "none", "slow"),
    max_m=(3.0, 0.5),
    mean_m=(2.0, 0.25),
    whole_max_m=(4.0, 1.0),
    within_at=None,
    within_share=None,
    settled_at=None,
    peak_m=5.0,
    fastest_wheel_rad_s=180.0,
    speed_limit_rad_s=180.0,
    diverged_at=None,
    seconds_per_iteration=0.5,
)
FAST = replace(ENTRY, law="fast", max_m=(0.5, 0.004), within_at=2, within_share=0.75, settled_at=6)


def test_limit_is_kept_up_to_its_very_value() -> None:
    assert ENTRY.keeps_limit
    assert not replace(ENTRY, fastest_wheel_rad_s=math.nextafter(180, 181)).keeps_limit
    assert replace(ENTRY, speed_limit_rad_s=None).keeps_limit is None
