from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.sweeps.pictures.metric_axis import metric_scale


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
