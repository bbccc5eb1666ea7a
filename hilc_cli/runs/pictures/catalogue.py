"""The kinds of picture by name."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from hilc_cli.drawing.save import save_pictures
from hilc_cli.errors import UsageError, suggestion
from hilc_cli.results.folder import SWEEP_PICTURE_KINDS
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.error import error_figure
from hilc_cli.runs.pictures.final_path import final_path_figure
from hilc_cli.runs.pictures.learning import learning_figure, quantities_to_draw
from hilc_cli.runs.pictures.path_change import check_iterations, path_change_figure
from hilc_cli.runs.pictures.summary import summary_figure
from hilc_cli.runs.pictures.wheel_speeds import wheel_speeds_figure
from hilc_cli.runs.run_folder import PICTURE_KINDS

Drawer = Callable[[Sequence[RunData], Collection[int] | None], Figure]

_DRAWERS: Mapping[str, Drawer] = {
    "path-change": path_change_figure,
    "final-path": lambda runs, iterations: final_path_figure(runs),
    "error": lambda runs, iterations: error_figure(runs),
    "wheel-speeds": lambda runs, iterations: wheel_speeds_figure(runs),
    "summary": summary_figure,
    "learning": lambda runs, iterations: learning_figure(runs),
}
KINDS = PICTURE_KINDS
assert set(KINDS) == set(_DRAWERS)


def kinds_of(runs: Sequence[RunData]) -> list[str]:
    """The kinds of picture that there are of runs: one of learning only if a law tells of it."""
    return [kind for kind in KINDS if kind != "learning" or quantities_to_draw(runs)]


def draw(kind: str, runs: Sequence[RunData], iterations: Collection[int] | None = None) -> Figure:
    """Draws one kind of picture.

    Args:
        kind: One of ``KINDS``.
        runs: The run, or several to lay over each other.
        iterations: The iterations whose paths are shown; None for all that are recorded.

    Raises:
        UsageError: There is no such kind, no run, or no such iteration in any of the runs; or
            there is no such picture of these runs.
    """
    _check(runs, [kind], iterations)
    return _DRAWERS[kind](runs, iterations)


def save_figures(
    runs: Sequence[RunData],
    folder: Path,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    iterations: Collection[int] | None = None,
) -> list[Path]:
    """Draws pictures and writes each to ``KIND.FORMAT``.

    Args:
        runs: The run, or several to lay over each other.
        folder: Where the files go; it must exist.
        kinds: Some of ``KINDS``; all that there are of these runs by default.
        formats: Some of ``FORMATS``.
        dpi: Dots per inch of PNG files.
        iterations: The iterations whose paths are shown; None for all that are recorded.

    Returns:
        The files, in the order of kinds and formats.

    Raises:
        UsageError: A kind, a format or an iteration is not known, or there is no such picture of
            these runs; nothing is written then.
        OSError: A file cannot be written.
    """
    _check(runs, kinds, iterations)
    drawn = {kind: partial(draw, kind, runs, iterations) for kind in kinds or kinds_of(runs)}
    return save_pictures(drawn, folder, formats, dpi)


def _check(
    runs: Sequence[RunData], kinds: Sequence[str], iterations: Collection[int] | None
) -> None:
    if not runs:
        raise UsageError("there is no run to draw; give at least one")
    for kind in kinds:
        if kind in SWEEP_PICTURE_KINDS:
            raise UsageError(
                f"picture '{kind}' is one of sweeps; those of runs: {', '.join(KINDS)}"
            )
        if kind not in KINDS:
            raise UsageError(f"unknown kind of picture '{kind}'; {suggestion(kind, KINDS)}")
    check_iterations(runs, iterations)
