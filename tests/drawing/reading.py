"""Reads figures back: what a test looks for in them."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox


def lines(axes: Axes, label: str) -> list[Line2D]:
    return [line for line in axes.lines if line.get_label() == label]


def line(axes: Axes, label: str) -> Line2D:
    (found,) = lines(axes, label)
    return found


def legend(axes: Axes) -> list[str]:
    box = axes.get_legend()
    return [] if box is None else [text.get_text() for text in box.get_texts()]


def texts(figure: Figure) -> str:
    """All that is written on panels and sheet, legends and ticks aside."""
    found = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        found += [axes.get_title(loc="left"), *(text.get_text() for text in axes.texts)]
    return "\n".join(found)


def overlaps(figure: Figure) -> list[str]:
    """Legends, titles and axes labels that cover a panel or each other, or leave the sheet.

    Values that stand in a panel on purpose are left out.
    """
    figure.draw_without_rendering()
    panels = [axes.get_window_extent() for axes in figure.axes]
    words: list[tuple[str, Bbox]] = [
        (text.get_text(), text.get_window_extent()) for text in figure.texts
    ]
    words += [("shared legend", box.get_window_extent()) for box in figure.legends]
    for axes in figure.axes:
        title = axes._left_title  # type: ignore[attr-defined]
        written = [title, axes.title, axes.xaxis.label, axes.yaxis.label]
        written += [text for text in axes.texts if text.get_gid() != "value"]
        words += [(text.get_text(), text.get_window_extent()) for text in written]
        box = axes.get_legend()
        if box is not None:
            words.append(("legend", box.get_window_extent()))
    words = [(name, extent) for name, extent in words if name]
    found = [name for name, e in words if not figure.bbox.contains(e.x0, e.y0)]
    found += [name for name, e in words if not figure.bbox.contains(e.x1, e.y1)]
    found += [
        f"{n} on panel" for n, e in words if any(e.shrunk(0.98, 0.98).overlaps(p) for p in panels)
    ]
    for place, (name, extent) in enumerate(words):
        found += [f"{name} on {other}" for other, e in words[:place] if extent.overlaps(e)]
    return found
