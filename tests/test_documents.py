"""Every example in the documents is run as it stands there."""

import re
import shlex
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import hilc_cli as hilc
from hilc_cli.spec.trajectory import TrajectorySpec

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
DOCUMENTS = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def test_the_shell_examples_run_one_after_the_other(tmp_path: Path) -> None:
    script = "set -eu\n" + "\n".join(blocks("sh"))
    path = f"{Path(sys.executable).parent}:/usr/bin:/bin"
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=tmp_path,
        env={"PATH": path, "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "runs" / "fig3-circle" / "summary.png").stat().st_size > 0
    assert (tmp_path / "runs" / "limit" / "error.png").stat().st_size > 0
    assert (tmp_path / "runs" / "twice" / "iterations.csv").stat().st_size > 0
    assert (tmp_path / "runs" / "fig8a-best" / "iterations.csv").stat().st_size > 0


def test_the_python_example_runs(tmp_path: Path) -> None:
    (code,) = blocks("python")
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "pictures" / "final-path.svg").stat().st_size > 0


def test_the_yaml_examples_are_valid(tmp_path: Path) -> None:
    trajectory, scenario, sweep = blocks("yaml")
    (tmp_path / "trajectory.yaml").write_text(trajectory, encoding="utf-8")
    (tmp_path / "scenario.yaml").write_text(scenario, encoding="utf-8")
    loaded = hilc.load_scenario(tmp_path / "scenario.yaml")
    assert loaded.name == "my-experiment"
    (tmp_path / "sweep.yaml").write_text(sweep, encoding="utf-8")
    assert len(hilc.plan_sweep(hilc.load_scenario(tmp_path / "sweep.yaml")).cases) == 33
    assert loaded.compensates  # it starts at x = 9
    path = {"trajectory": str(tmp_path / "trajectory.yaml"), "initial_pose": None}
    other = hilc.load_scenario(tmp_path / "scenario.yaml", overrides=path)
    assert isinstance(other.spec.trajectory, TrajectorySpec)
    assert other.spec.trajectory.reference().samples == 3000


def test_the_search_of_the_sweeps_document_is_valid(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"^hilc (sweep [^\n]*--minimise [^\n]*\n[^\n]*)", text, re.MULTILINE)
    (section,) = re.findall(r"^```yaml\n(sweep:\n.*?)^```", text, re.MULTILINE | re.DOTALL)
    words = shlex.split(command.replace("\\\n", ""))
    vary = [text for option, text in pairwise(words) if option == "--vary"]
    options = {
        option: words[words.index(option) + 1] for option in ("--minimise", "--cases", "--seed")
    }
    scenario = hilc.load_scenario(words[1])
    plan = hilc.plan_sweep(
        scenario,
        vary,
        minimise=options["--minimise"],
        cases=int(options["--cases"]),
        seed=int(options["--seed"]),
    )
    (tmp_path / "scenario.yaml").write_text(scenario.resolved_yaml() + section, encoding="utf-8")
    same = hilc.plan_sweep(hilc.load_scenario(tmp_path / "scenario.yaml"))
    assert (plan.axes, plan.spec) == (same.axes, same.spec)


def test_the_error_messages_shown_are_the_ones_given(tmp_path: Path) -> None:
    (shown,) = re.findall(r"^```\n(my\.yaml:.*?)^```", README, re.MULTILINE | re.DOTALL)
    text = "\n".join(
        [
            "name: mine",
            "trajectory: example:circle",
            "",
            "robot:",
            "  turn_convention: paper",
            "  wheel_radius: -1",
            "  half_track: 0.5",
            "controller:",
            "  gain: 3",
            "  gains: {l1: 1}",
        ]
    )
    (tmp_path / "my.yaml").write_text(text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "hilc_cli", "run", "my.yaml"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stderr) == (2, shown)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_between_documents_lead_somewhere(document: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8")):
        if not target.startswith("https://"):
            assert (document.parent / target).exists(), target
