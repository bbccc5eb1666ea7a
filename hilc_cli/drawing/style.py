"""Colours, line styles and sizes of all pictures; applied locally, never on import."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib
import numpy as np
from matplotlib.colors import Colormap, ListedColormap

from hilc_cli.results.look import USUAL, Look

# Okabe and Ito's colours, which survive colour blindness, and four more for long comparisons.
# Neighbours differ in luminance too, so that they stay apart in grey.
BLUE, ORANGE, GREEN, VERMILLION = "#0072B2", "#E69F00", "#009E73", "#D55E00"
RUN_COLORS = (
    *(BLUE, ORANGE, "#882255", "#56B4E9", VERMILLION, GREEN),
    *("#332288", "#CC79A7", "#666666", "#999933"),
)
WINE = RUN_COLORS[2]
# Sparse markers tell runs apart where colour cannot.
RUN_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "p")
REFERENCE_COLOR = "black"
LIMIT_COLOR = "0.25"
STRIP_COLOR = "0.9"
NOTE_COLOR = "#A03C00"
BEST_COLOR = "#F0E442"
BEYOND_COLOR = "#FDE725"  # beyond the colours of `iteration_colors`, brighter than all of them
FINAL_PATH_COLOR = VERMILLION
APPLIED_COLOR, AIM_COLOR = "#56B4E9", "0.5"  # of wheel speeds that were applied, or asked for

DASHED = (0, (5, 2.5))
DOTTED = (0, (1.2, 1.6))
PATH_WIDTH = 1.3  # [pt]
THIN = 0.8  # [pt]
MARKER_SIZE = 4.0  # [pt]

HEADING_SIZE = 10.0  # [pt]
TITLE_SIZE = 9.5  # [pt]
TEXT_SIZE = 8.5  # [pt]
SMALL_SIZE = 8.0  # [pt]
PRINT_SIZE = 7.0  # of text on a journal's page [pt]
PRINT_SHRINK = 0.65  # of lines and marks there
TRUE_SIZE = 8.0  # of text where the width of a picture is given [pt]

_PALEST = 0.9  # viridis beyond this is too pale for a thin line on white

_RC: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # comes with Matplotlib: the same on every machine
    "font.size": TEXT_SIZE,
    "text.usetex": False,
    "text.parse_math": False,  # a name is shown as it is, dollar signs included
    "axes.unicode_minus": True,
    "axes.facecolor": "white",
    "axes.edgecolor": "0.15",
    "axes.linewidth": 0.7,
    "axes.labelsize": TEXT_SIZE,
    "axes.labelcolor": "black",
    "axes.titlesize": TITLE_SIZE,
    "axes.titleweight": "normal",
    "axes.titlecolor": "black",
    "axes.axisbelow": True,
    "axes.grid": False,
    "axes.spines.top": True,
    "axes.spines.right": True,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "grid.linestyle": "-",
    "figure.facecolor": "white",
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
    "legend.fontsize": SMALL_SIZE,
    "legend.frameon": False,
    "legend.handlelength": 2.3,
    "xtick.labelsize": SMALL_SIZE,
    "ytick.labelsize": SMALL_SIZE,
    "xtick.color": "0.15",
    "ytick.color": "0.15",
    "text.color": "black",
    "path.simplify": True,
    "pdf.fonttype": 42,  # journals ask for TrueType
    "svg.fonttype": "path",
    "svg.hashsalt": "hilc",  # the same ids in every file, so that the same data gives the same file
}


# The backend belongs to the user: asked for, it would be loaded.
_DEFAULTS = {k: v for k, v in dict.items(matplotlib.rcParamsDefault) if k != "backend"}

_PRINT: dict[Any, Any] = {
    "font.size": PRINT_SIZE,
    "axes.labelsize": PRINT_SIZE,
    "axes.titlesize": PRINT_SIZE,
    "legend.fontsize": PRINT_SIZE,
    "xtick.labelsize": PRINT_SIZE,
    "ytick.labelsize": PRINT_SIZE,
}


IN_POINTS = frozenset(
    {
        *("axes.linewidth", "grid.linewidth"),
        *(
            f"{axis}tick.{kind}.{what}"
            for axis in "xy"
            for kind in ("major", "minor")
            for what in ("size", "width")
        ),
    }
)
"""Settings of a style file that are lengths on paper [pt]."""


def scale_of(look: Look, text_size: float = TEXT_SIZE) -> float:
    """How large an inch and a point of the layout are on paper.

    Pictures are laid out around text of one size, which all distances fit. Where it is to be
    another one, the whole sheet is scaled as it is saved.

    Args:
        look: What the user asks for.
        text_size: Of axis labels in the layout [pt].
    """
    if look.font_size is not None:
        return look.font_size / text_size
    return 1.0 if look.width is None else min(1.0, TRUE_SIZE / text_size)


def _chosen(look: Look, text_size: float) -> dict[Any, Any]:
    """The settings that a user asks for, in the points of the layout."""
    scale = scale_of(look, text_size)
    chosen: dict[Any, Any] = {
        key: value / scale if key in IN_POINTS and isinstance(value, float) else value
        for key, value in look.settings
        if key != "font.size"  # by which the sheet is scaled
    }
    if look.font:
        chosen["font.family"] = [look.font, *_RC["font.sans-serif"]]  # letters that it lacks
    return chosen


@contextmanager
def applied(look: Look = USUAL, *, in_print: bool = False) -> Iterator[None]:
    """The settings of all pictures, for as long as a figure is built or saved.

    What hilc does not set is as Matplotlib comes, not as the user has it.

    Args:
        look: What the user asks for.
        in_print: With the text sizes of a journal's page, where many panels share one.
    """
    with matplotlib.rc_context(), warnings.catch_warnings():
        # A name may have letters that the font lacks, which are drawn as boxes.
        warnings.filterwarnings("ignore", r"Glyph .* missing from font")
        # It has a minus sign by the font that takes its place.
        warnings.filterwarnings("ignore", r"cmr10 font should ideally be used with mathtext")
        # As a dictionary: what comes with Matplotlib needs no validation, which takes its time
        # and warns of settings that it is about to drop.
        settings: dict[Any, Any] = matplotlib.rcParams
        dict.update(settings, _DEFAULTS)
        matplotlib.rcParams.update({**_RC, **_PRINT} if in_print else _RC)
        matplotlib.rcParams.update(_chosen(look, PRINT_SIZE if in_print else TEXT_SIZE))
        yield


def iteration_colors() -> Colormap:
    """Colours of iterations from first (dark) to last (bright, for the dashes on top of it).

    Viridis: equal steps look equal, in grey and to the colour-blind as well.
    """
    return ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0, _PALEST, 256)))


def run_color(index: int) -> str:
    """Colour of the run at a place in a comparison."""
    return RUN_COLORS[index % len(RUN_COLORS)]


def run_marker(index: int, runs: int) -> str:
    """Marker of the run at a place in a comparison; none for a run on its own."""
    # The second round of colours starts one marker later, so that no pair comes twice.
    return RUN_MARKERS[(index + index // len(RUN_COLORS)) % len(RUN_MARKERS)] if runs > 1 else ""


def sparse(points: int, index: int, runs: Sequence[object]) -> tuple[int, int]:
    """Places of a run's markers along its line: about ten, not on top of those of other runs.

    Args:
        points: Number of points of the line.
        index: Place of the run in the comparison.
        runs: The comparison.

    Returns:
        First point and step, as ``markevery`` takes them.
    """
    step = max(1, points // 10)
    return (index * step // len(runs), step)
