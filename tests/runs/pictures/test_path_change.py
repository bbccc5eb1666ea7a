from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.drawing import style
from hilc_cli.reference.sampled import Reference
from hilc_cli.runs.pictures.path_change import iteration_scale, path_change_figure
from tests.drawing.reading import legend, line, lines, texts
from tests.made_up_runs import MakeRun, circle, straight


def test_paths_are_those_of_the_run(make_run: MakeRun) -> None:
    run = make_run()
    axes = path_change_figure([run]).axes[0]

    for path, trial in zip(lines(axes, "_path"), run.trials.values(), strict=True):
        np.testing.assert_array_equal(path.get_xdata(), trial.x)
        np.testing.assert_array_equal(path.get_ydata(), trial.y)
    reference = line(axes, "Reference")
    np.testing.assert_array_equal(reference.get_xdata(), run.reference.x)
    assert reference.get_color() == "black"
    assert reference.is_dashed()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "y [m]")
    assert legend(axes) == ["Reference", "Start"]


def test_color_bar_runs_over_the_shown_iterations(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5] * 31, recorded=[0, 1, 2, 5, 30])
    figure = path_change_figure([run])
    axes, bar = figure.axes

    assert bar.get_ylim() == pytest.approx((0, 30))
    assert [text.get_text() for text in bar.get_yticklabels()] == [
        "0",
        "1",
        "2",
        "5",
        "10",
        "20",
        "30",
    ]
    assert bar.get_ylabel() == "Iteration"
    paths = lines(axes, "_path")
    colors = style.iteration_colors()
    assert paths[0].get_color() == colors(0.0)
    assert paths[-1].get_color() == colors(1.0)


def test_colors_get_brighter_with_the_iterations() -> None:
    luminance = style.iteration_colors()(np.linspace(0, 1, 50))[:, :3] @ [0.2126, 0.7152, 0.0722]

    assert np.all(np.diff(luminance) > 0)
    assert luminance[-1] < 0.8  # still seen on white paper


@pytest.mark.parametrize("reference", [circle(), circle(1e-3), circle(1e6), straight()])
def test_scales_of_the_axes_are_equal(make_run: MakeRun, reference: Reference) -> None:
    figure = path_change_figure([make_run(reference=reference)])
    axes = figure.axes[0]

    figure.draw_without_rendering()

    assert axes.get_aspect() == 1
    box = axes.get_window_extent()
    (x_min, x_max), (y_min, y_max) = axes.get_xlim(), axes.get_ylim()
    assert box.width / (x_max - x_min) == pytest.approx(box.height / (y_max - y_min), rel=1e-6)
    assert x_min < reference.x.min() < reference.x.max() < x_max
    assert y_min < reference.y.min() <= reference.y.max() < y_max


def test_view_stays_with_the_reference_and_says_what_leaves_it(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5, 1000.0, 3.0, 0.9])
    figure = path_change_figure([run])
    low, high = figure.axes[0].get_xlim()

    assert high - low < 5 * run.reference.size
    assert "2 of 4 paths leave the view, error up to 2e4 m" in texts(figure)


def test_no_note_where_all_paths_are_in_view(make_run: MakeRun) -> None:
    assert "view" not in texts(path_change_figure([make_run()]))


def test_start_is_always_in_view(make_run: MakeRun) -> None:
    run = make_run()
    far = run.last
    far.x[:] += 500.0
    axes = path_change_figure([run]).axes[0]

    assert axes.get_xlim()[1] > far.x[0]


def test_start_mark_stands_at_the_pose_and_points_ahead(make_run: MakeRun) -> None:
    run = make_run()
    axes = path_change_figure([run]).axes[0]
    mark = lines(axes, "_pose")[0]

    assert (mark.get_xdata(), mark.get_ydata()) == (run.last.x[0], run.last.y[0])
    marker = mark._marker  # type: ignore[attr-defined]
    ahead = marker.get_transform().transform([(1.0, 0.0)])[0]
    assert np.arctan2(ahead[1], ahead[0]) == pytest.approx(run.last.heading[0])


def test_chosen_iterations_only(make_run: MakeRun) -> None:
    run = make_run()
    figure = path_change_figure([run], iterations=[1, 3])

    assert len(lines(figure.axes[0], "_path")) == 2
    assert figure.axes[1].get_ylim() == pytest.approx((1, 3))


def test_one_iteration_is_named_and_needs_no_color_bar(make_run: MakeRun) -> None:
    (axes,) = path_change_figure([make_run(factors=[0.7])]).axes

    assert legend(axes) == ["Iteration 0", "Reference", "Start"]


def test_several_runs_share_one_scale(make_run: MakeRun) -> None:
    runs = [make_run("short", factors=[0.5, 0.6]), make_run("long", factors=[0.5] * 9)]
    figure = path_change_figure(runs)
    first, second, bar = figure.axes

    assert [axes.get_title(loc="left") for axes in (first, second)] == ["short", "long"]
    assert bar.get_ylim() == pytest.approx((0, 8))
    assert lines(first, "_path")[1].get_color() == lines(second, "_path")[1].get_color()
    assert legend(first) == ["Reference", "Start"]


def test_run_without_any_of_the_chosen_iterations_says_so(make_run: MakeRun) -> None:
    runs = [make_run(factors=[0.5]), make_run(factors=[0.5, 0.6])]

    assert "no path of these iterations" in texts(path_change_figure(runs, [1]))


def test_scale_without_extent(make_run: MakeRun) -> None:
    assert iteration_scale([make_run(factors=[0.5])]) is None
    assert iteration_scale([make_run(factors=[])]) is None
