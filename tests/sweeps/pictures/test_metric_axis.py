from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.results.metrics import CASE_METRICS, ITERATIONS_TO_TOLERANCE
from hilc_cli.sweeps.pictures.metric_axis import metric_label, metric_scale, metric_text
from tests.made_up_sweeps import L1, RATES, bowl, sweep


@pytest.mark.parametrize(
    ("values", "is_logarithmic"),
    [
        (np.linspace(1, 29, 9), False),
        (np.linspace(1, 31, 9), True),
        (np.geomspace(1, 4.9, 9), False),
        (np.geomspace(1, 20, 9), True),
        ([0.024, 0.03, 0.04, 0.05, 0.57], True),  # one outlier
        ([0.024, 0.5, 0.51, 0.52, 0.57], False),  # one that is better than all others
        ([0.0, 0.03, 0.04, 0.05, 0.57], False),
        ([0.0, 0.01, 0.04, 0.05, 0.57], True),
        ([1.0, 1.0, 1.0, 1.1], False),
        ([1.0, 1.0, 1.0, np.inf, np.nan], False),
        ([-1.0, 1.0, 100.0], False),
    ],
)
def test_scale_is_logarithmic_where_a_linear_one_would_show_good_cases_as_the_same(
    values: list[float], is_logarithmic: bool
) -> None:
    assert metric_scale(np.asarray(values)).is_logarithmic == is_logarithmic


@pytest.mark.parametrize("outlier", [0.2, 0.6, 2.0])
def test_good_cases_keep_their_share_of_the_scale(outlier: float) -> None:
    good = np.linspace(0.02, 0.06, 20)
    scale = metric_scale(np.append(good, outlier))
    ends = np.array([good[0], good[-1]])
    shown = np.log(ends) if scale.is_logarithmic else ends
    low, high = scale.low, scale.high
    whole = np.log(high / low) if scale.is_logarithmic else high - low
    # ln 3 / ln (outlier / 0.02) of a logarithmic one, 0.04 / (outlier - 0.02) of a linear one
    assert np.ptp(shown) / whole > 0.23


@pytest.mark.parametrize("metric", CASE_METRICS)
def test_every_metric_has_words_and_a_unit(metric: str) -> None:
    label = metric_label(sweep({L1: RATES}, bowl, column=metric), 10.0)
    assert label[0].isupper()
    assert "_" not in label
    for ending, unit in (("_m", "[m]"), ("_rad", "[rad]"), ("_rad_s", "[rad/s]")):
        assert metric.endswith(ending) == label.endswith(unit)


def test_the_tolerance_is_named() -> None:
    data = sweep({L1: RATES}, np.ones(5), column=ITERATIONS_TO_TOLERANCE)
    assert metric_label(data, 10.0) == "Iterations until the error stays below 0.01 m"
    assert metric_text(data, 7.0) == "7 iterations"
    assert metric_text(sweep({L1: RATES}, bowl), 0.123456) == "0.1235 m"
