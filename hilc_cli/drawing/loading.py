"""Matplotlib is loaded, whatever is set for it: ``MPLBACKEND``, ``matplotlibrc``, folders.

It reads all of that while it is imported, and cannot be imported where one of them makes no
sense. Pictures need none of it: `save.render` names the canvas, `style.applied` all settings.
"""

from __future__ import annotations

import logging
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hilc_cli.surroundings import hidden

_RC_FILE = "matplotlibrc"
_MOST_SETTINGS = 1_000_000
"""Bytes of a file of settings that is read."""


def load_matplotlib() -> None:
    """Imports Matplotlib without the user's settings, then puts them in as far as they make sense.

    Pictures do not depend on them, but in a notebook they are those of other pictures as well. If
    Matplotlib is there already it stays as it is.
    """
    if "matplotlib" in sys.modules:
        return
    backend = os.environ.get("MPLBACKEND")
    with _silent():
        with hidden(_RC_FILE, {"MPLBACKEND": None, "MATPLOTLIBRC": os.devnull}):
            import matplotlib
        with suppress(Exception):  # of many kinds: a file may hold anything
            _read_settings(Path(matplotlib.matplotlib_fname()))
        if backend:
            with suppress(ValueError):
                matplotlib.rcParams["backend"] = backend
        matplotlib.rcParamsOrig = matplotlib.rcParams.copy()
        # Keeps a list of fonts in its folder, and complains where it cannot.
        import matplotlib.font_manager


def _read_settings(path: Path) -> None:
    import matplotlib

    if path.is_file() and path.stat().st_size <= _MOST_SETTINGS:
        settings = matplotlib.rc_params_from_file(path, use_default_template=False)
        matplotlib.rcParams.update(settings)


@contextmanager
def _silent() -> Iterator[None]:
    """Complaints about settings that pictures do not need are told to nobody."""
    logger = logging.getLogger("matplotlib")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.setLevel(level)
