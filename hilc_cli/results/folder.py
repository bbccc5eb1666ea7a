"""What folders of runs and of sweeps share: a manifest, and when they may be replaced."""

from __future__ import annotations

import filecmp
import json
import shutil
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path
from typing import Any

from hilc_cli.errors import ExistingResultsError, MissingFileError
from hilc_cli.files import (
    is_there,
    output_place,
    read_file,
    resolved,
    writing,
)

_MAX_MANIFEST_BYTES = 1_000_000_000
_MAX_PICTURE_BYTES = 100_000_000

PICTURE_FORMATS = ("png", "svg", "pdf")

SWEEP_PICTURE_KINDS = ("curve", "map", "effects", "best", "bands", "search")


def read_manifest(path: Path, kind: str | None = None) -> dict[str, Any]:
    """What a JSON file says of the folder that it is in.

    Args:
        path: The file.
        kind: What its ``kind`` must be; None for anything.

    Returns:
        The document; empty if there is none, or it is of another kind or no JSON.

    Raises:
        UsageError: A folder, pipe or device stands there, or too large a file.
        FileAccessError: It cannot be read.
    """
    if not is_there(path.parent):
        return {}
    try:
        manifest = json.loads(read_file(path, _MAX_MANIFEST_BYTES))
    except (MissingFileError, ValueError, RecursionError):
        return {}
    if not isinstance(manifest, dict) or kind not in (None, manifest.get("kind")):
        return {}
    return manifest


def keep_pictures(old: Path, new: Path, tables: Collection[str], pictures: Collection[str]) -> None:
    """Copies pictures that still show what the tables say into the folder that replaces another.

    Args:
        old: The folder that is to be replaced; it need not be there.
        new: The new one, with its tables and pictures.
        tables: Names of all files that pictures are drawn from. One that neither folder has is the
            same; if any differs, nothing is copied.
        pictures: Names of files that hilc draws; one that the new folder has is not copied, nor one
            that is too large to be a picture.

    Raises:
        OSError: They cannot be written.
    """
    with suppress(FileNotFoundError):  # another program has replaced the old folder meanwhile
        if not old.is_dir() or not all(_is_same(old / name, new / name) for name in tables):
            return
        for name in pictures:
            picture, copy = old / name, new / name
            # A link stays behind: what it leads to is nobody's picture of these tables.
            if not picture.is_file() or picture.is_symlink() or copy.exists():
                continue
            if picture.stat().st_size <= _MAX_PICTURE_BYTES:
                shutil.copyfile(picture, copy)


def _is_same(one: Path, other: Path) -> bool:
    """Whether two files have the same content, or neither is there."""
    if not one.exists() and not other.exists():
        return True
    return one.is_file() and other.is_file() and filecmp.cmp(one, other, shallow=False)


def check_replaceable(
    path: Path, what: str, other: str, is_own: Callable[[], bool], is_same: Callable[[], bool]
) -> None:
    """Whether results may be written to a folder.

    Args:
        path: The folder.
        what: What is to be written there: ``run`` or ``sweep``.
        other: What else of that kind may stand there, such as ``another sweep``.
        is_own: Whether the folder holds something of that kind.
        is_same: Whether it may be replaced.

    Raises:
        ExistingResultsError: Something stands there that may not be replaced.
    """
    with writing(path):
        is_folder, is_empty = path.is_dir(), not path.is_dir() or not any(path.iterdir())
    if not is_folder:
        if path.exists() or path.is_symlink():
            raise ExistingResultsError(f"{path}: is no folder; choose another with --out")
        with writing(path):
            output_place(path)
        return
    with writing(path):
        is_here = Path.cwd().is_relative_to(resolved(path))
    if is_here:
        # It would be exchanged for another one under the feet of whoever stands in it.
        raise ExistingResultsError(f"{path}: is the folder you are in; name another with --out")
    if is_empty:
        if path.is_symlink():  # in a folder that comes from elsewhere it may lead anywhere
            raise ExistingResultsError(
                f"{path}: is a link to an empty folder; name that one with --out"
            )
        return
    if not is_own():
        raise ExistingResultsError(
            f"{path}: exists and is no {what} folder, so it is left as it is; "
            "choose another with --out"
        )
    if not is_same():
        raise ExistingResultsError(
            f"{path}: holds the results of {other}; "
            "choose another folder with --out, or replace it with --force"
        )
