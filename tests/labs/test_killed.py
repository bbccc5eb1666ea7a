"""Labs whose program is killed, or whose disk is full: as before or as after, never between."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.labs.lab import Lab
from tests.cli.processes import environment, uncovered
from tests.labs.robots import driven, files_of, scenario

MOMENTS = 20
ADDING = """\
import os, sys, time
import numpy as np
import hilc_cli.runs.pictures.catalogue
from hilc_cli.labs.lab import Lab
data = np.load("pass.npz")
Lab("lab").state.run
for line in sys.stdin:
    child = os.fork()
    if not child:
        lab = Lab("lab")
        lab.add(data["poses"], data["times"])
        os._exit(0)
    print(child, flush=True)
    os.waitpid(child, 0)
    print("over", flush=True)
"""


class Adders:
    """Programs that add a pass to a lab, started one after the other."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def killed_after(self, delay: float | None) -> float:
        """Adds, and kills after a delay [s] if there is one; returns how long it took [s]."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(file=self._process.stdin, flush=True)
        child = int(self._process.stdout.readline())
        begin = time.perf_counter()
        if delay is not None:
            time.sleep(delay)
            with suppress(ProcessLookupError):  # it was faster
                os.kill(child, signal.SIGKILL)
        assert self._process.stdout.readline() == "over\n"
        return time.perf_counter() - begin


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    """A lab with one trial, beside the poses of its second."""
    lab = Lab.start(scenario(), tmp_path / "lab")
    times, poses = driven(lab.plan)
    lab.add(poses, times)
    times, poses = driven(lab.plan)
    np.savez(tmp_path / "pass.npz", times=times, poses=poses)
    return lab


@pytest.fixture
def adders(lab: Lab) -> Iterator[Adders]:
    with subprocess.Popen(
        [sys.executable, "-c", ADDING],
        cwd=lab.folder.parent,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=uncovered(environment()),
    ) as process:
        yield Adders(process)


def restore(folder: Path, kept: Path) -> None:
    shutil.rmtree(folder)
    shutil.copytree(kept, folder)


def test_a_killed_add_leaves_the_lab_as_before_or_as_after(lab: Lab, adders: Adders) -> None:
    kept = lab.folder.parent / "kept"
    shutil.copytree(lab.folder, kept)
    before = files_of(lab.folder)
    adders.killed_after(None)
    after = files_of(lab.folder)
    restore(lab.folder, kept)
    lasts = adders.killed_after(None)
    assert after.keys() > before.keys()
    outcomes = []
    for moment in range(MOMENTS):
        restore(lab.folder, kept)
        # Most of it is learning: half of the moments are in the last fifth, where it is written.
        share = (0.8 * moment / 10) if moment < 10 else 0.8 + 0.3 * (moment - 10) / 10
        adders.killed_after(share * lasts)
        found = files_of(lab.folder)
        assert found in (before, after)
        outcomes.append(found == after)
        assert len(Lab(lab.folder).trials) == 1 + (found == after)
    assert not all(outcomes)
    # What was left of drafts goes with the next one that is whole.
    restore(lab.folder, kept)
    adders.killed_after(None)
    assert files_of(lab.folder) == after
    names = {path.name for path in lab.folder.parent.iterdir()}
    assert names == {"lab", "kept", "pass.npz"}


def test_a_full_disk_leaves_the_lab_as_it_is(lab: Lab) -> None:
    before = files_of(lab.folder)
    script = (
        "import resource, numpy as np\n"
        "from hilc_cli.errors import FileAccessError\n"
        "from hilc_cli.labs.lab import Lab\n"
        "data, lab = np.load('pass.npz'), Lab('lab')\n"
        "lab.state.run\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000))\n"
        "try:\n"
        "    lab.add(data['poses'], data['times'])\n"
        "except FileAccessError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=lab.folder.parent,
        capture_output=True,
        text=True,
        env=uncovered(environment()),
        check=True,
    )
    assert done.stdout == "lab: cannot be written: file too large\n"
    assert files_of(lab.folder) == before
    assert {path.name for path in lab.folder.parent.iterdir()} == {"lab", "pass.npz"}


def test_of_two_adds_at_once_one_is_told_to_wait(lab: Lab) -> None:
    script = (
        "import sys, numpy as np\n"
        "from hilc_cli.errors import ExistingResultsError\n"
        "from hilc_cli.labs.lab import Lab\n"
        "data, lab = np.load('pass.npz'), Lab('lab')\n"
        "lab.state.run\n"
        "print('ready', flush=True)\n"
        "sys.stdin.readline()\n"
        "try:\n"
        "    lab.add(data['poses'], data['times'])\n"
        "    print('added')\n"
        "except ExistingResultsError as error:\n"
        "    print('refused')\n"
    )
    both = [
        subprocess.Popen(
            [sys.executable, "-c", script],
            cwd=lab.folder.parent,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=uncovered(environment()),
        )
        for _ in range(2)
    ]
    for process in both:
        assert process.stdout is not None and process.stdout.readline() == "ready\n"
    for process in both:
        assert process.stdin is not None
        process.stdin.write("\n")
        process.stdin.flush()
    said = sorted(process.communicate()[0] for process in both)
    assert said == ["added\n", "refused\n"]
    assert len(Lab(lab.folder).trials) == 2
