"""What pictures say in words and numbers: names, ticks of axes, titles and notes."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import XAxis, YAxis
from matplotlib.text import Text
from matplotlib.ticker import Formatter, MaxNLocator
from numpy.typing import NDArray

from hilc_cli.drawing.sheet import balanced, is_fitted, look_of, most_ticks, panel_size
from hilc_cli.drawing.style import LIMIT_COLOR, MARKER_SIZE, NOTE_COLOR, SMALL_SIZE, TITLE_SIZE
from hilc_cli.results.run import RunData, distinct_names
from hilc_cli.wording import printable

Entitle = Callable[[Axes, str, Sequence[str]], object]
"""Titles a panel and puts notes that the reader must know beside it, as `set_title` does."""

LONGEST_LABEL = 64
_LONG = 1e5  # numbers from here on are written with an exponent
_TITLE_PAD = 5.0  # [pt]
_LINE_PITCH = 10.5  # [pt], of notes
_BESIDE = 0.25  # that titles and notes may reach beyond their panel to the right [inch]
_NOTES = "notes"
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def run_labels(runs: Sequence[RunData]) -> list[str]:
    """The names of runs, shortened where they are very long and told apart where they are equal."""
    names = [shortened(run.name).strip() or "(no name)" for run in runs]
    # Matplotlib leaves labels that start with an underscore out of the legend.
    return distinct_names([f" {name}" if name.startswith("_") else name for name in names])


def shortened(name: str, longest: int = LONGEST_LABEL) -> str:
    """A name in at most so many printable characters; both its ends stay, they differ most."""
    name = printable(name)
    if len(name) <= longest:
        return name
    head = (longest - 1) // 2
    return f"{name[:head]}…{name[len(name) - (longest - 1 - head) :]}"


def with_unit(text: str, unit: str) -> str:
    """A text with a unit behind it, if there is one."""
    return f"{text} [{unit}]" if unit else text


def wrapped(text: str, width: float) -> str:
    """A title broken into at most two lines that fit a panel of so many inches."""
    longest = int(width * 72 / (0.6 * TITLE_SIZE))
    lines = textwrap.wrap(text, longest)
    if len(lines) > 2:  # no good place for a break
        text = shortened(text, 2 * longest)
        lines = [text[:longest], text[longest:]]
    return "\n".join(lines)


def number_text(value: float, digits: int = 10) -> str:
    """A number as an axis shows it, with a true minus sign and a short exponent."""
    text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    text = f"{mantissa}e{int(exponent)}" if exponent else mantissa
    return text.replace("-", "\N{MINUS SIGN}")


def name_limit(axes: Axes, value: float, text: str) -> None:
    """Names the value of a horizontal line to the right of its panel."""
    axes.annotate(
        text,
        xy=(1, value),
        xycoords=("axes fraction", "data"),
        xytext=(3, 0),
        textcoords="offset points",
        va="center",
        fontsize=SMALL_SIZE,
        color=LIMIT_COLOR,
        annotation_clip=False,
    )


def exponent_text(value: float) -> str:
    """A large number in few characters, such as 1.5e6."""
    if value == 0:
        return "0"
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}".replace("-", "\N{MINUS SIGN}")


def tick_text(value: float) -> str:
    """A number as an axis shows it if it need not match its neighbours."""
    return exponent_text(value) if abs(value) >= _LONG else number_text(value)


def power_text(exponent: int) -> str:
    """A power of ten, in plain characters: Matplotlib's own formulas take long to set."""
    return f"10{str(exponent).translate(_SUPERSCRIPTS)}"


def plain_ticks(axes: Axes) -> None:
    """Shows the tick values as they are, never as an offset or factor in a far corner."""
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(PlainFormatter())


class PlainFormatter(Formatter):
    """Tick labels of one length behind the point; exponents only where there is no room."""

    def __call__(self, value: float, pos: int | None = None) -> str:
        """The label of one tick."""
        return tick_text(value)

    def format_ticks(self, values: Iterable[float]) -> list[str]:
        """The labels of all ticks."""
        values = [float(value) for value in values]
        if max(map(abs, values), default=0) >= _LONG:
            texts = [exponent_text(value) for value in values]
            # Large coordinates of a small path, such as those of a map, need all their digits.
            if len(set(texts)) == len(texts):
                return texts
        texts = [number_text(value) for value in values]
        if any("e" in text for text in texts):
            return texts
        places = max((len(text.partition(".")[2]) for text in texts), default=0)
        return [f"{value:.{places}f}".replace("-", "\N{MINUS SIGN}") for value in values]


Ticks = tuple[list[float], list[str], list[float]]


def logarithmic_ticks(bottom: float, top: float, most: int = 9) -> Ticks:
    """Ticks between two exponents.

    Args:
        bottom: Logarithm of the lower end.
        top: Logarithm of the upper end, > bottom.
        most: About so many fit.

    Returns:
        Major ticks, their labels, minor ticks.
    """
    first, last = math.ceil(bottom), math.floor(top)
    digits = range(2, 10) if last - first <= 5 else range(0)
    if last - first >= 3:
        steps = (1, 2, 5, 10, 20, 50, 100, 200)
        step = next(step for step in steps if (last - first) / step <= most)
        exponents = range(-(-first // step) * step, last + 1, step)
        major = [10.0**exponent for exponent in exponents]
        texts = [power_text(exponent) for exponent in exponents]
    else:
        major = _within(bottom, top, (1, 2, 5))
        if len(major) > most:
            major = _within(bottom, top, (1, 3))
        if len(major) > most:
            major = _within(bottom, top, (1,))
        texts = [tick_text(value) for value in major]
    minor = [value for value in _within(bottom, top, digits) if value not in major]
    return major, texts, minor


def _within(bottom: float, top: float, digits: tuple[int, ...] | range) -> list[float]:
    """So many times a power of ten, between two exponents."""
    exponents = range(math.floor(bottom), math.floor(top) + 1)
    values = [digit * 10.0**exponent for exponent in exponents for digit in digits]
    return [value for value in values if bottom <= math.log10(value) <= top]


def narrow_ticks(low: float, high: float, most: int = 6, least: int = 2) -> Ticks:
    """Ticks between two positive numbers that may be close together.

    Args:
        low: The lower end.
        high: The upper end, > low.
        most: About so many fit.
        least: With fewer ticks at ones, twos and fives they are spread like linear ones.

    Returns:
        Major ticks, their labels, minor ticks.
    """
    found = logarithmic_ticks(math.log10(low), math.log10(high), most)
    if len(found[0]) >= least:
        return found
    round_numbers = MaxNLocator(nbins=max(2, most), steps=[1, 2, 5, 10]).tick_values(low, high)
    inside = [float(value) for value in round_numbers if low <= value <= high]
    return inside, PlainFormatter().format_ticks(inside), []


def set_logarithmic(
    axis: XAxis | YAxis, low: float, high: float, most: int = 6, least: int = 2
) -> None:
    """Makes an axis logarithmic, from one positive number to another, with its ticks."""
    if isinstance(axis, XAxis):
        axis.axes.set_xscale("log")
        axis.axes.set_xlim(low, high)
    else:
        axis.axes.set_yscale("log")
        axis.axes.set_ylim(low, high)
    major, texts, minor = narrow_ticks(low, high, most, least)
    axis.set_ticks(major, labels=texts)
    axis.set_ticks(minor, labels=[""] * len(minor), minor=True)


def draw_marks(
    axes: Axes,
    x: NDArray[Any],
    height: float,
    marker: str,
    color: str,
    label: str,
    *,
    size: float = MARKER_SIZE,
    zorder: float = 2.0,
) -> None:
    """Draws open marks at a height of the panel, 0 to 1, of what has no place on its axis."""
    axes.plot(
        *(x, np.full(len(x), height)),
        transform=axes.get_xaxis_transform(),
        color=color,
        linestyle="none",
        marker=marker,
        markersize=size,
        markerfacecolor="white",
        zorder=zorder,
        label=label,
    )


def set_iterations(axes: Axes, last: int) -> None:
    """Makes the x axis one of iterations, from 0 to the last."""
    border = max(0.5, 0.02 * last)
    axes.set_xlim(-border, last + border)
    axes.xaxis.set_major_locator(
        MaxNLocator(nbins=most_ticks(axes, 8), steps=[1, 2, 5, 10], integer=True, min_n_ticks=1)
    )
    axes.set_xlabel("Iteration")


def set_title(
    axes: Axes, title: str, notes: Iterable[str] = (), *, tells_apart: bool = False
) -> Text:
    """Titles a panel; what the reader must know stands between title and panel, a line each.

    Args:
        axes: The panel.
        title: Left out if the user wants no titles.
        notes: They stand there in any case.
        tells_apart: Whether nothing else says which of several panels it is, so that the title
            stands there in any case, too.

    Returns:
        The title.
    """
    notes = list(notes)
    if not (look_of(axes).title or tells_apart):
        title = ""
    if is_fitted(axes):
        width, _ = panel_size(axes)
        width += _BESIDE
        title = wrapped(title, width) if "\n" not in title else title
        longest = int(width * 72 / (0.56 * (SMALL_SIZE - 0.5)))
        notes = [line for note in notes for line in balanced(note, longest)]
    # A fixed height spares Matplotlib from measuring all tick labels to find a free one.
    pad = _TITLE_PAD + _LINE_PITCH * len(notes)
    heading = axes.set_title(title, loc="left", y=1.0, pad=pad)
    if notes:
        axes.annotate(
            "\n".join(notes),
            xy=(0, 1),
            xycoords="axes fraction",
            xytext=(0, 3),
            textcoords="offset points",
            color=NOTE_COLOR,
            fontsize=SMALL_SIZE - 0.5,
            linespacing=1.15,
            annotation_clip=False,
            gid=_NOTES,
        )
    return heading


def spare_room(panels: Iterable[Axes]) -> float:
    """Height above panels, kept for two lines beside the first, that none of them needs [inch].

    It is negative if one of them needs more.
    """
    used = -1
    for axes in panels:
        notes = [text.get_text() for text in axes.texts if text.get_gid() == _NOTES]
        title = axes.get_title(loc="left")
        lines = title.count("\n") if title else -1
        used = max(used, lines + sum(1 + note.count("\n") for note in notes))
    return (2 - used) * _LINE_PITCH / 72


def divergence_notes(runs: Sequence[RunData]) -> list[str]:
    """Says which runs ended because their numbers did."""
    if len(runs) == 1:
        at = runs[0].diverged_at
        return [] if at is None else [f"diverged to non-finite values in iteration {at}"]
    ended = [
        f"{shortened(label, 24)} in iteration {run.diverged_at}"
        for label, run in zip(run_labels(runs), runs, strict=True)
        if run.diverged_at is not None
    ]
    if len(ended) > 1:
        return [f"{len(ended)} of {len(runs)} runs diverged to non-finite values"]
    return [f"diverged: {ended[0]}"] if ended else []


def last_iteration_text(runs: Sequence[RunData]) -> str:
    """``iteration 100``, or the range of the last iterations of several runs."""
    last = sorted({max(run.trials) for run in runs if run.trials})
    if not last:
        return "no iteration completed"
    if len(last) == 1:
        return f"iteration {last[0]}"
    return f"last iterations, {last[0]} to {last[-1]}"
