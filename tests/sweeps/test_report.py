"""What is told of a sweep whose metric cannot tell its cases apart.

The robot starts a metre behind a line of one sample and one metre: in each iteration Eq. 17 leaves
1 - d_t l1 of the two metres at the end, and the metre at the start stays.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.searches import L1, PATH, SCENARIO
from tests.conftest import Hilc, Outcome, Write

BEHIND = SCENARIO.replace("{l1: 4}}", "{l1: 4}, compensation: 'off'}\ninitial_pose: {x: -1}")
SWEEP = ("sweep", "scenario.yaml", "--no-plots", "--json")
LATER = "max_position_error_second_half_m"
WARNING = (
    "hilc: warning: {metric} is at least the initial error of 1 m in every case, however good it "
    f"is; {{option}} {LATER} tells cases apart\n"
)


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write({"scenario.yaml": BEHIND, "path.yaml": PATH})


def test_ties_are_told_before_and_after(hilc: Hilc) -> None:
    outcome = hilc(*SWEEP, "--vary", f"{L1}=1,8,9,10")
    assert outcome.code == 0
    assert outcome.err == WARNING.format(metric="max_position_error_m", option="--metric") + (
        "hilc: 3 of 4 cases share the best max_position_error_m, 1; case 1 is only one of them: "
        f"--metric {LATER} tells them apart\n"
    )
    document = json.loads(outcome.out)
    assert (document["tied"], document["best"][0]["case"]) == (3, 1)


def test_metric_that_tells_cases_apart_has_no_ties(hilc: Hilc) -> None:
    outcome = hilc(*SWEEP, "--vary", f"{L1}=1,8,9,10", "--metric", LATER)
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out)
    assert (document["tied"], document["best"][0]["case"]) == (1, 3)
    assert [best["metric"] for best in document["best"][1:]] == pytest.approx(
        [2 * (1 - 0.1 * gain) ** 3 for gain in (9, 8, 1)], rel=1e-9
    )


def test_keys_without_effect_tie_for_whatever_metric(hilc: Hilc) -> None:
    vary = ("--vary", f"{L1}=8", "--vary", "disturbance.output.repeat=true,false")
    command = [word for word in SWEEP if word != "--json"]
    outcome = hilc(*command, *vary, "--metric", LATER)
    assert outcome.err == (
        f"hilc: 2 of 2 cases share the best {LATER}, 0.016; case 0 is only one of them\n"
    )
    assert f"case 1: {L1}=8, disturbance.output.repeat=false" in outcome.out


def test_search_among_ties_is_no_better(hilc: Hilc) -> None:
    command = [word for word in SWEEP if word != "--json"]
    options = ("--vary", f"{L1}=8,9,11", "--minimise", "max_position_error_m", "--cases", "3")
    outcome = hilc(*command, *options)
    assert outcome.err == WARNING.format(metric="max_position_error_m", option="--minimise") + (
        "hilc: 3 of 3 cases share the best max_position_error_m, 1; case 0 is only one of them, "
        f"and the one in best.yaml: --minimise {LATER} tells them apart\n"
        "hilc: no case is better than the scenario as it is\n"
    )
    assert outcome.out.endswith(
        "Best case tried, no better than the scenario as it is: runs/test-sweep/best.yaml\n"
    )
    assert Path("runs/test-sweep/best.yaml").read_text().splitlines()[1] == (
        "# No better than the scenario as it is, which has 1.0."
    )


def test_tolerance_below_the_initial_error(hilc: Hilc) -> None:
    options = ("--tolerance", "50 cm", "--metric", "iterations_to_tolerance")
    outcome = hilc(*SWEEP, "--vary", f"{L1}=8,9", *options)
    assert outcome.err == (
        "hilc: warning: no case can settle within the tolerance of 0.5 m: its maximum error is at "
        f"least the initial error of 1 m; --metric {LATER} tells cases apart\n"
        "hilc: no case has a value of iterations_to_tolerance, so there is no best.yaml\n"
    )
    assert json.loads(outcome.out)["within_tolerance"] == 0


def test_poses_that_vary_are_told_apart(hilc: Hilc) -> None:
    outcome = hilc(*SWEEP, "--vary", "initial_pose.x=-1,-0.5", "--vary", f"{L1}=10")
    assert (outcome.code, outcome.err) == (0, "")


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        (
            "max_position_error_m<=5 mm",
            f"; the initial error alone is 1 m, which {LATER} leaves out",
        ),
        ("max_position_error_m>1.5", ""),
        ("mean_position_error_m<=5 mm", ""),
    ],
)
def test_requirement_that_the_initial_error_forbids(hilc: Hilc, text: str, hint: str) -> None:
    run = ("run", "scenario.yaml", "--no-plots", "-q", "--set", f"{L1}=8", "--require", text)
    outcome = hilc(*run)
    metric = text.partition("_position")[0]
    got = {"max": "1", "mean": "0.508"}[metric]
    assert outcome == Outcome(3, "", f"hilc: not met: {text}, got {got}{hint}\n")
    assert hilc(*run, "--require", f"{LATER}<=2 cm").err == outcome.err
