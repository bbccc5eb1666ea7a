"""Lines with few points are where the eye cannot tell them from the whole ones."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray

from hilc_cli.html_reports.thinning import thinned
from hilc_cli.reference.sampled import Floats


def off(lines: Floats, samples: NDArray[np.int64]) -> float:
    """How far straight lines through some samples are off at most."""
    every = np.arange(lines.shape[1])
    return max(
        float(np.abs(np.interp(every, samples, line[samples]) - line).max()) for line in lines
    )


def test_straight_lines_need_their_ends_alone() -> None:
    lines = np.array([np.linspace(0, 1e6, 500), np.linspace(3, -1e6, 500)])
    found = thinned(lines, 100)
    assert found.samples.tolist() == [0, 499]
    assert found.deviation == pytest.approx(0, abs=1e-8)


def test_a_jump_keeps_the_samples_around_it() -> None:
    line = np.where(np.arange(100) < 40, 0.0, 50.0)
    assert thinned(line[None], 100).samples.tolist() == [0, 39, 40, 99]


def test_a_circle_needs_as_many_points_as_its_sagitta_says() -> None:
    # A chord of the angle a leaves a circle of radius r by r (1 - cos(a / 2)).
    radius = 750.0  # in what is just seen
    angle = np.linspace(0, 2 * np.pi, 3001)
    lines = radius * np.array([np.cos(angle), np.sin(angle)])
    found = thinned(lines, 3000)
    fewest = 2 * math.pi / (2 * math.acos(1 - 1 / radius))
    assert fewest <= len(found.samples) - 1 <= 2 * fewest
    assert off(lines, found.samples) <= 1


@given(
    st.lists(st.tuples(*[st.floats(-50, 50)] * 2), min_size=1, max_size=60),
    st.integers(min_value=2, max_value=80),
)
def test_whatever_is_thinned_is_as_near_as_it_says(
    points: list[tuple[float, float]], most: int
) -> None:
    lines = np.array(points).T
    found = thinned(lines, most)
    last = lines.shape[1] - 1
    assert {0, last} <= set(found.samples.tolist()) <= set(range(last + 1))
    assert len(found.samples) <= most
    assert (np.diff(found.samples) > 0).all()
    assert off(lines, found.samples) == pytest.approx(found.deviation, abs=1e-9)
    assert found.deviation <= 1 or len(found.samples) == most
