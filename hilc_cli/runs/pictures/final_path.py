"""How well the last path follows the reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.on_the_spot import SHAPE, Line, draw_headings, stays_on_the_spot

_WIDTH = 5.4  # of the panel [inch]


def same_path(references: Sequence[Reference]) -> bool:
    """Whether all references run along the very same samples."""
    first = references[0]
    return all(
        np.array_equal(first.x, other.x) and np.array_equal(first.y, other.y)
        for other in references[1:]
    )


def draw_final_path(
    axes: Axes,
    runs: Sequence[RunData],
    entitle: labels.Entitle = labels.set_title,
    among: Sequence[RunData] | None = None,
) -> None:
    """Draws the last recorded path of each run and the dashed reference.

    Of runs that all stay on the spot, the headings over time.

    Args:
        axes: Where to draw.
        runs: At least one; all with one reference if they share it, with one each if not.
        entitle: Puts the title above the panel.
        among: The comparison that the runs are some of, which gives them their colours; None if
            they are all of it.
    """
    among = runs if among is None else among
    places = [next(place for place, one in enumerate(among) if one is run) for run in runs]
    several = len(among) > 1
    names = labels.run_labels(runs)
    references = [run.reference for run in runs]
    trials = [run.last for run in runs if run.trials]
    if stays_on_the_spot(runs):
        lines = [
            Line(
                run.last,
                style.run_color(index) if several else style.FINAL_PATH_COLOR,
                name if several else f"Iteration {run.last.iteration}",
            )
            for index, run, name in zip(places, runs, names, strict=True)
            if run.trials
        ]
        draw_headings(axes, references, lines)
        title = f"Final heading, {labels.last_iteration_text(runs)}"
        entitle(axes, title, labels.divergence_notes(runs))
        return
    shown = view.show(axes, view.view_of(references, trials))
    shared = same_path(references)
    notes: list[str] = []
    for index, run, name in zip(places, runs, names, strict=True):
        color = style.run_color(index) if several else style.FINAL_PATH_COLOR
        if not shared:
            view.draw_reference(axes, run.reference, color, "_reference")
        if not run.trials:
            continue
        trial = run.last
        axes.plot(
            *(trial.x, trial.y),
            color=color,
            linewidth=style.PATH_WIDTH,
            marker=style.run_marker(index, len(among)),
            markersize=style.MARKER_SIZE,
            markevery=style.sparse(len(trial.x), index, among),
            label=name if several else f"Iteration {trial.iteration}",
        )
        notes += view.leaving_note(shown, run.reference, [trial], name if several else "")
        pose_color = color if several else "black"
        view.draw_start(axes, trial, pose_color)
        view.draw_end(axes, trial, pose_color)
    if trials:
        view.name_poses(axes, end=True)
    if shared:
        view.draw_reference(axes, references[0])
    else:
        view.name_reference(axes)
    if len(notes) > 1:
        notes = [f"{len(notes)} of {len(trials)} paths leave the view"]
    entitle(
        axes,
        f"Final path, {labels.last_iteration_text(runs)}",
        [*notes, *labels.divergence_notes(runs)],
    )


def final_path_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """The last recorded paths of one or several runs against the reference."""
    trials = [run.last for run in runs if run.trials]
    shape = view.shape_of(view.view_of([run.reference for run in runs], trials))
    if stays_on_the_spot(runs):
        shape = SHAPE
    heading = layout.heading_of(labels.run_labels(runs), layout.panel_width(look, _WIDTH))
    height = max(2.4, _WIDTH * shape)
    return layout.panel_figure(
        heading, lambda axes: draw_final_path(axes, runs), _WIDTH, height, look=look
    )


PICTURE = RunPicture(lambda runs, iterations, look: final_path_figure(runs, look))
