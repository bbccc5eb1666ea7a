from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.axes import Axes

from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.sweeps.pictures.distribution import SHARE
from hilc_cli.variation import Range
from tests.drawing.reading import legend, line, overlaps, texts
from tests.made_up_sweeps import FAILED, SEED, SEEDS, number, sweep


def distribution(data: SweepData) -> Axes:
    figure = draw_sweep("curve", data)
    assert overlaps(figure) == []
    return figure.axes[0]


def test_shares_rise_with_the_values_in_any_order_of_the_seeds() -> None:
    data = sweep({SEED: Range(1, 4, "integer")}, np.array([3.0, 1.0, 4.0, 2.0]))
    axes = distribution(data)
    shown = np.asarray(line(axes, SHARE).get_xydata(), float)
    np.testing.assert_array_equal(shown[1:-1], [[1, 25], [2, 50], [3, 75], [4, 100]])
    assert shown[0, 1] == 0 and shown[-1, 1] == 100
    assert line(axes, SHARE).get_drawstyle() == "steps-post"
    assert axes.get_xlabel() == "Maximum position error after the last iteration [m]"
    assert axes.get_ylabel() == "Share of the cases [%]"


def test_bands_and_title_tell_the_quantiles() -> None:
    axes = distribution(
        sweep({SEED: Range(0, 100, "integer")}, lambda case: 100 + number(case[SEED]))
    )
    title = "Median 150 m, quantiles of 5 and 95 % 105 and 195"
    assert axes.get_title(loc="left") == title
    assert legend(axes) == ["5 to 95 %", "25 to 75 %", "Median", SHARE]
    assert line(axes, "Median").get_xdata() == [150, 150]
    boxes = [patch.get_extents().transformed(axes.transData.inverted()) for patch in axes.patches]
    np.testing.assert_allclose([(box.x0, box.x1) for box in boxes], [(105, 195), (125, 175)])


def test_values_that_hardly_differ_are_told_apart() -> None:
    axes = distribution(sweep({SEED: SEEDS}, lambda case: 0.3425 + 1e-6 * number(case[SEED])))
    assert axes.get_title(loc="left") == (
        "Median 0.342505 m, quantiles of 5 and 95 % 0.342501 and 0.342509"
    )


def test_cases_without_a_value_are_told_of_and_failed_ones_do_not_count() -> None:
    metric = np.array([1.0, 2, 3, math.inf, FAILED])
    figure = draw_sweep("curve", sweep({SEED: Range(1, 5, "integer")}, metric))
    shown = np.asarray(line(figure.axes[0], SHARE).get_ydata(), float)
    np.testing.assert_array_equal(shown, [0, 25, 50, 75, 75])
    assert "not in the curve: Failed (1 case), Diverged (1 case)" in texts(figure)


@pytest.mark.parametrize("value", [math.inf, FAILED, 0.0, 2.0])
def test_cases_that_are_all_alike(value: float) -> None:
    figure = draw_sweep("curve", sweep({SEED: SEEDS}, np.full(9, value)))
    figure.draw_without_rendering()
    median = np.isfinite(value) and value >= 0
    title = f"Median {value:g} m" if median else "Half of the cases or more have no value"
    assert title in texts(figure)
