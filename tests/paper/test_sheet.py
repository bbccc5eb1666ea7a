"""Sheets: their size, what stands in them, and that nothing covers anything."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import style
from hilc_cli.drawing.save import render
from hilc_cli.paper.panel import Panel, PanelKind, PanelRow, shown_trials
from hilc_cli.paper.sheet import PAGE_HEIGHT, PAGE_WIDTH, sheet_figure
from hilc_cli.results.run import RunData
from tests.drawing.reading import line, lines, overlaps, texts
from tests.made_up_runs import MakeRun

KINDS = (PanelKind.PATH_CHANGE, PanelKind.FINAL_PATH, PanelKind.MAXIMUM_ERROR)
SPEEDS = (PanelKind.PATH_CHANGE, PanelKind.WHEEL_SPEEDS, PanelKind.AVERAGE_ERROR)


def row(letter: str, run: RunData, kinds: Sequence[PanelKind] = KINDS) -> PanelRow:
    panels = [
        Panel(f"{letter}{place}", kind, kind.capitalize(), run, 180.0)
        for place, kind in enumerate(kinds, 1)
    ]
    return PanelRow(f"({letter}) Situation 1: {run.name}", tuple(panels))


def panels(figure: Figure) -> list[Axes]:
    """The axes but for the colour bar."""
    return [axes for axes in figure.axes if axes.get_ylabel()]


@pytest.mark.parametrize(("rows", "kinds"), [(1, KINDS), (2, SPEEDS), (4, KINDS), (4, SPEEDS)])
def test_sheet_fits_a_page_and_nothing_covers_anything(
    make_run: MakeRun, rows: int, kinds: Sequence[PanelKind]
) -> None:
    run = make_run(factors=[0.5, 1000.0, 3.0, 0.9], saturated=20)  # with notes of two lines
    figure = sheet_figure(
        "Figure 9", "as it is", [row(letter, run, kinds) for letter in "abcd"[:rows]]
    )

    width, height = figure.get_size_inches()
    assert width == PAGE_WIDTH == 7
    assert PAGE_HEIGHT == 9.5
    assert height <= PAGE_HEIGHT + 1e-9  # with two lines of notes it is filled, but for rounding
    assert len(panels(figure)) == 3 * rows
    assert overlaps(figure) == []


def test_note_of_a_panel_moves_no_title(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5, 1000.0, 3.0, 0.9])  # only the first panel has a note
    figure = sheet_figure("Figure 9", "as it is", [row("a", run)])
    figure.draw_without_rendering()

    heights = [
        round(axes._left_title.get_window_extent().y0, 3)  # type: ignore[attr-defined]
        for axes in panels(figure)
    ]
    assert len(set(heights)) == 1
    (note,) = [
        text for text in panels(figure)[0].texts if text.get_text().startswith("2 of 4 paths")
    ]
    label = panels(figure)[0].xaxis.label
    assert note.get_window_extent().y1 < label.get_window_extent().y0
    assert "2 of 4 paths leave the view" in texts(figure)
    assert [axes.get_title(loc="left") for axes in panels(figure)] == [
        "(a1) Path change",
        "(a2) Final path",
        "(a3) Maximum error",
    ]


def test_text_can_be_read_in_print(make_run: MakeRun) -> None:
    figure = sheet_figure("Figure 9", "as it is", [row("a", make_run(), SPEEDS)])
    render(figure, "png", 30)  # ticks are made when they are drawn

    written = figure.findobj(lambda artist: isinstance(artist, matplotlib.text.Text))
    sizes = {text.get_fontsize() for text in written if text.get_text()}  # type: ignore[attr-defined]
    assert min(sizes) == style.PRINT_SIZE == 7


def test_scales_of_paths_are_equal(make_run: MakeRun) -> None:
    figure = sheet_figure("Figure 9", "as it is", [row("a", make_run())])
    figure.draw_without_rendering()

    for axes in panels(figure)[:2]:
        box = axes.get_window_extent()
        (x_min, x_max), (y_min, y_max) = axes.get_xlim(), axes.get_ylim()
        assert box.width / (x_max - x_min) == pytest.approx(box.height / (y_max - y_min), rel=1e-6)


def test_all_panels_share_colours_and_legend(make_run: MakeRun) -> None:
    runs = [make_run("short", factors=[0.5, 0.6]), make_run("long", factors=[0.5] * 9)]
    figure = sheet_figure("Figure 9", "as it is", [row("a", runs[0]), row("b", runs[1], SPEEDS)])
    (bar,) = [axes for axes in figure.axes if axes not in panels(figure)]

    assert bar.get_xlabel() == "Iteration"
    assert bar.get_xlim() == pytest.approx((0, 8))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        *("Reference", "Start", "Final path", "End"),
        *("Left wheel", "Right wheel", "Limit of the motors"),
    ]
    assert all(axes.get_legend() is None for axes in figure.axes)


def test_final_path_stands_out_where_it_has_no_panel_of_its_own(make_run: MakeRun) -> None:
    run = make_run()
    figure = sheet_figure("Figure 9", "as it is", [row("a", run, [PanelKind.PATHS])])
    (axes,) = panels(figure)

    final = line(axes, "Final path")
    np.testing.assert_array_equal(final.get_xydata(), np.column_stack([run.last.x, run.last.y]))
    others = lines(axes, "_path")
    assert final.get_color() not in {other.get_color() for other in others}
    assert final.get_linewidth() > max(other.get_linewidth() for other in others)
    assert final.get_zorder() > max(other.get_zorder() for other in others)


def test_limit_of_the_motors_is_shown_whether_the_run_kept_it_or_not(make_run: MakeRun) -> None:
    for run in (make_run(), make_run(speed_limit=None)):
        axes = panels(sheet_figure("Figure 9", "as it is", [row("a", run, SPEEDS)]))[1]
        drawn = [limit.get_ydata()[0] for limit in lines(axes, "Limit of the motors")]  # type: ignore[index]
        assert drawn == [180], "no wheel turns back"


def test_error_is_the_one_of_the_caption_with_its_final_value(make_run: MakeRun) -> None:
    # A circle of 10 m shrunk to half about its start is off by half the chord from the start,
    # 10 sin(k pi / 80) m: at most 10 m, and the sum over k = 0..80 is 10 cot(pi / 160).
    run = make_run(factors=[0.5])
    for kind, label, final in (
        (PanelKind.MAXIMUM_ERROR, "Maximum error [m]", "final 10 m"),
        (
            PanelKind.AVERAGE_ERROR,
            "Average error [m]",
            f"final {10 / math.tan(math.pi / 160) / 81:.4g} m",
        ),
    ):
        (axes,) = panels(sheet_figure("Figure 9", "as it is", [row("a", run, [kind])]))
        assert axes.get_ylabel() == label
        assert axes.get_yscale() == "log"
        assert len(axes.lines) == 1
        (told,) = [text.get_text() for text in axes.texts if text.get_gid() == "value"]
        assert told == final


def test_few_iterations_are_shown_the_last_among_them(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5] * 13)
    assert [trial.iteration for trial in shown_trials(run)] == [0, 1, 2, 3, 5, 7, 10, 12]
