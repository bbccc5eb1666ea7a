"""``hilc examples``, and scenarios by the name of an example."""

from __future__ import annotations

import ast
import json
import os
from pathlib import Path

from hilc_cli.shipped_files import examples, programs
from tests.cli.inputs import listing
from tests.cli.processes import run_hilc
from tests.conftest import Hilc, Outcome

SCENARIOS = [path.stem for path in examples()]
QUICK = ("--set", "iterations=1", "--no-plots", "-q")


def test_example_runs_outside_the_checkout(tmp_path: Path) -> None:
    assert run_hilc("run", "example:fig3-circle", *QUICK, cwd=tmp_path) == Outcome(0, "", "")
    assert (tmp_path / "runs" / "fig3-circle+iterations=1" / "samples.csv").exists()


def test_example_may_end_with_yaml(hilc: Hilc, folder: Path) -> None:
    assert hilc("run", "example:fig6a.yaml", *QUICK).code == 0


def test_trajectory_may_be_an_example(hilc: Hilc, folder: Path) -> None:
    changes = ("--set", "trajectory=example:spiral", "--out", "here")
    assert hilc("run", "example:fig6a", *QUICK, *changes).code == 0
    assert json.loads((folder / "here/manifest.json").read_text())["trajectory"] == "spiral"


def test_examples_are_listed_with_what_they_are(hilc: Hilc) -> None:
    outcome = hilc("examples")
    assert (outcome.code, outcome.err) == (0, "")
    for name in SCENARIOS:
        assert f"example:{name} " in outcome.out


def test_examples_are_listed_as_json(hilc: Hilc) -> None:
    outcome = hilc("examples", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    listed = json.loads(outcome.out)
    scenarios, trajectories = listed["scenarios"], listed["trajectories"]
    assert [each["name"] for each in scenarios] == [f"example:{name}" for name in SCENARIOS]
    assert "example:figure-eight" in [each["name"] for each in trajectories]
    assert all(each["description"] for each in [*scenarios, *trajectories])


def test_quiet_list_is_empty(hilc: Hilc) -> None:
    assert hilc("examples", "-q") == Outcome(0, "", "")


def test_copied_example_runs(hilc: Hilc, folder: Path) -> None:
    others = [*examples("trajectories"), *examples("leaderboards"), *programs()]
    count = len(SCENARIOS) + len(others)
    assert hilc("examples", "--copy", "mine") == Outcome(0, f"Wrote {count} files to mine\n", "")
    beside = len(list(examples("leaderboards")))
    assert len(listing(folder / "mine/scenarios")) == len(SCENARIOS) + beside
    assert hilc("run", "mine/scenarios/fig3-spiral.yaml", *QUICK) == Outcome(0, "", "")


def test_copy_is_byte_for_byte(hilc: Hilc, folder: Path) -> None:
    hilc("examples", "--copy", "mine", "-q")
    for kind in ("scenarios", "trajectories"):
        for original in examples(kind):
            assert (folder / "mine" / kind / original.name).read_bytes() == original.read_bytes()
    for program in programs():
        assert (folder / "mine/programs" / program.name).read_bytes() == program.read_bytes()


def test_players_of_plans_send_standstill_whatever_happens() -> None:
    # They need a robot; what can be held to here is that they are Python, and stop in the end.
    for program in programs():
        tree = ast.parse(program.read_text(encoding="utf-8"))
        assert ast.get_docstring(tree)
        if program.name.startswith("play_plan"):
            (guarded,) = [node for node in ast.walk(tree) if isinstance(node, ast.Try)]
            last = "".join(map(ast.unparse, guarded.finalbody))
            assert "send(0.0, 0.0)" in last or "send('0', '0')" in last


def test_copy_as_json_names_the_files(hilc: Hilc, folder: Path) -> None:
    document = json.loads(hilc("examples", "--copy", "mine", "--json").out)
    assert document["folder"] == "mine"
    assert all((folder / name).is_file() for name in document["files"])


def test_second_copy_changes_nothing(hilc: Hilc, folder: Path) -> None:
    assert hilc("examples", "--copy", "mine").code == 0
    before = listing(folder)
    assert hilc("examples", "--copy", "mine").code == 0
    assert listing(folder) == before


def test_changed_file_is_not_copied_over(hilc: Hilc, folder: Path) -> None:
    hilc("examples", "--copy", "mine", "-q")
    mine = folder / "mine/scenarios/fig6a.yaml"
    mine.write_text("my changes")
    (folder / "mine/scenarios/fig3-circle.yaml").unlink()
    before = listing(folder)
    assert hilc("examples", "--copy", "mine") == Outcome(
        1,
        "",
        "hilc: mine/scenarios/fig6a.yaml: exists and differs from the example; "
        "choose another folder, or replace it with --force\n",
    )
    assert listing(folder) == before


def test_force_copies_over_a_changed_file(hilc: Hilc, folder: Path) -> None:
    hilc("examples", "--copy", "mine", "-q")
    mine = folder / "mine/scenarios/fig6a.yaml"
    mine.write_text("my changes")
    (folder / "mine/my-notes.txt").write_text("mine")
    assert hilc("examples", "--copy", "mine", "--force").code == 0
    assert mine.read_text().startswith("# Qiao et al. 2021")
    assert (folder / "mine/my-notes.txt").read_text() == "mine"


def test_copy_to_a_file_is_told(hilc: Hilc, folder: Path) -> None:
    (folder / "mine").write_text("precious")
    outcome = hilc("examples", "--copy", "mine")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
    assert outcome.err.startswith("hilc: mine: cannot be written: ")
    assert (folder / "mine").read_text() == "precious"


def test_copy_does_not_wait_for_a_named_pipe(hilc: Hilc, folder: Path) -> None:
    (folder / "mine/scenarios").mkdir(parents=True)
    os.mkfifo(folder / "mine/scenarios/fig6a.yaml")
    assert hilc("examples", "--copy", "mine").code == 1
