"""Bounded reading, and writing that is whole or not there at all."""

from __future__ import annotations

import errno
import io
import os
import socket
import stat
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hilc_cli import files
from hilc_cli.errors import ExistingResultsError, FileAccessError, UsageError
from hilc_cli.files import merge_folder, read_file, write_file, write_folder
from tests.cli.inputs import listing


def test_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    assert read_file(path, 5) == b"12345"
    with pytest.raises(UsageError, match=r"is larger than 4 bytes, the most that is read"):
        read_file(path, 4)


def test_huge_file_is_refused_before_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fdopen", None)
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(UsageError, match=r"is larger than 1000000000 bytes, the most that is read"):
        read_file(tmp_path / "sparse", 10**9)


def test_socket_is_refused(folder: Path) -> None:
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind("sock")
        with pytest.raises(UsageError, match=r"^sock: is a socket; give a regular file$"):
            read_file(Path("sock"), 10)


def test_endless_device_is_refused() -> None:
    with pytest.raises(UsageError, match=r"^/dev/zero: is a device; give a regular file$"):
        read_file(Path("/dev/zero"), 10)


def test_named_pipe_is_refused_without_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(UsageError, match=r"is a named pipe; give a regular file$"):
        read_file(tmp_path / "pipe", 10)


def test_file_of_the_system_without_an_end_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As the kernel's log: a regular file that has nothing to say yet.
    class Silent(io.BytesIO):
        def read(self, size: int | None = -1) -> Any:
            return None

    def opened(descriptor: int, mode: str) -> Silent:
        os.close(descriptor)
        return Silent()

    (tmp_path / "log").touch()
    monkeypatch.setattr(os, "fdopen", opened)
    with pytest.raises(UsageError, match=r"log: has no end up to which it could be read; give a"):
        read_file(tmp_path / "log", 10)


def test_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"is a folder; give a regular file$"):
        read_file(tmp_path, 10)


def test_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"there is no such file; check the path$"):
        read_file(tmp_path / "nosuch", 10)


def test_loop_of_links_is_told(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(UsageError, match=r"too many levels of symbolic links$"):
        read_file(tmp_path / "loop", 10)


def test_loop_of_links_is_no_bug(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(UsageError, match=r"loop: cannot be read: too many levels of symbolic link"):
        files.folder_to_read(tmp_path / "loop")
    with pytest.raises(UsageError, match=r"loop: cannot be read: too many levels of symbolic link"):
        files.is_there(tmp_path / "loop")


def test_path_from_a_folder_that_is_gone_is_told(folder: Path) -> None:
    folder.rmdir()
    with pytest.raises(
        FileAccessError, match=r"^\.\./x: cannot be read: no such file or directory$"
    ):
        files.folder_to_read(Path("../x"))


def test_name_with_a_nul_is_told(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"cannot be read: embedded null byte$"):
        read_file(tmp_path / "a\0b", 10)


def test_file_is_replaced_as_a_whole(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")

    def write(draft: Path) -> None:
        draft.write_text("new")

    write_file(path, write)
    assert listing(tmp_path) == {"file.txt": b"new"}


def test_file_that_cannot_be_made_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    path.write_text("old")

    def fail(draft: Path) -> None:
        draft.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(FileAccessError, match=r"cannot be written: no space left on device$"):
        write_file(path, fail)
    assert listing(tmp_path) == {"file.txt": b"old"}


def fill(folder: Path) -> None:
    (folder / "a").write_text("a")
    (folder / "b").write_text("b")


def test_folder_is_there_only_when_it_is_whole(tmp_path: Path) -> None:
    def watch(draft: Path) -> None:
        fill(draft)
        assert not (tmp_path / "out").exists()

    write_folder(tmp_path / "out", watch, lambda there: False)
    assert listing(tmp_path) == {"out": None, "out/a": b"a", "out/b": b"b"}


def test_folder_that_cannot_be_made_leaves_the_old_one(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", fill, lambda there: False)
    before = listing(tmp_path)

    def fail(draft: Path) -> None:
        (draft / "a").write_text("half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_folder(tmp_path / "out", fail, lambda there: True)
    assert listing(tmp_path) == before


def test_folder_that_may_not_be_replaced_stays(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/precious").write_text("precious")
    before = listing(tmp_path)
    with pytest.raises(ExistingResultsError, match=r"exists and holds something else$"):
        write_folder(tmp_path / "out", fill, lambda there: False)
    assert listing(tmp_path) == before


def test_folder_that_appears_meanwhile_is_asked_about(tmp_path: Path) -> None:
    asked: list[Path] = []

    def meanwhile(draft: Path) -> None:
        fill(draft)
        (tmp_path / "out").mkdir()
        (tmp_path / "out/theirs").write_text("theirs")

    def refuse(there: Path) -> bool:
        asked.append(there)
        return False

    with pytest.raises(ExistingResultsError):
        write_folder(tmp_path / "out", meanwhile, refuse)
    assert asked == [tmp_path / "out"]
    assert listing(tmp_path) == {"out": None, "out/theirs": b"theirs"}


def test_no_draft_is_left_in_a_parent_folder_that_was_made(tmp_path: Path) -> None:
    def fail(draft: Path) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(FileAccessError):
        write_folder(tmp_path / "runs" / "out", fail, lambda there: False)
    assert {path.name for path in tmp_path.rglob("*")} <= {"runs"}


@pytest.mark.parametrize("write", [write_folder, merge_folder])
def test_nothing_is_made_where_a_link_to_nothing_leads(
    tmp_path: Path, write: Callable[..., None]
) -> None:
    (tmp_path / "outside").mkdir()
    (tmp_path / "dangling").symlink_to("outside/nowhere")
    before = listing(tmp_path)
    for place in ("x", "x/y", "../outside/x"):
        with pytest.raises(
            FileAccessError, match=r"nothing is made below .*dangling, a link to no"
        ):
            write(tmp_path / "dangling" / place, fill, lambda there: True)
    assert listing(tmp_path) == before


def test_files_are_added_to_a_folder_with_usual_permissions(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        merge_folder(tmp_path / "out", fill, lambda there: False)
    finally:
        os.umask(before)
    modes = [stat.S_IMODE((tmp_path / "out" / name).stat().st_mode) for name in ("", "a", "b")]
    assert modes == [0o750, 0o640, 0o640]


def test_nothing_is_added_if_one_file_may_not_be_replaced(tmp_path: Path) -> None:
    (tmp_path / "b").write_text("precious")
    before = listing(tmp_path)
    with pytest.raises(ExistingResultsError, match=r"b: exists; choose another folder"):
        merge_folder(tmp_path, fill, lambda there: False)
    assert listing(tmp_path) == before


def test_file_of_the_same_content_may_stand_there(tmp_path: Path) -> None:
    merge_folder(tmp_path, fill, lambda there: False)
    before = listing(tmp_path)
    merge_folder(tmp_path, fill, lambda there: False, or_same=True)
    assert listing(tmp_path) == before
    with pytest.raises(ExistingResultsError):
        merge_folder(tmp_path, fill, lambda there: False)
    (tmp_path / "b").write_bytes((tmp_path / "b").read_bytes().swapcase() + b" ")
    with pytest.raises(ExistingResultsError, match="b: exists"):
        merge_folder(tmp_path, fill, lambda there: False, or_same=True)


def test_folder_of_files_that_cannot_be_made_is_not_made_either(tmp_path: Path) -> None:
    def fail(draft: Path) -> None:
        raise UsageError("there is no such kind")

    with pytest.raises(UsageError):
        merge_folder(tmp_path / "new", fail, lambda there: False)
    assert listing(tmp_path) == {}


def test_folder_in_the_place_of_a_file_is_kept(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a/precious").write_text("precious")
    before = listing(tmp_path)
    with pytest.raises((ExistingResultsError, FileAccessError)):
        merge_folder(tmp_path, fill, lambda there: True)
    assert listing(tmp_path) == before


def _swap(old: Path, name: str = "note.txt") -> None:
    old.mkdir()
    (old / "own").write_text("old")
    (old / name).write_text("mine")


def _write_new(folder: Path) -> None:
    (folder / "own").write_text("new")


def test_foreign_files_survive_an_interrupt_right_after_the_swap(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "place"
    _swap(place)
    exchange = files._exchange

    def interrupted(one: Path, other: Path) -> None:
        exchange(one, other)
        raise KeyboardInterrupt

    monkeypatch.setattr(files, "_exchange", interrupted)
    with pytest.raises(KeyboardInterrupt):
        files.write_folder(place, _write_new, lambda _: True, keeps=lambda name: name != "own")
    assert (place / "own").read_text() == "new"
    assert (place / "note.txt").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["place"]


def test_foreign_file_that_cannot_be_moved_is_not_deleted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "place"
    _swap(place)
    rename = Path.rename

    def stubborn(self: Path, target: Path) -> Path:
        if self.name == "note.txt":
            raise OSError(errno.EIO, "Input/output error")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", stubborn)
    files.write_folder(place, _write_new, lambda _: True, keeps=lambda name: name != "own")
    assert (place / "own").read_text() == "new"
    (left,) = tmp_path.glob(".place.hilc-*/note.txt")
    assert left.read_text() == "mine"


@pytest.mark.skipif(sys.platform != "linux", reason="needs renameat2")
def test_at_no_moment_is_there_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "place"
    _swap(place)
    monkeypatch.setattr(Path, "rename", _refuse_to_move(Path.rename, place))
    files.write_folder(place, _write_new, lambda _: True)
    assert (place / "own").read_text() == "new"


def _refuse_to_move(
    rename: Callable[[Path, Path], Path], place: Path
) -> Callable[[Path, Path], Path]:
    """A rename that fails if the old folder is moved away instead of being exchanged."""

    def checked(self: Path, target: Path) -> Path:
        assert self != place, "the folder was moved away"
        return rename(self, target)

    return checked
