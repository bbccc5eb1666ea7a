"""Leaderboards with a case whose trajectory has a speed profile."""

from __future__ import annotations

import pytest

from hilc_cli.errors import InvalidInputError
from hilc_cli.leaderboards.plan import load_leaderboard
from tests.cli.inputs import SCENARIO
from tests.conftest import Write

PATH = """\
name: path
sample_time: 50 ms
start: {x: 0, y: 0, heading: 0}
timing: {acceleration: 0.5}
segments:
  - line: {length: 0.983}
"""
GAINS = {"l1": 0.5}
LEADERBOARD = {
    "name": "profiles",
    "cases": {"line": "scenario.yaml"},
    "beliefs": {"exact": {}, "small": {"wheel_radius": 0.5}},
    "laws": {"slow": {"gains": GAINS, "b_w": 1}, "fast": {"gains": GAINS, "b_w": 2}},
}


def test_each_law_and_belief_has_the_profile_of_its_wheels(write: Write) -> None:
    write({"path.yaml": PATH, "scenario.yaml": SCENARIO})
    found = {
        (contest.belief, contest.law): contest.scenario.experiment().reference.samples
        for contest in load_leaderboard(LEADERBOARD).contests()
    }
    # A line of length s from rest to rest takes s / v + v / a.
    assert found == {
        ("exact", "slow"): 107,  # 0.2 m/s: 4.915 + 0.4 s
        ("exact", "fast"): 66,  # 0.4 m/s: 2.4575 + 0.8 s
        ("small", "slow"): 201,  # 0.1 m/s: 9.83 + 0.2 s
        ("small", "fast"): 107,
    }


def test_a_law_without_the_limit_that_a_profile_needs_is_told(write: Write) -> None:
    write({"path.yaml": PATH, "scenario.yaml": SCENARIO})
    laws = {"fast": {"gains": GAINS, "b_w": 2}, "free": {"gains": GAINS}}
    with pytest.raises(InvalidInputError) as caught:
        load_leaderboard({**LEADERBOARD, "laws": laws})
    (told,) = str(caught.value).splitlines()
    assert told.endswith(
        "laws.free.b_w: nothing limits the speed of the path (case line, belief exact); give "
        "'speed' or 'wheel_speed' or 'lateral_acceleration'"
    )
