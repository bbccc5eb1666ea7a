"""The folder that results go to without --out, which tells what --set has changed."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilc_cli.cli.default_folders import default_folder, folder_of_shards
from tests.conftest import Hilc, Outcome, Write

QUIET = ("--no-plots", "-q")


@pytest.mark.parametrize(
    ("overrides", "name"),
    [
        ([], "a"),
        (["controller.gains.l2=0.75"], "a+l2=0.75"),
        (["controller.h=3", "robot.friction=null"], "a+h=3+friction=null"),
        (["robot.friction=null", "controller.h=3"], "a+friction=null+h=3"),
        (["controller.b_w="], "a+b_w=null"),
        (["h=1", "iterations=2", "h=3"], "a+iterations=2+h=3"),  # the last one counts
        (["initial_pose.x=-4"], "a+x=-4"),
        (["initial_pose.heading=pi/3"], "a+heading=pi-3"),
        (["disturbance.output.bound=[1 mm, 2 mm, 0]"], "a+bound=1-mm-2-mm-0"),
        (["disturbance.output.bound.0=7"], "a+bound.0=7"),
        (["trajectory=example:spiral"], "a+trajectory=example-spiral"),
        (["initial_input=../../other/input.csv"], "a+initial_input=..-..-other-input.csv"),
        (
            ["model.wheel_radius=0.3", "robot.wheel_radius=0.4"],
            "a+model.wheel_radius=0.3+robot.wheel_radius=0.4",
        ),
        (["name=a"], "a"),
        (["x=\x1b[31m$(rm) 'y'\n"], "a+x=31m-rm-y"),
    ],
)
def test_changes_stand_behind_the_name(overrides: list[str], name: str) -> None:
    for ending in ("", "-sweep"):
        assert default_folder("a", overrides, ending) == Path(f"runs/{name}{ending}")


def test_long_changes_are_cut_and_stay_apart() -> None:
    texts = [[f"initial_input={'d/' * 60}{last}.csv", "h=9"] for last in "xyz"]
    texts += [["x=''"], ['x="?"']]  # of which nothing is left
    names = [default_folder("a", text).name for text in texts]
    assert len(set(names)) == len(names)
    assert all(len(name) <= 100 for name in names)


def test_each_change_has_its_folder(hilc: Hilc, write: Write) -> None:
    write()
    for change in ("iterations=1", "controller.gains.l1=0.7"):
        assert hilc("run", "scenario.yaml", *QUIET, "--set", change) == Outcome(0, "", "")
    assert hilc("run", "scenario.yaml", *QUIET).code == 0
    check = ("check", "scenario.yaml", "-q", "--plot", "--format", "svg", "--set", "iterations=3")
    assert hilc(*check).code == 0
    assert sorted(path.name for path in Path("runs").iterdir()) == [
        *("test", "test+iterations=1", "test+iterations=3-check", "test+l1=0.7"),
    ]


def test_changes_that_are_spelled_alike_do_not_replace_each_other(hilc: Hilc, write: Write) -> None:
    write()
    run = ("run", "scenario.yaml", *QUIET, "--set")
    assert hilc(*run, "robot.wheel_radius=0.21").code == 0
    before = Path("runs/test+wheel_radius=0.21/iterations.csv").read_bytes()
    outcome = hilc(*run, "model.wheel_radius=0.21")
    assert outcome == Outcome(
        1,
        "",
        "hilc: runs/test+wheel_radius=0.21: holds the results of another scenario; "
        "choose another folder with --out, or replace it with --force\n",
    )
    assert Path("runs/test+wheel_radius=0.21/iterations.csv").read_bytes() == before


def test_shards_of_a_changed_scenario_end_up_together(hilc: Hilc, write: Write) -> None:
    write()
    sweep = ("sweep", "scenario.yaml", "--vary", "controller.gains.l1=0.1:0.4:4", *QUIET)
    changed = (*sweep, "--set", "iterations=1")
    for number in ("1", "2"):
        assert hilc(*changed, "--shard", f"{number}/2") == Outcome(0, "", "")
    shards = [f"runs/test+iterations=1-sweep.{number}-of-2" for number in ("1", "2")]
    assert hilc("sweep", "--merge", *shards, *QUIET) == Outcome(0, "", "")
    assert hilc(*changed, "--out", "whole") == Outcome(0, "", "")
    merged = Path("runs/test+iterations=1-sweep/cases.csv")
    assert merged.read_bytes() == Path("whole/cases.csv").read_bytes()


@pytest.mark.parametrize(
    ("shards", "folder"),
    [
        (["x/a-sweep.1-of-2", "y/a-sweep.2-of-2"], "runs/a-sweep"),
        (["mine.1-of-2", "mine.2-of-2"], "runs/a-sweep"),
        (["a+h=1-sweep.1-of-2", "a+h=2-sweep.2-of-2"], "runs/a-sweep"),
        (["ab+h=1-sweep.1-of-2", "ab+h=1-sweep.2-of-2"], "runs/a-sweep"),
    ],
)
def test_other_names_of_shards_tell_nothing(shards: list[str], folder: str) -> None:
    assert folder_of_shards("a", [Path(shard) for shard in shards]) == Path(folder)


def test_shard_with_a_folder_of_its_own(hilc: Hilc, write: Write) -> None:
    write()
    sweep = ("sweep", "scenario.yaml", "--vary", "controller.gains.l1=0.1:0.5:5", *QUIET)
    assert hilc(*sweep, "--shard", "2/3", "--out", "some/where") == Outcome(0, "", "")
    assert [str(path) for path in Path("some").iterdir()] == ["some/where.2-of-3"]
