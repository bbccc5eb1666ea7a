"""``hilc new``: what it writes runs at once, and suits the robot."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import UsageError
from tests.conftest import Hilc, Outcome

SMALL = (
    *("--wheel-radius", "33mm", "--wheel-separation", "16cm"),
    *("--top-speed", "0.22m/s", "--rate", "20"),
)


def options(radius: str, separation: str, speed: str, rate: str) -> list[str]:
    names = ("--wheel-radius", "--wheel-separation", "--top-speed", "--rate")
    values = (radius, separation, speed, rate)
    return [word for pair in zip(names, values, strict=True) for word in pair]


def test_what_is_written_is_shown_checked_and_run(hilc: Hilc, folder: Path) -> None:
    outcome = hilc("new", "mine", *SMALL)
    assert outcome == Outcome(
        0,
        "Wrote mine.yaml and mine-path.yaml. Next:\n"
        "hilc show mine.yaml\nhilc check mine.yaml\nhilc run mine.yaml\n",
        "",
    )
    for line in outcome.out.splitlines()[1:]:
        words = line.split()[1:]
        found = hilc(*words, "--no-plots") if words[0] != "check" else hilc(*words)
        assert found.code == 0, found
        assert "does something the model does not know" not in found.err
    run = hilc_api.read_run("runs/mine")
    assert run.metrics["max_position_error_m"][0] > 0.2
    assert run.metrics["max_position_error_second_half_m"][-1] < 0.005


@pytest.mark.parametrize(
    ("radius", "separation", "speed", "rate"),
    [
        ("33 mm", "160 mm", "0.22 m/s", "20 Hz"),
        ("33 mm", "160 mm", "64 rpm", "20"),
        ("0.2", "1.036", "36", "100"),
        ("1 cm", "6 cm", "5 cm/s", "5"),
        ("10 cm", "0.5", "1.5", "30"),
        ("7.5 cm", "40 cm", "5 km/h", "50"),
    ],
)
def test_wheels_can_follow_whatever_the_robot(
    hilc: Hilc, folder: Path, radius: str, separation: str, speed: str, rate: str
) -> None:
    assert hilc("new", "r", *options(radius, separation, speed, rate)).code == 0
    scenario = hilc_api.load_scenario("r.yaml")
    demand, limit = scenario.feasibility().demand, scenario.speed_limit
    assert limit is not None
    assert 0.6 * limit < demand.fastest.value < 0.95 * limit
    assert demand.lateral.value <= 2.0 * 1.001
    merge = scenario.spec.controller.model_dump()["h"]
    assert merge < scenario.spec.reference.samples / 2
    assert scenario.spec.trajectory.sample_time == pytest.approx(1 / float(rate.split()[0]))
    assert not [each for each in scenario.warnings() if "safety" in each]


def test_numbers_are_those_of_the_data_sheet(hilc: Hilc, folder: Path) -> None:
    # 60 rpm are 2 pi rad/s: 0.2073 m/s with wheels of 33 mm.
    assert hilc("new", "r", *options("33mm", "16cm", "60rpm", "20"), "-q") == Outcome(0, "", "")
    spec = hilc_api.load_scenario("r.yaml").spec
    assert (spec.model.wheel_radius, spec.robot.wheel_radius) == pytest.approx((0.033, 0.03201))
    assert spec.controller.b_w == pytest.approx(6.283, abs=1e-3)


def test_files_elsewhere_and_json(hilc: Hilc, folder: Path) -> None:
    outcome = hilc("new", "r", *SMALL, "--out", "a/b", "--json")
    assert json.loads(outcome.out) == {"scenario": "a/b/r.yaml", "trajectory": "a/b/r-path.yaml"}
    assert sorted(path.name for path in Path("a/b").iterdir()) == ["r-path.yaml", "r.yaml"]
    assert hilc("check", "a/b/r.yaml", "-q").code == 0


@pytest.mark.parametrize("there", ["r.yaml", "r-path.yaml"])
def test_nothing_is_replaced(hilc: Hilc, folder: Path, there: str) -> None:
    Path(there).symlink_to("nowhere")
    outcome = hilc("new", "r", *SMALL)
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err.startswith(f"hilc: {there}: exists, and nothing is replaced; choose another")
    assert [path.name for path in folder.iterdir()] == [there]


@pytest.mark.parametrize(
    ("name", "changed", "message"),
    [
        ("../r", (), "hilc: ../r: is no name; begin with a letter or digit: hidden files"),
        ("a b", (), "hilc: a b: is no name; use letters, digits, '.', '_' and '-'"),
        ("r", ("--wheel-radius", "0"), "hilc: --wheel-radius 0: must be above 0; give a number"),
        ("r", ("--wheel-radius", "3 s"), "hilc: --wheel-radius 3 s: has the wrong unit; give a"),
        ("r", ("--wheel-separation", "x"), "hilc: --wheel-separation x: "),
        ("r", ("--top-speed", "1 m"), "hilc: --top-speed 1 m: has the wrong unit; did you mean"),
        ("r", ("--top-speed", "0 rpm"), "hilc: --top-speed 0 rpm: must be above 0; give a number"),
        ("r", ("--rate", "-20"), "hilc: --rate -20: must be above 0; give a number above 0"),
    ],
)
def test_what_cannot_be(
    hilc: Hilc, folder: Path, name: str, changed: tuple[str, ...], message: str
) -> None:
    outcome = hilc("new", name, *SMALL, *changed)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.startswith(message)
    assert outcome.err.count("\n") == 1
    assert not list(folder.iterdir())


def test_each_of_the_four_numbers_is_needed(hilc: Hilc, folder: Path) -> None:
    outcome = hilc("new", "r", *SMALL[2:])
    assert outcome.code == 2
    assert "missing option '--wheel-radius'" in outcome.err.lower()


def test_in_python(folder: Path) -> None:
    files = hilc_api.write_own_robot(
        "r", wheel_radius=0.033, wheel_separation="16 cm", top_speed=0.22, rate=20
    )
    assert files == [Path("r.yaml"), Path("r-path.yaml")]
    assert all(len(line) <= 100 for file in files for line in file.read_text().splitlines())
    with pytest.raises(UsageError, match="--rate"):
        hilc_api.write_own_robot(
            "s", wheel_radius=0.033, wheel_separation=0.16, top_speed=0.22, rate=0
        )
