"""How theory expects the error to go, beside how it went."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.figures import labels, layout, logarithmic, style
from hilc_cli.figures.error import drawable
from hilc_cli.reference.sampled import Floats

_SHARES = {"1 %": 0.01, "0.1 %": 0.001}  # of the path's size
_WIDTH = 5.8  # [inch]


def transient_figure(
    name: str,
    predicted: Floats,
    path_size_m: float,
    simulated: Floats | None = None,
    rest_error_m: float | None = None,
) -> Figure:
    """The maximum position error over the iterations, which run with log(1 + iteration).

    Args:
        name: Name of the scenario.
        predicted: Predicted error of iterations 0..N [m], shape (N + 1,); infinite where it leaves
            the finite numbers.
        path_size_m: Longer side of the path's bounding box [m].
        simulated: Error of a run [m], if there is one.
        rest_error_m: Error where learning rests [m], if it rests.
    """
    with style.applied():
        figure, axes = layout.single_panel(labels.shortened(name), _WIDTH)
        lines = [drawable(predicted)]
        number = np.arange(len(predicted))
        axes.plot(
            1 + number,
            lines[0],
            color=style.BLUE,
            linewidth=style.PATH_WIDTH,
            label="Predicted, without limit and disturbances",
        )
        if simulated is not None:
            lines.append(drawable(simulated))
            axes.plot(
                1 + np.arange(len(simulated)),
                lines[1],
                color=style.VERMILLION,
                linewidth=style.PATH_WIDTH,
                linestyle=style.DASHED,
                label="Simulated",
            )
        levels = [share * path_size_m for share in _SHARES.values()]
        if rest_error_m is not None and rest_error_m > 0:
            axes.axhline(
                rest_error_m, color="black", linewidth=style.THIN, label="Where learning rests"
            )
            levels.append(rest_error_m)
        last = max(len(predicted), 1 if simulated is None else len(simulated))
        for label, share in _SHARES.items():
            axes.axhline(
                share * path_size_m,
                color=style.LIMIT_COLOR,
                linewidth=style.THIN,
                linestyle=style.DOTTED,
                label="_share",
            )
            axes.annotate(
                f"{label} of the path's size",
                xy=(1, share * path_size_m),
                xytext=(3, 2),
                textcoords="offset points",
                fontsize=style.SMALL_SIZE,
                color=style.LIMIT_COLOR,
            )
        values = np.concatenate([*lines, np.array(levels)])
        values = values[np.isfinite(values) & (values > 0)]
        low, high = math.log10(values.min()) - 0.15, math.log10(values.max()) + 0.15
        axes.set_yscale("log")
        major, texts, minor = logarithmic.ticks(low, high)
        axes.set_yticks(major, texts)
        axes.set_yticks(minor, [""] * len(minor), minor=True)
        axes.set_ylim(10**low, 10**high)
        axes.set_ylabel("Maximum position error [m]", labelpad=2)
        _scale_iterations(axes, last - 1)
        axes.grid(visible=True)
        note = (
            [f"beyond all numbers from iteration {int(np.argmax(np.isinf(predicted)))} on"]
            if np.isinf(predicted).any()
            else []
        )
        labels.set_title(axes, "Predicted transient", note)
        layout.finish(figure, axes, _WIDTH)
        return figure


def _scale_iterations(axes: Axes, last: int) -> None:
    """A logarithmic axis of 1 + iteration, labelled with the iterations."""
    axes.set_xscale("log")
    axes.set_xlim(0.95, 1.05 * (1 + max(1, last)))
    shown = [0, *(digit * 10**power for power in range(7) for digit in (1, 2, 5))]
    shown = [iteration for iteration in shown if iteration <= last]
    axes.set_xticks([1 + iteration for iteration in shown], [f"{number}" for number in shown])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("Iteration")
