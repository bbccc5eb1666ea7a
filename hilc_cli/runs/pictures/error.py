"""How the position error falls over the iterations, and where the speed limit acted."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from hilc_cli.drawing import labels, layout, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import MAX_ERROR_SECOND_HALF
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.on_the_spot import stays_on_the_spot

LineStyle = str | tuple[int, tuple[float, ...]]

MAXIMUM, MEAN = "Maximum error", "Mean error"
"""Of several runs, whose legend is that of other panels, too."""
ZERO_LABEL = "Exactly zero"
STRIP_LABEL = "Samples at speed limit (0 to 100 %)"
SEVERAL_STRIPS = ", colours of the runs"
MOST_DETAILED = 5
"""Mean errors and shares at the limit are drawn of so many runs; those of more hide the lines."""
MARKED_UP_TO = 30
"""So many iterations are marked one by one."""

# A logarithmic axis of double precision ends a little inside of what its numbers can hold.
_SMALLEST, _LARGEST = 1e-300, 1e300
_WIDTH = 5.8  # of the panel [inch]
_STRIP, _STRIPS = 0.05, 0.2  # height of a strip, and of all of them, of the panel's
_HEADROOM = 0.06  # free space above and below the lines, of the panel's height
_SINGLE = (
    ("max_position_error_m", "Maximum", style.BLUE, "-"),
    ("rms_position_error_m", "RMS", style.VERMILLION, style.DASHED),
    ("mean_position_error_m", "Mean", style.GREEN, style.DOTTED),
)
SINGLE_METRICS = tuple(column[0] for column in _SINGLE)
"""What is drawn of a single run."""
_ON_THE_SPOT = (("max_abs_error_heading_rad", "Maximum", style.BLUE, "-"),)
"""What is drawn in their place of a path that does nothing but turn."""
SECOND_HALF_LABEL = "Maximum, second half"
_DASH_DOTTED = (0, (6, 1.6, 1.2, 1.6))
_SECOND_HALF = (MAX_ERROR_SECOND_HALF, SECOND_HALF_LABEL, style.WINE, _DASH_DOTTED)
"""What is drawn as well where a start beside the path decides the maximum."""


def drawable(errors: Floats) -> Floats:
    """Errors as a logarithmic axis can show them: what is zero or not finite becomes a gap."""
    with np.errstate(invalid="ignore"):
        return np.where((errors >= _SMALLEST) & (errors <= _LARGEST), errors, np.nan)


def saturated_share(run: RunData) -> Floats:
    """Share of the samples of each iteration at which the speed limit acted, 0..1."""
    return run.metrics["saturated_samples"] / max(1, run.reference.samples)


def draw_error(
    axes: Axes,
    runs: Sequence[RunData],
    metrics: Collection[str] | None = None,
    entitle: labels.Entitle = labels.set_title,
    strip: float = _STRIP,
) -> None:
    """Draws the position error against the iteration.

    Of a single run the maximum, RMS and mean; of several the maximum, and the mean as a thin line;
    of more than ``MOST_DETAILED`` the maximum alone. Of runs on the spot, whose positions tell
    nothing, the heading's error. Where a start beside the path decides the maximum of a run,
    the maximum of the second half is drawn as well: of a single run as one more line, of several in
    the place of the mean.

    Args:
        axes: Where to draw.
        runs: At least one.
        metrics: Which of ``SINGLE_METRICS`` to draw of a single run, and nothing else.
        entitle: Puts the title above the panel.
        strip: Height of the strip of a single run's share at the limit, of the panel's.
    """
    several, detailed = len(runs) > 1, len(runs) <= MOST_DETAILED
    turns = stays_on_the_spot(runs)
    off = metrics is None and not turns and any(run.start_decides for run in runs)
    single = _ON_THE_SPOT if turns else (*_SINGLE, *((_SECOND_HALF,) if off else ()))
    what = "Heading error" if turns else "Position error"
    thin, thin_label, thin_style = (
        (MAX_ERROR_SECOND_HALF, f"{MAXIMUM}, second half", _DASH_DOTTED)
        if off
        else (_SINGLE[2][0], MEAN, style.DOTTED)
    )
    shares = [share for share in map(saturated_share, runs) if detailed and share.any()]
    strip = min(strip, _STRIPS / max(1, len(shares)))
    strips = strip * len(shares)

    lines: list[Floats] = []
    zeros = False
    for index, (run, name) in enumerate(zip(runs, labels.run_labels(runs), strict=True)):
        color = style.run_color(index)
        columns = (
            (
                ((_ON_THE_SPOT if turns else _SINGLE)[0][0], name, color, "-"),
                (thin, "_second half" if off else "_mean", color, thin_style),
            )[: 2 if detailed and not turns else 1]
            if several
            else tuple(column for column in single if metrics is None or column[0] in metrics)
        )
        for place, (metric, label, line_color, line_style) in enumerate(columns):
            errors = drawable(run.metrics[metric])
            lines.append(errors)
            count = len(errors)
            marker = style.run_marker(index, len(runs)) or "o"
            marked = place == 0 if several else count <= MARKED_UP_TO
            axes.plot(
                np.arange(count),
                errors,
                color=line_color,
                linestyle=line_style,
                linewidth=style.THIN if several and place else style.PATH_WIDTH,
                marker=marker if marked else "",
                markersize=style.MARKER_SIZE - (0 if several else 1),
                markevery=style.sparse(count, index, runs) if count > MARKED_UP_TO else None,
                label=label,
            )
        at_zero = np.flatnonzero(run.metrics[columns[0][0]] < _SMALLEST if columns else [])
        if len(at_zero):
            zeros = True
            mark_color = color if several else style.BLUE
            labels.draw_marks(axes, at_zero, strips + _HEADROOM / 2, "v", mark_color, "_zero")
        if run.diverged_at is not None:
            axes.axvline(
                run.diverged_at,
                color=color,
                linestyle=style.DOTTED,
                linewidth=1.0,
                label="_diverged",
            )
    shared = {MAXIMUM: "-"} | ({thin_label: thin_style} if detailed and not turns else {})
    _legend_proxies(axes, shared if several else {}, zeros=zeros)
    scale_iterations(axes, runs)
    _scale_errors(axes, lines, strips)
    axes.set_ylabel(f"{what} [{'rad' if turns else 'm'}]", labelpad=2)
    if detailed:
        _draw_strips(axes, runs, strip)
    entitle(axes, what, [*_gap_notes(runs), *labels.divergence_notes(runs)])


def _legend_proxies(axes: Axes, lines: Mapping[str, LineStyle], *, zeros: bool) -> None:
    """Names what the lines of a kind have in common."""
    for place, (label, line_style) in enumerate(lines.items()):
        width = style.THIN if place else style.PATH_WIDTH
        axes.plot([], [], color="black", linewidth=width, linestyle=line_style, label=label)
    if zeros:
        labels.draw_marks(axes, np.empty(0), 0.0, "v", "black", ZERO_LABEL)


def scale_iterations(axes: Axes, runs: Sequence[RunData]) -> None:
    """Sets up the axis of iterations, from the first to the last of all runs."""
    last = max(
        max(len(run.metrics) - 1, 0 if run.diverged_at is None else run.diverged_at) for run in runs
    )
    labels.set_iterations(axes, last)


def _scale_errors(axes: Axes, lines: Sequence[Floats], strips: float) -> None:
    """Sets up the logarithmic axis, with the lines above the strips at the bottom."""
    floor = strips + _HEADROOM
    values = np.concatenate([*lines, np.empty(0)])
    values = values[~np.isnan(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.1, 1.0)
    # At least about a decade: an error that stays the same is a line in the middle.
    spread = max(0.0, 1 - np.log10(high / low)) / 2
    bottom, top = np.log10(low) - spread, np.log10(high) + spread
    per_height = (top - bottom) / (1 - floor - _HEADROOM)
    bottom, top = bottom - floor * per_height, top + _HEADROOM * per_height
    axes.set_yscale("log")
    major, texts, minor = labels.logarithmic_ticks(bottom + strips * per_height, top)
    # Fixed ticks in plain characters are set many times faster than those of LogFormatter.
    axes.set_yticks(major, texts)
    axes.set_yticks(minor, [""] * len(minor), minor=True)
    axes.set_ylim(10.0**bottom, 10.0**top)
    axes.grid(visible=True)


def _draw_strips(axes: Axes, runs: Sequence[RunData], height: float) -> None:
    """Draws for each run that was limited a strip along the bottom, filled by the share."""
    several = len(runs) > 1
    bottom = 0.0
    for index, run in enumerate(runs):
        share = saturated_share(run)
        if not share.any():
            continue
        full = Rectangle((0, bottom), 1, 0.92 * height, transform=axes.transAxes)
        full.set(color=style.STRIP_COLOR, linewidth=0, gid="full")
        axes.add_patch(full)
        axes.stairs(
            bottom + 0.92 * height * share,
            np.arange(len(share) + 1) - 0.5,
            baseline=bottom,
            fill=True,
            color=style.run_color(index) if several else "0.35",
            transform=axes.get_xaxis_transform(),
            label="_share",
        )
        bottom += height
    if bottom:
        axes.fill(
            [],
            [],
            color="0.35",
            linewidth=0,
            label=STRIP_LABEL + (SEVERAL_STRIPS if several else ""),
        )


def _gap_notes(runs: Sequence[RunData]) -> list[str]:
    """Says how many errors are too large for the axis, and for a number."""
    gaps = sum(
        int(np.count_nonzero(~(run.metrics["max_position_error_m"] <= _LARGEST))) for run in runs
    )
    return [f"{gaps} errors above {labels.number_text(_LARGEST)} m are not drawn"] if gaps else []


def error_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """The position error of one or several runs against the iteration."""
    heading = layout.heading_of(labels.run_labels(runs), layout.panel_width(look, _WIDTH))
    return layout.panel_figure(heading, lambda axes: draw_error(axes, runs), _WIDTH, look=look)


PICTURE = RunPicture(lambda runs, iterations, look: error_figure(runs, look))
