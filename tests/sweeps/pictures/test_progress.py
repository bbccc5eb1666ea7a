from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.sweeps.data import OwnValues, SweepData
from hilc_cli.sweeps.pictures.catalogue import draw_sweep, kinds_for
from tests.drawing.reading import overlaps
from tests.made_up_sweeps import FAILED, L1, L2, RATES, STEPS, sweep

METRIC = np.array([3.0, math.inf, 2.0, 2.5, FAILED, 1.0, math.nan, 1.5, 4.0])


def searched(as_it_is: float = 3.5, metric: np.ndarray = METRIC) -> SweepData:
    data = sweep({L1: RATES, L2: STEPS}, metric, "random", len(metric))
    return replace(data, as_it_is=OwnValues({L1: 1.0, L2: None}, as_it_is))


def test_search_has_a_picture_of_its_own() -> None:
    data = searched()
    assert kinds_for(data) == ("map", "search")
    with pytest.raises(UsageError, match=r"picture 'search' needs a search; set 'sweep\.minimise'"):
        draw_sweep("search", replace(data, as_it_is=None))


def test_best_so_far_beside_the_scenario_as_it_is() -> None:
    figure = draw_sweep("search", searched())
    (axes,) = figure.axes
    lines = {str(line.get_label()): line for line in axes.lines}
    assert axes.get_title(loc="left") == "Best: 1 m (case 5)"
    np.testing.assert_array_equal(lines["Best so far"].get_ydata(), [3, 3, 2, 2, 2, 1, 1, 1, 1])
    np.testing.assert_array_equal(lines["Scenario as it is"].get_ydata(), [3.5, 3.5])
    dots = np.asarray(lines["Cases"].get_ydata(), dtype=float)
    np.testing.assert_array_equal(dots[np.isfinite(dots)], [3, 2, 2.5, 1, 1.5, 4])
    np.testing.assert_array_equal(lines["Best"].get_xydata(), [[5, 1]])
    marks = {"Diverged (1 case)": [1], "Failed (1 case)": [4], "Never reached (1 case)": [6]}
    for label, at in marks.items():
        np.testing.assert_array_equal(lines[label].get_xdata(), at)
    assert not overlaps(figure)


def test_scenario_without_a_metric_has_no_line() -> None:
    figure = draw_sweep("search", searched(math.nan))
    assert "Scenario as it is" not in [line.get_label() for line in figure.axes[0].lines]


def test_nothing_was_found() -> None:
    figure = draw_sweep("search", searched(2.0, np.full(4, math.nan)))
    labels = [line.get_label() for line in figure.axes[0].lines]
    assert "Best" not in labels and "Scenario as it is" in labels
    assert not overlaps(figure)
