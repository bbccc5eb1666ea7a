from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.results.metrics import CASE_METRICS, ITERATIONS_TO_TOLERANCE
from hilc_cli.sweeps.pictures.key_axis import shortened_words, value_text
from hilc_cli.sweeps.pictures.metric_axis import metric_label, metric_text
from hilc_cli.variation.axes import Value
from tests.made_up_sweeps import L1, RATES, bowl, sweep


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "null"),
        (True, "true"),
        (180, "180"),
        (1234567, "1234567"),
        (2**63, "9.223e18"),
        (0.123456, "0.1235"),
        ("measured", "measured"),
        ("w" * 30, "w" * 11 + "…" + "w" * 12),
    ],
)
def test_values(value: Value, text: str) -> None:
    assert value_text(value) == text


def test_words_lose_first_what_they_have_in_common() -> None:
    assert shortened_words(["same-1", "same-2"], 6) == ["same-1", "same-2"]
    assert shortened_words(["same-1", "same-2"], 4) == ["…1", "…2"]
    assert shortened_words(["same-1.csv", "same-12.csv"], 5) == ["…1…", "…12…"]
    assert shortened_words(["aaab", "aab"], 3) == ["…ab", "…b"]
    assert shortened_words(["abcdefgh"], 4) == ["a…gh"]


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
