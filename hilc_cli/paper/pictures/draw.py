"""Draws one panel in the size in which a journal prints it."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from hilc_cli.drawing import layout, style, view
from hilc_cli.drawing.labels import number_text
from hilc_cli.paper.pictures.panel import ERROR_METRICS, Panel, PanelKind, shown_trials
from hilc_cli.runs.pictures.error import draw_error
from hilc_cli.runs.pictures.final_path import draw_final_path
from hilc_cli.runs.pictures.path_change import draw_path_change
from hilc_cli.runs.pictures.wheel_speeds import LIMIT_LABEL, draw_wheel_speeds

FINAL_PATH = "Final path"
MOTOR_LIMIT = "Limit of the motors"
FINAL_COLOR = style.VERMILLION
NOTE_LINE = 0.115  # [inch]
VALUE = "value"
"""What stands in a panel on purpose."""

_TITLE_PAD = 3.0  # [pt]
_CHARACTER = 0.52  # mean width of a letter, in sizes of the text


def draw_panel(axes: Axes, panel: Panel, scale: Normalize | None) -> int:
    """Draws a panel, without its title.

    Args:
        axes: Where to draw.
        panel: What to draw.
        scale: Colours of the iterations, see `path_change.iteration_scale`.

    Returns:
        Number of lines with notes above the panel.
    """
    lines: list[str] = []

    def entitle(axes: Axes, title: str, notes: Sequence[str]) -> None:
        lines.extend(_write_notes(axes, notes))

    run = panel.run
    match panel.kind:
        case PanelKind.PATH_CHANGE | PanelKind.PATHS:
            iterations = [trial.iteration for trial in shown_trials(run)]
            draw_path_change(axes, run, iterations, scale, entitle=entitle)
            if panel.kind is PanelKind.PATHS:
                axes.plot(
                    *(run.last.x, run.last.y),
                    color=FINAL_COLOR,
                    linewidth=1.5 * style.PATH_WIDTH,
                    label=FINAL_PATH,
                    zorder=4,
                )
                view.draw_end(axes, run.last)
                view.name_poses(axes, end=True)
        case PanelKind.FINAL_PATH:
            draw_final_path(axes, [run], entitle)
            for line in _lines(axes, f"Iteration {run.last.iteration}"):
                line.set(label=FINAL_PATH, color=FINAL_COLOR)
        case PanelKind.WHEEL_SPEEDS:
            draw_wheel_speeds(axes, [run], [panel.speed_limit], entitle)
            for line in _lines(axes, LIMIT_LABEL):
                line.set_label(MOTOR_LIMIT)  # of the motors, whether the run kept it or not
        case PanelKind.MAXIMUM_ERROR | PanelKind.AVERAGE_ERROR:
            metric = ERROR_METRICS[panel.kind]
            draw_error(axes, [run], [metric], entitle)
            first = axes.lines[0]
            first.set(label="_error", color=style.BLUE, linestyle="-")
            axes.set_ylabel(f"{panel.kind.capitalize()} [m]", labelpad=2)
            axes.text(
                *(0.97, 0.96, f"final {number_text(run.metrics[metric][-1], 4)} m"),
                transform=axes.transAxes,
                ha="right",
                va="top",
                gid=VALUE,
            )
    _shrink(axes)
    return len(lines)


def entitle_panel(axes: Axes, panel: Panel, notes: int) -> None:
    """Writes letter and title above a panel, with room for so many lines of notes below them."""
    above = _TITLE_PAD + 72 * NOTE_LINE * notes
    axes.set_title(f"({panel.letter}) {panel.title}", loc="left", y=1.0, pad=above)


def _write_notes(axes: Axes, notes: Sequence[str]) -> list[str]:
    """Writes notes above a panel, and returns the lines that fit it."""
    width, _ = layout.panel_size(axes)
    longest = int(width * 72 / (_CHARACTER * style.PRINT_SIZE))
    lines = [line for note in notes for line in textwrap.wrap(note, longest)]
    if lines:
        axes.annotate(
            "\n".join(lines),
            xy=(0, 1),
            xycoords="axes fraction",
            xytext=(0, 2),
            textcoords="offset points",
            color=style.NOTE_COLOR,
            fontsize=style.PRINT_SIZE,
            linespacing=1.0,
            annotation_clip=False,
        )
    return lines


def _lines(axes: Axes, label: str) -> list[Line2D]:
    return [line for line in axes.lines if line.get_label() == label]


def _shrink(axes: Axes) -> None:
    """Makes lines and marks fit a small panel."""
    for line in axes.lines:
        line.set_linewidth(style.PRINT_SHRINK * line.get_linewidth())
        line.set_markersize(style.PRINT_SHRINK * line.get_markersize())
        line.set_markeredgewidth(style.PRINT_SHRINK * line.get_markeredgewidth())
    for text in axes.texts:
        text.set_fontsize(style.PRINT_SIZE)
    # Ticks are made when they are drawn, when these settings no longer apply.
    axes.tick_params(which="both", labelsize=style.PRINT_SIZE, length=2.0, pad=2.0)
    axes.xaxis.labelpad = 1.0
