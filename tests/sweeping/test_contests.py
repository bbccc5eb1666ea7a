"""The runs of a leaderboard: what the shipped one must show, and what becomes of odd ones."""

from __future__ import annotations

from itertools import islice

import pytest

from hilc_cli.results.leaderboard import Entry
from hilc_cli.spec.leaderboard import Contest, load_leaderboard
from hilc_cli.sweeping import contests
from hilc_cli.sweeping.contests import Contests, FailedContestError, compete, hold

SHIPPED = load_leaderboard("example:leaderboard")
UNDISTURBED = [
    contest
    for contest in SHIPPED.contests()
    if contest.law == "norm-optimal" and contest.disturbance == "none"
]


def name(contest: Contest) -> str:
    return f"{contest.case}-{contest.belief}"


def test_the_shipped_leaderboard_has_all_cases() -> None:
    assert SHIPPED.size == 8 * 3 * 2 * 6
    assert len(UNDISTURBED) == 24
    starts = [scenario.spec.initial_error for scenario in SHIPPED.cases.values()]
    assert sum(any(start) for start in starts) == 4
    assert {
        (each.spec.model.wheel_radius, each.spec.model.half_track)
        for each in (contest.scenario for contest in UNDISTURBED)
    } == {(0.2, 0.518), (0.7 * 0.2, 1.3 * 0.518), (1.3 * 0.2, 0.7 * 0.518)}


# Each case once, with a wrong belief; all 24 are in docs/laws.md.
HARD = [
    contest
    for contest in UNDISTURBED
    if contest.belief == ("R0.7-B1.3" if contest.case.endswith("-off") else "R1.3-B0.7")
]


@pytest.mark.parametrize("contest", HARD, ids=map(name, HARD))
def test_norm_optimal_learning_is_within_5_mm_after_5_iterations(contest: Contest) -> None:
    scenario = contest.scenario
    spec = scenario.spec.model_copy(update={"iterations": 5})
    entry = compete(
        Contest(contest.case, contest.belief, "none", contest.law, type(scenario)(spec)), [5], 0.005
    )
    assert entry.speed_limit_rad_s == 180
    assert entry.fastest_wheel_rad_s <= 180
    assert entry.max_m[0] <= 0.005
    if not any(spec.initial_error):
        assert entry.whole_max_m[0] <= 0.005


def test_law_that_does_not_learn_is_run_once_where_nothing_is_disturbed() -> None:
    contest = next(each for each in SHIPPED.contests() if each.law == "feedback")
    assert contest.disturbance == "none"
    entry = compete(contest, [1, 100], 0.01)
    assert entry.max_m[0] == entry.max_m[1] < 0.01
    assert entry.settled_at == 0


def test_run_that_cannot_be_computed_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def compete(*_: object) -> Entry:
        raise ZeroDivisionError("nothing to divide by")

    monkeypatch.setattr(contests, "compete", compete)
    runs = tuple(islice(SHIPPED.contests(), 1))
    told = r"law paper-17, case circle, belief exact, disturbance none: ZeroDivisionError: nothing"
    with pytest.raises(FailedContestError, match=told):
        hold(Contests(runs, (1,), 0.01), workers=1)
