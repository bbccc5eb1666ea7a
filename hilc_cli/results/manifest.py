"""What the manifests of results tell of when and with what they were computed."""

from __future__ import annotations

import platform
import sys
from collections.abc import Mapping, Sequence
from datetime import datetime
from importlib.metadata import version
from typing import Any

from hilc_cli.version import __version__

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
    return {
        "hilc": __version__,
        "python": platform.python_version(),
        **{library: version(library) for library in libraries},
    }
