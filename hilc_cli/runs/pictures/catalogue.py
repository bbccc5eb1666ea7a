"""Draws and saves the pictures of runs by the names of their kinds."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from hilc_cli.drawing.save import save_pictures
from hilc_cli.errors import UsageError
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.results.run import RunData
from hilc_cli.wording import suggestion


@dataclass(frozen=True, slots=True)
class RunPicture:
    """How a kind of picture of runs is drawn.

    Attributes:
        draw: Draws one or several runs; of the paths, those of some iterations or of all; with the
            look that the user asks for.
        is_of: Whether there is such a picture of runs; of any by default.
    """

    draw: Callable[[Sequence[RunData], Collection[int] | None, Look], Figure]
    is_of: Callable[[Sequence[RunData]], bool] = lambda runs: True


@dataclass(frozen=True, slots=True)
class MovingPicture:
    """How a kind of picture that moves is drawn.

    Attributes:
        save: Draws one run into a file with so many dots per inch; of the paths, those of some
            iterations or of all; with the look that the user asks for.
    """

    save: Callable[[RunData, Path, int, Collection[int] | None, Look], None]


def kinds_of(runs: Sequence[RunData]) -> list[str]:
    """The kinds of picture that there are of runs: one of learning only if a law tells of it."""
    return [name for name, kind in RUN_PICTURES.items() if kind.load().is_of(runs)]


def draw(
    kind: str,
    runs: Sequence[RunData],
    iterations: Collection[int] | None = None,
    look: Look = USUAL,
) -> Figure:
    """Draws one kind of picture.

    Args:
        kind: One of ``RUN_PICTURES``.
        runs: The run, or several to lay over each other.
        iterations: The iterations whose paths are shown; None for all that are recorded.
        look: What the user asks for.

    Raises:
        UsageError: There is no such kind, no run, or no such iteration in any of the runs; or
            there is no such picture of these runs.
    """
    _check(runs, [kind], iterations)
    if kind in MOVING_PICTURES:
        raise UsageError(f"picture '{kind}' moves: it is saved as a GIF, and not a figure")
    picture: RunPicture = RUN_PICTURES[kind].load()
    return picture.draw(runs, iterations, look)


def save_figures(
    runs: Sequence[RunData],
    folder: Path,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    iterations: Collection[int] | None = None,
    look: Look = USUAL,
) -> list[Path]:
    """Draws pictures and writes each to ``KIND.FORMAT``; those that move to ``KIND.gif``.

    Args:
        runs: The run, or several to lay over each other.
        folder: Where the files go; it must exist.
        kinds: Some of ``RUN_PICTURES`` and ``MOVING_PICTURES``; by default all of the former that
            there are of these runs.
        formats: Some of ``FORMATS``.
        dpi: Dots per inch of PNG and GIF files.
        iterations: The iterations whose paths are shown; None for all that are recorded.
        look: What the user asks for.

    Returns:
        The files, in the order of kinds and formats, those that move at the end.

    Raises:
        UsageError: A kind, a format or an iteration is not known, or there is no such picture of
            these runs; nothing is written then.
        OSError: A file cannot be written.
    """
    _check(runs, kinds, iterations)
    chosen = kinds or kinds_of(runs)
    still = [kind for kind in chosen if kind not in MOVING_PICTURES]
    drawn = {kind: partial(draw, kind, runs, iterations, look) for kind in still}
    files = save_pictures(drawn, folder, formats, dpi)
    for kind in dict.fromkeys(chosen):
        if kind in MOVING_PICTURES:
            files.append(folder / f"{kind}.gif")
            MOVING_PICTURES[kind].load().save(runs[0], files[-1], dpi, iterations, look)
    return files


def _check(
    runs: Sequence[RunData], kinds: Sequence[str], iterations: Collection[int] | None
) -> None:
    if not runs:
        raise UsageError("there is no run to draw; give at least one")
    for kind in kinds:
        if kind in SWEEP_PICTURES:
            raise UsageError(
                f"picture '{kind}' is one of sweeps; those of runs: {', '.join(RUN_PICTURES)}"
            )
        if kind in MOVING_PICTURES:
            if len(runs) > 1:
                raise UsageError(f"picture '{kind}' is of one run, got {len(runs)}")
        elif kind not in RUN_PICTURES:
            names = [*RUN_PICTURES, *MOVING_PICTURES]
            raise UsageError(f"unknown kind of picture '{kind}'; {suggestion(kind, names)}")
    if iterations is None:
        return
    recorded = sorted({iteration for run in runs for iteration in run.trials})
    known = f"recorded: {', '.join(map(str, recorded)) or 'none'}"
    missing = sorted(set(iterations) - set(recorded))
    if missing:
        what = "iterations" if len(missing) > 1 else "iteration"
        raise UsageError(f"{what} {', '.join(map(str, missing))} not recorded; {known}")
    if not iterations:
        raise UsageError(f"no iterations to draw; {known}")
