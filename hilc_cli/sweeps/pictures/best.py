"""The best cases: a row for each, with its metric and its place in the range of each key."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from hilc_cli.drawing import labels, layout, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.effects import effects_of
from hilc_cli.sweeps.pictures.key_axis import (
    KeyAxis,
    key_axis,
    key_labels_in_lines,
    value_text,
)
from hilc_cli.sweeps.pictures.metric_axis import metric_name, scale_of
from hilc_cli.sweeps.pictures.picking import (
    Combinations,
    Integers,
    combined,
    results_of,
    varied_keys,
    varies_seed,
)
from hilc_cli.sweeps.pictures.shared import heading_of

MOST_ROWS, MOST_KEYS = 10, 12
_PITCH = 0.34  # of rows [inch]
_LEAST_COLUMN = 1.0  # on a narrow sheet [inch]
_WIDTH, _GUTTER = 1.15, 0.2  # of a column, and between two [inch]
_LEFT, _KEY_ROOM, _RANGE_ROOM = 0.95, 0.36, 0.3  # beside the rows, above and below them [inch]
_TITLE_ROOM, _NOTE_ROOM, _LEAST_WIDTH = 0.3, 0.17, 6.0  # [inch]
_LETTER = 0.078  # of the title [inch]
_LETTERS = 19  # of a key in a line above its column
_TEXT_SIZE = 7.0  # [pt], of values
_END_DIGITS, _MOST_DIGITS = 3, 15  # of the ends of ranges
_INSET = 0.16  # from the edges of a column to the ends of its range, of its width


def shown_keys(data: SweepData) -> list[KeyAxis]:
    """The keys in the order in which they were given; if they are too many, those that matter."""
    keys = varied_keys(data)
    if len(keys) > MOST_KEYS:
        results = results_of(data)
        scale = scale_of(data, results.metric)
        effects = effects_of(data, results, scale)[:MOST_KEYS]
        kept = {effect.where.key for effect in effects}
        keys = [key for key in keys if key in kept]
    return [key_axis(data, key) for key in keys]


def best_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """The best cases row by row; on a narrow sheet the columns go on below."""
    with style.applied(look):
        keys = shown_keys(data)
        repeated = varied_keys(data) if varies_seed(data) else []
        positions = [key_axis(data, key).positions for key in repeated]
        found = combined(data, results_of(data), positions)
        place = found.best(MOST_ROWS)
        best = Combinations(
            found.cases[place], found.metric[place], found.outcomes[place], found.is_median
        )
        rows, columns = max(1, len(best.cases)), 1 + len(keys)
        left_out = len(varied_keys(data)) - len(keys)
        height = rows * _PITCH
        width = layout.room_on(look, max(_LEAST_WIDTH, _LEFT + columns * (_WIDTH + _GUTTER)))
        title = _title(data, best, left_out)
        if look.width is not None:
            title = [part for line in title for part in textwrap.wrap(line, int(width / _LETTER))]
        top = layout.HEADING + _TITLE_ROOM + _NOTE_ROOM * (len(title) - 1) + _KEY_ROOM
        top -= 0 if look.title else layout.HEADING
        across, column = columns, _WIDTH
        if look.width is not None:
            across = min(columns, max(2, int((width - _LEFT) / (_LEAST_COLUMN + _GUTTER))))
            column = min(_WIDTH, (width - _LEFT) / across - _GUTTER)
        blocks, pitch = -(-columns // across), _KEY_ROOM + height + _RANGE_ROOM
        figure = layout.new_sheet(width, top - _KEY_ROOM + blocks * pitch, heading_of(data), look)
        panels = []
        for index in range(columns):
            block, spot = divmod(index, across)
            left = _LEFT + spot * (column + _GUTTER)
            axes = layout.add_panel(figure, left, top + block * pitch, column, height)
            _draw_rows(axes, rows)
            if not spot:
                _name_rows(axes, best, data.row)
            panels.append(axes)
        _draw_metric(panels[0], data, best)
        letters = int(_LETTERS * column / _WIDTH)
        names = key_labels_in_lines([where.key for where in keys], letters)
        for axes, where in zip(panels[1:], keys, strict=True):
            draw_key(axes, data, where, best.cases)
            axes.set_title(names[where.key], fontsize=style.SMALL_SIZE, pad=3)
        _draw_title(figure, title, layout.HEADING if look.title else 0.0)
        return figure


def draw_key(axes: Axes, data: SweepData, where: KeyAxis, cases: Sequence[int] | Integers) -> None:
    """Draws the values of a key in some cases as dots within its range.

    Args:
        axes: Where to draw, a row for each case from the top down.
        data: The sweep.
        where: The key's axis.
        cases: The cases.
    """
    numbers = [int(case) for case in cases]
    ends = np.unique(where.positions)[[0, -1]]
    if not where.words:
        ends = np.array([float(end) for end in data.axes[where.key].ends])  # type: ignore[arg-type]
    flat = where.flattened(ends)
    if where.is_logarithmic:
        axes.set_xscale("log")
    limits = where.bent(np.array(_padded(float(flat[0]), float(flat[-1]))))
    axes.set_xlim(float(limits[0]), float(limits[1]))
    texts = [value_text(data.values[where.key][case]) for case in numbers]
    _draw_dots(axes, where.positions[numbers], texts)
    _draw_range(axes, len(numbers), (float(ends[0]), float(ends[-1])), 0 if where.words else 3)


def _draw_metric(axes: Axes, data: SweepData, best: Combinations) -> None:
    """Draws the metric of the best cases."""
    scale = scale_of(data, best.metric)
    low, high = scale.low, scale.high
    if scale.is_logarithmic:
        axes.set_xscale("log")
        first, last = _padded(float(np.log10(low)), float(np.log10(high)))
        axes.set_xlim(10.0**first, 10.0**last)
    else:
        axes.set_xlim(_padded(low, high))
    texts = [labels.number_text(value, 4) for value in best.metric.tolist()]
    _draw_dots(axes, np.clip(best.metric, low, high), texts, style.BLUE)
    _draw_range(axes, len(best.cases), (low, high), 0 if scale.is_empty else _END_DIGITS)
    axes.set_title(labels.with_unit("Metric", scale.unit), fontsize=style.SMALL_SIZE, pad=3)


def _name_rows(axes: Axes, best: Combinations, row: str) -> None:
    """Writes rank and case, or choice, to the left of each row."""
    ranks = [f"{rank}." for rank in range(1, len(best.cases) + 1)]
    if not best.is_median:
        pairs = zip(ranks, best.cases, strict=True)
        ranks = [f"{rank}  {row} {case}" for rank, case in pairs]
    axes.set_yticks(range(len(ranks)), ranks)


def _draw_range(axes: Axes, rows: int, ends: tuple[float, float], digits: int) -> None:
    """Draws the range that the dots of a column lie in, and its ends below, unless without digits.

    Ends that would read the same have as many more digits as they need.
    """
    axes.hlines(np.arange(rows), *ends, color="0.8", linewidth=1.0, zorder=1)
    places = list(dict.fromkeys(ends)) if digits else []
    texts = [value_text(place, digits) for place in places]
    while len(set(texts)) < len(texts) and digits < _MOST_DIGITS:
        digits += 1
        texts = [value_text(place, digits) for place in places]
    axes.set_xticks(places, texts)
    axes.set_xticks([], minor=True)


def _padded(low: float, high: float) -> tuple[float, float]:
    """The range with room for texts at its ends."""
    if low == high:
        half = 0.5 * abs(low) or 0.5
        return low - half, high + half
    margin = _INSET / (1 - 2 * _INSET) * (high - low)
    return low - margin, high + margin


def _draw_dots(axes: Axes, x: Floats, texts: Sequence[str], color: str = "black") -> None:
    axes.plot(
        x,
        np.arange(len(x)),
        linestyle="none",
        marker="o",
        markersize=style.MARKER_SIZE + 1,
        color=color,
        zorder=3,
        label="_best",
    )
    for row, (place, text) in enumerate(zip(x.tolist(), texts, strict=True)):
        axes.annotate(
            text,
            xy=(place, row),
            xytext=(0, 4),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=_TEXT_SIZE,
            gid="value",
        )


def _draw_rows(axes: Axes, rows: int) -> None:
    """Sets up a column without a frame, the first row at the top."""
    axes.set_ylim(rows - 0.4, -0.6)
    axes.set_yticks([])
    axes.tick_params(length=0)
    axes.tick_params(axis="x", labelcolor="0.35", labelsize=_TEXT_SIZE)
    axes.spines[:].set_visible(False)


def _title(data: SweepData, best: Combinations, left_out: int) -> list[str]:
    """What the table shows: the only place where the metric is named."""
    what = (
        f"median over the seeds of the {metric_name(data)}" if best.is_median else metric_name(data)
    )
    lines = [f"Smallest {what}" if len(best.cases) else f"No {data.row} has a value"]
    if left_out:
        lines.append(f"{left_out} keys with smaller effects are left out")
    return lines


def _draw_title(figure: Figure, title: Sequence[str], heading: float) -> None:
    """Writes above the table what it shows, below a heading of some height [inch]."""
    place = figure.transFigure + ScaledTranslation(0.15, -heading - 0.06, figure.dpi_scale_trans)
    figure.text(0, 1, "\n".join(title), transform=place, va="top", fontsize=style.TITLE_SIZE)


PICTURE = SweepPicture(
    best_figure,
    fits=lambda data: len(varied_keys(data)) > 0,
    needs="a varied key",
    by_default=lambda data: len(varied_keys(data)) > 2,
    of_choices=True,
)
