"""Which iterations keep their samples."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given, strategies as st

from hilc_cli.scenario.record import recorded_iterations


@given(last=st.integers(0, 10**6))
def test_automatic_choice_has_the_first_and_the_last(last: int) -> None:
    kept = recorded_iterations("auto", last)
    assert {0, last} <= kept
    assert min(kept) == 0
    assert max(kept) == last


@given(last=st.integers(0, 10**6))
def test_automatic_choice_has_the_first_few_all(last: int) -> None:
    assert set(range(min(last, 4) + 1)) <= recorded_iterations("auto", last)


def test_automatic_choice_is_bounded_for_a_long_run() -> None:
    assert len(recorded_iterations("auto", 100_000)) <= 26


@given(last=st.integers(0, 10**6))
def test_automatic_choice_is_never_more_than_a_screenful(last: int) -> None:
    assert len(recorded_iterations("auto", last)) <= 26


def test_automatic_choice_leaves_no_wide_gap_in_the_ratio() -> None:
    # 19 ratios from 5 to 100,000: about 1.73 each.
    kept = sorted(recorded_iterations("auto", 100_000))
    late = [iteration for iteration in kept if iteration >= 5]
    assert max(after / before for before, after in pairwise(late)) < 2


@pytest.mark.parametrize("last", [0, 1, 5, 23])
def test_automatic_choice_keeps_all_of_a_short_run(last: int) -> None:
    assert recorded_iterations("auto", last) == frozenset(range(last + 1))


def test_all_are_all() -> None:
    assert recorded_iterations("all", 500) == frozenset(range(501))


def test_list_gains_the_first_and_the_last() -> None:
    assert recorded_iterations([3, 7], 10) == frozenset({0, 3, 7, 10})


def test_empty_list_keeps_the_first_and_the_last() -> None:
    assert recorded_iterations([], 10) == frozenset({0, 10})


def test_run_of_one_iteration_keeps_it_once() -> None:
    assert recorded_iterations([0], 0) == frozenset({0})
