"""Draws the picture of the README: the paper's law and the norm-optimal one, side by side.

Both start one metre beside the arc-and-line path, believe in a wheel radius 30 % too small and a
half track 30 % too large, and keep the limit of 180 rad/s. Run as
``python docs/images/two_laws.py``.
"""

from __future__ import annotations

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import hilc_cli as hilc

PICTURE = Path(__file__).with_name("two-laws.png")
BELIEF = {"model.wheel_radius": 0.7 * 0.200, "model.half_track": 1.3 * 0.518}
LAWS = {  # what it is called, color, dashes, iterations after which its path is drawn
    "paper": ("the paper's law (Eq. 21)", "#D55E00", (0, (5, 2)), 100),
    "norm-optimal": ("norm-optimal", "#0072B2", "-", 2),
}
TICKS = ["10 m", "1 m", "10 cm", "1 cm", "1 mm", "0.1 mm"]
ERROR = "max_position_error_second_half_m"


def run(law: str, iterations: int = 100) -> hilc.Run:
    """One of the two laws, in situation 3 of the paper with a wrong belief."""
    other = {"controller": {"law": law, "b_w": 180}} if law != "paper" else {}
    changes = {**BELIEF, **other, "iterations": iterations, "record.iterations": [2]}
    return hilc.run(hilc.load_scenario("example:fig5-arc-and-line", changes))


def draw(done: dict[str, hilc.Run]) -> Figure:
    """Paths to the left, errors of all passes to the right."""
    figure = Figure(figsize=(9.2, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    paths, errors = figure.subplots(1, 2, width_ratios=[1, 1.7])
    _draw_paths(paths, done)
    _draw_errors(errors, done)
    figure.legend(*paths.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _draw_paths(axes: Axes, done: dict[str, hilc.Run]) -> None:
    reference = done["paper"].reference
    axes.plot(reference.x, reference.y, color="0.78", lw=7, label="where it should drive")
    start = done["paper"].last
    axes.plot(start.x[0], start.y[0], "ko", ms=7, ls="none", label="where it starts, 1 m off")
    for law, (name, color, dashes, iteration) in LAWS.items():
        trial = done[law].trials[iteration]
        label = f"{name}, pass {iteration}"
        axes.plot(trial.x, trial.y, color=color, ls=dashes, lw=2, label=label)
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title="What it drives")


def _draw_errors(axes: Axes, done: dict[str, hilc.Run]) -> None:
    for law, (_, color, dashes, _) in LAWS.items():
        axes.semilogy(done[law].metrics[ERROR], color=color, ls=dashes, lw=2)
    axes.set(xlabel="pass", xlim=(0, 100), title="Largest error, second half of the path")
    axes.set_yticks([10, 1, 0.1, 0.01, 0.001, 1e-4], TICKS)
    axes.minorticks_off()
    axes.grid(color="0.88")


if __name__ == "__main__":
    draw({law: run(law) for law in LAWS}).savefig(PICTURE, dpi=110)
