"""Runs that stay on one spot, of which the plane shows nothing and the heading everything."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, style
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial

SHAPE = 0.5
"""Height by width of a panel of headings."""
_MARGIN = 0.06  # above and below the headings, of the height; in rad of a robot that only stands
_SEEN = 0.01  # [m]: a robot that gets farther away from its spot has a path to look at


def stays_on_the_spot(runs: Sequence[RunData]) -> bool:
    """Whether the references of all runs do nothing but turn or stand, and so do the robots."""
    return all(
        run.reference.size == 0 and not (run.metrics["max_position_error_m"] > _SEEN).any()
        for run in runs
    )


class Line(NamedTuple):
    """The heading of a robot on its spot, and how it is drawn.

    Attributes:
        trial: What was driven.
        color: Of the line.
        label: What the legend calls it.
    """

    trial: Trial
    color: Any
    label: str


def draw_headings(axes: Axes, references: Sequence[Reference], lines: Sequence[Line]) -> None:
    """Draws headings over time, below the dashed ones of the references.

    Args:
        axes: Where to draw.
        references: What was to be followed, at least one.
        lines: What was driven.
    """
    sample_time = references[0].sample_time
    for trial, color, label in lines:
        times = sample_time * np.arange(len(trial.heading))
        axes.plot(times, trial.heading, color=color, linewidth=style.PATH_WIDTH, label=label)
    for number, reference in enumerate(references):
        axes.plot(
            *(reference.times, reference.heading),
            color=style.REFERENCE_COLOR,
            linestyle=style.DASHED,
            linewidth=1.0,
            label="_reference" if number else "Reference",
            zorder=5,
        )
    headings = np.concatenate(
        [*(each.heading for each in references), *(line.trial.heading for line in lines)]
    )
    headings = headings[np.isfinite(headings)]
    low, high = float(headings.min()), float(headings.max())
    margin = _MARGIN * (high - low) or _MARGIN
    axes.set_xlim(0, max(float(each.times[-1]) for each in references))
    axes.set_ylim(low - margin, high + margin)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=most_ticks(axes, 8), steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.grid(visible=True)
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Heading [rad]", labelpad=2)
