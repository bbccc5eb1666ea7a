from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE
from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.sweeps.pictures.heat_map import Cells
from hilc_cli.sweeps.pictures.picking import Groups, Outcome
from hilc_cli.variation import Axis, Range
from tests.drawing.reading import legend, line, texts
from tests.made_up_sweeps import (
    FAILED,
    L1,
    L2,
    RATES,
    SEED,
    SEEDS,
    SPEED,
    STEPS,
    bowl,
    number,
    numbers,
    sweep,
)


def mesh(figure: Figure) -> QuadMesh:
    (found,) = [each for each in figure.axes[0].collections if isinstance(each, QuadMesh)]
    return found


def test_cells_are_the_metric_at_their_place() -> None:
    data = sweep({L1: numbers(0, 1, 3), SPEED: numbers(1, 2)}, bowl)
    figure = draw_sweep("map", data)
    cells, axes = mesh(figure), figure.axes[0]
    corners = np.asarray(cells.get_coordinates())
    np.testing.assert_array_equal(corners[0, :, 0], [-0.5, 0.5, 2, 4])
    np.testing.assert_array_equal(corners[:, 0, 1], [0.5, 1.5, 2.5])
    expected = [[0.01 + (x - 1) ** 2 + (y - 1) ** 2 for x in (0, 1, 3)] for y in (1, 2)]
    np.testing.assert_allclose(np.asarray(cells.get_array()).reshape(2, 3), expected)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("l1", "b_w [rad/s]")
    assert axes.get_title(loc="left") == "Best: 0.01 m at l1 = 1, b_w = 1 (case 2)"
    best = line(axes, "Best")
    assert np.asarray(best.get_xydata()).tolist() == [[1, 1]]
    assert figure.axes[1].get_ylabel() == "Maximum position error after the last iteration [m]"


@pytest.mark.parametrize("outcome", Outcome)
def test_an_outline_is_around_all_cells_of_an_outcome_and_no_other(outcome: Outcome) -> None:
    random = np.random.default_rng(3)
    found = random.choice(len(Outcome), (7, 9), p=[0.4, 0.3, 0.2, 0.1])
    x, y = np.cumsum(random.random(10)), np.cumsum(random.random(8))
    cells = Cells(x, y, Groups(found.ravel(), np.zeros((63, 5)), found.ravel()), (1, 1))
    outline = cells.outline(outcome)
    runs = [np.diff(row == outcome, prepend=False, append=False).sum() // 2 for row in found]
    assert len(np.asarray(outline.codes)) == 5 * sum(runs)
    centres = np.stack(np.meshgrid((x[:-1] + x[1:]) / 2, (y[:-1] + y[1:]) / 2), axis=-1)
    inside = outline.contains_points(centres.reshape(-1, 2)).reshape(7, 9)
    np.testing.assert_array_equal(inside, found == outcome)


def test_scales_are_logarithmic_where_the_numbers_are() -> None:
    figure = draw_sweep("map", sweep({L1: RATES, L2: STEPS}, bowl))
    assert (figure.axes[0].get_xscale(), figure.axes[0].get_yscale()) == ("log", "linear")
    assert isinstance(mesh(figure).norm, LogNorm)
    edges = np.log10(np.asarray(mesh(figure).get_coordinates())[0, :, 0])
    np.testing.assert_allclose(edges, np.linspace(-1.25, 1.25, 6))
    narrow = draw_sweep("map", sweep({L1: RATES, L2: STEPS}, lambda case: number(case[L1]) + 5))
    assert not isinstance(mesh(narrow).norm, LogNorm)


def test_cells_without_a_metric_have_a_pattern_each() -> None:
    metric = np.array([1.0, math.inf, math.inf, 2.0, FAILED, math.nan])
    figure = draw_sweep("map", sweep({L1: numbers(1, 2), L2: numbers(1, 2, 3)}, metric))
    axes = figure.axes[0]
    labels = ["Diverged (2 cells)", "Never reached (1 cell)", "Failed (1 cell)"]
    assert legend(axes) == [*labels, "Best"]
    patches = {patch.get_label(): patch for patch in axes.patches}
    assert len({patches[label].get_hatch() for label in labels}) == 3
    diverged = patches[labels[0]].get_path().get_extents()
    assert (diverged.x0, diverged.x1, diverged.y0, diverged.y1) == (0.5, 1.5, 1.5, 3.5)
    shown = np.ma.getmaskarray(np.ma.asarray(mesh(figure).get_array())).reshape(3, 2)
    assert shown.tolist() == [[False, False], [True, True], [True, True]]


@pytest.mark.parametrize("value", [math.inf, FAILED])
def test_no_cell_has_a_value(value: float) -> None:
    figure = draw_sweep("map", sweep({L1: STEPS, L2: STEPS}, np.full(25, value)))
    assert figure.axes[0].get_title(loc="left") == "No case has a value"
    assert len(figure.axes) == 1  # no colour bar


def test_seeds_are_summed_up() -> None:
    def metric(case: object) -> float:
        assert isinstance(case, dict)
        return math.inf if case[L1] == 3 and case[SEED] >= 5 else float(case[SEED] + case[L1])

    axes: dict[str, Axis] = {L1: numbers(1, 2, 3), L2: numbers(1, 2), SEED: SEEDS}
    figure = draw_sweep("map", sweep(axes, metric))
    array: Any = np.ma.asarray(mesh(figure).get_array()).reshape(2, 3)
    assert array.tolist() == [[6, 7, None], [6, 7, None]]
    assert "Diverged (2 cells)" in legend(figure.axes[0])
    assert figure.axes[1].get_ylabel().startswith("Median over the seeds of the maximum")
    assert figure.axes[0].get_title(loc="left") == "Best median: 6 m at l1 = 1, l2 = 1"


def test_drawn_cases_are_coloured_dots() -> None:
    ranges = {L1: Range(0.1, 10, "log"), L2: Range(0.0, 2.0)}
    data = sweep(ranges, bowl, "sobol", 64)
    data.columns["diverged"][:4] = 1
    axes = draw_sweep("map", data).axes[0]
    dots = next(
        each
        for each in axes.collections
        if isinstance(each, PathCollection) and each.get_label() == "_cases"
    )
    shown = np.asarray(dots.get_offsets())
    values = np.asarray(dots.get_array())
    assert len(shown) == 60
    expected = 0.01 + (shown[:, 0] - 1) ** 2 + (shown[:, 1] - 1) ** 2
    np.testing.assert_allclose(values, expected)
    assert np.all(np.diff(values) <= 0)  # the best ones on top
    assert legend(axes) == ["Diverged (4 cases)", "Best"]


def test_more_values_than_pixels_share_cells() -> None:
    many = Range(0.0, 1.0, "linear", 700)
    metric = np.tile([1.0, 2.0], 700)
    figure = draw_sweep("map", sweep({L1: many, L2: numbers(1, 2)}, metric))
    array = np.asarray(mesh(figure).get_array()).reshape(2, -1)
    assert array.shape == (2, 234)
    assert (array == [[1], [2]]).all()
    assert "median of 3 x 1 values" in texts(figure)


def test_zero_on_a_logarithmic_scale_is_told_of() -> None:
    figure = draw_sweep("map", sweep({L1: RATES, L2: STEPS}, np.r_[0.0, np.geomspace(1, 1e4, 24)]))
    assert "1 exactly zero" in texts(figure)
    assert np.asarray(mesh(figure).get_array()).min() == 1


def test_colour_bar_of_less_than_a_decade_has_plain_numbers() -> None:
    figure = draw_sweep("map", sweep({L1: RATES, L2: STEPS}, lambda case: number(case[L1]) + 1.2))
    assert isinstance(mesh(figure).norm, LogNorm)
    bar = figure.axes[1].yaxis
    assert all(text.get_text() == "" for text in bar.get_minorticklabels())
    assert all(float(text.get_text()) > 0 for text in bar.get_majorticklabels())
    assert len(bar.get_majorticklabels()) >= 3


def test_tolerance_is_a_line_around_the_cells_that_keep_it() -> None:
    data = sweep({L1: numbers(0, 1, 2), L2: numbers(0, 1)}, np.array([9.0, 1, 2, 3, 9, 9]))
    figure = draw_sweep("map", replace(data, tolerance=2.0))
    points = np.asarray(line(figure.axes[0], "Tolerance, 2 m").get_xydata(), float)
    edges = {frozenset(map(tuple, edge)) for edge in points.reshape(-1, 3, 2)[:, :2].tolist()}
    # Within are l1 = 0 with l2 = 1, and l1 = 1 with l2 = 0.
    upright = [((0.5, -0.5), (0.5, 0.5)), ((0.5, 0.5), (0.5, 1.5)), ((1.5, -0.5), (1.5, 0.5))]
    lying = [((-0.5, 0.5), (0.5, 0.5)), ((0.5, 0.5), (1.5, 0.5))]
    assert edges == {frozenset(edge) for edge in [*upright, *lying]}
    for tolerance, note in ((10.0, "all cells are within 10 m"), (0.5, "no cell is within 0.5 m")):
        assert note in texts(draw_sweep("map", replace(data, tolerance=tolerance)))


def test_errors_beyond_the_size_of_the_path_share_a_colour_at_an_arrow() -> None:
    data = sweep({L1: RATES, L2: STEPS}, np.geomspace(1, 1e9, 25))
    figure = draw_sweep("map", replace(data, path_size=20.0))
    cells, bar = mesh(figure), figure.axes[1]
    assert (cells.norm.vmin, cells.norm.vmax) == (1, 20)
    colors = cells.cmap(cells.norm(np.array([20.0, 21.0, 1e9])))
    assert np.array_equal(colors[1], colors[2]) and not np.array_equal(colors[0], colors[1])
    assert f"{np.sum(np.geomspace(1, 1e9, 25) > 20)} values are above 20 m, the path's size" in (
        texts(figure)
    )
    assert bar.get_ylim() == (1, 20)
    whole = sweep({L1: RATES, L2: STEPS}, np.arange(25.0), column=ITERATIONS_TO_TOLERANCE)
    counts = mesh(draw_sweep("map", replace(whole, path_size=20.0)))
    assert counts.norm.vmax == 24  # which are no lengths
