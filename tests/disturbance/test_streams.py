"""The disturbances: their bounds, their moments, the independence of their draws, their words.

The words of Philox 4x32-10 are held against the published known answers of Random123.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.disturbance import compiled_words
from hilc_cli.disturbance.streams import (
    Bounded,
    Distribution,
    Disturbance,
    Triple,
    open_unit_interval,
    philox,
    words_of_samples,
)
from hilc_cli.reference.sampled import Floats

MANY = 20_000
# The draws below are one fixed set of numbers. The limits are set at five standard errors, which
# a right generator passes with a probability of 1 - 6e-7 each for whatever seed one picks.
SIGMAS = 5.0
BOUND: Triple = (1.0, 0.02, 3.0)
DEVIATION: Triple = (0.5, 0.02, 30.0)  # bound / deviation: 2, 1, 0.1
DISTRIBUTIONS: list[Distribution] = ["uniform", "truncated-normal"]


def source(distribution: Distribution, *, repeat: bool = False) -> Bounded:
    return Bounded(BOUND, distribution, DEVIATION, repeat)


def state_draws(distribution: Distribution, seed: int = 7, iteration: int = 3) -> Floats:
    drawn = Disturbance(seed, state=source(distribution)).of_state(iteration, MANY)
    assert drawn is not None
    return drawn


def variance_of(distribution: Distribution, component: int) -> float:
    """The closed form: a^2 / 3, or s^2 (1 - 2 b phi(b) / (2 Phi(b) - 1)) with b = a / s."""
    bound, deviation = BOUND[component], DEVIATION[component]
    if distribution == "uniform":
        return bound**2 / 3
    b = bound / deviation
    inside = 2 * NormalDist().cdf(b) - 1
    return deviation**2 * (1 - 2 * b * NormalDist().pdf(b) / inside)


def probability_below(distribution: Distribution, component: int, value: Floats) -> Floats:
    """The distribution function."""
    bound, deviation = BOUND[component], DEVIATION[component]
    if distribution == "uniform":
        return (value / bound + 1) / 2
    normal = NormalDist(0, deviation)
    low, high = normal.cdf(-bound), normal.cdf(bound)
    return (np.array([normal.cdf(v) for v in value.tolist()]) - low) / (high - low)


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_draws_never_exceed_their_bounds(distribution: Distribution) -> None:
    assert (np.abs(state_draws(distribution)) <= np.array(BOUND)).all()


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_draws_come_near_their_bounds_on_both_sides(distribution: Distribution) -> None:
    # 20,000 draws: the chance that none falls in the outer 1 % of the range is below 1e-8 for the
    # sharpest of the densities here (b = 2, 1.1e-3 of the mass in each outer 1 %).
    drawn = state_draws(distribution) / np.array(BOUND)
    assert (drawn.max(axis=0) > 0.99).all()
    assert (drawn.min(axis=0) < -0.99).all()


@pytest.mark.parametrize("component", [0, 1, 2])
@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_mean_is_zero(distribution: Distribution, component: int) -> None:
    standard_error = math.sqrt(variance_of(distribution, component) / MANY)
    assert abs(state_draws(distribution)[:, component].mean()) < SIGMAS * standard_error


@pytest.mark.parametrize("component", [0, 1, 2])
@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_variance_is_its_closed_form(distribution: Distribution, component: int) -> None:
    variance = variance_of(distribution, component)
    # Var(x^2) = E x^4 - variance^2 <= bound^2 variance - variance^2.
    standard_error = math.sqrt(variance * (BOUND[component] ** 2 - variance) / MANY)
    drawn = state_draws(distribution)[:, component]
    assert abs((drawn**2).mean() - variance) < SIGMAS * standard_error


@pytest.mark.parametrize("component", [0, 1, 2])
@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_distribution_function_is_the_named_one(distribution: Distribution, component: int) -> None:
    # Kolmogorov-Smirnov: sup |F_n - F| sqrt(n) exceeds 2.5 with probability 2 exp(-2 * 2.5^2).
    drawn = np.sort(state_draws(distribution)[:, component])
    gap = probability_below(distribution, component, drawn) - (np.arange(MANY) + 0.5) / MANY
    assert np.abs(gap).max() * math.sqrt(MANY) < 2.5


def test_first_uniform_draw_is_made_of_the_published_words() -> None:
    # Seed 0, state, iteration 0, sample 0: counter and key are all zero, whose words Random123
    # publishes as 6627e8d5 e169c58d bc57ac4c.
    drawn = Disturbance(0, state=Bounded((1.0, 1.0, 1.0))).of_state(0, 1)
    assert drawn is not None
    expected = [(2 * word + 1) / 2**32 - 1 for word in (0x6627E8D5, 0xE169C58D, 0xBC57AC4C)]
    assert drawn[0].tolist() == pytest.approx(expected, abs=1e-15)


def independent(first: Floats, second: Floats) -> bool:
    """Whether the correlation of two columns of draws is that of independent ones."""
    correlation = float(np.corrcoef(first, second)[0, 1])
    return abs(correlation) < SIGMAS / math.sqrt(len(first))


@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (1, 2)])
def test_components_are_independent(pair: tuple[int, int]) -> None:
    drawn = state_draws("uniform")
    assert independent(drawn[:, pair[0]], drawn[:, pair[1]])


@pytest.mark.parametrize("component", [0, 1, 2])
def test_neighboring_samples_are_independent(component: int) -> None:
    drawn = state_draws("uniform")[:, component]
    assert independent(drawn[:-1], drawn[1:])


@pytest.mark.parametrize("component", [0, 1, 2])
def test_iterations_are_independent(component: int) -> None:
    first, second = (state_draws("uniform", iteration=i)[:, component] for i in (3, 4))
    assert independent(first, second)


@pytest.mark.parametrize("component", [0, 1, 2])
def test_seeds_are_independent(component: int) -> None:
    # Seeds that differ in the high key word only, too.
    first, second, third = (
        state_draws("uniform", seed=seed)[:, component] for seed in (1, 2, 1 + 2**32)
    )
    assert independent(first, second)
    assert independent(first, third)


@pytest.mark.parametrize("component", [0, 1, 2])
def test_state_and_output_are_independent(component: int) -> None:
    disturbance = Disturbance(5, state=source("uniform"), output=source("uniform"))
    state, output = disturbance.of_state(2, MANY), disturbance.of_output(2, MANY)
    assert state is not None
    assert output is not None
    assert independent(state[:, component], output[:, component])


def test_initial_poses_are_independent_of_state_and_output() -> None:
    iterations = 2000
    every = source("uniform")
    disturbance = Disturbance(5, state=every, output=every, initial_pose=every)
    poses = np.array([disturbance.of_initial_pose(i) for i in range(iterations)])
    states, outputs = np.empty((2, iterations, 3))
    for i in range(iterations):
        state, output = disturbance.of_state(i, 1), disturbance.of_output(i, 1)
        assert state is not None
        assert output is not None
        states[i], outputs[i] = state[0], output[0]
    for component in range(3):
        assert independent(poses[:, component], states[:, component])
        assert independent(poses[:, component], outputs[:, component])


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_initial_poses_never_exceed_their_bounds(distribution: Distribution) -> None:
    disturbance = Disturbance(5, initial_pose=source(distribution))
    poses = np.array([disturbance.of_initial_pose(i) for i in range(500)])
    assert (np.abs(poses) <= np.array(BOUND)).all()
    assert np.ptp(poses[:, 0]) > BOUND[0]  # and they do differ


def test_repeated_disturbance_is_the_same_in_every_iteration() -> None:
    every = source("uniform", repeat=True)
    disturbance = Disturbance(9, state=every, output=every, initial_pose=every)
    for i in (1, 2, 77):
        np.testing.assert_array_equal(disturbance.of_state(i, 50), disturbance.of_state(0, 50))
        np.testing.assert_array_equal(disturbance.of_output(i, 50), disturbance.of_output(0, 50))
        assert disturbance.of_initial_pose(i) == disturbance.of_initial_pose(0)


def test_repeated_disturbance_still_differs_from_sample_to_sample() -> None:
    drawn = Disturbance(9, state=source("uniform", repeat=True)).of_state(4, 1000)
    assert drawn is not None
    assert len(np.unique(drawn[:, 0])) == 1000


def test_repeat_belongs_to_each_disturbance_alone() -> None:
    disturbance = Disturbance(9, state=source("uniform", repeat=True), output=source("uniform"))
    np.testing.assert_array_equal(disturbance.of_state(1, 10), disturbance.of_state(2, 10))
    first, second = disturbance.of_output(1, 10), disturbance.of_output(2, 10)
    assert first is not None
    assert second is not None
    assert (first != second).all()


@given(
    seed=st.integers(0, 2**64 - 1),
    iteration=st.integers(0, 10**6),
    count=st.integers(1, 60),
    data=st.data(),
    distribution=st.sampled_from(DISTRIBUTIONS),
)
@settings(max_examples=50, deadline=None)
def test_fewer_draws_are_the_first_of_more(
    seed: int, iteration: int, count: int, data: st.DataObject, distribution: Distribution
) -> None:
    fewer = data.draw(st.integers(1, count))
    disturbance = Disturbance(seed, state=source(distribution), output=source(distribution))
    for draw in (disturbance.of_state, disturbance.of_output):
        all_of_them, some = draw(iteration, count), draw(iteration, fewer)
        assert all_of_them is not None
        np.testing.assert_array_equal(some, all_of_them[:fewer])


def test_order_of_drawing_does_not_matter() -> None:
    disturbance = Disturbance(9, state=source("uniform"))
    forward = [disturbance.of_state(i, 5) for i in range(4)]
    backward = [disturbance.of_state(i, 5) for i in reversed(range(4))][::-1]
    np.testing.assert_array_equal(np.array(forward), np.array(backward))


def test_component_without_a_bound_is_not_disturbed() -> None:
    for distribution in DISTRIBUTIONS:
        bounded = Bounded((0.0, 1.0, 0.0), distribution, (0.0, 1.0, 0.0))
        drawn = Disturbance(1, state=bounded).of_state(0, 100)
        assert drawn is not None
        np.testing.assert_array_equal(drawn[:, [0, 2]], 0)
        assert (drawn[:, 1] != 0).all()


def test_no_bound_at_all_means_no_disturbance() -> None:
    disturbance = Disturbance(1)
    assert disturbance.of_state(0, 10) is None
    assert disturbance.of_output(0, 10) is None
    assert disturbance.of_initial_pose(0) == (0.0, 0.0, 0.0)


Words4 = tuple[int, int, int, int]


def words(counter: Words4, key: int) -> list[int]:
    """The four words of one counter."""
    c0, c1, c2, c3 = (np.array([word], dtype=np.uint64) for word in counter)
    return [int(word[0]) for word in philox((c0, c1, c2, c3), key)]


# kat_vectors of Random123, lines "philox4x32 10": counter, key words, result. The low key word
# comes first there.
@pytest.mark.parametrize(
    ("counter", "key_words", "expected"),
    [
        (
            (0, 0, 0, 0),
            (0, 0),
            [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8],
        ),
        (
            (0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF),
            (0xFFFFFFFF, 0xFFFFFFFF),
            [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD],
        ),
        (
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            (0xA4093822, 0x299F31D0),
            [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
        ),
    ],
    ids=["zeros", "ones", "pi"],
)
def test_words_are_the_published_ones(
    counter: Words4, key_words: tuple[int, int], expected: list[int]
) -> None:
    assert words(counter, key_words[0] | key_words[1] << 32) == expected


def test_many_counters_at_once_give_the_words_of_each() -> None:
    zeros = np.zeros(2, dtype=np.uint64)
    first = np.array([0, 7], dtype=np.uint64)
    together = philox((first, zeros, zeros, zeros), 0)
    assert [int(word[0]) for word in together] == words((0, 0, 0, 0), 0)
    assert [int(word[1]) for word in together] == words((7, 0, 0, 0), 0)


def test_smallest_and_largest_word_stay_inside_the_unit_interval() -> None:
    ends = open_unit_interval(np.array([0, 0xFFFFFFFF], dtype=np.uint64))
    assert ends.tolist() == [2.0**-33, 1 - 2.0**-33]


@pytest.mark.parametrize("seed", [0, 7, 2**64 - 1])
@pytest.mark.parametrize(("pass_word", "stream_word"), [(0, 0), (3, 1), (2**31, 2)])
def test_machine_code_draws_the_same_words(seed: int, pass_word: int, stream_word: int) -> None:
    plain = words_of_samples(1000, pass_word, stream_word, seed)
    compiled = compiled_words.words_of_samples(1000, pass_word, stream_word, seed)
    for one, other in zip(plain, compiled, strict=True):
        assert one.tobytes() == other.tobytes()
