from __future__ import annotations

import numpy as np

from hilc_cli.runs.pictures.final_path import final_path_figure
from tests.drawing.reading import legend, line, lines, texts
from tests.made_up_runs import MakeRun, straight


def test_last_path_against_the_reference(make_run: MakeRun) -> None:
    run = make_run("demo")
    figure = final_path_figure([run])
    (axes,) = figure.axes

    path = line(axes, "Iteration 3")
    np.testing.assert_array_equal(path.get_xdata(), run.last.x)
    np.testing.assert_array_equal(path.get_ydata(), run.last.y)
    assert line(axes, "Reference").is_dashed()
    assert legend(axes) == ["Iteration 3", "Start", "End", "Reference"]
    assert axes.get_title(loc="left") == "Final path, iteration 3"
    assert figure.texts[0].get_text() == "demo"


def test_start_and_end_are_marked(make_run: MakeRun) -> None:
    run = make_run()
    start, end = lines(final_path_figure([run]).axes[0], "_pose")

    assert (start.get_xdata(), start.get_ydata()) == (run.last.x[0], run.last.y[0])
    assert (end.get_xdata(), end.get_ydata()) == (run.last.x[-1], run.last.y[-1])


def test_reference_that_runs_share_is_drawn_once(make_run: MakeRun) -> None:
    axes = final_path_figure([make_run("a"), make_run("b")]).axes[0]

    assert line(axes, "Reference").get_color() == "black"
    assert {"a", "b", "Reference", "Start", "End"} == set(legend(axes))


def test_references_that_differ_are_drawn_in_the_colour_of_their_run(make_run: MakeRun) -> None:
    axes = final_path_figure([make_run("a"), make_run("b", straight())]).axes[0]
    references = lines(axes, "_reference")

    assert len(references) == 2
    for reference, name in zip(references, "ab", strict=True):
        assert reference.get_color() == line(axes, name).get_color()
    assert line(axes, "Reference").get_color() == "black", "in the legend, of no run"


def test_path_that_leaves_the_view_is_named(make_run: MakeRun) -> None:
    runs = [make_run("tame"), make_run("wild", factors=[0.5, 50.0])]

    assert "wild leaves the view, error up to 980 m" in texts(final_path_figure(runs))
    assert "the path leaves the view" in texts(final_path_figure(runs[1:]))
    both = final_path_figure([runs[1], runs[1]])
    assert "2 of 2 paths leave the view" in texts(both)
    assert "last iterations, 1 to 3" in texts(final_path_figure(runs))


def test_run_that_diverged_at_once_still_shows_its_reference(make_run: MakeRun) -> None:
    figure = final_path_figure([make_run(factors=[], diverged_at=0)])

    assert legend(figure.axes[0]) == ["Reference"]
    assert "no iteration completed" in texts(figure)
    assert "diverged to non-finite values in iteration 0" in texts(figure)
