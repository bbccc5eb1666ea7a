from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.axes import Axes

from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.sweeps.pictures.metric_axis import ZERO_LABEL
from hilc_cli.variation import Choices, Range
from tests.drawing.reading import legend, line, lines, texts
from tests.made_up_sweeps import (
    FAILED,
    HEADING,
    L1,
    RATES,
    SEED,
    SEEDS,
    SPEED,
    STEPS,
    WORDS,
    bowl,
    number,
    numbers,
    sweep,
)


def curve(data: SweepData) -> Axes:
    (axes,) = draw_sweep("curve", data).axes
    return axes


def top_of_data(axes: Axes) -> float:
    """Height of the highest point, of the panel's height."""
    highest = max(np.nanmax(np.asarray(each.get_ydata(), float)) for each in lines(axes, "_curve"))
    return float(axes.transAxes.inverted().transform(axes.transData.transform((1, highest)))[1])


def test_line_is_the_metric_in_the_order_of_the_key() -> None:
    axes = curve(sweep({L1: numbers(1.5, 0.5, 1.0)}, bowl))
    shown = line(axes, "_curve")
    np.testing.assert_array_equal(shown.get_xdata(), [0.5, 1, 1.5])
    np.testing.assert_allclose(np.asarray(shown.get_ydata()), [0.26, 0.01, 0.26])
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "linear")
    assert axes.get_xlabel() == "l1"
    assert axes.get_ylabel() == "Maximum position error after the last iteration [m]"
    assert axes.get_title(loc="left") == "Best: 0.01 m at l1 = 1 (case 2)"
    best = line(axes, "Best")
    assert np.asarray(best.get_xydata()).tolist() == [[1, 0.01]]


def test_axes_are_logarithmic_where_the_numbers_are() -> None:
    axes = curve(sweep({L1: RATES}, lambda case: number(case[L1]) ** 2))
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert curve(sweep({SPEED: RATES}, bowl)).get_xlabel() == "b_w [rad/s]"


def test_cases_without_a_metric_lie_above_the_others() -> None:
    metric = np.array([2.0, math.inf, FAILED, 4.0, math.inf])
    axes = curve(sweep({L1: STEPS}, metric))
    assert legend(axes) == ["Failed (1 case)", "Diverged (2 cases)", "Best"]
    np.testing.assert_allclose(np.asarray(line(axes, "Diverged (2 cases)").get_xdata()), [0.5, 2])
    np.testing.assert_allclose(np.asarray(line(axes, "Failed (1 case)").get_xdata()), [1])
    heights = [np.min(line(axes, label).get_ydata()) for label in legend(axes)[:2]]
    assert min(heights) > top_of_data(axes)
    assert heights[0] != heights[1]
    assert len({str(line(axes, label).get_marker()) for label in legend(axes)}) == 3
    shown = np.asarray(line(axes, "_curve").get_ydata())
    assert np.isnan(shown).tolist() == [False, True, True, False, True]


def test_tolerance_never_reached() -> None:
    metric = np.array([3.0, math.nan, 5, math.nan, math.inf])
    axes = curve(sweep({L1: STEPS}, metric, column=ITERATIONS_TO_TOLERANCE))
    assert legend(axes) == ["Diverged (1 case)", "Never reached (2 cases)", "Best"]
    assert axes.get_ylabel() == "Iterations until the error stays below 0.01 m"
    assert axes.get_title(loc="left") == "Best: 3 iterations at l1 = 0 (case 0)"


def test_zero_on_a_logarithmic_axis_is_marked_at_the_bottom() -> None:
    axes = curve(sweep({L1: STEPS}, np.array([0.0, 1e-3, 1, 10, 0])))
    np.testing.assert_array_equal(np.asarray(line(axes, ZERO_LABEL).get_xdata()), [0, 2])
    assert 0 < np.max(line(axes, ZERO_LABEL).get_ydata()) < 0.1
    assert np.max(line(axes, "Best").get_ydata()) < 0.1
    np.testing.assert_array_equal(axes.get_ylim()[0] > 0, True)


@pytest.mark.parametrize("value", [math.inf, FAILED, math.nan])
def test_no_case_has_a_value(value: float) -> None:
    axes = curve(sweep({L1: STEPS}, np.full(5, value)))
    assert axes.get_title(loc="left") == "No case has a value"
    assert list(axes.get_yticks()) == []
    assert lines(axes, "Best") == []


def test_words_are_places_on_the_axis() -> None:
    axes = curve(sweep({SPEED: Choices((None, 100, 180))}, np.array([1.0, 3, 2])))
    assert [text.get_text() for text in axes.get_xticklabels()] == ["null", "100", "180"]
    assert line(axes, "_curve").get_linestyle() == "None"
    np.testing.assert_array_equal(line(axes, "_curve").get_xdata(), [0, 1, 2])
    assert axes.get_title(loc="left") == "Best: 1 m at b_w = null (case 0)"


def test_seeds_are_summed_up() -> None:
    data = sweep({L1: STEPS, SEED: SEEDS}, lambda case: number(case[L1]) + number(case[SEED]))
    axes = curve(data)
    np.testing.assert_allclose(np.asarray(line(axes, "Median").get_ydata()), 5 + np.arange(5) / 2)
    assert legend(axes) == ["5 to 95 %", "25 to 75 %", "Median", "Best"]
    wide, middle = (band.get_paths()[0].get_extents() for band in axes.collections)
    assert (wide.y0, wide.y1) == (pytest.approx(1.4), pytest.approx(10.6))
    assert (middle.y0, middle.y1) == (pytest.approx(3), pytest.approx(9))
    assert axes.get_title(loc="left") == "Best median: 5 m at l1 = 0"


def test_band_leaves_the_panel_where_seeds_diverge() -> None:
    def metric(case: object) -> float:
        assert isinstance(case, dict)
        return math.inf if case[L1] == 2 and case[SEED] > 6 else 1.0 + case[SEED]

    axes = curve(sweep({L1: STEPS, SEED: SEEDS}, metric))
    tops = [band.get_paths()[0].get_extents().y1 for band in axes.collections]
    assert min(tops) > axes.get_ylim()[1]
    assert np.isfinite(np.asarray(line(axes, "Median").get_ydata(), float)).all()
    assert "Diverged (3 cases)" in legend(axes)


def test_one_curve_for_each_word() -> None:
    axes = curve(sweep({L1: RATES, HEADING: WORDS}, bowl))
    names = [f"gain_heading = {word}" for word in WORDS.values]
    assert legend(axes) == [*names, "Best"]
    for name, word in zip(names, WORDS.values, strict=True):
        rates = 10.0 ** np.linspace(-1, 1, 5)
        expected = 0.01 + (rates - 1) ** 2 + len(str(word))
        np.testing.assert_allclose(np.asarray(line(axes, name).get_ydata()), expected)
    assert len({str(line(axes, name).get_color()) for name in names}) == 3
    assert len({str(line(axes, name).get_marker()) for name in names}) == 3
    assert axes.get_title(loc="left").startswith("Best: 8.01 m at l1 = 1, gain_heading = measured")


@pytest.mark.parametrize("keys", [(SPEED, HEADING), (HEADING, SPEED)])
def test_the_key_with_fewer_words_gives_the_curves(keys: tuple[str, str]) -> None:
    words = {SPEED: Choices((None, 100)), HEADING: WORDS}
    axes = curve(sweep({key: words[key] for key in keys}, bowl))
    assert legend(axes) == ["b_w = null", "b_w = 100", "Best"]
    assert axes.get_xlabel() == "gain_heading"


def test_drawn_cases_are_dots() -> None:
    axes = curve(sweep({L1: Range(0.5, 2.0)}, bowl, "random", 50))
    assert len(np.asarray(line(axes, "Cases").get_xdata())) == 50
    assert lines(axes, "Median") == []
    many = curve(sweep({L1: Range(0.5, 2.0)}, bowl, "random", 6000))
    assert len(np.asarray(line(many, "Cases").get_xdata())) == 5000
    median = line(many, "Median")
    assert len(np.asarray(median.get_xdata())) == 20
    at = np.asarray(median.get_xdata(), float)
    expected = 0.01 + (at - 1) ** 2
    # The median of 300 places in a bin of 0.075 is off by 0.002; the slope is 2 at most.
    np.testing.assert_allclose(np.asarray(median.get_ydata(), float), expected, atol=0.016)


def test_values_far_above_the_others_are_told_of() -> None:
    figure = draw_sweep("curve", sweep({L1: STEPS}, np.array([1.0, 2, 3, 1e90, 1e140])))
    assert "2 values are above 1e6 m" in texts(figure)
    assert figure.axes[0].get_ylim()[1] < 1e9


def test_best_is_in_view_also_beside_bands() -> None:
    metric = np.random.default_rng(2).lognormal(size=3000)
    metric[7] = 1e-9
    axes = curve(sweep({L1: Range(0.0, 1.0, "linear", 3000)}, metric))
    assert axes.get_ylim()[0] < 1e-9
    assert np.asarray(line(axes, "Best").get_xydata())[0, 1] == 1e-9


def test_points_of_words_lie_side_by_side_and_on_the_star() -> None:
    words, curves = Choices(("on", "off", "auto")), Choices((True, False))
    axes = curve(sweep({HEADING: words, SPEED: curves}, np.array([1.0, 1, 2, 2, 3, 3])))
    true, false, best = (line(axes, name) for name in ("b_w = true", "b_w = false", "Best"))
    places = [np.asarray(each.get_xdata(), float) for each in (true, false)]
    np.testing.assert_allclose(places[0] + places[1], [0, 2, 4])
    shown = axes.transData.transform(np.column_stack([np.concatenate(places), np.ones(6)]))[:, 0]
    gap = (shown[3:] - shown[:3]) / axes.figure.dpi * 72
    assert (gap > 1.5 * true.get_markersize()).all()
    np.testing.assert_array_equal(best.get_xydata(), [[places[0][0], 1]])
    assert best.get_zorder() < true.get_zorder()
    assert best.get_markersize() > 2 * true.get_markersize()
    assert [text.get_text() for text in axes.get_xticklabels()] == ["on", "off", "auto"]
    np.testing.assert_array_equal(axes.get_xticks(), [0, 1, 2])


def test_many_points_of_many_words_stay_with_their_word() -> None:
    words = Choices(tuple(f"word-{number}" for number in range(30)))
    curves = Choices(tuple("abcdefgh"))
    axes = curve(sweep({HEADING: words, SPEED: curves}, np.arange(240.0)))
    for name in "abcdefgh":
        places = np.asarray(line(axes, f"b_w = {name}").get_xdata(), float)
        assert np.abs(places - np.arange(30)).max() < 0.5
