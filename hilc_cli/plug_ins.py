"""Laws and plants that are not hilc's own: found by name, and imported only when named.

What is installed under an entry point was put there on purpose. ``package.module:Class`` in a file
may come from anybody, and importing it runs its code: that takes the user's word, ``--trust``.
"""

from __future__ import annotations

import re
import sys
import sysconfig
from collections.abc import Container, Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
from contextvars import ContextVar
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from hilc_cli.errors import UsageError
from hilc_cli.wording import near_word, printable, shortened

if TYPE_CHECKING:
    from importlib.metadata import Distribution, EntryPoint

Kind = Literal["law", "plant"]

REFERENCE = r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*"
"""What ``package.module:Class`` looks like."""
_LONGEST = 200


class PlugIn(NamedTuple):
    """A class from elsewhere.

    Attributes:
        cls: The class.
        distribution: The name of the installed package that it belongs to; None if it is of none.
        version: The version of that package.
    """

    cls: type
    distribution: str | None
    version: str | None


class PlugInError(UsageError):
    """A plug-in is not there, may not be imported, or cannot be.

    Attributes:
        problem: What is wrong with its name.
        remedy: What to do about it.
    """

    def __init__(self, kind: Kind, name: str, problem: str, remedy: str) -> None:
        self.problem, self.remedy = printable(problem), printable(remedy)
        super().__init__(f"{kind} {printable(shortened(name, 60))}: {self.problem}; {self.remedy}")


@dataclass(slots=True)
class _Trust:
    """The user's word for one file, and what could not be imported in spite of it."""

    given: bool = False
    failed: dict[tuple[Kind, str], PlugInError] = field(default_factory=dict)


_TRUST: ContextVar[_Trust | None] = ContextVar("trust", default=None)
_FOUND: dict[tuple[Kind, str], PlugIn] = {}
_TRUSTED_PROGRAMS: set[tuple[str, ...]] = set()


@contextmanager
def trusting(trust: bool) -> Iterator[None]:
    """Says for all that is validated inside whether classes that a file names may be imported.

    Args:
        trust: Whether the user has said ``--trust``.
    """
    before = _TRUST.set(_Trust(trust))
    try:
        yield
    finally:
        _TRUST.reset(before)


def find(kind: Kind, name: str, *, trust: bool | None = None, own: Iterable[str] = ()) -> PlugIn:
    """Returns the law or plant of a name.

    What this process has imported already is found again without trust: no code runs for it.

    Args:
        kind: What it is to be.
        name: The name of an entry point, or ``package.module:Class``.
        trust: Whether the latter may be imported; None for what `trusting` says.
        own: The names of hilc's own, for the message.

    Raises:
        PlugInError: There is no such thing, it needs trust, or importing it fails.
    """
    if (kind, name) in _FOUND:
        return _FOUND[kind, name]
    said = _TRUST.get() or _Trust()
    if (kind, name) in said.failed:  # its code is not run once more
        raise said.failed[kind, name]
    try:
        found = _found(kind, name, said.given if trust is None else trust, own)
    except PlugInError as error:
        said.failed[kind, name] = error
        raise
    _FOUND[kind, name] = found
    return found


def may_run(command: Iterable[str], folder: str) -> bool:
    """Returns whether a program that a file names may be run: what was trusted once stays so.

    Args:
        command: The program and its arguments.
        folder: Its working folder.
    """
    program = (folder, *command)
    said = _TRUST.get()
    if said is not None and said.given:
        _TRUSTED_PROGRAMS.add(program)
    return program in _TRUSTED_PROGRAMS


def installed(kind: Kind) -> list[str]:
    """Returns the names of all installed plug-ins of a kind, in alphabetical order."""
    return sorted({point.name for point, _ in _entry_points(kind)})


def packages_of(
    kind: Kind, names: Iterable[str], own: Container[str]
) -> dict[str, dict[str, str | None]]:
    """Returns package and version of names found before, but for hilc's own, for manifests."""
    found = {name: find(kind, name) for name in names if name not in own}
    return {
        name: {"package": each.distribution, "version": each.version}
        for name, each in found.items()
    }


def schema_of_installed(kind: Kind) -> dict[str, Any]:
    """Returns the JSON Schema of any but hilc's own, whose keys are not known before it is."""
    names = [REFERENCE, *map(re.escape, installed(kind))]
    return {
        "type": "object",
        "title": f"a {kind} that is installed beside hilc",
        "required": [kind],
        "properties": {kind: {"type": "string", "pattern": f"^({'|'.join(names)})$"}},
        "additionalProperties": True,
    }


def import_path() -> list[str]:
    """Returns the folders from which plug-ins may come.

    That is the import path of Python without the working folder, which with ``python -m`` stands
    first in it: a folder that came from elsewhere is often worked in. If it has been installed,
    as a checkout often is, it stands behind the standard library as well, and there it stays.
    """
    here = Path().resolve()
    library = sysconfig.get_path("stdlib")
    behind = sys.path.index(library) if library in sys.path else len(sys.path)
    return [
        entry
        for place, entry in enumerate(sys.path)
        if entry and (place > behind or Path(entry).resolve() != here)
    ]


def _found(kind: Kind, name: str, trust: bool, own: Iterable[str]) -> PlugIn:
    if ":" in name:
        return _by_reference(kind, name, trust)
    points = [each for each in _entry_points(kind) if each[0].name == name]
    if not points:
        known = list(dict.fromkeys([*own, *installed(kind)]))
        near = near_word(name, known)
        *others, last = known or ["package.module:Class"]
        remedy = f"give {', '.join(others)} or {last}" if others else f"give {last}"
        if near:
            remedy = f"did you mean '{near}'?"
        raise PlugInError(kind, name, "is not one of the choices", remedy)
    if len(points) > 1:
        packages = sorted(distribution.name for _, distribution in points)
        problem = f"is the name of more than one installed {kind}"
        raise PlugInError(kind, name, problem, f"uninstall one of {', '.join(packages)}")
    point, distribution = points[0]
    return PlugIn(_imported(kind, name, point), distribution.name, distribution.version)


def _by_reference(kind: Kind, name: str, trust: bool) -> PlugIn:
    """The class that ``package.module:Class`` means."""
    from importlib.metadata import EntryPoint, packages_distributions, version  # start slowly

    if len(name) > _LONGEST or not re.fullmatch(REFERENCE, name, re.ASCII):
        remedy = "write package.module:Class, or the name of an installed one"
        raise PlugInError(kind, name, f"is no name of a {kind}", remedy)
    module = name.partition(":")[0]
    if not trust and module not in sys.modules:
        problem = "is code, which is imported only with --trust"
        raise PlugInError(kind, name, problem, "give --trust if you know where it comes from")
    cls = _imported(kind, name, EntryPoint(name, name, f"hilc.{kind}s"))
    owners = packages_distributions().get(module.partition(".")[0], [None])
    owner = owners[0]
    return PlugIn(cls, owner, None if owner is None else version(owner))


def _entry_points(kind: Kind) -> list[tuple[EntryPoint, Distribution]]:
    """All entry points of a kind, each package once: as for modules, the first one counts."""
    from importlib.metadata import MetadataPathFinder  # start slowly

    context = MetadataPathFinder.Context(path=import_path())
    packages: dict[str, Distribution] = {}
    for package in MetadataPathFinder.find_distributions(context):
        packages.setdefault(str(package.metadata["Name"]), package)
    return [
        (point, package)
        for package in packages.values()
        for point in package.entry_points
        if point.group == f"hilc.{kind}s"
    ]


def _imported(kind: Kind, name: str, point: EntryPoint) -> type:
    """The class of an entry point, whatever its code may do while it is imported."""
    before = list(sys.path)
    sys.path[:] = import_path()
    try:
        with redirect_stdout(sys.stderr):  # standard output may be a document
            cls: object = import_module(point.module)
            for part in point.attr.split("."):
                cls = getattr(cls, part)
    except (Exception, SystemExit) as error:
        lines = str(error).splitlines() or [""]
        why = f"cannot be imported: {type(error).__name__}: {shortened(lines[0])}"
        remedy = "mend or install its package; the working folder is not searched"
        raise PlugInError(kind, name, why, remedy) from error
    finally:
        sys.path[:] = before
    if not isinstance(cls, type):
        raise PlugInError(kind, name, "is no class", "name a class")
    return cls
