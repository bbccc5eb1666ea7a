"""How theory expects the error to go, beside how it went."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import csv
import math
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.frames import Columns
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import RELATIVE_TOLERANCES
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.error import drawable
from hilc_cli.theory.learning.transient import Transient

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check

TITLE = "Predicted without limit"
PREDICTED = "Predicted, without limit and disturbances"
SIMULATED = "Simulated"
RESTS = "Where learning rests"
END = "End of the scenario"
SHARES = "Share of the path's size"

_WIDTH = 5.6  # [inch]
_SHARE_LABELS = 0.2  # [inch]
_MARKED_UP_TO = 30  # iterations that are marked one by one
_SMALLEST, _LARGEST = 1e-6, 100.0  # of the path's size: what is beyond tells nothing more
_TIGHT = 0.8  # width of a decade of iterations that has room for all its labels [inch]
_TIGHT_THOUSANDS = 1.1  # the same where labels have four digits and more
_ROOM = 0.15  # above and below the lines, in decades
_DASH_DOT = (0, (6, 2, 1.2, 2))


def figure_of(check: Check, look: Look = USUAL) -> Figure | None:
    """Draws what a check has found of the error over the iterations.

    Args:
        check: With the simulated error, if it has a simulation.
        look: What the user asks for.

    Returns:
        The figure; None if no errors are predicted of the law.
    """
    expected, spec = check.forecast, check.scenario.spec
    if expected is None:
        return None
    rest = expected.rest if expected.settles else None
    return transient_figure(
        check.scenario.name,
        expected.transient,
        spec.iterations,
        None if check.simulated is None else check.simulated.run,
        rest.max_position_error_m if rest is not None and rest.is_finite else None,
        spec.controller.in_short(check.scenario.setting),
        look,
    )


def transient_figure(
    name: str,
    transient: Transient,
    iterations: int,
    simulated: RunData | None = None,
    rest_error_m: float | None = None,
    law: str = "",
    look: Look = USUAL,
) -> Figure:
    """Draws the maximum position error over the iterations, which run with log(1 + iteration).

    Args:
        name: Name of the scenario.
        transient: What is predicted.
        iterations: How many learning updates the scenario has.
        simulated: A run of it, if there is one.
        rest_error_m: Error where learning rests [m], if it rests.
        law: The law and its gains in a few words, for the title.
        look: What the user asks for.
    """
    with style.applied(look):
        figure, axes = layout.single_panel(
            labels.shortened(name), _WIDTH, extra_right=_SHARE_LABELS, look=look
        )
        predicted = transient.max_position_error_m
        lines = [_draw(axes, predicted, PREDICTED)]
        if simulated is not None:
            limit = "without limit" if simulated.speed_limit is None else "with limit"
            simulated_errors = simulated.metrics["max_position_error_m"]
            lines.append(_draw(axes, simulated_errors, f"{SIMULATED}, {limit}"))
        last = max(map(len, lines)) - 1
        low, high = _range(lines, transient.path_size_m)
        notes = [] if simulated is None else labels.divergence_notes([simulated])
        if np.isinf(predicted).any():
            first = int(np.argmax(np.isinf(predicted)))
            notes.insert(0, f"prediction not finite from iteration {first} on")
        notes += _above(lines, high)
        if not any((line >= low).any() for line in lines):
            notes.append("no error but rounding")
        if rest_error_m is not None and low <= rest_error_m <= high:
            axes.axhline(rest_error_m, color="black", linewidth=style.THIN, label=RESTS)
        elif rest_error_m is not None and rest_error_m > high:
            notes.append(f"learning rests at {rest_error_m:.3g} m, above this picture")
        if iterations < last:
            axes.axvline(
                1 + iterations,
                color=style.LIMIT_COLOR,
                linewidth=style.THIN,
                linestyle=_DASH_DOT,
                label=END,
            )
        _draw_shares(axes, transient.path_size_m)
        _scale_errors(axes, low, high)
        _scale_iterations(axes, last)
        axes.grid(visible=True)
        labels.set_title(axes, f"{TITLE}: {law}" if law else TITLE, notes)
        layout.finish(figure, axes)
        return figure


def _draw(axes: Axes, errors: Floats, label: str) -> Floats:
    """Draws the errors of iterations 0, 1, ... and returns them as they are drawn."""
    shown = drawable(errors)
    axes.plot(
        1 + np.arange(len(shown)),
        shown,
        color=style.BLUE if label == PREDICTED else style.VERMILLION,
        linewidth=style.PATH_WIDTH,
        linestyle="-" if label == PREDICTED else style.DASHED,
        marker="o" if len(shown) <= _MARKED_UP_TO else "",
        markersize=style.MARKER_SIZE - 1,
        label=label,
    )
    return shown


def _above(lines: list[Floats], high: float) -> list[str]:
    """Says how far errors go that are above the panel."""
    largest = max((float(np.nanmax(line, initial=0.0)) for line in lines), default=0.0)
    if largest <= high:
        return []
    return [
        f"errors of up to {labels.number_text(largest, 2)} m; those above "
        f"{labels.tick_text(float(f'{high:.2g}'))} m are not shown"
    ]


def _range(lines: list[Floats], path_size_m: float) -> tuple[float, float]:
    """The lowest and the highest error to show [m], with the shares of the path between them."""
    values = np.concatenate(
        [*lines, [share * path_size_m for share in RELATIVE_TOLERANCES.values()]]
    )
    values = values[np.isfinite(values) & (values > 0)]
    if not len(values):  # a turn on the spot without an error
        return 0.1, 10.0
    if path_size_m > 0:
        values = values.clip(_SMALLEST * path_size_m, _LARGEST * path_size_m)
    return float(values.min()) * 10**-_ROOM, float(values.max()) * 10**_ROOM


def _draw_shares(axes: Axes, path_size_m: float) -> None:
    """Marks the shares of the path's size, named beside the panel where no line is."""
    if path_size_m == 0:
        return
    for label, share in RELATIVE_TOLERANCES.items():
        axes.axhline(
            share * path_size_m,
            color=style.LIMIT_COLOR,
            linewidth=style.THIN,
            linestyle=style.DOTTED,
            label=SHARES if share == max(RELATIVE_TOLERANCES.values()) else "_share",
        )
        axes.annotate(
            label,
            xy=(1, share * path_size_m),
            xycoords=axes.get_yaxis_transform(),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=style.SMALL_SIZE,
            color=style.LIMIT_COLOR,
            annotation_clip=False,
        )


def _scale_errors(axes: Axes, low: float, high: float) -> None:
    axes.set_ylim(low, high)  # first: Matplotlib would look for limits, and may overflow
    axes.set_yscale("log")
    major, texts, minor = labels.logarithmic_ticks(math.log10(low), math.log10(high))
    axes.set_yticks(major, texts)
    axes.set_yticks(minor, [""] * len(minor), minor=True)
    axes.set_ylabel("Maximum position error [m]", labelpad=2)


def _scale_iterations(axes: Axes, last: int) -> None:
    """Makes a logarithmic axis of 1 + iteration, labelled with the iterations."""
    axes.set_xscale("log")
    axes.set_xlim(0.95, 1.05 * (1 + max(1, last)))
    shown = [0, *(digit * 10**power for power in range(7) for digit in (1, 2, 5))]
    width, _ = layout.panel_size(axes)
    decade = width / math.log10(2 + last)
    if last > 10_000 or decade < (_TIGHT if last < 1000 else _TIGHT_THOUSANDS):
        shown = [0, *(10**power for power in range(9))]
    shown = [iteration for iteration in shown if iteration <= max(1, last)]
    axes.set_xticks([1 + iteration for iteration in shown], [f"{number}" for number in shown])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("Iteration")


TRANSIENT_FILE = "transient.csv"
TRANSIENT_HEADER = (
    "iteration",
    "predicted_max_position_error_m",
    "simulated_max_position_error_m",
)


def write_transient(path: Path, predicted: Floats, simulated: Floats | None = None) -> None:
    """Writes a row per iteration; what was not predicted, or not simulated, is empty.

    Args:
        path: The file.
        predicted: Largest position errors of iterations 0, 1, ... [m]; ``inf`` where they leave
            the finite numbers.
        simulated: Those of a simulation, if there is one.
    """
    columns = predicted.tolist(), [] if simulated is None else simulated.tolist()
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(TRANSIENT_HEADER)
        for iteration, errors in enumerate(zip_longest(*columns, fillvalue="")):
            writer.writerow((iteration, *errors))


def errors_of(check: Check) -> Columns:
    """The columns of ``transient.csv``; not-a-number where there is nothing.

    Raises:
        UsageError: No errors are predicted of the law.
    """
    if check.forecast is None:
        raise UsageError(
            f"no errors are predicted of law {check.scenario.spec.controller.law} on this plant; "
            "run the scenario, and ask the run"
        )
    predicted = check.forecast.transient.max_position_error_m
    run = None if check.simulated is None else check.simulated.run
    simulated = np.empty(0) if run is None else run.metrics["max_position_error_m"]
    errors = np.full((2, max(len(predicted), len(simulated))), np.nan)
    errors[0, : len(predicted)] = predicted
    errors[1, : len(simulated)] = simulated
    columns = [np.arange(errors.shape[1]), *errors]
    return dict(zip(TRANSIENT_HEADER, columns, strict=True))
