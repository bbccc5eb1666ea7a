"""Errors over the second half of a trajectory, from numbers that are easy to see."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.second_half import second_half
from hilc_cli.results.trial import Trial


def trial(x: Floats, y: Floats) -> Trial:
    n = len(x) - 1
    return Trial(0, x, y, np.zeros(n + 1), np.zeros(n), np.zeros(n))


@pytest.mark.parametrize(
    ("errors", "largest", "mean"),
    [
        ([9, 9, 2, 1, 3], 3, 2),  # n = 4: samples 2 to 4
        ([9, 9, 9, 2, 1, 3], 3, 2),  # n = 5: samples 3 to 5
        ([9, 4], 4, 4),  # n = 1
    ],
)
def test_samples_from_the_middle_on_count(errors: list[float], largest: int, mean: int) -> None:
    size = np.array(errors, dtype=np.float64)
    nothing = np.zeros(len(size))
    reference = Reference("path", 0.1, nothing, nothing, nothing)
    # 3-4-5 triangles.
    found = second_half(trial(-0.6 * size, 0.8 * size), reference)
    assert found.max_position_error_m == pytest.approx(largest, rel=1e-15)
    assert found.mean_position_error_m == pytest.approx(mean, rel=1e-15)


def test_errors_beyond_all_numbers_are_infinite() -> None:
    far = np.array([0.0, 1e200, 1e308])
    nothing = np.zeros(3)
    found = second_half(trial(far, -far), Reference("path", 0.1, nothing, nothing, nothing))
    assert found.max_position_error_m > 1e308
