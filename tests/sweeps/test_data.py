"""What is known of all cases: quantiles, of any length and diverged, and who shares the best."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as npst

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.data import QUANTILES, bands, collect, summarise_sweep, tied
from hilc_cli.variation import Cases, Choices, Range
from tests.made_up_sweeps import FAILED, L1, sweep


@given(npst.arrays(np.float64, st.integers(1, 40), elements=st.floats(0, 1e9)))
def test_quantiles_are_those_of_numpy(errors: Floats) -> None:
    found = bands([errors])
    expected = np.quantile(errors, QUANTILES)
    np.testing.assert_allclose(found.quantiles[0], expected, rtol=1e-12, atol=1e-300)
    assert found.cases.tolist() == [len(errors)]


INF, NAN = math.inf, math.nan


@pytest.mark.parametrize(
    ("errors", "cases", "quantiles"),
    [
        ([3.0], 1, [3, 3, 3, 3, 3]),
        ([0.0, 1, 2, 3, 4], 5, [0.2, 1, 2, 3, 3.8]),
        # Position 3.8 lies between 3 and infinity, position 3 does not.
        ([0.0, INF, 2, 3, 1], 5, [0.2, 1, 2, 3, INF]),
        ([INF, INF, 1, INF], 4, [INF, INF, INF, INF, INF]),
        ([1.0, 2, INF], 3, [1.1, 1.5, 2, INF, INF]),
        ([INF, INF], 2, [INF] * 5),
        ([NAN, 1, NAN, 3], 2, [1.1, 1.5, 2, 2.5, 2.9]),
        ([NAN, NAN], 0, [NAN] * 5),
        ([], 0, [NAN] * 5),
    ],
)
def test_diverged_cases_are_infinite_and_shorter_ones_do_not_count(
    errors: list[float], cases: int, quantiles: list[float]
) -> None:
    found = bands([np.array(errors, dtype=np.float64)])
    assert found.cases.tolist() == [cases]
    if errors == [INF, INF, 1, INF]:
        assert found.quantiles[0].tolist() == quantiles
    np.testing.assert_allclose(found.quantiles[0], quantiles, rtol=1e-12)


def test_results_stand_beside_the_values_of_their_cases() -> None:
    cases = Cases({"a": Choices((1, 2)), "b": Choices(("x", None))})
    rows = np.arange(4.0 * len(CASE_COLUMNS)).reshape(4, -1)
    data = collect("name", cases, rows, None, 0.5, "peak_max_position_error_m", 20.0)
    assert (len(data), data.is_grid, data.bands) == (4, True, None)
    assert data.case(2) == {"a": 2, "b": "x"}
    for index, column in enumerate(CASE_COLUMNS):
        assert data.columns[column].tolist() == rows[:, index].tolist()


@pytest.mark.parametrize(
    ("metric", "cases"),
    [
        ([3.0, 1, 2], [1]),
        ([3.0, 1, 2, 1], [1, 3]),
        ([1 + 9e-7, 1, 1 + 2e-6], [0, 1]),
        ([0.0, 1e-9, 0.0], [0, 2]),
        ([math.inf, 2, FAILED, 2, math.nan], [1, 3]),
        ([math.inf, math.nan], []),
    ],
)
def test_cases_that_share_the_best_metric(metric: list[float], cases: list[int]) -> None:
    data = sweep({L1: Range(0.0, 1.0, "linear", len(metric))}, np.array(metric))
    assert tied(data).tolist() == cases
    summary = summarise_sweep(data)
    assert summary.tied == len(cases)
    assert [best.case in cases for best in summary.best[: len(cases)]] == [True] * len(cases)
