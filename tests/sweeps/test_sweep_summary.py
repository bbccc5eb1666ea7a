from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.sweeps.summary import summarise_sweep, tied
from hilc_cli.variation.axes import Range
from tests.made_up_sweeps import FAILED, L1, sweep


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
