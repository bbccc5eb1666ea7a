"""When the system refuses to write: one line, nothing half written, old results intact."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli import files
from tests.cli.inputs import SCENARIO, TRAJECTORY, listing
from tests.cli.processes import HILC, environment, outcome_of, run_hilc, started
from tests.conftest import Hilc, Outcome, Write

CIRCLE = ("run", "example:fig3-circle", "--no-plots", "--out", "runs/fig3-circle", "--set")
SMALLEST_FILE = 300_000  # samples.csv of the circle is larger


def limit_file_size() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (SMALLEST_FILE, SMALLEST_FILE))


def test_file_size_limit(tmp_path: Path) -> None:
    outcome = run_hilc(*CIRCLE, "iterations=2", cwd=tmp_path, before=limit_file_size)
    message = "hilc: runs/fig3-circle: cannot be written: file too large\n"
    assert outcome == Outcome(1, "", message)
    assert not list(tmp_path.glob("runs/*")) and not list(tmp_path.glob("runs/.*"))


def test_file_size_limit_leaves_old_results_intact(tmp_path: Path) -> None:
    assert run_hilc(*CIRCLE, "iterations=0", "-q", cwd=tmp_path).code == 0
    before = listing(tmp_path)
    outcome = run_hilc(*CIRCLE, "iterations=2", "--force", cwd=tmp_path, before=limit_file_size)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
    assert listing(tmp_path) == before


@pytest.fixture
def tiny_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 1 MB."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(disk)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("mounting a small disk is not permitted here")
    try:
        yield disk
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_full_disk(tiny_disk: Path) -> None:
    assert run_hilc(*CIRCLE, "iterations=0", "-q", cwd=tiny_disk).code == 0
    before = listing(tiny_disk)
    outcome = run_hilc(*CIRCLE, "iterations=2", "--force", cwd=tiny_disk)
    message = "hilc: runs/fig3-circle: cannot be written: no space left on device\n"
    assert outcome == Outcome(1, "", message)
    assert listing(tiny_disk) == before


def test_full_disk_while_pictures_are_drawn(tiny_disk: Path) -> None:
    assert run_hilc(*CIRCLE, "iterations=0", "-q", cwd=tiny_disk).code == 0
    before = listing(tiny_disk)
    arguments = ("plot", "runs/fig3-circle", "--dpi", "600")
    outcome = run_hilc(*arguments, cwd=tiny_disk)
    message = "hilc: runs/fig3-circle: cannot be written: no space left on device\n"
    assert outcome == Outcome(1, "", message)
    assert listing(tiny_disk) == before


def test_read_only_disk(tiny_disk: Path) -> None:
    (tiny_disk / "scenario.yaml").write_text(SCENARIO)
    (tiny_disk / "path.yaml").write_text(TRAJECTORY)
    remount = ["mount", "-o", "remount,ro", str(tiny_disk)]
    subprocess.run(remount, check=True, capture_output=True)
    outcome = run_hilc("run", "scenario.yaml", "--no-plots", cwd=tiny_disk)
    message = "hilc: runs/test: cannot be written: read-only file system\n"
    assert outcome == Outcome(1, "", message)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anyway")
def test_read_only_folder(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    (folder / "runs").mkdir(mode=0o555)
    outcome = hilc("run", "scenario.yaml", "--no-plots")
    assert outcome == Outcome(1, "", "hilc: runs/test: cannot be written: permission denied\n")


def test_refused_exchange_leaves_old_results_intact(
    hilc: Hilc, write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    assert hilc("run", "scenario.yaml", "--no-plots", "-q").code == 0
    before = listing(folder)

    def refuse(one: Path, other: Path) -> bool:
        raise PermissionError(13, "Permission denied", str(other))

    monkeypatch.setattr(files, "_rename_exchange", refuse)
    outcome = hilc("run", "scenario.yaml", "--no-plots")
    assert outcome == Outcome(1, "", "hilc: runs/test: cannot be written: permission denied\n")
    assert listing(folder) == before


def test_replacement_works_without_the_exchange_of_linux(
    hilc: Hilc, write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    assert hilc("run", "scenario.yaml", "--no-plots", "-q").code == 0
    monkeypatch.setattr(files, "_rename_exchange", lambda one, other: False)
    changes = ("--set", "iterations=1", "--force", "--out", "runs/test")
    assert hilc("run", "scenario.yaml", "--no-plots", "-q", *changes) == Outcome(0, "", "")
    assert [path.name for path in (folder / "runs").iterdir()] == ["test"]
    assert len(hilc_api.read_run(folder / "runs/test").metrics) == 2


@pytest.mark.parametrize("round_", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2))])
def test_two_runs_into_the_same_folder_at_once(tmp_path: Path, round_: int) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    command = ("run", "scenario.yaml", "--no-plots", "-q", "--force", "--out", "runs/test", "--set")
    with (
        started(*command, "iterations=20", cwd=tmp_path) as one,
        started(*command, "iterations=10", cwd=tmp_path) as other,
    ):
        outcomes = [outcome_of(one), outcome_of(other)]
    assert sorted(outcome.code for outcome in outcomes) in ([0, 0], [0, 1])
    for outcome in outcomes:
        assert "Traceback" not in outcome.err
    assert [path.name for path in (tmp_path / "runs").iterdir()] == ["test"]
    run = hilc_api.read_run(tmp_path / "runs/test")
    scenario = hilc_api.load_scenario(tmp_path / "runs/test/scenario.yaml")
    assert len(run.metrics) - 1 == scenario.spec.iterations


def test_two_runs_of_one_scenario_at_once_both_end_well(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    command = ("run", "scenario.yaml", "--no-plots", "-q")
    with started(*command, cwd=tmp_path) as one, started(*command, cwd=tmp_path) as other:
        assert [outcome_of(one), outcome_of(other)] == [Outcome(0, "", "")] * 2
    assert [path.name for path in (tmp_path / "runs").iterdir()] == ["test"]


@pytest.mark.parametrize(
    "arguments",
    [("run", "scenario.yaml", "--no-plots"), ("schema", "scenario"), ("examples",)],
    ids=["run", "schema", "examples"],
)
def test_output_that_cannot_be_written(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*HILC, *arguments],
            cwd=tmp_path,
            stdout=full,
            stderr=subprocess.PIPE,
            env=environment(),
            check=False,
        )
    assert (done.returncode, done.stderr.count(b"\n")) == (1, 1)
    assert done.stderr.startswith(b"hilc: ")
    assert done.stderr.lower().endswith(b": no space left on device\n")


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_help_that_cannot_be_written(tmp_path: Path, option: str) -> None:
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*HILC, option], stdout=full, stderr=subprocess.PIPE, env=environment(), check=False
        )
    assert done.returncode == 1
    assert done.stderr.startswith(b"hilc: ") and done.stderr.count(b"\n") == 1
