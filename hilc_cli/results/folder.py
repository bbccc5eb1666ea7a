"""What all folders of results share: names in them, a manifest, and when they may be replaced."""

from __future__ import annotations

import json
import platform
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any, TypeVar

from hilc_cli.errors import ExistingResultsError, MissingFileError, UsageError
from hilc_cli.files import (
    is_same,
    is_there,
    output_place,
    read_file,
    resolved,
    write_folder,
    writing,
)
from hilc_cli.results.reading import MAX_JSON_BYTES, Document, read_document
from hilc_cli.version import __version__

_MAX_PICTURE_BYTES = 100_000_000

PICTURE_FORMATS = ("png", "svg", "pdf")

SCENARIO = "scenario.yaml"
INITIAL_INPUT = "initial-input.csv"

_Document = TypeVar("_Document", bound=Document)


@dataclass(frozen=True)
class ResultFolder:
    """A kind of folder with results: each kind is data, and what is done with it is written here.

    Attributes:
        what: The kind in a word, such as ``run``.
        kind: What the manifest says that it is.
        other: What else of the kind may stand in its place, such as ``another scenario``.
        tables: Names of all files that pictures are drawn from. As long as all of them stay as
            they are, pictures of a folder that is replaced stay, too; none if they never do.
        pictures: Names of the pictures without their endings.
        moving: Names of pictures that move, likewise.
        files: Names of other files, and folders, that hilc writes.
        manifest: Name of the JSON file that says what the folder is.
    """

    what: str
    kind: str
    other: str
    tables: frozenset[str] = frozenset()
    pictures: tuple[str, ...] = ()
    moving: tuple[str, ...] = ()
    files: frozenset[str] = frozenset()
    manifest: str = "manifest.json"
    own: frozenset[str] = field(init=False)
    """Names of all that hilc writes; anything else in such a folder is somebody's own."""

    def __post_init__(self) -> None:
        own = {*self.tables, *self.files, self.manifest, *self._picture_files()}
        object.__setattr__(self, "own", frozenset(own))

    def look(self, path: Path) -> dict[str, Any]:
        """What a folder says of itself, unchecked; empty if it is none of this kind.

        Raises:
            UsageError: A folder, pipe or device stands in the place of the manifest.
            FileAccessError: It cannot be read.
        """
        if not is_there(path):
            return {}
        try:
            found = json.loads(read_file(path / self.manifest, MAX_JSON_BYTES))
        except (MissingFileError, ValueError, RecursionError):
            return {}
        return found if isinstance(found, dict) and found.get("kind") == self.kind else {}

    def is_at(self, path: str | Path) -> bool:
        """Whether a folder is one of this kind."""
        return bool(self.look(Path(path)))

    def read(self, path: Path, shape: type[_Document]) -> _Document:
        """The manifest of a folder, checked.

        Args:
            path: The folder.
            shape: What the manifest must be.

        Raises:
            UsageError: It is no folder of this kind, or its manifest is damaged.
            FileAccessError: It cannot be read.
        """
        if not self.is_at(path):
            kind = self.kind
            raise UsageError(
                f"{path}: is no {self.what} folder: it has no {self.manifest} of {kind}"
            )
        return read_document(path / self.manifest, shape)

    def check(
        self, path: Path, is_same: Callable[[Mapping[str, Any]], bool], *, force: bool = False
    ) -> None:
        """Makes sure that results may be written to a folder; to be asked before they are computed.

        Args:
            path: The folder.
            is_same: Whether the results there, with this manifest, are those that are to be
                written.
            force: Whether others of the kind may be replaced.

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
        manifest = self.look(path)
        if not manifest:
            raise ExistingResultsError(
                f"{path}: exists and is no {self.what} folder, so it is left as it is; "
                "choose another with --out"
            )
        if not force and not is_same(manifest):
            raise ExistingResultsError(
                f"{path}: holds the results of {self.other}; "
                "choose another folder with --out, or replace it with --force"
            )

    def check_checksum(self, path: Path, checksum: str, *, force: bool) -> None:
        """Does what `check` does where results are the same if their manifests' checksum is."""
        self.check(path, lambda there: there.get("checksum") == checksum, force=force)

    def write(
        self,
        path: Path,
        fill: Callable[[Path], None],
        manifest: Callable[[], Mapping[str, Any]],
        check: Callable[[Path], None],
    ) -> list[Path]:
        """Writes a folder as a whole; files of somebody's own in one that it replaces stay.

        Args:
            path: The folder.
            fill: Writes tables and pictures into the folder that it is given.
            manifest: Gives what is to be known of the results, asked last; kind and names of files
                are added.
            check: Raises ExistingResultsError if a folder that stands there may not be replaced.

        Returns:
            The files.

        Raises:
            ExistingResultsError: The folder holds something else.
            FileAccessError: It cannot be written.
        """
        names: list[str] = []

        def fill_all(folder: Path) -> None:
            fill(folder)
            if self.tables:
                self._keep_pictures(path, folder)
            files = [file for file in folder.rglob("*") if file.is_file()]
            names[:] = [file.relative_to(folder).as_posix() for file in files]
            names.append(self.manifest)
            names.sort()
            document = {"kind": self.kind, **manifest(), "files": names}
            text = json.dumps(document, indent=2)
            (folder / self.manifest).write_text(f"{text}\n", encoding="utf-8")

        def may_replace(folder: Path) -> bool:
            check(folder)
            return True

        write_folder(path, fill_all, may_replace, keeps=lambda name: name not in self.own)
        return [path / name for name in names]

    def _picture_files(self) -> list[str]:
        still = [f"{name}.{suffix}" for name in self.pictures for suffix in PICTURE_FORMATS]
        return [*still, *(f"{name}.gif" for name in self.moving)]

    def _keep_pictures(self, old: Path, new: Path) -> None:
        """Copies pictures that still show what the tables say into the folder that replaces one."""
        with suppress(FileNotFoundError):  # another program has replaced the old folder meanwhile
            both = [(old / name, new / name) for name in self.tables]
            if not old.is_dir() or not all(
                is_same(*pair) if pair[0].exists() else not pair[1].exists() for pair in both
            ):
                return
            for name in self._picture_files():
                picture, copy = old / name, new / name
                # A link stays behind: what it leads to is nobody's picture of these tables.
                if not picture.is_file() or picture.is_symlink() or copy.exists():
                    continue
                if picture.stat().st_size <= _MAX_PICTURE_BYTES:
                    shutil.copyfile(picture, copy)


DRAWN_WITH = ("matplotlib", "numpy", "pydantic", "pyyaml")
"""Packages that take part in a run and its pictures."""

COMPILED_WITH = ("numba", "numpy", "pydantic", "pyyaml", "scipy")
"""Packages that take part where many experiments are computed."""


def origin(
    started: datetime, libraries: Sequence[str], plug_ins: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Returns what a manifest tells of when and where results were computed: time and versions.

    Args:
        started: When the computation began, in UTC.
        libraries: Names of the packages that took part.
        plug_ins: Package and version of what is not hilc's own, by name.
    """
    return {
        "versions": versions(libraries),
        **({"plug_ins": plug_ins} if plug_ins else {}),
        "platform": f"{sys.platform} {platform.machine()}",
        "started": started.isoformat(timespec="seconds"),
    }


def versions(libraries: Sequence[str]) -> dict[str, str]:
    """Versions of this program, of Python and of some packages, by name."""
    from importlib.metadata import version  # starts slowly

    return {
        "hilc": __version__,
        "python": platform.python_version(),
        **{library: version(library) for library in libraries},
    }
