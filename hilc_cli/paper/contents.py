"""What stands where: figures 3 to 8, their panels, the situations that these show, and files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hilc_cli.errors import UsageError
from hilc_cli.paper.panel import PanelKind
from hilc_cli.paper.reading import READINGS, Reading
from hilc_cli.results.folder import ResultFolder
from hilc_cli.wording import suggestion

MOTOR_LIMIT = 180.0
"""u_max [rad/s] of the platform's motors, Eq. 44."""


@dataclass(frozen=True, slots=True)
class Situation:
    """An experiment of the paper.

    Attributes:
        number: The paper's number of it; runs of one situation are told apart by a letter.
        equation: Where its gains stand.
        scenario: The example that is run.
    """

    number: str
    equation: int
    scenario: str


@dataclass(frozen=True, slots=True)
class PaperPanel:
    """A panel.

    Attributes:
        name: Of figure and panel, such as ``fig3a1``.
        letter: As the paper has it, such as ``a1``.
        kind: What is drawn.
        situation: The experiment whose results are drawn.
    """

    name: str
    letter: str
    kind: PanelKind
    situation: Situation


@dataclass(frozen=True, slots=True)
class PaperFigure:
    """A figure.

    Attributes:
        name: Such as ``fig3``.
        title: What it is about, in our words.
        caption: What it shows, in our words.
        rows: The panels that stand side by side, from top to bottom.
    """

    name: str
    title: str
    caption: str
    rows: tuple[tuple[PaperPanel, ...], ...]

    @property
    def number(self) -> int:
        """The paper's number of the figure."""
        return int(self.name.removeprefix("fig"))

    @property
    def panels(self) -> tuple[PaperPanel, ...]:
        """All panels in order."""
        return tuple(panel for row in self.rows for panel in row)

    @property
    def situations(self) -> tuple[Situation, ...]:
        """All situations in order."""
        return tuple(dict.fromkeys(panel.situation for panel in self.panels))


def _in_three(
    figure: str, kinds: Sequence[PanelKind], situations: Sequence[Situation]
) -> tuple[tuple[PaperPanel, ...], ...]:
    """A row for each situation, a column for each kind: a1, a2, a3, b1, ..."""
    return tuple(
        tuple(
            PaperPanel(f"{figure}{letter}{column}", f"{letter}{column}", kind, situation)
            for column, kind in enumerate(kinds, 1)
        )
        for letter, situation in zip("abcd", situations, strict=False)
    )


def _one_each(
    figure: str, kind: PanelKind, rows: Sequence[Sequence[Situation]]
) -> tuple[tuple[PaperPanel, ...], ...]:
    """A panel for each situation: a, b, c, ..."""
    letters = iter("abcdefghi")
    return tuple(
        tuple(
            PaperPanel(f"{figure}{letter}", letter, kind, situation)
            for situation, letter in zip(row, letters, strict=False)
        )
        for row in rows
    )


_PATHS_AND_MAXIMUM = (PanelKind.PATH_CHANGE, PanelKind.FINAL_PATH, PanelKind.MAXIMUM_ERROR)
_PATHS_AND_AVERAGE = (PanelKind.PATH_CHANGE, PanelKind.FINAL_PATH, PanelKind.AVERAGE_ERROR)
_SPEEDS_AND_MAXIMUM = (PanelKind.PATH_CHANGE, PanelKind.WHEEL_SPEEDS, PanelKind.MAXIMUM_ERROR)

FIGURES: tuple[PaperFigure, ...] = (
    PaperFigure(
        "fig3",
        "P-type law on four trajectories",
        "The law that uses the error of the previous iteration only, on each of the paper's four "
        "trajectories, without an initial error.",
        _in_three(
            "fig3",
            _PATHS_AND_MAXIMUM,
            [
                Situation("1", 45, "fig3-circle"),
                Situation("1", 45, "fig3-arc-and-line"),
                Situation("1", 45, "fig3-cardioid"),
                Situation("1", 45, "fig3-spiral"),
            ],
        ),
    ),
    PaperFigure(
        "fig4",
        "Initial error, without and with compensation",
        "The platform starts one metre inside the circle: first the law without compensation "
        "(a), then the law that compensates the initial error (b).",
        _in_three(
            "fig4",
            _PATHS_AND_AVERAGE,
            [Situation("2", 46, "fig4-uncompensated"), Situation("3", 47, "fig4-compensated")],
        ),
    ),
    PaperFigure(
        "fig5",
        "Initial error on three more trajectories",
        "The law that compensates the initial error on the other three trajectories.",
        _in_three(
            "fig5",
            _PATHS_AND_AVERAGE,
            [
                Situation("3", 47, "fig5-arc-and-line"),
                Situation("3", 47, "fig5-cardioid"),
                Situation("3", 47, "fig5-spiral"),
            ],
        ),
    ),
    PaperFigure(
        "fig6",
        "Circle with other gains and error terms",
        "A growing gain of the previous iteration's error alone (a to c), of the running "
        "iteration's error beside it (d to f), and of that error one sample before beside both "
        "(g to i). Each panel shows the iterations and, on top of them, the final path.",
        _one_each(
            "fig6",
            PanelKind.PATHS,
            [
                [
                    Situation("4a", 48, "fig6a"),
                    Situation("4b", 48, "fig6b"),
                    Situation("4c", 48, "fig6c"),
                ],
                [
                    Situation("5a", 49, "fig6d"),
                    Situation("5b", 49, "fig6e"),
                    Situation("5c", 49, "fig6f"),
                ],
                [
                    Situation("6a", 50, "fig6g"),
                    Situation("6b", 50, "fig6h"),
                    Situation("6c", 50, "fig6i"),
                ],
            ],
        ),
    ),
    PaperFigure(
        "fig7",
        "Circle without and with the speed limit",
        "Two sets of gains, each without the speed limit (a, c) and with it (b, d). The first "
        "gain of the second pair differs too, in the paper as here: 1 without, 0.5 with the limit.",
        _in_three(
            "fig7",
            _SPEEDS_AND_MAXIMUM,
            [
                Situation("7", 51, "fig7a"),
                Situation("8", 52, "fig7b"),
                Situation("9", 53, "fig7c"),
                Situation("10", 54, "fig7d"),
            ],
        ),
    ),
    PaperFigure(
        "fig8",
        "Circle with other gain matrices",
        "The gain matrix of the true platform (a), one that does without its wheel radius and "
        "track (b), and one that contradicts its kinematics (c).",
        _in_three(
            "fig8",
            _PATHS_AND_MAXIMUM,
            [
                Situation("11", 55, "fig8a"),
                Situation("12", 56, "fig8b"),
                Situation("13", 57, "fig8c"),
            ],
        ),
    ),
)
FIGURE_NAMES = tuple(figure.name for figure in FIGURES)


def figures_named(names: Sequence[str]) -> tuple[PaperFigure, ...]:
    """Figures by their names, in the order of the paper.

    Args:
        names: Such as ``fig3``, or only ``3``; none for all figures.

    Raises:
        UsageError: The paper has no such figure with results.
    """
    wanted = set()
    for name in names:
        full = f"fig{name}" if name.isdecimal() else name.lower()
        if full not in FIGURE_NAMES:
            known = suggestion(full, FIGURE_NAMES)
            raise UsageError(f"{name}: is no figure of the paper's results; {known}")
        wanted.add(full)
    return tuple(figure for figure in FIGURES if not wanted or figure.name in wanted)


INDEX = "index.md"
CLAIMS_CSV = "claims.csv"
CLAIMS_MD = "claims.md"
DATA = "data"


def picture_name(figure: PaperFigure, reading: Reading, suffix: str) -> str:
    """The picture of a figure under a reading in one format; always the same, alone or not."""
    return f"{figure.name}-{reading.name}.{suffix}"


def with_shown(formats: Sequence[str]) -> tuple[str, ...]:
    """The formats of the pictures, with one that browsers show for the page of all figures."""
    chosen = tuple(dict.fromkeys(formats))
    return chosen if set(chosen) - {"pdf"} else (*chosen, "png")


def data_name(panel: PaperPanel, reading: Reading) -> str:
    """The table of a panel under a reading."""
    return f"{DATA}/{panel.name}-{reading.name}.csv"


REPRODUCTION_FOLDER = ResultFolder(
    what="reproduction",
    kind="hilc reproduce",
    other="other figures, readings or scenarios",
    pictures=tuple(f"{name}-{reading.name}" for name in FIGURE_NAMES for reading in READINGS),
    files=frozenset({INDEX, CLAIMS_CSV, CLAIMS_MD, DATA}),
)

OWN_DATA = frozenset(
    data_name(panel, reading)
    for figure in FIGURES
    for panel in figure.panels
    for reading in READINGS
)
