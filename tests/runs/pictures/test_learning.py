from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection

from hilc_cli.results.learning import LearningTable
from hilc_cli.runs.pictures.learning import (
    ALONE,
    BARS_AND_BAND,
    BARS_OF_RUNS,
    MODEL,
    NEVER,
    YARDSTICKS,
    learning_figure,
    quantities_to_draw,
)
from tests.drawing.reading import legend, line, lines, overlaps, texts
from tests.made_up_runs import MakeRun, told

NOISY = told(
    [(math.nan, math.nan, 140, math.nan), (203, 2, 203, 2), (199, 1, 200, 0.9), (200, 1, 200, 0.6)],
    [math.nan, math.inf, 0.5, 0.2],
)
EXACT = told([(math.nan, math.nan, 140, math.nan), *[(200, 1e-11, 200, 1e-11)] * 3])


def test_estimates_stand_beside_what_is_true_and_what_was_believed(make_run: MakeRun) -> None:
    figure = learning_figure([make_run(learning=NOISY)])
    radius, merge = figure.axes

    assert (radius.get_ylabel(), merge.get_ylabel()) == ("Deviation [%]", "Merge time [s]")
    assert (radius.get_xlabel(), merge.get_xlabel()) == ("", "Iteration")
    title = "Wheel radius: deviation from the true value, 0.2 m"
    assert radius.get_title(loc="left") == title
    (bars,) = [each for each in radius.collections if isinstance(each, LineCollection)]
    drawn = [segment[:, 1].tolist() for segment in bars.get_segments() if len(segment)]
    assert drawn[-2:] == [pytest.approx([-1.5, 0.5]), pytest.approx([-1, 1])]
    assert list(line(radius, MODEL).get_ydata()) == pytest.approx([-30, 1.5, 0, 0])  # type: ignore[arg-type]
    (band,) = [each for each in radius.collections if isinstance(each, PolyCollection)]
    assert band.get_paths()[0].get_extents().y1 == pytest.approx(3.5)
    assert line(radius, YARDSTICKS["true"]).get_ydata() == [0, 0]
    assert line(merge, YARDSTICKS["h"]).get_ydata() == [0.2, 0.2]
    names = {ALONE, MODEL, BARS_AND_BAND, YARDSTICKS["true"], NEVER, YARDSTICKS["h"]}
    assert set(legend(merge)) == names
    assert overlaps(figure) == []


def test_belief_that_is_far_off_is_told_and_not_shown(make_run: MakeRun) -> None:
    figure = learning_figure([make_run(learning=NOISY)])
    low, high = figure.axes[0].get_ylim()

    # All bars are in view, and not much else.
    assert -5 < low < -1.5 and 3.5 < high < 7.5
    assert "believed at first, out of view: \N{MINUS SIGN}30 %" in texts(figure)
    assert lines(figure.axes[0], YARDSTICKS["believed"]) == []


def test_belief_is_shown_where_there_are_no_bars_to_be_seen(make_run: MakeRun) -> None:
    figure = learning_figure([make_run(learning=EXACT)])
    low, high = figure.axes[0].get_ylim()

    assert low < -30 and 0 < high < 10
    assert line(figure.axes[0], YARDSTICKS["believed"]).get_ydata() == pytest.approx([-30, -30])
    assert "out of view" not in texts(figure)
    assert len(figure.axes) == 1  # no merge time is told


def test_vague_estimate_does_not_squash_the_others(make_run: MakeRun) -> None:
    vague = told([(200, 0.1, 200, 0.1)] * 3 + [(220, 30, 200, 0.1)])
    low, high = learning_figure([make_run(learning=vague)]).axes[0].get_ylim()

    assert high - low < 0.5  # %


@pytest.mark.parametrize("value", [0.0, 1e-9, 1e9])
def test_view_on_a_single_value(make_run: MakeRun, value: float) -> None:
    learning = LearningTable()
    for _ in range(4):
        learning.append({"a_m": value, "a_standard_error_m": 0.0})
    figure = learning_figure([make_run(learning=learning)])
    figure.draw_without_rendering()
    low, high = figure.axes[0].get_ylim()

    assert low < value < high
    assert len(figure.axes[0].get_yticks()) >= 2


def test_what_was_not_measured_is_said_so(make_run: MakeRun) -> None:
    none = told([(math.nan, math.nan, 140, math.nan)] * 4)
    figure = learning_figure([make_run(learning=none)])
    low, high = figure.axes[0].get_ylim()

    assert "not measured" in texts(figure)
    assert low < -30 and high > 0


def test_without_a_true_value_deviations_are_from_the_belief(make_run: MakeRun) -> None:
    run = make_run(learning=NOISY, yardsticks={"wheel_radius_m": {"believed": 0.25}})
    (axes,) = learning_figure([run]).axes

    title = "Wheel radius: deviation from what was believed at first, 0.25 m"
    assert axes.get_title(loc="left") == title
    found = np.asarray(line(axes, MODEL).get_ydata(), float)
    np.testing.assert_allclose(found, [-44, -18.8, -20, -20], rtol=1e-12)


@pytest.mark.parametrize("held", [{}, {"true": 0.0}])
def test_without_anything_to_deviate_from_values_are_shown(
    make_run: MakeRun, held: dict[str, float]
) -> None:
    (axes,) = learning_figure([make_run(learning=NOISY, yardsticks={"wheel_radius_m": held})]).axes

    assert (axes.get_title(loc="left"), axes.get_ylabel()) == ("Wheel radius", "Wheel radius [m]")
    found = np.asarray(line(axes, MODEL).get_ydata(), float)
    np.testing.assert_allclose(found, [0.14, 0.203, 0.2, 0.2])


def test_several_runs_have_a_line_with_bars_each(make_run: MakeRun) -> None:
    names = ["a", "b", "c"]
    silent = make_run("silent", learning=LearningTable())
    figure = learning_figure([make_run(name, learning=NOISY) for name in names] + [silent])
    radius, merge = figure.axes

    colors = {str(line(radius, name).get_color()) for name in names}
    markers = {str(line(radius, name).get_marker()) for name in names}
    assert len(colors) == len(markers) == 3
    # Bars of the same iteration stand beside each other.
    starts = [np.asarray(line(radius, name).get_xdata(), float)[0] for name in names]
    assert starts == sorted(set(starts)) and starts[-1] - starts[0] < 0.5
    assert line(radius, YARDSTICKS["true"]).get_ydata() == [0, 0]
    assert legend(merge)[:3] == names
    assert BARS_OF_RUNS in legend(merge)
    assert "1 of 4 runs tell nothing" in texts(figure)
    assert overlaps(figure) == []


def test_values_that_differ_have_the_colours_of_their_runs(make_run: MakeRun) -> None:
    runs = [
        make_run(name, learning=EXACT, yardsticks={"wheel_radius_m": {"true": 0.2, "believed": b}})
        for name, b in (("a", 0.14), ("b", 0.3))
    ]
    (axes,) = learning_figure(runs).axes

    found = {str(each.get_color()): each.get_ydata() for each in lines(axes, "_yardstick")}
    assert found == {
        str(line(axes, "a").get_color()): pytest.approx([-30, -30]),
        str(line(axes, "b").get_color()): pytest.approx([50, 50]),
    }
    assert YARDSTICKS["believed"] in legend(axes)


def test_time_without_a_yardstick_is_not_drawn(make_run: MakeRun) -> None:
    # Without an initial error there is nothing to merge into.
    run = make_run(learning=NOISY, yardsticks={})

    assert list(quantities_to_draw([run])) == ["wheel_radius_m"]
    assert len(learning_figure([run]).axes) == 1


def test_what_never_happens_is_at_the_upper_edge(make_run: MakeRun) -> None:
    merge = learning_figure([make_run(learning=NOISY)]).axes[1]

    np.testing.assert_array_equal(line(merge, "_never").get_xdata(), [1])
    shown = np.asarray(line(merge, "_plain").get_ydata(), float)
    np.testing.assert_array_equal(shown, [math.nan, math.nan, 0.5, 0.2])


def test_many_iterations_are_drawn(make_run: MakeRun) -> None:
    many = told([(200, 1, 200, 1)] * 150, [0.2] * 150)
    runs = [make_run(name, learning=many, factors=[0.5] * 150) for name in "ab"]

    learning_figure(runs[:1]).draw_without_rendering()
    learning_figure(runs).draw_without_rendering()
