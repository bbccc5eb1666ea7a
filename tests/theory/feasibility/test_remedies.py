"""What is said of references that ask too much: the sentences and the numbers in them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import pytest

from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.theory.feasibility.demand import demand_of
from hilc_cli.theory.feasibility.feasibility import (
    Feasibility,
    Limits,
    beyond_wheels,
    feasibility_findings,
)
from hilc_cli.theory.findings import Findings

PLATFORM = Robot(0.2, 0.5)
HALF_TURN = ArcPlan(math.pi, "left", radius=2.0, duration=1.0)
AHEAD = LinePlan(to=(3.0, 0.0), duration=0.4)
ASIDE = LinePlan(to=(3.0, 3.0), duration=2.0)
ACROSS = LinePlan(to=(0.0, 0.0), duration=2.0)
BACK = LinePlan(to=(0.0, 3.0), duration=2.0)


def untold(found: Findings) -> list[str]:
    """The warnings but for that of wheels that are to be fast at once."""
    return [text for text in found.warnings if " at once: " not in text]


def findings(plans: Sequence[SegmentPlan], limits: Limits, sample_time: float = 0.001) -> Findings:
    reference = build_reference("path", (0, 0, 0), plans, sample_time, corners=True)
    names = [f"segments.{index}.piece" for index in range(len(plans))]
    return feasibility_findings(
        Feasibility(demand_of(reference, PLATFORM, names), PLATFORM, limits)
    )


def test_slow_path_is_not_spoken_of() -> None:
    assert findings([LinePlan(length=1.0, duration=10.0)], Limits(0.5, 0.1)) == Findings()


def test_fast_line_is_to_take_longer() -> None:
    # 15 rad of wheel in 0.4 s; 15 / 18 s, in whole milliseconds.
    assert findings([AHEAD], Limits(18.0)).failures == (
        "trajectory.segments.0.piece needs a wheel speed of 37.5 rad/s, above b_w of 18 rad/s; "
        "give it at least 0.834 s (at most 3.59712 m/s) instead of 0.4 s",
    )


def test_sharp_arc_is_to_take_longer() -> None:
    # 2 pi^2 m/s^2; pi sqrt(2 / (0.5 g)) s.
    assert findings([HALF_TURN], Limits(friction=0.5)).failures == (
        "trajectory.segments.0.piece needs 19.74 m/s^2 of lateral acceleration, above the "
        "4.903 m/s^2 that a friction of 0.5 holds; "
        "give it at least 2.007 s (at most 3.13063 m/s) instead of 1 s",
    )


@pytest.mark.parametrize(
    ("plans", "limits", "told"),
    [
        ([AHEAD], Limits(37.5), []),
        ([AHEAD], Limits(), []),
        ([HALF_TURN], Limits(friction=0.01), []),  # no matter to wheels
        ([HALF_TURN], Limits(37.0), ["39.27"]),  # (2 pi + 0.5 pi) / 0.2
        # The last millisecond of 7.5 m/s turns by 3 pi / 4: (7.5 + 0.5 * 750 pi) / 0.2.
        ([AHEAD, BACK], Limits(18.0), ["5928"]),
    ],
)
def test_before_a_run_the_fastest_wheel_is_told(
    plans: Sequence[SegmentPlan], limits: Limits, told: Sequence[str]
) -> None:
    reference = build_reference("path", (0, 0, 0), plans, 0.001, corners=True)
    names = [f"segments.{index}.piece" for index in range(len(plans))]
    demand = demand_of(reference, PLATFORM, names)
    assert beyond_wheels(Feasibility(demand, PLATFORM, limits)) == [
        f"the trajectory needs wheel speeds up to {speed} rad/s, above b_w of "
        f"{limits.wheel_speed:g} rad/s: the platform cannot follow it, whatever the law; see "
        "'hilc check'"
        for speed in told
    ]


def test_both_limits_are_told_together() -> None:
    (text,) = findings([HALF_TURN], Limits(20.0, 0.5)).failures
    assert text == (
        "trajectory.segments.0.piece needs a wheel speed of 39.27 rad/s, above b_w of 20 rad/s, "
        "and 19.74 m/s^2 of lateral acceleration, above the 4.903 m/s^2 that a friction of 0.5 "
        "holds; give it at least 2.007 s (at most 3.13063 m/s) instead of 1 s"
    )


@pytest.mark.parametrize("plan", [AHEAD, HALF_TURN])
@pytest.mark.parametrize("limits", [Limits(7.123), Limits(0.777, 0.123), Limits(33.0, 0.4)])
def test_remedy_works_as_it_is_written(plan: ArcPlan | LinePlan, limits: Limits) -> None:
    for text in findings([plan], limits).failures:
        words = text.partition("; give it at least ")[2].split()
        for duration, speed in ((float(words[0]), None), (None, float(words[4]))):
            slower = replace(plan, duration=duration, speed=speed)
            assert findings([slower], limits).failures == ()


def test_excess_is_seen_in_the_digits() -> None:
    (text,) = findings([AHEAD], Limits(37.4999)).failures
    assert "a wheel speed of 37.5 rad/s, above b_w of 37.4999 rad/s; " in text
    assert text.endswith("at least 0.401 s (at most 7.48129 m/s) instead of 0.4 s")


def test_offences_are_told_in_the_order_of_the_path() -> None:
    failures = findings([AHEAD, ASIDE, BACK], Limits(7.0)).failures
    assert [text.split(" ")[:3] for text in failures] == [
        ["trajectory.segments.0.piece", "needs", "a"],
        ["trajectory.segments.1.piece", "starts", "with"],
        ["trajectory.segments.1.piece", "needs", "a"],
        ["trajectory.segments.2.piece", "starts", "with"],
        ["trajectory.segments.2.piece", "needs", "a"],
    ]
    # 7.5 m/s and pi / 2 in a millisecond.
    assert failures[1] == (
        "trajectory.segments.1.piece starts with a corner of 1.571 rad, and to turn it in one "
        "sample needs a wheel speed of 3964 rad/s, above b_w of 7 rad/s; round it with an arc"
    )


def test_sharpest_corner_that_is_possible_is_warned_of() -> None:
    # Corners of 90 and 135 degrees, the second one at 1.5 m/s.
    assert untold(findings([AHEAD, ASIDE, ACROSS], Limits())) == [
        "trajectory.segments.2.piece starts with a corner of 2.356 rad (135 deg), the sharpest of "
        "2: turned in one sample, it takes wheels of 5898 rad/s and 3530 m/s^2 sideways; a "
        "robot has to stop for it: round it with an arc"
    ]


def test_friction_that_no_tyre_has_is_warned_of_if_none_is_given() -> None:
    (text,) = untold(findings([LinePlan(length=1.0, duration=1.0), HALF_TURN], Limits()))
    assert text == (
        "trajectory.segments.1.piece needs 19.74 m/s^2 of lateral acceleration, 2.01 g where "
        "tyres hold about 1 g; run it slower, or give robot.friction"
    )
    assert untold(findings([HALF_TURN], Limits(friction=2.1))) == []


def test_coarse_turn_is_warned_of() -> None:
    arc = ArcPlan(math.pi, "left", radius=2.0, duration=10.0)
    assert findings([arc], Limits(), 0.5) == Findings()  # 0.157 rad in a sample
    (text,) = findings([arc], Limits(), 1.0).warnings
    assert text.startswith("trajectory.segments.0.piece turns by 0.314 rad in a sample, ")


def test_speed_that_no_tyre_lets_a_robot_gain_at_once_is_warned_of() -> None:
    # 7.5 m/s in a millisecond are 765 g; with 1 g it takes 0.765 s, longer than the line, over
    # which g t^2 / 2 are driven instead of 3 m.
    behind = 3.0 - 9.80665 * 0.4**2 / 2
    assert findings([AHEAD], Limits(100.0)).warnings == (
        "trajectory.segments.0.piece starts at once: 7.5 m/s in one sample, 765 g where tyres hold "
        f"1 g: a robot gets {behind:.2g} m behind; lead up to it slowly",
    )


def test_speed_that_is_gained_in_steps_is_warned_of_where_it_is_gained() -> None:
    # 0.1 m/s, then 4 m/s: v^2 / (2 mu g) = 3.9^2 / 9.80665 behind, of 10.1 m.
    plans = [LinePlan(length=0.1, duration=1.0), LinePlan(length=10.0, duration=2.5)]
    (text,) = findings(plans, Limits(friction=0.5)).warnings
    assert text.startswith(
        "trajectory.segments.1.piece changes wheel speeds at once: 3.9 m/s in one sample, 398 g "
        "where tyres hold 0.5 g: a robot gets 1.6 m behind; "
    )
    # Ten times the length: less than a hundredth of it.
    longer = [plans[0], LinePlan(length=200.0, duration=50.0)]
    assert findings(longer, Limits(friction=0.5)).warnings == ()
    # In a sample of 0.5 s the tyres hold it.
    assert findings(plans, Limits(), 0.5).warnings == ()


def test_remedy_beyond_the_longest_path_names_the_sample_time() -> None:
    (text,) = findings([AHEAD], Limits(0.001)).failures
    assert text.endswith(
        "; give it at least 15000 s (at most 0.0002 m/s) instead of 0.4 s, and a longer "
        "sample_time: a path has at most 1000000 samples"
    )
    (text,) = findings([AHEAD], Limits(1e-300)).failures
    assert text.endswith("; no duration would do: raise the limit")
