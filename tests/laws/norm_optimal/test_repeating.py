"""What comes back in each pass, told apart from what does not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.repeating import Repeating
from hilc_cli.reference.sampled import Floats

N = 64


def repeating(leftovers: Floats, sent: Floats | None = None, most: int = 16) -> Floats:
    """What is expected to come back after some passes, if no inputs are given of all alike."""
    passes, n, _ = leftovers.shape
    kept = Repeating(n, most)
    inputs = np.zeros((min(passes, most), n, 2))
    for number, own in enumerate(leftovers):
        kept.put(number % most, own.T[None])
        if sent is not None:
            inputs[number % most] = sent[number]
    return kept.expected(inputs, (passes - 1) % most)


def wave(half_waves: int) -> Floats:
    """A cosine of power one along the path."""
    angles = math.pi * half_waves * (np.arange(N) + 0.5) / N
    unit: Floats = np.cos(angles) * math.sqrt((2 if half_waves else 1) / N)
    return unit


def test_one_pass_tells_nothing() -> None:
    assert not repeating(np.ones((1, N, 3))).any()


@pytest.mark.parametrize("passes", [3, 7])
def test_what_all_passes_have_is_expected(passes: int) -> None:
    common = np.random.default_rng(1).normal(size=(N, 3))
    assert repeating(np.array([common] * passes)) == pytest.approx(common, abs=1e-12)


def test_from_two_passes_slow_waves_alone_are_expected() -> None:
    slow, fast = wave(15), wave(16)
    both = np.tile((slow + fast)[:, None], (1, 3))
    expected = np.tile(slow[:, None], (1, 3))
    assert repeating(np.array([both, both])) == pytest.approx(expected, abs=1e-12)


def test_what_changes_its_sign_is_not_expected() -> None:
    own = np.random.default_rng(1).normal(size=(N, 3))
    found = repeating(np.array([own, -own, own, -own]))
    assert found == pytest.approx(np.zeros((N, 3)), abs=1e-12)


def test_mixture_is_shrunk_by_its_powers() -> None:
    # Two waves of one octave: what comes back, and what has either sign in half of the passes.
    common, own = 3.0 * wave(9), 1.0 * wave(13)
    passes = np.zeros((4, N, 3))
    passes[:, :, 0] = [common + own, common - own, common + own, common - own]
    passes[:, :, 2] = [common, common, common, common]
    # c = (4 |mean|^2 - 10) / 3 with |mean|^2 = 9, and each pass has 10 - c of its own.
    repeated = 26 / 3
    share = repeated / (repeated + (10 - repeated) / 4)
    found = repeating(passes)
    assert found[:, 0] == pytest.approx(share * common, abs=1e-12)
    assert found[:, 1].any() == 0
    assert found[:, 2] == pytest.approx(common, abs=1e-12)


def test_octaves_do_not_lend_each_other_their_power() -> None:
    slow, fast = 10 * wave(1), 0.1 * wave(40)
    passes = np.zeros((4, N, 3))
    passes[:, :, 1] = [slow + fast, slow - fast, slow + fast, slow - fast]
    assert repeating(passes)[:, 1] == pytest.approx(slow, abs=1e-12)


def test_noise_is_shrunk_on_average() -> None:
    random = np.random.default_rng(3)
    found = np.array([repeating(random.normal(size=(8, N, 3))) for _ in range(50)])
    # The mean of eight passes has an eighth of the power; most of that is seen through.
    assert np.square(found).mean() < 0.4 / 8


@pytest.mark.parametrize("n", [1, 2, 3])
def test_short_paths(n: int) -> None:
    assert repeating(np.ones((3, n, 3))) == pytest.approx(np.ones((n, 3)))


def driven(*speeds: float) -> Floats:
    """Inputs of passes that are driven evenly [rad/s]."""
    return np.tile(np.array(speeds)[:, None, None], (1, N, 2))


def test_passes_that_were_driven_alike_count_alike() -> None:
    leftovers = np.random.default_rng(2).normal(size=(5, N, 3))
    alike = repeating(leftovers, driven(*[3.0] * 5))
    np.testing.assert_array_equal(alike, repeating(leftovers))


def test_a_pass_that_was_driven_otherwise_does_not_mislead() -> None:
    # A first pass far off leaves another motion beyond the model than all that come after it.
    rest = np.tile(np.random.default_rng(3).normal(size=N)[:, None], (1, 3))
    leftovers = np.array([-4 * rest, rest, rest, rest])
    found = repeating(leftovers, driven(9.0, 3.0, 3.01, 3.0))
    assert np.abs(found - rest).max() < 0.02 * np.abs(rest).max()
    # The plain mean of all four is not even of its sign.
    assert leftovers.mean(axis=0) == pytest.approx(-0.25 * rest)


def test_noise_is_averaged_though_inputs_differ() -> None:
    # What differs by chance alone tells nothing of the inputs: all passes are made use of.
    random = np.random.default_rng(4)
    common = np.tile(wave(5)[:, None] * 4, (1, 3))
    off, off_last = [], []
    for _ in range(40):
        leftovers = common + random.normal(size=(8, N, 3))
        found = repeating(leftovers, driven(*random.normal(3.0, 0.5, 8)))
        off.append(np.square(found - common).sum())
        off_last.append(np.square(leftovers[-1] - common).sum())
    assert np.mean(off) < 0.25 * np.mean(off_last)


def test_inputs_that_come_nearer_are_followed() -> None:
    # The motion beyond the model goes with the input, which settles as learning does.
    inputs = [3.0 + 2.0**-k for k in range(7)]
    shape = np.tile(wave(2)[:, None], (1, 3))
    leftovers = np.array([shape * speed for speed in inputs])
    found = repeating(leftovers, driven(*inputs))
    last, mean = shape * inputs[-1], leftovers.mean(axis=0)
    assert np.abs(found - last).max() < 0.2 * np.abs(mean - last).max()


def test_a_pass_takes_the_place_of_an_older_one() -> None:
    random = np.random.default_rng(5)
    leftovers, sent = random.normal(size=(11, N, 3)), random.normal(3.0, 0.5, (11, N, 2))
    last = repeating(leftovers[-4:], sent[-4:])
    assert repeating(leftovers, sent, most=4) == pytest.approx(last, abs=1e-12)
    kept = Repeating(N, 4)
    for own in leftovers[4:8]:
        kept.put(0, own.T[None])
    kept.put(0, leftovers[:4].transpose(0, 2, 1))
    expected = repeating(leftovers[:4], sent[:4])
    assert kept.expected(sent[:4], 3) == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_growth_is_the_likeliest_of_those_that_are_tried() -> None:
    # Restricted maximum likelihood as it stands in textbooks, with matrices.
    random = np.random.default_rng(6)
    passes, low, high = 5, 8, 16
    inputs = random.normal(3.0, 0.5, (passes, N, 2))
    squares = np.square(inputs - inputs[-1]).mean(axis=(1, 2))
    differences = squares / squares.mean()
    amplitudes = random.normal(size=(passes, high - low)) * (1 + 3 * differences[:, None])
    leftovers = np.zeros((passes, N, 3))
    leftovers[:, :, 1] = amplitudes @ np.array([wave(k) for k in range(low, high)])
    one = np.ones(passes)
    best, expected = np.inf, np.zeros(high - low)
    for growth in [0.0, *np.logspace(-1, 4, 26)]:
        inverse = np.diag(1 / (1 + growth * differences))
        total = one @ inverse @ one
        centre = inverse - np.outer(inverse @ one, inverse @ one) / total
        power = np.trace(amplitudes.T @ centre @ amplitudes) / (passes - 1)
        unlikely = (high - low) * (
            (passes - 1) * math.log(power) - np.linalg.slogdet(inverse)[1] + math.log(total)
        ) + (math.log10(max(growth, 1e-2)) - 0.3) ** 2
        if unlikely < best:
            mean = one @ inverse @ amplitudes / total
            square = float(mean @ mean)
            best, expected = unlikely, mean * max(1 - power / total / square, 0.0)
    found = np.array([wave(k) for k in range(low, high)]) @ repeating(leftovers, inputs)[:, 1]
    assert expected.any()
    assert found == pytest.approx(expected, rel=1e-9)


def test_the_fastest_waves_come_back_too() -> None:
    # 100 samples have waves beyond the last power of two.
    common = np.random.default_rng(7).normal(size=(100, 3))
    assert repeating(np.array([common] * 3)) == pytest.approx(common, abs=1e-12)
