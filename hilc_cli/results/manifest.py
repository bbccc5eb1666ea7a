"""What the manifests of results tell of when and with what they were computed."""

from __future__ import annotations

import platform
import sys
from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib.metadata import version
from typing import Any

from hilc_cli.version import __version__


def circumstances(
    started: datetime, libraries: Sequence[str], plug_ins: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Versions, kind of machine and time, as a manifest holds them.

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
    return {
        "hilc": __version__,
        "python": platform.python_version(),
        **{library: version(library) for library in libraries},
    }
