"""Matplotlib is loaded, whatever is set for it: ``MPLBACKEND``, ``matplotlibrc``, folders.

It reads all of that while it is imported, and cannot be imported where one of them makes no
sense. Pictures need none of it: `save.render` names the canvas, `style.applied` all settings.
"""

from __future__ import annotations

import atexit
import logging
import os
import shutil
import sys
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hilc_cli.surroundings import hidden

_RC_FILE = "matplotlibrc"
_MOST_SETTINGS, _MOST_FONTS = 1_000_000, 100_000_000
"""Bytes of a file of settings, and of a list of fonts, that is read."""


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
        _settle_folder()
        # Keeps a list of fonts in its folder, and complains where it cannot.
        import matplotlib.font_manager


def _settle_folder() -> None:
    """Gives Matplotlib a folder for this process alone where its own is of no use.

    It does so itself if it cannot write there; here it would fail, or wait for ever.
    """
    import matplotlib

    try:
        usable = all(
            _is_file_up_to(_MOST_FONTS, each)
            for each in Path(matplotlib.get_cachedir()).glob("fontlist-*")
        )
    except (OSError, RuntimeError):  # a loop of links
        usable = False
    if not usable:
        place = tempfile.mkdtemp(prefix="matplotlib-")
        atexit.register(shutil.rmtree, place, ignore_errors=True)
        os.environ["MPLCONFIGDIR"] = place
        matplotlib.get_cachedir = lambda: place


def _read_settings(path: Path) -> None:
    import matplotlib

    if _is_file_up_to(_MOST_SETTINGS, path):
        settings = matplotlib.rc_params_from_file(path, use_default_template=False)
        matplotlib.rcParams.update(settings)


def _is_file_up_to(size: int, path: Path) -> bool:
    return path.is_file() and path.stat().st_size <= size


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
