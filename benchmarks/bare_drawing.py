"""What `benchmarks/run.py` compares with: the pictures of a run by a bare Matplotlib script.

Reads the arrays of a run from an .npz file and draws, at the same size and resolution, the same
lines as hilc does: path change, final path, error, wheel speeds and the four together, and the
error along the path.
"""

import sys

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

data = np.load(sys.argv[1])
folder = sys.argv[2]


def path_change(axes: Axes) -> None:
    for x, y in zip(data["x"], data["y"], strict=True):
        axes.plot(x, y)
    axes.plot(data["reference_x"], data["reference_y"], "k--")
    axes.set_aspect("equal")


def final_path(axes: Axes) -> None:
    axes.plot(data["x"][-1], data["y"][-1])
    axes.plot(data["reference_x"], data["reference_y"], "k--")
    axes.set_aspect("equal")


def error(axes: Axes) -> None:
    for line in data["errors"]:
        axes.semilogy(line)


def wheel_speeds(axes: Axes) -> None:
    axes.plot(data["left"])
    axes.plot(data["right"])


kinds = [path_change, final_path, error, wheel_speeds]
for kind in kinds:
    figure = Figure(figsize=(7, 6))
    FigureCanvasAgg(figure)
    kind(figure.add_subplot())
    figure.savefig(f"{folder}/{kind.__name__}.png", dpi=150)
figure = Figure(figsize=(11, 9.2))
FigureCanvasAgg(figure)
for index, kind in enumerate(kinds):
    kind(figure.add_subplot(2, 2, index + 1))
figure.savefig(f"{folder}/summary.png", dpi=150)

figure = Figure(figsize=(12, 5.8))
FigureCanvasAgg(figure)
x, y = data["x"][-1], data["y"][-1]
errors = data["reference_x"] - x, data["reference_y"] - y
for row, values in enumerate((*errors, np.hypot(*errors))):
    figure.add_subplot(3, 2, 2 * row + 1).plot(values)
axes = figure.add_subplot(1, 2, 2)
points = np.column_stack([x, y])
pieces = LineCollection(np.stack([points[:-1], points[1:]], axis=1).tolist(), linewidths=3)
pieces.set_array(np.hypot(*errors)[1:])
figure.colorbar(axes.add_collection(pieces))
axes.plot(data["reference_x"], data["reference_y"], "k--")
axes.set_aspect("equal")
figure.savefig(f"{folder}/error_along_path.png", dpi=150)
