"""What no law can avoid, beside closed forms and beside the fastest wheels there are."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.theory.feasibility.demand import demand_of
from hilc_cli.theory.feasibility.feasibility import Feasibility, Limits, feasibility_findings
from hilc_cli.theory.findings import ExpectedError
from hilc_cli.theory.noise.findings import least_error, with_what_is_left
from tests.engine.experiments import PLATFORM, experiment_of, law_of

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


def experiment(reference: Reference, limit: float, *, at_rest: bool = False) -> Experiment:
    """With the feedforward of the true platform, or wheels at rest."""
    inputs = None if at_rest else feedforward(reference, PLATFORM)
    return experiment_of(reference, law_of(1.0), initial_input=inputs, speed_limit=limit)


def findings(
    given: Experiment, expected: ExpectedError | None = None, friction: float | None = None
) -> tuple[int, int]:
    """The numbers of failures and of warnings that are made of failures."""
    reference = given.reference
    names = [f"segments.{index}" for index in range(len(reference.lengths))]
    limits = Limits(given.speed_limit, friction)
    feasibility = Feasibility(demand_of(reference, PLATFORM, names), PLATFORM, limits)
    found = feasibility_findings(feasibility)
    judged = with_what_is_left(found, feasibility, given, PLATFORM, expected)
    assert len(judged.failures) + len(judged.warnings) == len(found.failures) + len(found.warnings)
    return len(judged.failures), sum("error is left" in text for text in judged.warnings)


@pytest.mark.parametrize("share", [0.35, 0.8, 1.0, 1.4])
def test_on_a_line_the_robot_falls_behind(share: float) -> None:
    # 1.5 m/s on wheels of 0.2 m are 7.5 rad/s.
    assert least_error(experiment(AHEAD, 7.5 * share)) == pytest.approx(
        3.0 * max(0.0, 1 - share), abs=1e-12
    )


def test_no_limit_makes_nothing_unavoidable() -> None:
    assert least_error(experiment(CIRCLE, math.inf)) == 0


@pytest.mark.parametrize("share", [0.4, 0.7])
def test_of_a_circle_chords_are_left(share: float) -> None:
    # The chord over an angle is 2 r sin(a / 2), the way driven meanwhile share * r * a. From the
    # start, where it is on the circle, the robot has to get to the other side.
    speed = 2.0 * 2 * math.pi / 5
    angle = 2 * math.acos(share)
    between = 2.0 * (2 * math.sin(angle / 2) - share * angle) / 2
    expected = max(between, 4.0 - share * 2.0 * math.pi)
    found = least_error(experiment(CIRCLE, share * speed / PLATFORM.wheel_radius))
    assert found == pytest.approx(expected, rel=0.01)


def test_what_is_far_too_fast_cannot_work() -> None:
    for at_rest in (True, False):
        assert findings(experiment(AHEAD, 5.0, at_rest=at_rest)) == (1, 0)


def test_what_is_hardly_too_fast_is_a_warning() -> None:
    assert findings(experiment(AHEAD, 7.499)) == (0, 1)


def test_corner_that_takes_some_samples_is_judged_by_what_it_leaves() -> None:
    given = experiment(CORNER, 12.0)
    first = ExpectedError(0.5, 0.5, 0.5)
    assert findings(given) == (0, 1)
    assert findings(given, replace(first, final_m=0.02)) == (0, 1)
    assert findings(given, replace(first, final_m=2.5)) == (1, 0)
    assert findings(given, replace(first, final_m=2.5, unsure="nothing is known")) == (0, 1)


def test_what_is_left_is_said_only_where_it_is_known() -> None:
    found = {
        None: "; as it is, how much of error is left is not known (--simulate)",
        ExpectedError(0.5, 0.37, 0.4): "; as it is, about 0.37 m of error is left",
        ExpectedError(0.5, 0.37, 0.4, unsure="so"): "is not known (--simulate)",
    }
    given = experiment(CORNER, 12.0)
    names = [f"segments.{index}" for index in range(2)]
    feasibility = Feasibility(demand_of(CORNER, PLATFORM, names), PLATFORM, Limits(12.0, None))
    failures = feasibility_findings(feasibility)
    for expected, end in found.items():
        judged = with_what_is_left(failures, feasibility, given, PLATFORM, expected)
        assert judged.warnings[0].endswith(end)


def test_what_tyres_do_not_hold_stays_a_failure() -> None:
    failures, softened = findings(experiment(CIRCLE, 100.0), friction=0.1)
    assert (failures, softened) == (1, 0)


def test_start_counts_from_the_second_half_on() -> None:
    # Enough for the path, too little to be in time from a metre behind.
    given = replace(experiment(AHEAD, 7.5), initial_pose=(-1.0, 0.0, 0.0))
    assert least_error(given) == pytest.approx(1.0)
    np.testing.assert_allclose(least_error(replace(given, speed_limit=10.0)), 0.5, atol=0.02)
