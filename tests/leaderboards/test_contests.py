"""The runs of a leaderboard, and entries of made-up numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple, replace
from itertools import islice

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import DivergedError
from hilc_cli.laws.feedback import FeedbackController
from hilc_cli.leaderboards.comparing import compare_laws
from hilc_cli.leaderboards.contests import (
    FailedContestError,
    compete,
    compute_entries,
    run_heat,
)
from hilc_cli.leaderboards.entries import Entry
from hilc_cli.leaderboards.heats import Heat, heats
from hilc_cli.leaderboards.plan import Contest, load_leaderboard
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.experiment import Scenario

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


SHIPPED = load_leaderboard("example:leaderboard")
UNDISTURBED = [
    contest
    for contest in SHIPPED.contests()
    if contest.law == "norm-optimal" and contest.disturbance == "none"
]


def name(contest: Contest) -> str:
    return f"{contest.case}-{contest.belief}"


def test_the_shipped_leaderboard_has_all_cases() -> None:
    assert SHIPPED.size == 8 * 3 * 2 * 7
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
    short = Contest(contest.case, contest.belief, "none", contest.law, type(scenario)(spec))
    entry = compete(short, [5], 0.005)
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
    assert (entry.within_at, entry.within_share, entry.settled_at) == (0, 1, 0)
    assert entry.peak_m == entry.whole_max_m[0]


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> Contest:
    """The paper's law, whose iterations are trials on the circle so many metres outside of it."""
    found = next(each for each in SHIPPED.contests() if each.law == "paper-17")
    scenario = found.scenario
    spec = scenario.spec.model_copy(update={"iterations": len(OFF) - 1})
    reference = spec.trajectory.reference()

    def simulate(experiment: Experiment, learning: object) -> Iterator[Trial]:
        wheels = np.zeros(len(reference.x) - 1)
        for iteration, off in enumerate(OFF[: experiment.iterations + 1]):
            if math.isinf(off):
                raise DivergedError(iteration)
            x = reference.x + off
            yield Trial(iteration, x, reference.y, reference.heading, wheels, wheels)

    monkeypatch.setattr("hilc_cli.engine.loop.simulate", simulate)
    return replace(found, scenario=type(scenario)(spec))


OFF = (20.0, 3.0, 0.5, 2.0, 0.25, 0.5, math.inf, math.inf)
"""Error of each iteration [m]."""


def test_what_is_told_of_the_iterations(made_up: Contest, monkeypatch: pytest.MonkeyPatch) -> None:
    lost = compete(made_up, [1, 7], 0.75)
    assert lost.max_m == lost.whole_max_m
    assert list(lost.max_m) == pytest.approx([3, math.inf])
    # Of iterations 2 to 7, those numbered 2, 4 and 5 are within 0.75 m.
    assert (lost.within_at, lost.within_share, lost.settled_at) == (2, 3 / 6, None)
    assert (lost.peak_m, lost.diverged_at) == (math.inf, 6)
    spec = made_up.scenario.spec
    whole = spec.model_copy(update={"iterations": 5})
    entry = compete(replace(made_up, scenario=type(made_up.scenario)(whole)), [0, 5], 0.75)
    assert list(entry.max_m) == pytest.approx([20, 0.5])
    assert (entry.within_at, entry.within_share, entry.settled_at) == (2, 3 / 4, 4)
    assert entry.peak_m == pytest.approx(3)
    never = compete(made_up, [7], 0.2)
    assert (never.within_at, never.within_share, never.settled_at) == (None, None, None)
    first = spec.model_copy(update={"iterations": 0})
    entry = compete(replace(made_up, scenario=type(made_up.scenario)(first)), [0], 0.75)
    assert entry.peak_m is None


LEARNING = [each for each in SHIPPED.contests() if each.law != "norm-optimal"]
NOTHING = "ZeroDivisionError: nothing to divide by"


def test_run_that_cannot_be_computed_is_told() -> None:
    def work(heat: Heat) -> list[Entry | str]:
        raise ZeroDivisionError("nothing to divide by")

    runs = list(islice(SHIPPED.contests(), 1))
    told = f"law paper-17, case circle, belief exact, disturbance none: {NOTHING}"
    with pytest.raises(FailedContestError, match=told):
        compute_entries(runs, work, workers=1)
    many = "law paper-17, case circle, .*, or one of 143 that are run with it: Zero"
    with pytest.raises(FailedContestError, match=many):
        compute_entries(LEARNING, work, workers=1)


def test_run_that_cannot_be_computed_is_found_among_others() -> None:
    def work(heat: Heat) -> list[Entry | str]:
        return [NOTHING if each is LEARNING[77] else ENTRY for each in heat.contests]

    wrong = LEARNING[77]
    assert next(heat for heat in heats(LEARNING) if wrong in heat.contests).contests[0] != wrong
    told = f"law {wrong.law}, case {wrong.case}, belief {wrong.belief}, disturbance .*: {NOTHING}"
    with pytest.raises(FailedContestError, match=told):
        compute_entries(LEARNING, work, workers=1)


def test_run_that_cannot_even_be_made_is_left_to_who_computes_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def offer(experiment: Experiment) -> object:
        raise ZeroDivisionError("nothing to divide by")

    monkeypatch.setattr("hilc_cli.leaderboards.heats.offered", offer)
    assert sorted(map(len, (heat.contests for heat in heats(LEARNING)))) == [1] * len(LEARNING)


def test_laws_share_machine_code_as_far_as_they_can() -> None:
    contests = list(SHIPPED.contests())
    found = heats(contests)
    side_by_side = [heat for heat in found if heat.kind is not None]
    laws = [{contest.law for contest in heat.contests} for heat in side_by_side]
    assert laws == [{"paper-17", "derivative", "lateral"}, {"paper-21"}, {"pid"}, {"feedback"}]
    assert [len(heat.contests) for heat in side_by_side] == [3 * 48, 48, 48, 48]
    assert [heat for heat in found if heat.kind is None] == [
        Heat((contest,)) for contest in contests if contest.law == "norm-optimal"
    ]
    # What lanes take is compiled by one worker while another compiles what the other law takes.
    assert [heat.kind is None for heat in found[:6]] == [True, *[False] * 4, True]


def test_large_heats_are_shared_out(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = heats(LEARNING)
    monkeypatch.setattr("hilc_cli.leaderboards.heats._MOST", 50)
    parts = heats(LEARNING)
    assert [len(heat.contests) for heat in parts] == [50, 48, 48, 48, 50, 44]
    assert parts[0].contests + parts[4].contests + parts[5].contests == whole[0].contests


def test_few_samples_or_runs_are_not_worth_machine_code_of_their_own() -> None:
    robots = load_leaderboard("example:leaderboard-robots")
    assert all(heat.kind is None for heat in heats(list(robots.contests())))
    few = [replace(each, scenario=of_iterations(each, 2000)) for each in LEARNING[:6]]
    assert all(heat.kind is None for heat in heats(few))


def test_lanes_and_the_loop_engine_make_the_same_entries() -> None:
    """Of every law with and without noise, in packs of several laws and in half full ones."""
    for heat in heats(LEARNING):
        contests = [replace(each, scenario=of_iterations(each, 3)) for each in heat.contests[4:]]
        entries = run_heat(Heat(tuple(contests), heat.kind), [0, 3], 0.05)
        for contest, entry in list(zip(contests, entries, strict=True))[::7]:
            assert isinstance(entry, Entry)
            assert entry.seconds_per_iteration > 0
            assert rounded(entry) == rounded(compete(contest, [0, 3], 0.05))


def test_run_that_leaves_the_finite_numbers_at_once_is_told_of_lanes() -> None:
    tracking = [heat for heat in heats(LEARNING) if heat.contests[0].law == "feedback"]
    kind = tracking[0].kind
    tame = [replace(each, scenario=of_iterations(each, 1)) for each in tracking[0].contests[24:26]]
    controller = FeedbackController.model_validate({"law": "feedback", "gains": {"k_x": 1e12}})
    spec = tame[1].scenario.spec.model_copy(update={"controller": controller})
    wild = replace(tame[1], scenario=Scenario(spec))
    with pytest.raises(DivergedError, match="iteration 0"):
        compete(wild, [1], 0.01)
    entry, reason = run_heat(Heat((tame[0], wild), kind), [1], 0.01)
    assert isinstance(entry, Entry)
    expected = "DivergedError: the simulation diverged to non-finite values in iteration 0"
    assert reason == expected


def test_entries_do_not_depend_on_the_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hilc_cli.leaderboards.heats._PAYS", 0)
    laws = {f"hybrid-{gain}": {"law": "hybrid", "gains": {"l1": gain}} for gain in (0.1, 0.5)}
    board = {
        "name": "small",
        "cases": {"circle": "example:fig6a", "spiral": "example:fig3-spiral"},
        "beliefs": {"exact": {}, "large": {"wheel_radius": 1.1}},
        "laws": laws,
        "after": [1, 2],
    }
    contests = list(load_leaderboard(board).contests())
    assert [len(heat.contests) for heat in heats(contests)] == [8]
    alone, shared = (compare_laws(board, workers=workers).data.entries for workers in (1, 2))
    assert [timeless(entry) for entry in alone] == [timeless(entry) for entry in shared]
    assert [rounded(entry) for entry in alone] == [
        rounded(compete(contest, [1, 2], 0.01)) for contest in contests
    ]


def of_iterations(contest: Contest, iterations: int) -> Scenario:
    return Scenario(contest.scenario.spec.model_copy(update={"iterations": iterations}))


def timeless(entry: Entry) -> Entry:
    return replace(entry, seconds_per_iteration=0.0)


def rounded(entry: Entry) -> list[object]:
    """Its fields but the time; numbers to nine digits."""
    return [
        tuple(float(f"{number:.9g}") for number in field) if isinstance(field, tuple)
        else float(f"{field:.9g}") if isinstance(field, float) else field
        for field in astuple(timeless(entry))
    ]  # fmt: skip
