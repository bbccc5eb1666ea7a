"""How the norm-optimal law gets into the trajectory, beside runs of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import LinePlan, build_reference
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.laws.norm_optimal_merging import Merging, merging, merging_findings
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import Pose

SAMPLES, DT = 60, 0.02
LINE = build_reference("line", (0, 0, 0), [LinePlan(length=2.4, duration=1.2)], DT)  # 10 rad/s


def law(h: int = 20, model: Robot = PLATFORM) -> NormOptimalLaw:
    return NormOptimalLaw(model, h=h)


def experiment(
    start: Pose, limit: float = 15.0, h: int = 20, model: Robot = PLATFORM
) -> Experiment:
    made = experiment_of(LINE, law_of(0.0), initial_pose=start, speed_limit=limit, iterations=2)
    return replace(made, law=law(h, model))


def found_of(
    start: Pose, limit: float = 15.0, h: int = 20, model: Robot = PLATFORM
) -> tuple[Merging, Findings]:
    found = merging(experiment(start, limit, h, model), law(h, model))
    return found, merging_findings(found)


def test_who_is_behind_catches_up_with_the_difference_of_the_speeds() -> None:
    # 0.2 m behind 2 m/s with at most 15 * 0.2 = 3 m/s: 0.2 s, 10 samples.
    found, findings = found_of((-0.2, 0, 0))
    assert (found.earliest, found.is_off) == (10, True)
    assert (found.position_error, found.heading_error) == pytest.approx((0.2, 0))
    # Without noise the plan is what is driven; on the trajectory at h, and no sooner than need be.
    assert found.planned is not None
    assert 10 < found.planned <= 20
    assert findings == Findings()
    *_, trial = simulate(experiment((-0.2, 0, 0)))
    assert trial.figures["merge_time_s"] == pytest.approx(found.planned * DT)
    away = np.hypot(LINE.x - trial.x, LINE.y - trial.y)
    assert np.flatnonzero(away > 1.1e-3)[-1] < found.planned


def test_merge_is_that_of_the_true_platform_whatever_is_believed() -> None:
    start = (-0.1, 0.2, 0.3)
    exact, _ = found_of(start)
    wrong, _ = found_of(start, model=Robot(0.14, 0.6))
    assert wrong.planned == exact.planned
    assert (exact.fastest, exact.fastest_believed) == pytest.approx((10, 10))
    assert wrong.fastest_believed == pytest.approx(10 * 0.2 / 0.14)
    assert wrong.is_believed_possible
    assert not found_of(start, 14.0, model=Robot(0.14, 0.6))[0].is_believed_possible


def test_h_below_what_the_limit_allows_is_warned_of() -> None:
    found, findings = found_of((-0.2, 0, 0), h=5)
    assert found.planned is not None and found.planned >= 10
    (text,) = findings.warnings
    assert text == (
        f"the law merges into the trajectory at sample {found.planned} "
        f"({found.planned * DT:g} s), later than controller.h of 5: within controller.b_w of 15 "
        "rad/s no sample before 10 (0.2 s) can be reached from initial_pose; raise h to at least 10"
    )
    *_, trial = simulate(experiment((-0.2, 0, 0), h=5))
    assert trial.figures["merge_time_s"] == pytest.approx(found.planned * DT)


def test_start_out_of_reach_cannot_work() -> None:
    # 1.3 m behind: 1.2 s with 3 m/s make 3.6 m, 3.7 m are needed.
    found, findings = found_of((-1.3, 0, 0))
    assert (found.earliest, found.planned) == (None, None)
    (text,) = findings.failures
    assert text.startswith("from initial_pose no sample of the trajectory can be reached in time")
    near, findings = found_of((-1.19, 0, 0))
    assert near.earliest == SAMPLES  # 1.19 s
    (text,) = findings.failures
    assert "is on the trajectory from sample 59 of 60 on only (1.18 s)" in text


def test_trajectory_that_is_too_fast_is_left() -> None:
    found, findings = found_of((0, 0, 0), limit=9.0)
    assert not found.is_possible
    assert not found.is_off
    assert [text.partition(",")[0] for text in findings.warnings] == [
        "where the trajectory asks for more than controller.b_w"
    ]


def test_without_an_initial_error_there_is_no_way_in() -> None:
    found, findings = found_of((0, 0, 0))
    assert not found.is_off
    assert (found.earliest, found.planned, findings) == (0, 0, Findings())


def test_less_than_a_millimetre_counts_as_on_the_trajectory() -> None:
    found, findings = found_of((-0.0005, 0, 0))
    assert found.is_off
    assert (found.planned, findings) == (0, Findings())


def test_without_a_limit_everything_is_in_reach_at_once() -> None:
    found, findings = found_of((0.5, 0.5, 1.0), limit=math.inf)
    assert found.earliest == 0
    assert found.planned is not None and found.planned <= 22  # h, and two that nobody minds
    assert findings == Findings()


def test_start_from_which_there_is_a_way_but_not_for_this_law_cannot_work() -> None:
    assert found_of((0, 1.1, 0))[1].failures == ()  # a way that is late, and no more
    for aside in (1.4, 1.6):
        found, findings = found_of((0, aside, 0))
        assert found.earliest is not None
        (text,) = findings.failures
        assert text.startswith(f"from initial_pose, {aside:g} m off, the law within controller.b_w")
        *_, trial = simulate(experiment((0, aside, 0)))
        away = np.hypot(LINE.x - trial.x, LINE.y - trial.y)
        assert found.way.left_later == pytest.approx(away[SAMPLES // 2 :].max(), rel=0.02)
        assert found.way.left_later > 0.1 * 2.4


def test_trajectory_that_is_too_fast_is_reached_where_the_law_drives_it() -> None:
    near, findings = found_of((0, 0.05, 0), limit=9.9)
    assert not near.is_possible
    assert near.way.joins is not None
    assert findings.failures == ()
    far, findings = found_of((0, 1.5, 0), limit=9.9)
    assert len(findings.failures) == 1
    assert far.way.left_later > 0.5


def test_way_in_that_h_asks_for_may_end_as_late_as_it_says() -> None:
    found, findings = found_of((-0.7, 0, 0), h=50)
    assert found.way.joins is not None and found.way.joins > SAMPLES / 2
    assert findings == Findings()


@pytest.mark.parametrize(("planned", "told"), [(22, False), (23, True)])
def test_merge_a_little_behind_h_is_not_minded(planned: int, told: bool) -> None:
    found = replace(found_of((-0.2, 0, 0))[0], planned=planned)
    warnings = merging_findings(found).warnings
    assert [text.rpartition(", ")[2] for text in warnings] == [
        "because of controller.b_w of 15 rad/s; raise h for a gentler way in"
    ] * told
