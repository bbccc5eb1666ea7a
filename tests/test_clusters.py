"""The recipes of docs/clusters.md, run as they stand there, with a stand-in for the scheduler."""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from tests import stand_in_sbatch
from tests.cli.processes import environment
from tests.conftest import Hilc
from tests.pages import Block, Command, blocks, commands

PAGE = "docs/clusters.md"
MERGED = ("cases.csv", "scenario.yaml")


@pytest.fixture
def variables(folder: Path) -> dict[str, str]:
    """An environment with the stand-in and this hilc, in a folder with all files of the page."""
    for block in blocks(PAGE):
        kind, _, name = block.mark.partition("file: ")
        if name and not kind:
            Path(name).write_text(block.text, encoding="utf-8")
    programs = folder / "programs"
    programs.mkdir()
    sbatch = programs / "sbatch"
    sbatch.write_text(
        f'#!/bin/sh\nexec {shlex.quote(sys.executable)} {stand_in_sbatch.__file__} "$@"\n'
    )
    sbatch.chmod(0o755)
    here = Path(sys.executable).parent
    return environment({"PATH": f"{programs}:{here}:/usr/bin:/bin"})


def run(command: Command, variables: Mapping[str, str]) -> None:
    done = subprocess.run(
        ["bash", "-c", f"set -euo pipefail\n{command.line}"],
        env=dict(variables),
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == command.code, f"{command.line}\n{done.stderr}"


def recipes(program: str) -> list[Command]:
    """The commands of the page that begin with some program."""
    return [
        command
        for block in blocks(PAGE)
        if block.language == "sh" and block.is_run
        for command in commands(block)
        if command.line.split()[0] == program
    ]


def whole() -> dict[str, bytes]:
    """What the sweep gives in one piece."""
    plan = hilc_api.plan_sweep(hilc_api.load_scenario("sweep.yaml"))
    hilc_api.sweep(plan, hilc_api.Execution(workers=1)).write("whole", plots=False)
    return tables("whole")


def tables(folder: str) -> dict[str, bytes]:
    return {name: (Path(folder) / name).read_bytes() for name in MERGED}


def test_every_block_of_the_page_is_run_here() -> None:
    def is_known(block: Block) -> bool:
        return bool(block.mark) or all(
            command.line.split()[0] in ("hilc", "sbatch", "make") for command in commands(block)
        )

    assert all(map(is_known, blocks(PAGE)))
    assert {block.language for block in blocks(PAGE)} == {"yaml", "bash", "make", "sh", "python"}


def test_what_is_asked_for_before(hilc: Hilc, variables: dict[str, str]) -> None:
    for command in recipes("hilc"):
        assert command.arguments is not None and "--dry-run" in command.arguments
        outcome = hilc(*command.arguments)
        assert (outcome.code, outcome.err) == (0, "")
        assert ("33" if "--shard" not in command.line else "11") in outcome.out
    assert not Path("runs").exists()


def test_array_job_and_its_merge_give_the_sweep(variables: dict[str, str]) -> None:
    submit, again = recipes("sbatch")
    run(submit, variables)
    assert tables("runs/wheel-size-sweep") == whole()
    assert sorted(path.name for path in Path("runs").glob("*-of-*")) == [
        f"wheel-size-sweep.{number}-of-3" for number in (1, 2, 3)
    ]
    run(again, variables)  # alone in its array it is still a shard of three, and is done
    assert Path("job-3").read_text() == "0"
    assert Path("wheel-size-2.log").read_text() == ""


def test_merge_waits_for_an_array_job_that_fails(variables: dict[str, str]) -> None:
    Path("sweep.yaml").write_text("name: wheel-size\n")
    (submit, _) = recipes("sbatch")
    one = Command(submit.line.replace("--parsable", "--parsable --array=1"), 0)
    run(one, variables)
    assert Path("job-1").read_text() == "2"
    assert "sweep.yaml:" in Path("wheel-size-1.log").read_text()
    assert not Path("job-2").exists()


def test_makefile_gives_the_sweep_and_is_done_then(variables: dict[str, str]) -> None:
    for command in recipes("make"):
        run(command, variables)
    assert tables("runs/wheels") == whole()
    run(Command("make anew", 0), variables)
    assert list(Path("runs").iterdir()) == [Path("runs/wheels")]
    run(Command("make -q", 1), variables)
