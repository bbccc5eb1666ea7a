from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes

from hilc_cli.errors import UsageError
from hilc_cli.scenario.sweep_section import Robust
from hilc_cli.sweeps.data import OwnValues, SweepData
from hilc_cli.sweeps.pictures.catalogue import draw_sweep, kinds_for
from hilc_cli.variation import Axis, Range
from tests.drawing.reading import overlaps
from tests.made_up_sweeps import FAILED, L1, L2, SEED, WORDS, bowl, numbers, sweep

RADIUS = "robot.wheel_radius"
RADII = numbers(0.1, 0.2, 0.3)
GAINS = Range(0.1, 10.0, "log", 5)


def over(
    axes: dict[str, Axis], metric: list[float] | None = None, robust: Robust = "worst"
) -> SweepData:
    given = bowl if metric is None else np.array(metric)
    return replace(sweep(axes, given), over=(RADIUS,), robust=robust)


def line(axes: Axes, label: str) -> np.ndarray:
    (found,) = [each for each in axes.lines if each.get_label() == label]
    return np.asarray(found.get_xydata(), dtype=float)


def test_kinds_are_those_of_the_choices() -> None:
    assert kinds_for(over({L1: GAINS, RADIUS: RADII})) == ("curve", "spread")
    two: dict[str, Axis] = {L1: GAINS, L2: numbers(0.0, 1.0), RADIUS: RADII}
    assert kinds_for(over(two)) == ("map", "effects", "spread")
    three: dict[str, Axis] = {**two, "controller.h": numbers(1, 2)}
    assert kinds_for(over(three)) == ("best", "effects", "spread")
    searched = replace(over({L1: GAINS, RADIUS: RADII}), as_it_is=OwnValues({L1: 1.0}, 3.0))
    assert kinds_for(searched) == ("curve", "spread", "search")
    with pytest.raises(UsageError, match=r"needs keys that happen; name them in 'sweep\.over'"):
        draw_sweep("spread", sweep({L1: GAINS}, bowl))


METRIC = [3, 4, 5, 2, 3, 4, 1, 2, 3, 5, 6, math.inf, 7, FAILED, 8]


@pytest.mark.parametrize(("robust", "best"), [("worst", 3.0), ("q95", 2.9), ("mean", 2.0)])
def test_figures_along_the_only_key(robust: Robust, best: float) -> None:
    figure = draw_sweep("spread", over({L1: GAINS, RADIUS: RADII}, METRIC, robust))
    (axes,) = figure.axes
    gains = [0.1, 10**-0.5, 1, 10**0.5, 10]
    expected = {
        "Worst case": [5, 4, 3, math.nan, math.nan],
        "95 % quantile": [4.9, 3.9, 2.9, math.nan, math.nan],
        "Mean": [4, 3, 2, math.nan, math.nan],
    }
    for label, values in expected.items():
        np.testing.assert_allclose(line(axes, label), np.transpose([gains, values]))
    np.testing.assert_allclose(line(axes, "Best"), [[1, best]])
    assert line(axes, "Diverged (1 case)")[0, 0] == pytest.approx(10**0.5)
    assert line(axes, "Failed (1 case)")[0, 0] == pytest.approx(10)
    words = {"worst": "worst case", "q95": "95 % quantile", "mean": "mean"}[robust]
    assert axes.get_title(loc="left").startswith(f"Smallest {words} over wheel_radius: {best:g} m")
    assert not overlaps(figure)


def test_curve_is_that_of_the_figure() -> None:
    figure = draw_sweep("curve", over({L1: GAINS, RADIUS: RADII}, METRIC))
    (axes,) = figure.axes
    assert axes.get_title(loc="left") == "Best: 3 m at l1 = 1 (choice 2)"
    assert axes.get_ylabel().startswith("Worst maximum position error")
    values = line(axes, "_curve")[:, 1]
    np.testing.assert_array_equal(values[np.isfinite(values)], [5, 4, 3])


def test_map_is_that_of_the_figure() -> None:
    axes: dict[str, Axis] = {L1: GAINS, L2: Range(0.0, 2.0, "linear", 3), RADIUS: RADII}
    figure = draw_sweep("map", over(axes))
    (mesh,) = figure.axes[0].collections
    expected = [
        [max(bowl({L1: g, L2: l2, RADIUS: r}) for r in (0.1, 0.2, 0.3)) for g in GAINS.ladder()]
        for l2 in (0.0, 1.0, 2.0)
    ]
    found = np.asarray(mesh.get_array(), dtype=float).reshape(3, 5)
    np.testing.assert_allclose(found, np.array(expected))


def test_best_ones_side_by_side_if_there_are_several_keys() -> None:
    axes: dict[str, Axis] = {L1: Range(0.0, 2.0, "linear", 20), L2: GAINS, RADIUS: RADII}
    figure = draw_sweep("spread", over(axes))
    (panel,) = figure.axes
    worst = line(panel, "Worst case")
    assert len(worst) == 40 and (np.diff(worst[:, 1]) >= 0).all()
    assert worst[:, 0].tolist() == list(range(1, 41))
    assert line(panel, "Best").tolist() == [worst[0].tolist()]
    assert not overlaps(figure)


@pytest.mark.parametrize("axis", [WORDS, Range(1, 5, "integer")])
def test_words_and_seeds_are_chosen_too(axis: Axis) -> None:
    key = "controller.gain_heading" if axis is WORDS else SEED
    figure = draw_sweep("spread", over({key: axis, RADIUS: RADII}))
    assert not overlaps(figure)


def test_nothing_has_a_value() -> None:
    figure = draw_sweep("spread", over({L1: GAINS, RADIUS: RADII}, [math.inf] * 15))
    (axes,) = figure.axes
    assert axes.get_title(loc="left").startswith("No choice has a value of the worst maximum")
    assert "Best" not in [each.get_label() for each in axes.lines]
