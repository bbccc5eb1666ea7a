from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.variation import Axis, Range
from tests.drawing.reading import line, lines, texts
from tests.made_up_sweeps import HEADING, L1, L2, L3, SEED, SEEDS, STEPS, WORDS, bowl, number, sweep


def test_panels_are_sorted_by_the_spread_of_their_medians() -> None:
    data = sweep(
        {L1: STEPS, L2: STEPS, L3: STEPS, SEED: SEEDS},
        lambda case: number(case[L1]) + 9 * number(case[L2]) + 3 * number(case[L3]),
    )
    panels = draw_sweep("effects", data).axes
    assert [axes.get_xlabel() for axes in panels] == ["l2", "l3", "l1"]
    medians = [np.asarray(line(axes, "Median").get_ydata(), float) for axes in panels]
    # The other keys' medians are those of their middle values, 1 each.
    np.testing.assert_allclose(medians[0], 9 * np.linspace(0, 2, 5) + 4)
    np.testing.assert_allclose(medians[2], np.linspace(0, 2, 5) + 12)
    assert len({axes.get_ylim() for axes in panels}) == 1
    assert panels[0].get_ylabel().startswith("Maximum position error")
    assert panels[1].get_ylabel() == ""


def test_band_is_the_middle_half() -> None:
    data = sweep({L1: STEPS, L2: STEPS, L3: STEPS}, lambda case: number(case[L2]) + 1)
    figure = draw_sweep("effects", data)
    (band,) = figure.axes[1].collections
    box = band.get_paths()[0].get_extents()
    assert (box.y0, box.y1) == (1.5, 2.5)
    assert [text.get_text() for text in figure.legends[0].get_texts()][:3] == [
        "Cases",
        "25 to 75 %",
        "Median",
    ]


def test_drawn_cases_are_taken_together_in_bins() -> None:
    axes: dict[str, Axis] = {L1: Range(0.1, 10, "log"), L2: Range(0.0, 1.0), HEADING: WORDS}
    data = sweep(axes, lambda case: number(case[L1]), "random", 9000)
    panels = draw_sweep("effects", data).axes
    median = line(panels[0], "Median")
    assert len(np.asarray(median.get_xdata())) == 20
    np.testing.assert_allclose(
        np.asarray(median.get_ydata(), float), np.asarray(median.get_xdata(), float), rtol=0.05
    )
    dots = line(panels[0], "Cases")
    assert len(np.asarray(dots.get_xdata())) == 5000
    assert dots.get_rasterized()


def test_few_drawn_cases_are_taken_together_too() -> None:
    ranges = {L1: Range(0.1, 10), L2: Range(0.0, 1.0), L3: Range(0.0, 1.0)}
    panels = draw_sweep("effects", sweep(ranges, bowl, "random", 30)).axes
    assert {len(np.asarray(line(axes, "Median").get_xdata())) for axes in panels} == {3}


def test_words_have_a_place_each() -> None:
    data = sweep(
        {L1: STEPS, L2: STEPS, HEADING: WORDS}, lambda case: float(len(str(case[HEADING])))
    )
    axes = draw_sweep("effects", data).axes[0]
    assert [text.get_text() for text in axes.get_xticklabels()] == list(WORDS.values)
    np.testing.assert_array_equal(line(axes, "Median").get_ydata(), [8, 8, 9])


def test_twelve_panels_at_most() -> None:
    axes = {f"controller.gains.l{n}": Range(0.0, 1.0) for n in range(15)}
    data = sweep(axes, lambda case: number(case[L1]), "random", 100)
    figure = draw_sweep("effects", data)
    assert len(figure.axes) == 12
    assert figure.axes[0].get_xlabel() == "l1"
    assert "3 keys with smaller effects are left out" in texts(figure)


def test_diverged_cases_count_as_the_worst() -> None:
    data = sweep(
        {L1: STEPS, L2: STEPS, L3: STEPS},
        lambda case: math.inf if number(case[L2]) > 1 else 1 + number(case[L3]),
    )
    panels = draw_sweep("effects", data).axes
    assert panels[0].get_xlabel() == "l2"
    shown = np.asarray(line(panels[0], "Median").get_ydata(), float)
    assert np.isnan(shown).tolist() == [False, False, False, True, True]
    np.testing.assert_allclose(
        np.asarray(line(panels[0], "Diverged (50 cases)").get_xdata(), float), [1.5, 2]
    )
    assert lines(panels[1], "Diverged (50 cases)")


@pytest.mark.parametrize("top", [1.0, 0.00123, 123456.0])
def test_ticks_of_neighbours_do_not_meet(top: float) -> None:
    axes: dict[str, Axis] = {f"l{n}": Range(-top, top, "linear", 3) for n in range(3)}
    figure = draw_sweep("effects", sweep(axes, np.arange(27.0)))
    figure.draw_without_rendering()
    boxes = [
        label.get_window_extent()
        for panel in figure.axes
        for label in panel.get_xticklabels()
        if label.get_text()
    ]
    assert len(boxes) >= 3
    assert all(one.x1 + 2 < other.x0 for one, other in pairwise(boxes))
