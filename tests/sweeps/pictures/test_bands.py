from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from hilc_cli.sweeps.data import Bands
from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.sweeps.pictures.metric_axis import ZERO_LABEL
from tests.drawing.reading import legend, line, texts
from tests.made_up_sweeps import L1, RATES, bowl, sweep

INF, NAN = math.inf, math.nan


def drawn(quantiles: list[list[float]], cases: list[float] | None = None) -> Figure:
    counts = [5.0] * len(quantiles) if cases is None else cases
    bands = Bands(np.array(counts), np.array(quantiles))
    return draw_sweep("bands", sweep({L1: RATES}, bowl, bands=bands))


def test_median_and_bands_over_the_iterations() -> None:
    figure = drawn([[1, 2, 3, 4, 5], [0.1, 0.2, 0.3, 0.4, 0.5]])
    (axes,) = figure.axes
    np.testing.assert_array_equal(line(axes, "Median").get_xdata(), [0, 1])
    np.testing.assert_array_equal(line(axes, "Median").get_ydata(), [3, 0.3])
    wide, middle = (band.get_paths()[0].get_extents() for band in axes.collections)
    assert (wide.y0, wide.y1, middle.y0, middle.y1) == (0.1, 5, 0.2, 4)
    assert axes.get_yscale() == "log"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Iteration", "Maximum position error [m]")
    assert legend(axes) == ["5 to 95 %", "25 to 75 %", "Median"]


def test_infinite_ends_leave_the_panel_at_the_top() -> None:
    figure = drawn([[1, 2, 3, 4, 5], [1, 2, 3, INF, INF], [1, 2, INF, INF, INF], [INF] * 5])
    (axes,) = figure.axes
    tops = [band.get_paths()[0].get_extents().y1 for band in axes.collections]
    assert min(tops) > axes.get_ylim()[1]
    shown = np.asarray(line(axes, "Median").get_ydata(), float)
    assert np.isnan(shown).tolist() == [False, False, True, True]
    assert "half of the cases have diverged in iteration 2" in texts(figure)
    assert axes.get_ylim()[1] < 100


def test_number_of_cases_is_shown_if_it_changes() -> None:
    figure = drawn([[1, 2, 3, 4, 5]] * 3, [9, 9, 4])
    above, below = figure.axes
    (steps,) = below.lines
    np.testing.assert_array_equal(steps.get_ydata(), [9, 9, 4])
    assert (above.get_xlabel(), below.get_xlabel()) == ("", "Iteration")
    assert above.get_xlim() == below.get_xlim()
    box, panel = (
        each.get_window_extent() for each in (above.get_legend(), below) if each is not None
    )
    assert box.y1 < panel.y0


def test_iterations_without_any_case() -> None:
    figure = drawn([[1, 2, 3, 4, 5], [NAN] * 5], [5, 0])
    shown = np.asarray(line(figure.axes[0], "Median").get_ydata(), float)
    np.testing.assert_array_equal(shown, [3, NAN])


def test_exactly_zero_is_marked() -> None:
    (axes,) = drawn([[1, 2, 3, 4, 5], [0, 0, 0, 1, 2]]).axes
    np.testing.assert_array_equal(np.asarray(line(axes, ZERO_LABEL).get_xdata()), [1])
    assert axes.collections[0].get_paths()[0].get_extents().y0 < axes.get_ylim()[0]


def test_nothing_is_finite() -> None:
    (axes,) = drawn([[INF] * 5, [NAN] * 5]).axes
    assert list(axes.get_yticks()) == []


def test_many_iterations_are_thinned() -> None:
    (axes,) = drawn([[1, 2, 3, 4, 5]] * 20_001).axes
    assert 3000 < len(np.asarray(line(axes, "Median").get_xdata())) <= 5000
    assert axes.get_xlim()[1] > 20_000
