"""The paper's trajectories against coordinates worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.reference.paths import paper_reference

PI = math.pi
ROOT = math.sqrt(0.5)

# trajectory, sample, x [m], y [m], heading [rad]: ends, midpoints and quarters of the segments
BY_HAND: list[tuple[str, int, float, float, float]] = [
    ("circle", 0, 10.0, 0.0, PI / 2),
    ("circle", 250, 10 * ROOT, 10 * ROOT, 3 * PI / 4),
    ("circle", 500, 0.0, 10.0, PI),
    ("circle", 1000, -10.0, 0.0, 3 * PI / 2),
    ("circle", 1500, 0.0, -10.0, 2 * PI),
    ("circle", 2000, 10.0, 0.0, 5 * PI / 2),
    ("arc-and-line", 0, 5.0, 0.0, PI / 2),
    ("arc-and-line", 125, 5 * ROOT, 5 * ROOT, 3 * PI / 4),
    ("arc-and-line", 250, 0.0, 5.0, PI),
    ("arc-and-line", 500, -5.0, 0.0, 3 * PI / 2),
    ("arc-and-line", 750, -5.0, -2.5, 3 * PI / 2),
    ("arc-and-line", 1000, -5.0, -5.0, 3 * PI / 2),
    ("arc-and-line", 1500, -5.0, -10.0, 3 * PI / 2),
    ("arc-and-line", 1750, 0.0, -15.0, 2 * PI),
    ("arc-and-line", 2000, 5.0, -10.0, 5 * PI / 2),
    ("arc-and-line", 2500, 5.0, -5.0, 5 * PI / 2),
    ("arc-and-line", 3000, 5.0, 0.0, 5 * PI / 2),
    ("cardioid", 0, 2.5, 0.0, PI / 2),
    ("cardioid", 250, 0.0, 2.5, PI),
    ("cardioid", 500, -2.5, 0.0, 3 * PI / 2),
    ("cardioid", 750, 2.5 - 5 * ROOT, -5 * ROOT, 7 * PI / 4),
    ("cardioid", 1000, 2.5, -5.0, 2 * PI),
    ("cardioid", 1500, 7.5, 0.0, 5 * PI / 2),
    ("cardioid", 1750, 5.0, 2.5, 3 * PI),
    ("cardioid", 2000, 2.5, 0.0, 7 * PI / 2),
    ("spiral", 0, 3.0, 0.0, PI / 2),
    ("spiral", 250, 0.0, 3.0, PI),
    ("spiral", 500, -3.0, 0.0, 3 * PI / 2),
    ("spiral", 750, 0.5, -3.5, 2 * PI),
    ("spiral", 1000, 4.0, 0.0, 5 * PI / 2),
    ("spiral", 1250, 0.0, 4.0, 3 * PI),
    ("spiral", 1500, -4.0, 0.0, 7 * PI / 2),
    ("spiral", 1750, 0.0, -4.0, 4 * PI),
    ("spiral", 2000, 4.0, 0.0, 9 * PI / 2),
]

# trajectory: (samples, radius or None for a line, heading step per sample) of each segment
SHAPES: dict[str, list[tuple[int, float | None, float]]] = {
    "circle": [(2000, 10.0, PI / 1000)],
    "arc-and-line": [
        (500, 5.0, PI / 500),
        (1000, None, 0.0),
        (500, 5.0, PI / 500),
        (1000, None, 0.0),
    ],
    "cardioid": [(500, 2.5, PI / 500), (1000, 5.0, PI / 1000), (500, 2.5, PI / 500)],
    "spiral": [
        (500, 3.0, PI / 500),
        (500, 3.5, PI / 500),
        (500, 4.0, PI / 500),
        (500, 4.0, PI / 500),
    ],
}


@pytest.mark.parametrize(
    ("name", "sample", "x", "y", "heading"),
    BY_HAND,
    ids=[f"{name}-{sample}" for name, sample, *_ in BY_HAND],
)
def test_sample_lies_where_it_was_worked_out_by_hand(
    name: str, sample: int, x: float, y: float, heading: float
) -> None:
    reference = paper_reference(name)
    assert reference.x[sample] == pytest.approx(x, abs=1e-12)
    assert reference.y[sample] == pytest.approx(y, abs=1e-12)
    assert reference.heading[sample] == pytest.approx(heading, abs=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_segments_end_at_the_samples_of_their_durations(name: str) -> None:
    ends = tuple(np.cumsum([samples for samples, _, _ in SHAPES[name]]).tolist())
    reference = paper_reference(name)
    assert reference.segment_ends == ends
    assert reference.samples == ends[-1]


@pytest.mark.parametrize("name", SHAPES)
def test_heading_rises_by_the_known_angle_each_sample_and_never_jumps(name: str) -> None:
    expected = np.concatenate(
        [np.full(samples, increment) for samples, _, increment in SHAPES[name]]
    )
    steps = np.diff(paper_reference(name).heading)
    np.testing.assert_allclose(steps, expected, rtol=0, atol=1e-12)
    assert steps.min() >= 0
    assert steps.max() <= max(increment for _, _, increment in SHAPES[name]) + 1e-12


@pytest.mark.parametrize("name", SHAPES)
def test_every_step_has_the_chord_of_its_arc_or_the_share_of_its_line(name: str) -> None:
    # A chord is 2 r sin(delta / 2); both lines are 10 m long.
    expected = np.concatenate(
        [
            np.full(
                samples,
                10.0 / samples if radius is None else 2 * radius * math.sin(increment / 2),
            )
            for samples, radius, increment in SHAPES[name]
        ]
    )
    reference = paper_reference(name)
    chords = np.hypot(np.diff(reference.x), np.diff(reference.y))
    np.testing.assert_allclose(chords, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", SHAPES)
def test_chord_points_along_the_mean_of_the_headings_at_its_ends(name: str) -> None:
    # The chord of an arc is parallel to the tangent half way: ties heading and position together.
    reference = paper_reference(name)
    middle = (reference.heading[:-1] + reference.heading[1:]) / 2
    across = np.cos(middle) * np.diff(reference.y) - np.sin(middle) * np.diff(reference.x)
    np.testing.assert_allclose(across, 0, atol=1e-13)


@pytest.mark.parametrize("name", ["circle", "arc-and-line", "cardioid"])
def test_closed_trajectory_ends_where_it_starts(name: str) -> None:
    reference = paper_reference(name)
    assert math.dist(
        (reference.x[0], reference.y[0]), (reference.x[-1], reference.y[-1])
    ) == pytest.approx(0, abs=1e-12)


def test_times_run_from_zero_in_steps_of_the_sample_time() -> None:
    reference = paper_reference("circle")
    assert reference.times[[0, 1, 2000]] == pytest.approx([0.0, 0.001, 2.0], abs=1e-15)


@pytest.mark.parametrize(
    ("name", "size"), [("circle", 20.0), ("arc-and-line", 20.0), ("cardioid", 10.0)]
)
def test_size_is_the_longer_side_of_the_bounding_box(name: str, size: float) -> None:
    # arc-and-line reaches from y = -15 to 5, the cardioid from x = -2.5 to 7.5.
    assert paper_reference(name).size == pytest.approx(size, abs=1e-12)
