"""When the folder of a sweep under way is made, opened again, replaced, or removed."""

from __future__ import annotations

from contextlib import closing, suppress
from pathlib import Path

from hilc_cli.errors import ExistingResultsError
from hilc_cli.files import writing
from hilc_cli.sweeps.chunks import Chunk
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.store import FolderStore
from hilc_cli.sweeps.work_folder import is_empty, locked_journal, read_header, remove


def open_store(
    folder: Path, plan: Plan, cases: Chunk, shard: str | None, *, resume: bool, force: bool
) -> FolderStore:
    """Opens the folder of a sweep under way, or makes it.

    Args:
        folder: The folder.
        plan: The sweep.
        cases: The cases that belong into it.
        shard: ``K/N``, for a shard.
        resume: Go on with what is there; cases that have failed are tried again.
        force: Replace what is there of another sweep, or of this one if it is not resumed.

    Raises:
        ExistingResultsError: Something is there that may neither be resumed nor replaced.
        FileAccessError: It cannot be read or written.
    """
    with writing(folder):
        is_there = folder.is_symlink() or (folder.exists() and not is_empty(folder))
    if is_there:
        header = read_header(folder)
        if not header:
            raise ExistingResultsError(
                f"{folder}: exists and holds no sweep in progress, so it is left as it is; "
                "choose another folder with --out"
            )
        same = header.get("checksum") == plan.checksum() and header.get("shard") == shard
        if same and resume:
            store = FolderStore(folder)
            store.forget_failures()
            return store
        with closing(locked_journal(folder, header)) as journal:
            # One that was killed before it had any results is in nobody's way.
            if not force and not journal.is_empty():
                what = "this sweep" if same else "another sweep or version of hilc"
                go_on = "go on with --resume, or " if same else ""
                raise ExistingResultsError(
                    f"{folder}: holds results of {what}; {go_on}start anew with --force"
                )
            remove(folder)
    return FolderStore.create(folder, plan, cases, shard)


def discard(folder: Path, plan: Plan) -> None:
    """Removes the folder of a sweep whose results have gone elsewhere.

    What another program has open by now, or holds another sweep, stays.

    Raises:
        FileAccessError: It cannot be removed.
    """
    header = read_header(folder)
    if header.get("checksum") == plan.checksum():
        with suppress(ExistingResultsError), closing(locked_journal(folder, header)):
            remove(folder)
    elif not header and is_empty(folder):
        remove(folder)
