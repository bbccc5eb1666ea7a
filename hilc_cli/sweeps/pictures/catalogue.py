"""The kinds of picture of a sweep by name, and which of them fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from hilc_cli.drawing.save import save_pictures
from hilc_cli.errors import UsageError, suggestion
from hilc_cli.results.folder import SWEEP_PICTURE_KINDS
from hilc_cli.runs.run_folder import PICTURE_KINDS
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.bands import bands_figure
from hilc_cli.sweeps.pictures.best import best_figure
from hilc_cli.sweeps.pictures.curve import curve_figure, curve_keys
from hilc_cli.sweeps.pictures.effects import effects_figure
from hilc_cli.sweeps.pictures.heat_map import map_figure
from hilc_cli.sweeps.pictures.picking import varied_keys
from hilc_cli.sweeps.pictures.progress import search_figure

_DRAWERS: Mapping[str, Callable[[SweepData], Figure]] = {
    "curve": curve_figure,
    "map": map_figure,
    "best": best_figure,
    "effects": effects_figure,
    "bands": bands_figure,
    "search": search_figure,
}
SWEEP_KINDS = SWEEP_PICTURE_KINDS
assert set(SWEEP_KINDS) == set(_DRAWERS)


def kinds_for(data: SweepData) -> tuple[str, ...]:
    """The kinds of picture that show a sweep best.

    A curve for one varied key, or for two of which one has a few words; a map for two; for more
    the best cases and what each key does; beside them the error over the iterations if it is
    known, and how a search went. Keys with a single value and the seed of the disturbances do not
    count.
    """
    keys = len(varied_keys(data))
    if not len(data):
        return ()
    if curve_keys(data) is not None:
        kinds: tuple[str, ...] = ("curve",)
    else:
        kinds = () if keys == 0 else ("map",) if keys == 2 else ("best", "effects")
    kinds = kinds if data.bands is None else (*kinds, "bands")
    return kinds if data.as_it_is is None else (*kinds, "search")


def draw_sweep(kind: str, data: SweepData) -> Figure:
    """Draws one kind of picture.

    Args:
        kind: One of ``SWEEP_KINDS``.
        data: The sweep.

    Raises:
        UsageError: There is no such kind, or it does not fit this sweep.
    """
    _check(kind, data)
    return _DRAWERS[kind](data)


def save_sweep_figures(
    data: SweepData,
    folder: Path,
    *,
    formats: Sequence[str],
    kinds: Sequence[str] = (),
    dpi: int = 150,
) -> list[Path]:
    """Draws pictures and writes each to ``KIND.FORMAT``.

    Args:
        data: The sweep.
        folder: Where the files go; it must exist.
        formats: Some of ``FORMATS``.
        kinds: Some of ``SWEEP_KINDS``; empty for those that fit.
        dpi: Dots per inch of PNG files.

    Returns:
        The files, in the order of kinds and formats.

    Raises:
        UsageError: A kind or a format is not known, or a kind does not fit this sweep; nothing is
            written then.
        OSError: A file cannot be written.
    """
    chosen = dict.fromkeys(kinds or kinds_for(data))
    for kind in chosen:
        _check(kind, data)
    drawn = {kind: partial(draw_sweep, kind, data) for kind in chosen}
    return save_pictures(drawn, folder, formats, dpi)


def _check(kind: str, data: SweepData) -> None:
    if kind in PICTURE_KINDS:
        fitting = ", ".join(kinds_for(data)) or "none"
        raise UsageError(f"picture '{kind}' is one of runs; pictures of this sweep: {fitting}")
    if kind not in SWEEP_KINDS:
        raise UsageError(f"unknown kind of picture '{kind}'; {suggestion(kind, SWEEP_KINDS)}")
    keys = len(varied_keys(data))
    needs = {
        "curve": (curve_keys(data) is not None, "one varied key, or two with few words in one"),
        "map": (keys == 2, "two varied keys"),
        "best": (keys > 0, "a varied key"),
        "effects": (keys > 0, "a varied key"),
        "bands": (data.bands is not None, "the error over the iterations; set 'sweep.bands: true'"),
        "search": (data.as_it_is is not None, "a search; set 'sweep.minimise'"),
    }
    fits, need = needs[kind]
    if not len(data):
        raise UsageError("there is no case to draw")
    if not fits:
        fitting = ", ".join(kinds_for(data)) or "none"
        raise UsageError(f"picture '{kind}' needs {need}; pictures of this sweep: {fitting}")
