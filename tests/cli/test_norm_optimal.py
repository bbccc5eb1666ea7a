"""The norm-optimal law on the command line: what is told of it, in each command."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from tests.conftest import Hilc, Outcome, Write

# The platform believes in wheels of 0.7 times their radius, and in 1.3 times the true half track.
MOTORS = ("delay_and_lag_s", "delay_s", "lag_s", "friction_rad_s")
SCENARIO = """\
name: test
trajectory:
  name: bend
  sample_time: 5 ms
  start: {x: 1, y: 2, heading: 1}
  segments:
    - arc: {radius: 2 m, sweep: 60 deg, turn: left, duration: 0.3 s}
    - line: {length: 1 m, duration: 0.2 s}
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
model: {wheel_radius: 0.14, half_track: 0.65}
initial_pose: {x: 1.1}
iterations: 2
controller: {law: norm-optimal, h: 40, b_w: 180}
"""


@pytest.fixture
def scenario(write: Write) -> str:
    write({"scenario.yaml": SCENARIO})
    return "scenario.yaml"


def test_summary_tells_what_was_identified(hilc: Hilc, folder: Path, scenario: str) -> None:
    # In a scenario without noise everything is told to rounding, and h is the merge.
    outcome = hilc("run", scenario, "--no-plots", "--json")
    assert outcome.code == 0
    told = json.loads(outcome.out)["learning"]
    assert told["model_wheel_radius_m"] == pytest.approx(0.2, rel=1e-6)
    assert told["model_half_track_m"] == pytest.approx(0.5, rel=1e-6)
    assert 0 <= told["model_wheel_radius_standard_error_m"] < 1e-5
    assert 0 <= told["model_half_track_standard_error_m"] < 1e-5
    assert told["merge_time_s"] <= 40 * 5e-3 + 1e-9
    assert told["search_settled"] == 1
    rows = learned(hilc("run", scenario, "--no-plots").out)
    assert rows["wheel radius"].startswith("0.200000 m, standard error ")
    assert rows["half track"].startswith("0.500000 m, standard error ")
    assert rows["merge time"] == f"{told['merge_time_s']:.6g} s"


def learned(out: str) -> dict[str, str]:
    """What the summary says of what was learned."""
    found = re.findall(r"^ *Learned: (\w+(?: \w+)*)  +(.*)$", out, re.MULTILINE)
    return dict(found)


def test_what_was_not_measured_is_not_told_as_learned(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    only_first = ("--no-plots", "--set", "iterations=0", "--force")
    told = json.loads(hilc("run", scenario, *only_first, "--json").out)["learning"]
    # Nothing has moved: what the model is made of is what was believed.
    known = {name: value for name, value in told.items() if value is not None}
    assert known == {
        "model_wheel_radius_m": 0.14,
        "model_half_track_m": 0.65,
        "model_wheel_radius_per_half_track": 0.14 / 0.65,
        "model_left_per_right_radius": 1.0,
        "step_share": 1.0,
        "went_back": 0.0,
        **{f"model_{name}": 0.0 for name in MOTORS},
    }
    rows = learned(hilc("run", scenario, *only_first).out)
    untold = "not measured, taken as "
    assert rows == {
        "wheel radius": f"{untold}0.14 m",
        "half track": f"{untold}0.65 m",
        "wheel radius per half track": f"{untold}0.2154",
        "left per right radius": f"{untold}1",
        **dict.fromkeys(("delay and lag", "delay", "lag"), f"{untold}0 s"),
        "friction": f"{untold}0 rad/s",
        "step share": "1",
    }


def test_turn_in_place_tells_the_ratio_and_a_line_the_radius(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    def told(*settings: str) -> dict[str, str]:
        always = "initial_pose=null", "controller.feedback=none", "initial_input=feedforward"
        options = [word for text in (*always, *settings) for word in ("--set", text)]
        return learned(hilc("run", scenario, "--no-plots", "--force", *options).out)

    rows = told(
        "trajectory.segments=[arc: {radius: 1e-9, turn: left, sweep: 5, speed: 1e-8}]",
        "disturbance.output.bound=[0.1 mm, 0.1 mm, 1e-5]",
    )
    # Each is taken for what makes the ratio right and is nearest to what was believed.
    assert rows["wheel radius"].startswith("not measured, taken as 0.1")
    assert rows["half track"].startswith("not measured, taken as 0.")
    assert re.match(r"0\.4000\d*, standard error \d", rows["wheel radius per half track"])
    rows = told(
        "trajectory.segments=[line: {length: 2, duration: 1 s}]",
        "trajectory.start={x: 0, y: 0, heading: 0}",
    )
    assert rows["wheel radius"].startswith("0.200000 m, standard error ")
    assert rows["half track"] == "not measured, taken as 0.65 m"
    assert rows["wheel radius per half track"].startswith("not measured, taken as ")


def test_digits_are_those_that_the_standard_error_leaves(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    noise = "disturbance.state.bound=[1 mm, 1 mm, 0.002]"
    out = hilc("run", scenario, "--no-plots", "--set", noise).out
    for row in list(learned(out).values())[:2]:
        value, error = re.fullmatch(r"(.*) m, standard error (.*) m", row).groups()  # type: ignore[union-attr]
        last = 10.0 ** -len(value.partition(".")[2])
        assert 0.01 * float(error) <= last <= float(error)


def test_what_the_law_tells_may_be_required(hilc: Hilc, folder: Path, scenario: str) -> None:
    met = [
        "model_half_track_m<=51 cm",
        "model_wheel_radius_standard_error_m<1 mm",
        "merge_time_s<1 s",
    ]
    run = ("run", scenario, "--no-plots", "-q")
    assert hilc(*run, *(f"--require={text}" for text in met)) == Outcome(0, "", "")
    outcome = hilc(*run, "--require", "model_half_track_m>60 cm")
    assert outcome == Outcome(3, "", "hilc: not met: model_half_track_m>60 cm, got 0.5\n")
    at_rest = ("--set", "iterations=0", "--force")
    outcome = hilc(*run, *at_rest, "--require", "misfit_ahead<1", "--require", "merge_time_s<1")
    assert outcome == Outcome(
        3, "", "hilc: not met: misfit_ahead<1, got none\nhilc: not met: merge_time_s<1, got none\n"
    )


def test_unknown_metric_is_told_beside_what_the_law_tells(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    outcome = hilc("run", scenario, "--require", "qqq<1")
    assert outcome.code == 2
    assert "merge_time_s, misfit_ahead, " in outcome.err
    outcome = hilc("run", scenario, "--require", "model_half_trak_m<1")
    assert outcome.err.endswith(
        "'model_half_trak_m' is no metric; did you mean 'model_half_track_m'?\n"
    )


def test_limit_that_is_too_low_is_told_before_the_run(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    # The arc takes (2 m + 0.5 m) * 60 deg / 0.3 s / 0.2 m, its chords less by their share of it.
    low = ("run", scenario, "--no-plots", "--set", "controller.b_w=30", "--force")
    outcome = hilc(*low)
    (line,) = outcome.err.splitlines()
    assert line == (
        "hilc: warning: the trajectory needs wheel speeds up to 43.63 rad/s, above b_w of "
        "30 rad/s: the platform cannot follow it, whatever the law; see 'hilc check'"
    )
    assert outcome.code == 0
    assert learned(outcome.out)["merge time"] == "not by the end"
    told = json.loads(hilc(*low, "--json").out)
    assert f"hilc: warning: {told['warnings'][0]}" == line
    assert told["learning"]["merge_time_s"] is None
    assert hilc(*low, "-q").err == ""
    assert "above b_w of 30 rad/s" in hilc("check", *low[1:2], *low[3:5]).out


def test_picture_of_learning(hilc: Hilc, folder: Path, scenario: str) -> None:
    run = ("run", scenario, "--no-plots", "-q")
    assert hilc(*run, "--out", "a").code == 0
    outcome = hilc("plot", "a", "--kind", "learning")
    assert outcome == Outcome(0, "a/learning.png\n", "")
    assert hilc_api.read_run("a").yardsticks == {
        "wheel_radius_m": {"true": 0.2, "believed": 0.14},
        "half_track_m": {"true": 0.5, "believed": 0.65},
        "wheel_radius_per_half_track": {"true": 0.4, "believed": pytest.approx(0.14 / 0.65)},
        "merge_time_s": {"h": pytest.approx(0.2)},
        "left_per_right_radius": {"true": 1.0, "believed": 1.0},
        **{name: {"true": 0.0, "believed": 0.0} for name in MOTORS},
    }
    other = ("--set", "controller={gains: {l1: 0.5}}")
    assert hilc(*run, *other, "--out", "b").code == 0
    outcome = hilc("plot", "b", "--kind", "learning")
    assert outcome == Outcome(
        2,
        "",
        "hilc: there is no picture 'learning' of test: nothing is told of what was learned; "
        "law norm-optimal tells what it identifies of the robot\n",
    )
    assert not (folder / "b/learning.png").exists()
    outcome = hilc("plot", "a", "b", "--kind", "learning", "--out", "both")
    assert outcome == Outcome(0, "both/learning.png\n", "")


def test_sweep_varies_its_parameters(hilc: Hilc, folder: Path, scenario: str) -> None:
    arguments = ("--vary", "controller.weights.position=0.001,0.01", "--no-plots", "--json")
    outcome = hilc("sweep", scenario, *arguments)
    assert outcome.code == 0
    assert json.loads(outcome.out)["cases"] == 2


def test_check_tells_feasibility_and_simulates(hilc: Hilc, folder: Path, scenario: str) -> None:
    outcome = hilc("check", scenario, "--simulate", "--json")
    assert outcome.code == 0
    told = json.loads(outcome.out)
    assert told["ok"]
    assert told["theory"] == {}
    simulated = told["learning"]["simulated"]
    assert simulated["iterations"] == 2
    # At the start it is 0.1 m off, whatever it learns.
    assert simulated["max_position_error_m"] == pytest.approx(0.1, abs=0.01)
    printed = hilc("check", scenario, "--simulate").out
    assert "0.1" in printed.partition("Simulated")[2]
    # 0.1 m to the side, and the merge that a run tells.
    plain = json.loads(hilc("check", scenario, "--json").out)["learning"]
    assert plain == {key: value for key, value in told["learning"].items() if key != "simulated"}
    run = json.loads(hilc("run", scenario, "--no-plots", "--json").out)["learning"]
    assert plain["merge_sample"] * 5e-3 == pytest.approx(run["merge_time_s"])


def test_compare_beside_another_law(hilc: Hilc, folder: Path, scenario: str) -> None:
    quiet = ("--no-plots", "-q")
    assert hilc("run", scenario, *quiet, "--out", "a").code == 0
    other = ("--set", "controller={gains: {l1: 0.5}}")
    assert hilc("run", scenario, *quiet, *other, "--out", "b").code == 0
    assert hilc("compare", "a", "b", "--no-plots").code == 0
