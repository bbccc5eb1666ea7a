"""What ``hilc --version -v`` tells: all that a report of a fault needs."""

from __future__ import annotations

import platform
import re
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from hilc_cli.surroundings import numba_folders
from hilc_cli.version import __version__
from hilc_cli.wording import counted, printable
from hilc_cli.workers.crews import available_cores

_DISTRIBUTION = "hilc-cli"
_DEVELOPERS = "dev", "docs"
_CODE = ("*.nbi", "*.nbc")
_REQUIREMENT = re.compile(
    r"""(?P<name>[A-Za-z0-9._-]+).*?(?:;.*extra\s*==\s*["'](?P<extra>[\w-]+)["'].*)?"""
)


def about() -> str:
    """Versions, processor, caches and extras, in lines for people."""
    needed, extras = _packages()
    rows = [
        ("Installed in", str(Path(__file__).resolve().parents[1])),
        ("Python", f"{platform.python_version()} ({sys.executable})"),
        ("System", f"{platform.system()} {platform.release()}"),
        ("Processor", f"{_processor()}, {counted(available_cores(), 'core')}"),
        ("Packages", ", ".join(f"{name} {_version(name)}" for name in needed)),
        *((f"Extra {extra}", _extra(extra, name)) for extra, name in extras.items()),
        *(("Machine code", line) for line in _machine_code()),
    ]
    width = max(len(name) for name, _ in rows) + 2
    lines = [f"{name:<{width}}{text}" for name, text in rows]
    return "\n".join(map(printable, [f"hilc {__version__}", *lines]))


def _packages() -> tuple[list[str], dict[str, str]]:
    """Names of the packages that hilc needs, and of those of each extra for users."""
    needed, extras = [], {}
    for text in requires(_DISTRIBUTION) or ():
        found = _REQUIREMENT.fullmatch(text)
        assert found is not None  # it is hilc's own
        if found["extra"] is None:
            needed.append(found["name"])
        elif found["extra"] not in _DEVELOPERS:
            extras[found["extra"]] = found["name"]
    return needed, extras


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _extra(extra: str, package: str) -> str:
    found = _version(package)
    how = f": pip install '{_DISTRIBUTION}[{extra}]'" if found == "not installed" else ""
    return f"{package} {found}{how}"


def _processor() -> str:
    """The name of the processor, where the system tells it."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return f"{line.partition(':')[2].strip()} ({platform.machine()})"
    except (OSError, UnicodeDecodeError):
        pass
    return platform.processor() or platform.machine()


def _machine_code() -> Iterator[str]:
    """Where machine code is kept, and how much."""
    told = False
    for folder in numba_folders(Path(__file__).resolve().parents[1]):
        files = [file for ending in _CODE for file in folder.rglob(ending)]
        if files:
            size = sum(file.stat().st_size for file in files)
            yield f"{counted(len(files), 'file')}, {size / 1e6:.1f} MB, in {folder}"
            told = True
    if not told:
        yield "none yet: the first sweep and the first norm-optimal run compile it"
