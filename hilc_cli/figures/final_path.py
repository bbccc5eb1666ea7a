"""How well the last path follows the reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.figures import labels, layout, style, view
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.run import RunData


def same_path(references: Sequence[Reference]) -> bool:
    """Whether all references run along the very same samples."""
    first = references[0]
    return all(
        np.array_equal(first.x, other.x) and np.array_equal(first.y, other.y)
        for other in references[1:]
    )


def draw_final_path(
    axes: Axes, runs: Sequence[RunData], entitle: labels.Entitle = labels.set_title
) -> None:
    """Draws the last recorded path of each run and the dashed reference.

    Args:
        axes: Where to draw.
        runs: At least one; all with one reference if they share it, with one each if not.
        entitle: Puts the title above the panel.
    """
    names = labels.run_labels(runs)
    references = [run.reference for run in runs]
    trials = [run.last for run in runs if run.trials]
    shown = view.show(axes, view.view_of(references, trials))
    shared = same_path(references)
    notes: list[str] = []
    for index, (run, name) in enumerate(zip(runs, names, strict=True)):
        color = style.run_color(index)
        if not shared:
            view.draw_reference(axes, run.reference, color)
        if not run.trials:
            continue
        trial = run.last
        axes.plot(
            *(trial.x, trial.y),
            color=color,
            linewidth=style.PATH_WIDTH,
            marker=style.run_marker(index, len(runs)),
            markersize=style.MARKER_SIZE,
            markevery=style.sparse(len(trial.x), index, runs),
            label=name if len(runs) > 1 else f"Iteration {trial.iteration}",
        )
        notes += view.leaving_note(shown, run.reference, [trial], name if len(runs) > 1 else "")
        pose_color = color if len(runs) > 1 else "black"
        view.draw_start(axes, trial, pose_color)
        view.draw_end(axes, trial, pose_color)
    if trials:
        view.name_poses(axes, end=True)
    if shared:
        view.draw_reference(axes, references[0])
    if len(notes) > 1:
        notes = [f"{len(notes)} of {len(trials)} paths leave the view"]
    entitle(
        axes,
        f"Final path, {labels.last_iteration_text(runs)}",
        [*notes, *labels.divergence_notes(runs)],
    )


def final_path_figure(runs: Sequence[RunData]) -> Figure:
    """The last recorded paths of one or several runs against the reference."""
    with style.applied():
        trials = [run.last for run in runs if run.trials]
        shape = view.shape_of(view.view_of([run.reference for run in runs], trials))
        width, height = 5.4, max(2.4, 5.4 * shape)
        figure, axes = layout.single_panel(
            layout.heading_of(labels.run_labels(runs)), width, height
        )
        draw_final_path(axes, runs)
        layout.finish(figure, axes, width)
        return figure
