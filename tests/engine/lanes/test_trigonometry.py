"""The branch-free cosine and sine against the library's, to units in the last place."""

import math

import numpy as np
import pytest

from hilc_cli.engine.lanes.headings import RENEWAL
from hilc_cli.engine.lanes.machine_code import compiled
from hilc_cli.engine.lanes.trigonometry import (
    LARGEST,
    SHORT_TURN,
    cos_sin_near_zero,
    reduced,
    rotated,
    short_turn,
    turned,
)
from hilc_cli.reference.sampled import Floats

# As in the engine: fused products and sums round differently from Python's.
REDUCED, NEAR_ZERO, TURNED = (compiled(part) for part in (reduced, cos_sin_near_zero, turned))
SHORT, ROTATED = compiled(short_turn), compiled(rotated)


def cos_sin(angle: float) -> tuple[float, float]:
    rest, shifted = REDUCED(angle)
    cos, sin = TURNED(*NEAR_ZERO(rest), shifted)
    return cos, sin


def many(angles: Floats) -> tuple[Floats, Floats]:
    pairs = [cos_sin(angle) for angle in angles.tolist()]
    cosines, sines = zip(*pairs, strict=True)
    return np.array(cosines), np.array(sines)


def ulps(found: Floats, exact: "np.ndarray[tuple[int], np.dtype[np.longdouble]]") -> float:
    """Largest error in units in the last place of the exact value."""
    error = np.abs(found.astype(np.longdouble) - exact)
    return float((error / np.spacing(np.abs(exact).astype(np.float64))).max())


@pytest.mark.parametrize(
    "angles",
    [
        np.linspace(-LARGEST, LARGEST, 100_001),
        np.linspace(-10, 10, 40_001),
        # Beside multiples of a quarter of pi, where the pieces meet or a result is near zero.
        np.arange(-12_000, 12_001) * (np.pi / 4),
        np.nextafter(np.arange(-12_000, 12_001) * (np.pi / 4), np.inf),
        np.array([0.0, -0.0, 5e-324, 1e-300, -1e-18]),
    ],
    ids=["wide", "near", "quarters", "beside quarters", "tiny"],
)
def test_error_is_at_most_two_units_in_the_last_place(angles: Floats) -> None:
    cosines, sines = many(angles)
    exact = angles.astype(np.longdouble)
    assert ulps(cosines, np.cos(exact)) <= 2
    assert ulps(sines, np.sin(exact)) <= 2


def test_headings_beyond_reason_still_give_a_direction() -> None:
    for angle in (1e9, -1e12, 1e300, math.inf):
        cos, sin = cos_sin(angle)
        assert math.hypot(cos, sin) == pytest.approx(1, abs=1e-6)


def test_short_turns_are_right_to_rounding() -> None:
    for turn in np.linspace(-SHORT_TURN, SHORT_TURN, 2001).tolist():
        less, sine, sine_by_turn = SHORT(turn)
        assert less == pytest.approx(-2 * math.sin(turn / 2) ** 2, rel=1e-15, abs=1e-300)
        assert sine == pytest.approx(math.sin(turn), rel=1e-15, abs=1e-300)
        assert sine_by_turn == pytest.approx(math.sin(turn) / turn if turn else 1, rel=1e-15)


@pytest.mark.parametrize("bias", [0.0, SHORT_TURN / 2])
def test_rounding_adds_up_to_little_before_headings_are_computed_anew(bias: float) -> None:
    draw = np.random.default_rng(1)
    worst = 0.0
    for _ in range(200):
        heading = draw.uniform(-10, 10)
        cos, sin = math.cos(heading), math.sin(heading)
        for turn in bias + draw.uniform(-SHORT_TURN / 2, SHORT_TURN / 2, RENEWAL):
            before, heading = heading, heading + turn
            less, sine, _ = SHORT(heading - before)
            cos, sin = ROTATED(cos, sin, less, sine)
        worst = max(worst, abs(cos - math.cos(heading)), abs(sin - math.sin(heading)))
    # A walk of 256 roundings of both, each of up to half a unit: some sixteen halves is usual.
    assert worst < 40 * 2.0**-53
