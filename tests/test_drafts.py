"""What a killed program leaves goes with the next one; what anybody still needs stays."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from hilc_cli import drafts
from hilc_cli.errors import FileAccessError
from hilc_cli.files import merge_folder, write_file, write_folder
from tests.cli.inputs import listing
from tests.cli.processes import uncovered

Fill = Callable[[Path], None]
Write = Callable[[Path, Fill], None]


def as_folder(place: Path, fill: Fill) -> None:
    write_folder(place, fill, lambda there: True, keeps=lambda name: name != "new")


def as_added_files(place: Path, fill: Fill) -> None:
    merge_folder(place, fill, lambda there: True)


def as_file(place: Path, fill: Fill) -> None:
    write_file(place, lambda draft: fill(draft.parent))


HALF = """\
import sys, time
from pathlib import Path
from tests import test_drafts

def halt(draft):
    (draft / "new").write_text("half")
    print(flush=True)
    time.sleep(60)

getattr(test_drafts, sys.argv[1])(Path(sys.argv[2]), halt)
"""


@contextmanager
def another_process(write: Write, place: Path) -> Iterator[None]:
    """A process that is in the middle of writing; in the end it is killed."""
    command = [sys.executable, "-c", HALF, write.__name__, str(place)]
    variables = uncovered(dict(os.environ))
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=variables) as process:
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == b"\n"
            yield
        finally:
            process.kill()


def fill(draft: Path) -> None:
    (draft / "new").write_text("whole")


def hidden(folder: Path) -> list[str]:
    return [name for name in os.listdir(folder) if ".hilc-" in name]  # noqa: PTH208  # names


@pytest.mark.parametrize("write", [as_folder, as_added_files, as_file])
def test_draft_goes_with_the_next_run_once_its_process_has_gone(
    tmp_path: Path, write: Write
) -> None:
    place, other = tmp_path / "a.b", tmp_path / "a.c"
    with another_process(write, place):
        (draft,) = hidden(tmp_path)
        write(place, fill)
        assert hidden(tmp_path) == [draft]  # it is still at work
    write(other, fill)
    assert hidden(tmp_path) == [draft]
    write(place, fill)
    assert hidden(tmp_path) == []


def put_draft(place: Path, random: str) -> Path:
    draft = place.parent / f"{drafts._prefix(place)}{random}"
    draft.mkdir()
    (draft / "new").write_text("half")
    return draft


def test_nothing_else_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "place"
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "file").write_text("mine")
    prefix = drafts._prefix(place)
    (tmp_path / f"{prefix}abcdefgh").symlink_to(precious)
    os.mkfifo(tmp_path / f"{prefix}hgfedcba")
    for name in (f"{prefix}abcdefg", f"{prefix}abcdefghi", f"{prefix}ABCDEFGH", ".place-abcdefgh"):
        (tmp_path / name).mkdir()
    (put_draft(tmp_path / "place2", "abcdefgh") / "link").symlink_to(precious)
    before = listing(tmp_path)
    as_folder(place, fill)
    assert listing(tmp_path) == {**before, "place": None, "place/new": b"whole"}

    draft = put_draft(place, "00000000")
    (draft / "link").symlink_to(precious)
    with monkeypatch.context() as patched:
        patched.setattr(os, "geteuid", lambda: os.getuid() + 1)
        as_folder(place, fill)
    assert draft.is_dir()  # another user's
    merge_folder(place, fill, lambda there: True)
    assert not draft.exists()
    assert listing(tmp_path) == {**before, "place": None, "place/new": b"whole"}


def test_foreign_files_come_out_of_what_is_left_of_a_replaced_folder(tmp_path: Path) -> None:
    # Killed after the exchange, before they were moved.
    place = tmp_path / "place"
    as_folder(place, fill)
    (put_draft(place, "abcdefgh") / "notes.txt").write_text("mine")
    stuck = put_draft(place, "12345678") / "notes.txt"
    stuck.write_text("mine, too")
    as_folder(place, fill)
    (kept,) = hidden(tmp_path)
    assert {
        (place / "notes.txt").read_text(),
        (tmp_path / kept / "notes.txt").read_text(),
    } == {"mine", "mine, too"}


def test_draft_that_somebody_takes_at_once_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[Path] = []
    lock = drafts._lock

    def lock_late(draft: Path) -> int | None:
        made.append(draft)
        if len(made) == 1:
            draft.rmdir()
        return lock(draft)

    monkeypatch.setattr(drafts, "_lock", lock_late)
    with drafts.draft_folder(tmp_path / "place", tmp_path) as draft:
        assert draft == made[1] != made[0]
    assert not list(tmp_path.iterdir())


def test_draft_goes_even_if_hardly_anything_can_be_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(draft: Path) -> None:
        (draft / "deeper").mkdir()
        (draft / "deeper/new").write_text("half")
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    monkeypatch.setattr(shutil, "rmtree", lambda *_, **__: None)
    with pytest.raises(FileAccessError, match=r"too many open files$"):
        as_folder(tmp_path / "place", fail)
    assert not list(tmp_path.iterdir())
