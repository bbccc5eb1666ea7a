"""Draws and saves the pictures of a sweep by the names of their kinds, and says which fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from matplotlib.figure import Figure

from hilc_cli.drawing.save import save_pictures
from hilc_cli.errors import UsageError
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.sweeps.choices import as_sweep_of_choices
from hilc_cli.sweeps.data import SweepData
from hilc_cli.wording import suggestion


@dataclass(frozen=True, slots=True)
class SweepPicture:
    """How a kind of picture of a sweep is drawn.

    Attributes:
        draw: Draws a sweep that it fits, with the look that the user asks for.
        fits: Whether there is such a picture of a sweep with cases.
        needs: What a sweep needs for that, in words.
        by_default: Whether it is drawn of a sweep that it fits even if nobody asks for it.
        of_choices: Whether it shows choices, if some keys happen, in the place of cases.
        place: Pictures that are drawn together stand in this order, equal ones in that of
            ``SWEEP_PICTURES``.
    """

    draw: Callable[[SweepData, Look], Figure]
    fits: Callable[[SweepData], bool]
    needs: str
    by_default: Callable[[SweepData], bool] = lambda data: True
    of_choices: bool = False
    place: int = 0


class _Rows:
    """The cases of a sweep, and its choices, which are made once, when a picture asks for them."""

    def __init__(self, cases: SweepData) -> None:
        self.cases = cases

    @cached_property
    def choices(self) -> SweepData:
        """A row per choice, if some keys happen."""
        return as_sweep_of_choices(self.cases) if self.cases.over else self.cases

    def of(self, picture: SweepPicture) -> SweepData:
        """What a picture draws."""
        return self.choices if picture.of_choices else self.cases


def kinds_for(data: SweepData) -> tuple[str, ...]:
    """The kinds of picture that show a sweep best.

    A curve for one varied key, or for two of which one has a few words; a map for two; for more
    the best cases and what each key does; beside them the error over the iterations if it is
    known, how the metric of a choice is spread over what happens, and how a search went. Keys with
    a single value and the seed of the disturbances do not count. Where keys happen, curve, map and
    best cases are those of the choices.
    """
    return _kinds_for(_Rows(data))


def _kinds_for(rows: _Rows) -> tuple[str, ...]:
    if not len(rows.cases):
        return ()
    pictures: dict[str, SweepPicture] = {name: kind.load() for name, kind in SWEEP_PICTURES.items()}
    shown = [
        name
        for name, each in pictures.items()
        if each.fits(rows.of(each)) and each.by_default(rows.of(each))
    ]
    return tuple(sorted(shown, key=lambda name: pictures[name].place))


def draw_sweep(kind: str, data: SweepData, look: Look = USUAL) -> Figure:
    """Draws one kind of picture.

    Args:
        kind: One of ``SWEEP_PICTURES``.
        data: The sweep.
        look: What the user asks for.

    Raises:
        UsageError: There is no such kind, or it does not fit this sweep.
    """
    rows = _Rows(data)
    picture = _fitting(kind, rows)
    return picture.draw(rows.of(picture), look)


def save_sweep_figures(
    data: SweepData,
    folder: Path,
    *,
    formats: Sequence[str],
    kinds: Sequence[str] = (),
    dpi: int = 150,
    look: Look = USUAL,
) -> list[Path]:
    """Draws pictures and writes each to ``KIND.FORMAT``.

    Args:
        data: The sweep.
        folder: Where the files go; it must exist.
        formats: Some of ``FORMATS``.
        kinds: Some of ``SWEEP_PICTURES``; empty for those that fit.
        dpi: Dots per inch of PNG files.
        look: What the user asks for.

    Returns:
        The files, in the order of kinds and formats.

    Raises:
        UsageError: A kind or a format is not known, or a kind does not fit this sweep; nothing is
            written then.
        OSError: A file cannot be written.
    """
    rows = _Rows(data)
    pictures = {kind: _fitting(kind, rows) for kind in kinds or _kinds_for(rows)}
    drawn = {kind: partial(each.draw, rows.of(each), look) for kind, each in pictures.items()}
    return save_pictures(drawn, folder, formats, dpi)


def _fitting(kind: str, rows: _Rows) -> SweepPicture:
    """The picture of a kind, if a sweep has one.

    Raises:
        UsageError: It has none.
    """
    if kind in RUN_PICTURES or kind in MOVING_PICTURES:
        raise UsageError(f"picture '{kind}' is one of runs; pictures of this sweep: {_shown(rows)}")
    if kind not in SWEEP_PICTURES:
        raise UsageError(f"unknown kind of picture '{kind}'; {suggestion(kind, SWEEP_PICTURES)}")
    picture: SweepPicture = SWEEP_PICTURES[kind].load()
    if not len(rows.cases):
        raise UsageError("there is no case to draw")
    if not picture.fits(rows.of(picture)):
        needs = f"picture '{kind}' needs {picture.needs}"
        raise UsageError(f"{needs}; pictures of this sweep: {_shown(rows)}")
    return picture


def _shown(rows: _Rows) -> str:
    return ", ".join(_kinds_for(rows)) or "none"
