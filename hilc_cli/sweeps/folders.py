"""The folders of sweeps: opening those under way, reading and drawing finished ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing, suppress
from pathlib import Path

from hilc_cli.errors import ExistingResultsError, HilcError
from hilc_cli.files import merge_folder, writing
from hilc_cli.sweeps.chunks import Chunk
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.store import FolderStore
from hilc_cli.sweeps.sweep_folder import SWEEP_FOLDER, check_sweep_folder, read_sweep_folder
from hilc_cli.sweeps.work_folder import WORK_FOLDER, is_empty, locked_journal, read_header, remove


def work_folder(folder: str | Path) -> Path:
    """Where the command keeps the results of a sweep that is to be written to a folder."""
    return Path(folder).with_name(f"{Path(folder).name}.part")


def discard_work(plan: Plan, folder: str | Path) -> None:
    """Removes the work folder of a sweep; another program's, and what it works on, stay.

    Raises:
        FileAccessError: It cannot be removed.
    """
    discard(Path(folder), plan)


def is_resumable(folder: str | Path) -> bool:
    """Whether a folder holds an unfinished sweep, or a shard, that can be read."""
    try:
        return WORK_FOLDER.is_at(folder)
    except HilcError:
        return False


def check_sweep_output(plan: Plan, folder: str | Path, *, force: bool = False) -> None:
    """Whether the results of a sweep may be written to a folder, before it is computed.

    Raises:
        ExistingResultsError: The folder holds another sweep, or is no sweep folder.
        FileAccessError: Nothing can be written there, or the name is too long for what belongs to
            it while the sweep is under way.
    """
    check_sweep_folder(Path(folder), plan.checksum(), force=force)
    with writing(Path(folder)):
        work_folder(folder).is_symlink()


def is_complete(plan: Plan, folder: str | Path) -> bool:
    """Whether a folder holds the results of this very sweep, none of whose cases has failed."""
    manifest = SWEEP_FOLDER.look(Path(folder))
    return manifest.get("checksum") == plan.checksum() and not manifest.get("failed")


def is_sweep(folder: str | Path) -> bool:
    """Whether a folder holds the results of a sweep."""
    return SWEEP_FOLDER.is_at(folder)


def read_sweep(folder: str | Path) -> SweepData:
    """The results in a sweep folder, from its tables alone.

    Raises:
        HilcError: There is no such folder, or a table is missing or damaged.
    """
    return read_sweep_folder(Path(folder))


def plot_sweep(
    data: SweepData,
    folder: str | Path,
    *,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws pictures of a sweep.

    Args:
        data: From `read_sweep` or `sweep`.
        folder: Where to put KIND.FORMAT; made if it is not there.
        kinds: curve, map, effects, best, bands; by default those that fit.
        formats: png, svg, pdf.
        dpi: Resolution of png.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such kind or format, or the kind does not fit the sweep.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    # Matplotlib starts slowly.
    from hilc_cli.sweeps.pictures.catalogue import save_sweep_figures

    names: list[str] = []

    def draw(into: Path) -> None:
        drawn = save_sweep_figures(data, into, kinds=kinds, formats=formats, dpi=dpi)
        names.extend(path.name for path in drawn)

    merge_folder(Path(folder), draw, may_replace)
    return [Path(folder) / name for name in names]


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
