"""The sheet that a picture is drawn on, which knows how it is to look on paper."""

from __future__ import annotations

import textwrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import style
from hilc_cli.results.look import USUAL, Look

_LINE = 0.068  # width of a letter of an axis label [inch]


class Sheet(Figure):
    """A figure that is laid out around text of one size, and scaled as a whole when it is saved.

    Attributes:
        look: What the user asks for.
    """

    def __init__(
        self,
        width: float,
        height: float,
        look: Look = USUAL,
        text_size: float = style.TEXT_SIZE,
    ) -> None:
        """An empty sheet.

        Args:
            width: In inches of the layout, see `room_on`.
            height: Likewise.
            look: What the user asks for.
            text_size: Of axis labels in the layout [pt].
        """
        super().__init__(figsize=(width, height))
        self.look = look
        self._scale = style.scale_of(look, text_size)

    @property
    def scale(self) -> float:
        """How large an inch of the layout is on paper; the width comes out as it is asked for."""
        inches = self.look.inches
        return self._scale if inches is None else inches / float(self.get_size_inches()[0])


def room_on(look: Look, usual: float, text_size: float = style.TEXT_SIZE) -> float:
    """Width of a sheet, in inches of the layout.

    Args:
        look: What the user asks for.
        usual: The width that this kind of picture has if nobody asks for one [inch].
        text_size: Of axis labels in the layout [pt].
    """
    return (look.inches or usual) / style.scale_of(look, text_size)


def root_figure(axes: Axes) -> Figure:
    """The sheet that axes are on, also if a figure within the figure holds them."""
    return axes.figure.figure


def look_of(axes: Axes) -> Look:
    """How the picture that axes belong to is to look."""
    figure = root_figure(axes)
    return figure.look if isinstance(figure, Sheet) else USUAL


def panel_size(axes: Axes) -> tuple[float, float]:
    """Width and height of axes [inch]."""
    box = axes.get_position(original=True).transformed(axes.figure.transSubfigure)
    dpi = root_figure(axes).dpi
    return box.width / dpi, box.height / dpi


def is_fitted(axes: Axes) -> bool:
    """Whether texts have to fit a sheet of the user's width."""
    return look_of(axes).width is not None


def most_ticks(axes: Axes, most: int, each: float = 0.3) -> int:
    """How many ticks there is room for along x.

    Args:
        axes: The panel.
        most: As many as a panel of the usual width has.
        each: Room of a tick's label [inch].
    """
    return max(3, min(most, int(panel_size(axes)[0] / each))) if is_fitted(axes) else most


def fit_axis_labels(figure: Figure) -> None:
    """Breaks labels of axes that are longer than their panels on a sheet of the user's width."""
    for axes in figure.axes:
        if not is_fitted(axes):
            continue
        for axis, length in zip((axes.xaxis, axes.yaxis), panel_size(axes), strict=True):
            text = axis.get_label_text()
            longest = max(12, int((length + 0.2) / _LINE))
            if len(text) > longest and "\n" not in text:
                axis.set_label_text("\n".join(balanced(text, longest)))


def balanced(text: str, longest: int) -> list[str]:
    """A text in as few lines as it takes, all of about one length: no unit stands alone."""
    lines = textwrap.wrap(text, longest)
    for width in range(-(-len(text) // len(lines)), longest):
        even = textwrap.wrap(text, width, break_long_words=False)
        if len(even) == len(lines) and max(map(len, even)) <= longest:
            return even
    return lines
