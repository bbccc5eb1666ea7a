"""A disk that is full in mid-sweep: one line, and the sweep goes on once there is room."""

from __future__ import annotations

import resource
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.cli import sweeps
from tests.conftest import Hilc, Outcome

pytestmark = pytest.mark.usefixtures("alone")

Resize = Callable[[str], None]
SMALLEST_FILE = 39_200  # errors.bin reaches it after some chunks


@pytest.fixture(autouse=True)
def _compiled() -> None:
    """Compiles the engine before: where files may not grow, each process would do so for itself."""
    sweeps.expected()


def limit_file_size() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (SMALLEST_FILE, SMALLEST_FILE))


def check_refused(outcome: Outcome, reason: str) -> tuple[str, ...]:
    """The sweep has ended with one line, and one to go on with; gives the latter."""
    assert (outcome.code, outcome.out) == (1, "")
    go_on, refused = outcome.err.splitlines()
    assert go_on.startswith("hilc: go on with: hilc sweep ")
    assert refused.startswith("hilc: ") and refused.endswith(f": cannot be written: {reason}")
    return sweeps.line_to_go_on(outcome.err)


@pytest.mark.slow
def test_file_size_limit(hilc: Hilc, folder: Path) -> None:
    sweeps.put_sweep(folder)
    command = (*sweeps.COMMAND, "--workers", "2")
    outcome = sweeps.run(*command, cwd=folder, before=limit_file_size)
    resume = check_refused(outcome, "file too large")
    assert sweeps.chunks_kept() > 0
    assert sweeps.none_left(folder)
    assert hilc(*resume, "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()


@pytest.fixture
def resize(folder: Path) -> Iterator[Resize]:
    """Gives the folder `disk` a size."""
    disk = folder / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", str(disk)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("mounting a small disk is not permitted here")

    def resize(size: str) -> None:
        remount = ["mount", "-o", f"remount,size={size}", str(disk)]
        subprocess.run(remount, check=True, capture_output=True)

    try:
        yield resize
    finally:
        subprocess.run(["umount", str(disk)], check=True)


@pytest.mark.parametrize(
    ("size", "is_computed"),
    [
        pytest.param("60k", False, id="while it computes", marks=pytest.mark.slow),
        pytest.param("120k", True, id="while results are written"),
    ],
)
def test_full_disk(hilc: Hilc, folder: Path, resize: Resize, size: str, is_computed: bool) -> None:
    sweeps.put_sweep(folder)
    resize(size)
    command = (*sweeps.COMMAND, "--out", "disk/sweep")
    outcome = sweeps.run(*command, cwd=folder, script=sweeps.ALONE)
    resume = check_refused(outcome, "no space left on device")
    chunks = sweeps.chunks_kept(folder / "disk/sweep.part")
    every = sweeps.CASES // sweeps.CHUNK
    assert (chunks == every) if is_computed else (0 < chunks < every)
    assert [path.name for path in (folder / "disk").iterdir()] == ["sweep.part"]

    # Still full: the same again, and nothing is lost.
    outcome = sweeps.run(*resume, cwd=folder, script=sweeps.ALONE)
    assert check_refused(outcome, "no space left on device") == resume
    resize("4m")
    assert hilc(*resume, "-q") == Outcome(0, "", "")
    assert sweeps.tables(folder / "disk/sweep") == sweeps.expected()
    assert [path.name for path in (folder / "disk").iterdir()] == ["sweep"]


def test_disk_without_room_for_anything(hilc: Hilc, folder: Path, resize: Resize) -> None:
    sweeps.put_sweep(folder)
    (folder / "disk/full").write_bytes(bytes(4096))
    resize("4k")
    outcome = hilc(*sweeps.COMMAND, "--out", "disk/sweep")
    message = "hilc: disk/sweep.part: cannot be written: no space left on device\n"
    assert outcome == Outcome(1, "", message)
    assert [path.name for path in (folder / "disk").iterdir()] == ["full"]


def test_disk_without_room_for_a_shard(hilc: Hilc, folder: Path, resize: Resize) -> None:
    sweeps.put_sweep(folder)
    resize("72k")
    command = (*sweeps.COMMAND, "--shard", "1/1", "--out", "disk/shard")
    resume = check_refused(hilc(*command), "no space left on device")
    resize("4m")
    assert hilc(*resume, "-q") == Outcome(0, "", "")
    merge = ("sweep", "--merge", "disk/shard.1-of-1", "--out", "sweep", "--no-plots", "-q")
    assert hilc(*merge) == Outcome(0, "", "")
    assert sweeps.tables(folder / "sweep") == sweeps.expected()
