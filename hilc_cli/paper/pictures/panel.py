"""What a panel of the paper's figures shows. Nothing here needs Matplotlib."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial

SHOWN_ITERATIONS = (0, 1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100)
"""Their paths can still be told apart in a panel as wide as a third of a page."""


class PanelKind(StrEnum):
    """What is drawn."""

    PATH_CHANGE = "path change"
    PATHS = "path change and final path"
    FINAL_PATH = "final path"
    WHEEL_SPEEDS = "final wheel speeds"
    MAXIMUM_ERROR = "maximum error"
    AVERAGE_ERROR = "average error"


ERROR_METRICS = {
    PanelKind.MAXIMUM_ERROR: "max_position_error_m",
    PanelKind.AVERAGE_ERROR: "mean_position_error_m",
}


@dataclass(frozen=True, slots=True)
class Panel:
    """A panel with the run that it shows.

    Attributes:
        letter: Such as ``a1``.
        kind: What is drawn.
        title: What stands above it, behind the letter.
        run: The results.
        speed_limit: The motors' limit [rad/s], shown with wheel speeds whether the run kept it
            or not.
    """

    letter: str
    kind: PanelKind
    title: str
    run: RunData
    speed_limit: float


@dataclass(frozen=True, slots=True)
class PanelRow:
    """Panels side by side.

    Attributes:
        heading: What they have in common; empty for nothing.
        panels: From left to right.
    """

    heading: str
    panels: tuple[Panel, ...]


def shown_trials(run: RunData) -> list[Trial]:
    """The iterations whose paths a panel shows: some of those recorded, and the last."""
    last = run.last.iteration
    return [
        trial
        for number, trial in sorted(run.trials.items())
        if number in SHOWN_ITERATIONS or number == last
    ]
