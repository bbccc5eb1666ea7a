"""The files of a reproduction by name."""

from __future__ import annotations

from collections.abc import Sequence

from hilc_cli.paper.contents import FIGURE_NAMES, FIGURES, PaperFigure, PaperPanel
from hilc_cli.results.folder import ResultFolder

INDEX = "index.md"
CLAIMS_CSV = "claims.csv"
CLAIMS_MD = "claims.md"
DATA = "data"


def picture_name(figure: PaperFigure, suffix: str) -> str:
    """The picture of a figure in one format."""
    return f"{figure.name}.{suffix}"


def with_shown(formats: Sequence[str]) -> tuple[str, ...]:
    """The formats of the pictures, with one that browsers show for the page of all figures."""
    chosen = tuple(dict.fromkeys(formats))
    return chosen if set(chosen) - {"pdf"} else (*chosen, "png")


def data_name(panel: PaperPanel) -> str:
    """The table of a panel."""
    return f"{DATA}/{panel.name}.csv"


REPRODUCTION_FOLDER = ResultFolder(
    what="reproduction",
    kind="hilc reproduce",
    other="other figures or scenarios",
    pictures=tuple(FIGURE_NAMES),
    files=frozenset({INDEX, CLAIMS_CSV, CLAIMS_MD, DATA}),
)

OWN_DATA = frozenset(data_name(panel) for figure in FIGURES for panel in figure.panels)
