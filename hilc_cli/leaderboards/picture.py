"""How near laws come to the trajectory, and how soon: the error after each number of iterations."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from hilc_cli.drawing import labels, layout, style
from hilc_cli.drawing.save import save_pictures
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.folder import LEADERBOARD_PICTURE
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look

_LEAST = 1e-6  # [m]; smaller errors are drawn here, as rounding would stretch the axis
_WIDTH, _HEIGHT = 4.2, 3.4  # of a panel [inch]
_LEAST_WIDTH = 2.4  # of a panel on a narrow sheet [inch]
_GAP = 0.25  # between panels [inch]
_ASIDE = 3.0  # from the bar of a law to the next [pt]
_DIGIT = 0.075  # of a tick's label [inch]
_BESIDE = 0.08  # the first and the last iteration, of the way from one to the other


def leaderboard_figure(data: LeaderboardData, look: Look = USUAL) -> Figure:
    """A panel for each disturbance: median and range of each law's error over all other cases.

    Args:
        data: At least one entry.
        look: What the user asks for; on a narrow sheet some panels stand below others.
    """
    with style.applied(look):
        disturbances = data.disturbances
        top = layout.HEADING + layout.TOP
        panels = len(disturbances)
        beside = layout.LEFT + layout.RIGHT
        usual = layout.LEFT + panels * _WIDTH + (panels - 1) * _GAP + layout.RIGHT
        width = layout.room_on(look, usual)
        across, panel_width, height = panels, _WIDTH, _HEIGHT
        if look.width is not None:
            room = width - beside + _GAP
            across = max(1, min(panels, int(room / (_LEAST_WIDTH + _GAP))))
            panel_width = room / across - _GAP
            height = layout.panel_height(panel_width, _WIDTH, _HEIGHT)
        row = layout.TOP + height + layout.BOTTOM
        rows = -(-panels // across)
        figure = layout.new_sheet(width, layout.HEADING + rows * row, data.name, look)
        low, high = _range(data)
        drawn = []
        for place, disturbance in enumerate(disturbances):
            line, column = divmod(place, across)
            left = layout.LEFT + column * (panel_width + _GAP)
            axes = layout.add_panel(figure, left, top + line * row, panel_width, height)
            _draw(axes, data, disturbance, low, high)
            if column:
                axes.tick_params(axis="y", labelleft=False)
            else:
                axes.set_ylabel("Largest error of the second half [m]")
            drawn.append(axes)
        lowest = drawn[(rows - 1) * across]
        legend = layout.legend_below(drawn[:1], width - beside, below=lowest)
        layout.close_sheet(figure, legend=legend, top=drawn)
        return figure


def save_leaderboard(
    data: LeaderboardData,
    folder: Path,
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    look: Look = USUAL,
) -> list[Path]:
    """Draws the picture and writes it to ``leaderboard.FORMAT``.

    Args:
        data: At least one entry.
        folder: Where the files go; it must exist.
        formats: Some of png, svg, pdf.
        dpi: Dots per inch of PNG files.
        look: What the user asks for.

    Returns:
        The files, in the order of the formats.

    Raises:
        UsageError: A format is not known; nothing is written then.
        OSError: A file cannot be written.
    """
    pictures = {LEADERBOARD_PICTURE: partial(leaderboard_figure, data, look)}
    return save_pictures(pictures, folder, formats, dpi)


def _draw(axes: Axes, data: LeaderboardData, disturbance: str, low: float, high: float) -> None:
    """One panel: marks at the medians, and beside them bars from the best case to the worst."""
    laws = data.laws
    # A logarithmic axis has no place for iteration 0.
    after = np.array(data.after, dtype=np.float64) + (1 if data.after[0] == 0 else 0)
    points = layout.root_figure(axes).dpi_scale_trans
    for number, law in enumerate(laws):
        errors = _errors(data, law, disturbance)
        middle = np.median(errors, axis=0)
        color = style.run_color(number)
        aside = _ASIDE / 72 * (number - (len(laws) - 1) / 2)
        axes.vlines(
            *(after, errors.min(axis=0), errors.max(axis=0)),
            color=color,
            linewidth=1.6,
            alpha=0.5,
            transform=axes.transData + ScaledTranslation(aside, 0, points),
            label=f"_range of {law}",
        )
        axes.plot(
            *(after, middle),
            color=color,
            linewidth=style.THIN,
            marker=style.run_marker(number, 2),
            markersize=style.MARKER_SIZE + 1,
            label=law,
        )
    _scale_iterations(axes, after, list(map(str, data.after)))
    labels.set_logarithmic(axes.yaxis, low, high, 9)
    axes.axhline(
        data.tolerance,
        color=style.LIMIT_COLOR,
        linewidth=style.THIN,
        linestyle=style.DASHED,
        label=f"Tolerance, {data.tolerance:g} m",
    )
    axes.grid(visible=True)
    axes.set_xlabel("Iteration")
    runs = len(data.of(laws[0], disturbance))
    notes = [f"median of {runs} runs per law; bars: range"]
    if any(min(entry.max_m) < _LEAST for law in laws for entry in data.of(law, disturbance)):
        notes.append(f"what is less than {labels.exponent_text(_LEAST)} m is drawn there")
    labels.set_title(axes, f"Disturbance: {disturbance}", notes, tells_apart=True)


def _scale_iterations(axes: Axes, places: Floats, texts: Sequence[str]) -> None:
    """Makes the x axis a logarithmic one of iterations; ticks whose labels would meet have none."""
    axes.set_xscale("log")
    beside = max(places[-1] / places[0], 2.0) ** _BESIDE
    axes.set_xlim(places[0] / beside, places[-1] * beside)
    width, _ = layout.panel_size(axes)
    per_decade = width / math.log10(places[-1] / places[0] * beside**2)
    shown, end = [], -math.inf
    for place, text in zip((per_decade * np.log10(places)).tolist(), texts, strict=True):
        half = _DIGIT / 2 * len(text)
        fits = place - half > end
        shown.append(text if fits else "")
        end = place + half if fits else end
    axes.set_xticks(places, shown)
    axes.set_xticks([], minor=True)


def _errors(data: LeaderboardData, law: str, disturbance: str) -> Floats:
    """Errors [m], shape (runs, numbers of iterations), kept within what is drawn."""
    found = [entry.max_m for entry in data.of(law, disturbance)]
    errors: Floats = np.clip(np.array(found, dtype=np.float64), _LEAST, 1e12)
    return errors


def _range(data: LeaderboardData) -> tuple[float, float]:
    """Ends of the axis of errors [m]; runs that have diverged reach its upper one."""
    found = np.array([entry.max_m for entry in data.entries])
    finite = np.clip(found[np.isfinite(found)], _LEAST, 1e12)
    low, high = (finite.min(), finite.max()) if finite.size else (_LEAST, 1.0)
    return float(min(low, data.tolerance)) / 1.6, float(max(high, data.tolerance)) * 1.6
