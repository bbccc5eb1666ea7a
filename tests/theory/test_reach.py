"""Starts from which the trajectory is not reached, and what no law can avoid where it is too fast.

Both stand beside closed forms, and beside what simulated robots and the fastest wheels reach.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.feasibility.demand import demand_of
from hilc_cli.theory.feasibility.feasibility import Feasibility, Limits, feasibility_findings
from hilc_cli.theory.findings import ExpectedError, Findings
from hilc_cli.theory.law_theory import law_theory
from hilc_cli.theory.reach import (
    cannot_be_reached,
    earliest_merge,
    judged_feasibility,
    least_error,
    least_left,
    shortest_way,
    start_findings,
)
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import Pose

DT = 0.02
LINE = build_reference("line", (0, 0, 0), [LinePlan(length=2.4, duration=1.2)], DT)  # 10 rad/s


def experiment(start: Pose, limit: float = 15.0, *, compensation: bool = False) -> Experiment:
    law = law_of(5.0, compensation=compensation, h=20)
    return experiment_of(LINE, law, initial_pose=start, speed_limit=limit, iterations=2)


def findings(made: Experiment) -> Findings:
    return start_findings(law_theory(made))


@pytest.mark.parametrize("compensation", [True, False])
def test_start_too_far_behind_for_the_wheels_cannot_work(compensation: bool) -> None:
    # 1.2 s with 3 m/s are 3.6 m, of which the line takes 2.4: 1.4 m behind 0.2 m are missing.
    (text,) = findings(experiment((-1.4, 0, 0), compensation=compensation)).failures
    assert text == (
        "from initial_pose no sample of the trajectory can be reached in time within "
        "controller.b_w of 15 rad/s, whatever the law: it is out of reach by 0.2 m at least; "
        "start nearer, or run the trajectory slower"
    )
    assert findings(experiment((-1.19, 0, 0), compensation=compensation)).failures == ()
    # What is left is less than a hundredth of the path.
    assert findings(experiment((-1.22, 0, 0), compensation=compensation)).failures == ()
    assert cannot_be_reached(experiment((-1.4, 0, 0), math.inf)) == ""


def test_start_out_of_reach_is_told_of_a_law_of_which_no_errors_are_predicted() -> None:
    made = replace(experiment((-1.4, 0, 0)), law=FeedbackLaw(1.0, 1.0, 1.0, PLATFORM))
    assert len(start_findings(law_theory(made)).failures) == 1
    near = replace(made, initial_pose=(-0.4, 0, 0))
    own = law_theory(near).way_in  # 1.2 s at 1 / s leave 0.12 m of 0.4 m
    assert len(own.failures) == 1
    assert start_findings(law_theory(near)) == own


def test_trajectory_that_is_too_fast_is_not_blamed_on_the_start() -> None:
    assert findings(experiment((-0.1, 0, 0), 9.0)) == Findings()
    assert findings(experiment((0, 0, 0), 9.0)) == Findings()


def test_no_robot_gets_nearer_than_what_is_left() -> None:
    # 300 robots with random wheels at the limit, three speeds each.
    random = np.random.default_rng(8)
    start = np.array([-0.7, -0.9, 2.0])
    trajectory = np.stack([LINE.x, LINE.y, LINE.heading], axis=1)
    limit = 0.2 * 12.0
    bound = least_left(trajectory, start, limit, PLATFORM.half_track, DT)
    assert bound > 0
    wheels = random.choice([-1, 0.2, 1], (300, 2, 3)).repeat(LINE.samples // 3, axis=2) * limit
    heading = start[2] + np.cumsum(np.diff(wheels, axis=1)[:, 0], axis=1) * DT / (
        2 * PLATFORM.half_track
    )
    heading = np.concatenate([np.full((300, 1), start[2]), heading], axis=1)
    steps = wheels.mean(axis=1) * DT * np.exp(1j * heading[:, :-1])
    away = np.abs(complex(*start[:2]) + np.cumsum(steps, axis=1) - (LINE.x + 1j * LINE.y)[1:])
    left = away + PLATFORM.half_track * np.abs(heading[:, 1:] - LINE.heading[1:])
    assert left.min() >= bound * (1 - 1e-9)


def test_h_that_is_too_short_for_the_wheels_is_warned_of() -> None:
    # 0.5 m behind, by 1 m/s: 0.5 s, 25 samples.
    (text,) = findings(experiment((-0.5, 0, 0), compensation=True)).warnings
    assert text == (
        "controller.h of 20 is sooner than any law can be on the trajectory: within controller.b_w "
        "of 15 rad/s that is at sample 25 (0.5 s) at the earliest; raise h"
    )
    assert findings(experiment((-0.39, 0, 0), compensation=True)) == Findings()
    assert findings(experiment((-0.5, 0, 0))) == Findings()


def test_law_that_stays_far_away_cannot_work() -> None:
    # Nothing is learned of an error across the heading.
    (text,) = findings(experiment((0, 3.0, 0), math.inf)).failures
    assert text == (
        "from initial_pose, 3 m off a trajectory of 2.4 m, the law does not get onto it before its "
        "end: 3 m are left; start nearer, or set 'compensation: on'"
    )
    assert findings(experiment((0, 2.3, 0), math.inf)).failures == ()  # warned of, see rest
    assert findings(experiment((0, 0, 0), math.inf)) == Findings()


AHEAD = build_reference("ahead", (0, 0, 0), [LinePlan(length=3.0, duration=2.0)], 0.02)
CIRCLE = build_reference(
    "circle", (0, 0, 0), [ArcPlan(radius=2.0, sweep=2 * math.pi, turn="left", duration=5.0)], 0.02
)
CORNER = build_reference(
    "corner",
    (0, 0, 0),
    [LinePlan(length=3.0, duration=3.0), LinePlan(to=(3.4, 1.5), duration=2.0)],
    0.02,
    corners=True,
)


def bounded(reference: Reference, limit: float, *, at_rest: bool = False) -> Experiment:
    """With the feedforward of the true platform, or wheels at rest."""
    inputs = None if at_rest else feedforward(reference, PLATFORM)
    return experiment_of(reference, law_of(1.0), initial_input=inputs, speed_limit=limit)


def judged(
    given: Experiment, expected: ExpectedError | None = None, friction: float | None = None
) -> tuple[int, int]:
    """The numbers of failures and of warnings that are made of failures."""
    reference = given.reference
    names = [f"segments.{index}" for index in range(len(reference.lengths))]
    limits = Limits(given.speed_limit, friction)
    feasibility = Feasibility(demand_of(reference, PLATFORM, names), PLATFORM, limits)
    plain = feasibility_findings(feasibility)
    found = judged_feasibility(feasibility, given, PLATFORM, expected)
    assert len(found.failures) + len(found.warnings) == len(plain.failures) + len(plain.warnings)
    return len(found.failures), sum("error is left" in text for text in found.warnings)


@pytest.mark.parametrize("share", [0.35, 0.8, 1.0, 1.4])
def test_on_a_line_the_robot_falls_behind(share: float) -> None:
    # 1.5 m/s on wheels of 0.2 m are 7.5 rad/s.
    assert least_error(bounded(AHEAD, 7.5 * share)) == pytest.approx(
        3.0 * max(0.0, 1 - share), abs=1e-12
    )


def test_no_limit_makes_nothing_unavoidable() -> None:
    assert least_error(bounded(CIRCLE, math.inf)) == 0


@pytest.mark.parametrize("share", [0.4, 0.7])
def test_of_a_circle_chords_are_left(share: float) -> None:
    # The chord over an angle is 2 r sin(a / 2), the way driven meanwhile share * r * a. From the
    # start, where it is on the circle, the robot has to get to the other side.
    speed = 2.0 * 2 * math.pi / 5
    angle = 2 * math.acos(share)
    between = 2.0 * (2 * math.sin(angle / 2) - share * angle) / 2
    expected = max(between, 4.0 - share * 2.0 * math.pi)
    found = least_error(bounded(CIRCLE, share * speed / PLATFORM.wheel_radius))
    assert found == pytest.approx(expected, rel=0.01)


def test_what_is_far_too_fast_cannot_work() -> None:
    for at_rest in (True, False):
        assert judged(bounded(AHEAD, 5.0, at_rest=at_rest)) == (1, 0)


def test_what_is_hardly_too_fast_is_a_warning() -> None:
    assert judged(bounded(AHEAD, 7.499)) == (0, 1)


def test_corner_that_takes_some_samples_is_judged_by_what_it_leaves() -> None:
    given = bounded(CORNER, 12.0)
    first = ExpectedError(0.5, 0.5, 0.5)
    assert judged(given) == (0, 1)
    assert judged(given, replace(first, final_m=0.02)) == (0, 1)
    assert judged(given, replace(first, final_m=2.5)) == (1, 0)
    assert judged(given, replace(first, final_m=2.5, unsure="nothing is known")) == (0, 1)


def test_what_is_left_is_said_only_where_it_is_known() -> None:
    found = {
        None: "; as it is, how much of error is left is not known (--simulate)",
        ExpectedError(0.5, 0.37, 0.4): "; as it is, about 0.37 m of error is left",
        ExpectedError(0.5, 0.37, 0.4, unsure="so"): "is not known (--simulate)",
    }
    given = bounded(CORNER, 12.0)
    names = [f"segments.{index}" for index in range(2)]
    feasibility = Feasibility(demand_of(CORNER, PLATFORM, names), PLATFORM, Limits(12.0, None))
    for expected, end in found.items():
        (text, *_) = judged_feasibility(feasibility, given, PLATFORM, expected).warnings
        assert text.endswith(end)


def test_what_tyres_do_not_hold_stays_a_failure() -> None:
    failures, softened = judged(bounded(CIRCLE, 100.0), friction=0.1)
    assert (failures, softened) == (1, 0)


def test_start_counts_from_the_second_half_on() -> None:
    # Enough for the path, too little to be in time from a metre behind.
    given = replace(bounded(AHEAD, 7.5), initial_pose=(-1.0, 0.0, 0.0))
    assert least_error(given) == pytest.approx(1.0)
    np.testing.assert_allclose(least_error(replace(given, speed_limit=10.0)), 0.5, atol=0.02)


def straight(n: int) -> Floats:
    poses = np.zeros((n + 1, 3))
    poses[:, 0] = np.arange(n + 1.0)
    return poses


@pytest.mark.parametrize(
    ("start", "expected"),
    [
        ((0.0, 0.0, 0.0), 0),
        # At 2 m/s behind what moves at 1 m/s: 5 m are made good after 5 s.
        ((-5.0, 0.0, 0.0), 5),
        # 4 m ahead: they meet after 4 / 3 s, backwards; the next sample is 2.
        ((4.0, 0.0, 0.0), 2),
        # A turn by 1 rad takes 0.5 m of wheel; t + 0.5 <= 2 t.
        ((0.0, 0.0, 1.0), 1),
        # Turned by pi: B pi = 1.57 m.
        ((0.0, 0.0, math.pi), 2),
        # 3 m aside, at (m, 0): root(m^2 + 9) + 2 * 0.5 atan(3 / m) <= 2 m.
        ((0.0, 3.0, 0.0), 3),
    ],
)
def test_earliest_merge_by_hand(start: tuple[float, float, float], expected: int) -> None:
    assert earliest_merge(straight(10), np.array(start), 2.0, 0.5, 1.0) == expected


def test_earliest_merge_is_not_after_a_zigzag_that_was_driven() -> None:
    # Ahead, turn in place, back: into a pose 0.1 m ahead, from 30 deg to its left to 150 deg.
    top, half_track, sample_time = 36.0, 0.518, 0.001
    low, high = math.radians(30), math.radians(150)
    pieces = [  # lengths from the law of sines, rounded up to whole samples
        (0.1 * math.sin(high) / math.sin(high - low), 0.0),
        (0.0, high - low),
        (-0.1 * math.sin(low) / math.sin(high - low), 0.0),
    ]
    x, y, heading, samples = 0.0, 0.0, low, 0
    for length, turn in pieces:
        need = math.ceil((abs(length) + half_track * turn) / (top * sample_time))
        for _ in range(need):
            x += length / need * math.cos(heading)
            y += length / need * math.sin(heading)
            heading += turn / need
        samples += need
    pose = np.array([0.1, 0.0, high])
    assert np.array([x, y, heading]) == pytest.approx(pose, abs=1e-12)
    assert samples == 35
    earliest = earliest_merge(
        np.tile(pose, (50, 1)), np.array([0, 0, low]), top, half_track, sample_time
    )
    assert earliest is not None
    assert samples - 2 <= earliest <= samples  # two pieces were rounded up for nothing


@pytest.mark.parametrize("seed", range(12))
def test_shortest_way_is_the_best_of_all_sequences(seed: int) -> None:
    """Turn, straight, turn, straight, turn, straight, turn: three headings and one free length."""
    random = np.random.default_rng(seed)
    start_heading, end_heading = random.uniform(-4, 4, 2)
    half_track, x, y = (
        random.uniform(0.2, 1.0),
        *random.normal(0, 10 ** random.uniform(-1.5, 0.5), 2),
    )

    def way(headings: Floats, third: Floats) -> Floats:
        """What sequences cost; headings of shape (3, cases), lengths at the third of them."""
        cos, sin = np.cos(headings), np.sin(headings)
        rest_x, rest_y = x - third * cos[2], y - third * sin[2]
        # The first two lengths lead to where the third begins.
        across = cos[0] * sin[1] - sin[0] * cos[1]
        first = (rest_x * sin[1] - rest_y * cos[1]) / across
        second = (rest_y * cos[0] - rest_x * sin[0]) / across
        turns = np.abs(np.diff(headings, axis=0, prepend=start_heading, append=end_heading))
        lengths = np.abs(first) + np.abs(second) + np.abs(third)
        cost: Floats = lengths + half_track * turns.sum(axis=0)
        return cost

    least = shortest_way(
        np.array([[x, y, end_heading]]), np.array([0, 0, start_heading]), half_track
    )[0]
    wide = random.uniform(-6, 6, (3, 100_000))
    wide[0, ::4], wide[1, 1::4] = start_heading, end_heading  # without the first or a later turn
    third = random.normal(0, 1, wide.shape[1]) * np.tile([0.0, 1.0], wide.shape[1] // 2)
    costs = way(wide, third)
    assert np.all(costs >= least * (1 - 1e-9))
    # The best is refined by ever smaller random changes, some of them of one number alone.
    best = np.concatenate([wide, third[None]])[:, costs.argmin()]
    for size in np.geomspace(1.0, 1e-6, 40).tolist():
        some = random.choice([0.0, 1.0], (4, 2000))
        near: Floats = best[:, None] + random.normal(0, size, (4, 2000)) * some
        near[:, 0] = best
        near[3, ::3] = 0.0
        costs = way(near[:3], near[3])
        best = near[:, costs.argmin()]
    assert costs.min() == pytest.approx(least, rel=1e-3)


def test_what_cannot_be_caught_up_with_is_none() -> None:
    assert earliest_merge(straight(10), np.array([-5.0, 0, 0]), 1.0, 0.5, 1.0) is None
