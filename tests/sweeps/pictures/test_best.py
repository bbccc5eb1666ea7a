from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.figure import Figure

from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.variation import Range
from tests.drawing.reading import line, texts
from tests.made_up_sweeps import (
    HEADING,
    L1,
    L2,
    L3,
    RATES,
    SEED,
    SEEDS,
    STEPS,
    WORDS,
    bowl,
    number,
    sweep,
)


def values(figure: Figure, column: int) -> list[str]:
    return [text.get_text() for text in figure.axes[column].texts]


def test_rows_are_the_ten_best_cases() -> None:
    data = sweep({L1: RATES, L2: STEPS, HEADING: WORDS}, bowl)
    figure = draw_sweep("best", data)
    best = data.ranked()[:10]
    metric, first, second, words = figure.axes
    names = [text.get_text() for text in metric.get_yticklabels()]
    assert names == [f"{rank}.  case {case}" for rank, case in enumerate(best, 1)]
    np.testing.assert_array_equal(
        line(metric, "_best").get_xdata(), data.columns["max_position_error_m"][best]
    )
    np.testing.assert_array_equal(
        line(first, "_best").get_xdata(), [data.values[L1][c] for c in best]
    )
    np.testing.assert_array_equal(line(second, "_best").get_ydata(), np.arange(10))
    assert values(figure, 3) == [data.values[HEADING][case] for case in best]
    assert (first.get_title(), words.get_title()) == ("l1", "gain_heading")
    assert first.get_xscale() == "log"
    assert first.yaxis_inverted()
    assert "Smallest maximum position error after the last iteration" in texts(figure)


def test_ends_of_a_range_are_those_given() -> None:
    ranges = {L1: Range(0.1, 10, "log"), L2: Range(0.0, 2.0), L3: Range(-1.0, 1.0)}
    figure = draw_sweep("best", sweep(ranges, bowl, "random", 30))
    metric, *shown = [[text.get_text() for text in axes.get_xticklabels()] for axes in figure.axes]
    assert shown == [["0.1", "10"], ["0", "2"], ["\N{MINUS SIGN}1", "1"]]
    drawn = np.asarray(line(figure.axes[0], "_best").get_xdata(), float)
    assert metric == [f"{drawn.min():.3g}", f"{drawn.max():.3g}"]


def test_ends_that_are_close_together_are_told_apart() -> None:
    data = sweep({L1: RATES, L2: STEPS}, np.linspace(1.0, 1.000024, 25))
    shown = [text.get_text() for text in draw_sweep("best", data).axes[0].get_xticklabels()]
    assert shown == ["1", "1.00001"]


def test_seeds_are_summed_up() -> None:
    data = sweep(
        {L1: RATES, L2: STEPS, L3: STEPS, SEED: SEEDS},
        lambda case: bowl(case) + number(case[SEED]),
    )
    figure = draw_sweep("best", data)
    assert values(figure, 0)[0] == "5.01"
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()][:2] == ["1.", "2."]
    assert "Smallest median over the seeds of the maximum position error" in texts(figure)


@pytest.mark.parametrize(("finite", "rows"), [(0, 0), (1, 1), (4, 4)])
def test_few_cases_have_a_value(finite: int, rows: int) -> None:
    metric = np.r_[np.arange(1.0, finite + 1), np.full(75 - finite, math.inf)]
    figure = draw_sweep("best", sweep({L1: RATES, L2: STEPS, HEADING: WORDS}, metric))
    assert len(values(figure, 1)) == rows
    assert ("No case has a value" in texts(figure)) == (rows == 0)


def test_keys_with_the_largest_effects_are_shown() -> None:
    axes = {f"controller.gains.l{n}": Range(0.0, 1.0) for n in range(14)}
    data = sweep(
        axes,
        lambda case: sum(n * number(value) for n, value in enumerate(case.values())),
        "random",
        4000,
    )
    figure = draw_sweep("best", data)
    shown = [axes.get_title().replace("\n", "") for axes in figure.axes[1:]]
    assert shown == [f"l{n}" for n in range(2, 14)]
    assert "2 keys with smaller effects are left out" in texts(figure)
