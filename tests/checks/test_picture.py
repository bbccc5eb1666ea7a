from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.text import Text

from hilc_cli.checks.picture import END, PREDICTED, RESTS, SHARES, SIMULATED, transient_figure
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.transient import Transient
from tests.drawing.reading import legend, line, lines, overlaps, texts
from tests.made_up_runs import MakeRun

SIZE = 20.0  # of the path [m]
LIMITED = f"{SIMULATED}, with limit"


def of(errors: Floats, size: float = SIZE) -> Transient:
    """Predicted errors without heading errors."""
    return Transient(size, errors, np.zeros_like(errors))


FALLING = of(10 * np.power(0.95, np.arange(201)))


def test_lines_are_the_errors(make_run: MakeRun) -> None:
    run = make_run()
    figure = transient_figure("circle", FALLING, 3, run, 0.1, "Eq. 17, l1 1")
    (axes,) = figure.axes

    predicted, simulated = line(axes, PREDICTED), line(axes, LIMITED)
    np.testing.assert_array_equal(predicted.get_xdata(), 1 + np.arange(201))
    np.testing.assert_array_equal(predicted.get_ydata(), FALLING.max_position_error_m)
    np.testing.assert_array_equal(simulated.get_xdata(), [1, 2, 3, 4])
    np.testing.assert_array_equal(simulated.get_ydata(), run.metrics["max_position_error_m"])
    assert np.unique(line(axes, RESTS).get_ydata()) == 0.1
    assert np.unique(line(axes, END).get_xdata()) == 4
    shares = [*lines(axes, SHARES), *lines(axes, "_share")]
    assert [float(np.unique(each.get_ydata())[0]) for each in shares] == [0.2, 0.02]
    assert legend(axes) == [PREDICTED, LIMITED, RESTS, END, SHARES]
    assert texts(figure) == "circle\nPredicted without limit: Eq. 17, l1 1\n1 %\n0.1 %"
    assert not overlaps(figure)


def test_axis_is_logarithmic_and_labelled_with_iterations() -> None:
    (axes,) = transient_figure("circle", FALLING, 200).axes

    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Iteration", "Maximum position error [m]")
    marked = {int(tick) - 1: text.get_text() for tick, text in ticks(axes)}
    assert marked == {number: f"{number}" for number in (0, 1, 2, 5, 10, 20, 50, 100, 200)}
    assert legend(axes) == [PREDICTED, SHARES], "the scenario ends where the picture does"
    low, high = axes.get_ylim()
    assert low < 10 * 0.95**200 < 10 < high


def ticks(axes: Axes) -> list[tuple[float, Text]]:
    return list(zip(axes.get_xticks(), axes.get_xticklabels(), strict=True))


@pytest.mark.parametrize("last", [0, 1, 30_000, 2_000_000])
def test_any_number_of_iterations_leaves_a_readable_axis(last: int) -> None:
    figure = transient_figure("long", of(np.full(last + 1, 3.0)), last)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for _, text in ticks(figure.axes[0])]
    assert len(boxes) >= 2
    for before, after in pairwise(boxes):
        assert before.x1 < after.x0


def test_few_iterations_are_marked(make_run: MakeRun) -> None:
    (axes,) = transient_figure("short", FALLING, 0, make_run(factors=[0.5])).axes

    assert line(axes, LIMITED).get_marker() == "o"
    assert line(axes, PREDICTED).get_marker() == ""


def test_what_leaves_all_numbers_is_noted_and_cut(make_run: MakeRun) -> None:
    errors = np.full(400, np.inf)
    errors[:300] = 10.0 ** np.arange(300)
    run = make_run(diverged_at=4)
    figure = transient_figure("wild", of(errors), 5, run)
    (axes,) = figure.axes

    assert "prediction not finite from iteration 300 on" in texts(figure)
    assert "diverged to non-finite values in iteration 4" in texts(figure)
    assert "errors of up to 1e299 m; those above 2800 m are not shown" in texts(figure)
    assert 2000 < axes.get_ylim()[1] < 3000, "a hundred paths, and some room"
    assert not overlaps(figure)


def test_rest_that_is_far_above_is_noted_instead(make_run: MakeRun) -> None:
    figure = transient_figure("far", FALLING, 3, None, 4e8)

    assert "learning rests at 4e+08 m, above this picture" in texts(figure)
    assert RESTS not in legend(figure.axes[0])
    assert RESTS not in legend(transient_figure("exact", FALLING, 3, None, 0.0).axes[0])


@pytest.mark.parametrize("size", [0.0, 1e-9, 1.0])
def test_no_error_at_all_leaves_an_axis(size: float) -> None:
    figure = transient_figure("nothing", of(np.zeros(9), size), 3, None, 0.0)
    figure.draw_without_rendering()

    assert "no error but rounding" in texts(figure)
    low, high = figure.axes[0].get_ylim()
    assert 0 < low < high < np.inf
