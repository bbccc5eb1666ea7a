"""Learning that goes back where it made passes worse."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hilc_cli.laws.norm_optimal.safeguard import Learned, Safeguard


def learned(number: float) -> Learned:
    return Learned(np.full(6, number), np.full((4, 3), number))


def used(guard: Safeguard, errors: Sequence[float]) -> list[float]:
    """What the next passes are planned from, where the i-th from 1 on has told i."""
    found = [guard.next(error, learned(number)) for number, error in enumerate(errors, start=1)]
    assert all(np.all(each.beside == each.parameters[0]) for each in found)
    return [float(each.parameters[0]) for each in found]


def test_learning_that_gets_better_is_left_alone() -> None:
    guard = Safeguard(learned(0))
    assert used(guard, [900, 50, 7, 4, 2.5, 2.9, 0.2, 0.9, 0.1]) == list(range(1, 10))
    assert (guard.share, guard.returns) == (1, 0)


def test_one_bad_pass_is_bad_luck() -> None:
    guard = Safeguard(learned(0))
    used(guard, [5, 5, 6, 40, 5, 6, 45, 5, 5])
    assert guard.returns == 0


def test_what_does_not_count_as_an_error_is_never_worse() -> None:
    guard = Safeguard(learned(0))
    used(guard, [0.001, 0.001, 0.001, 0.8, 0.9, 0.9, 0.4, 0.7])
    assert guard.returns == 0


def test_it_goes_back_to_the_best_and_takes_half_steps_from_there() -> None:
    guard = Safeguard(learned(0))
    # The fourth pass, with the least error, ran on what the first three had told.
    assert used(guard, [9, 6, 5, 4, 5, 39, 38]) == [1, 2, 3, 4, 5, 6, 3]
    assert (guard.share, guard.returns) == (0.5, 1)
    found = [guard.next(5, learned(number)).parameters[0] for number in (5, 6, 6)]
    assert found == [4, 5, 5.5]


def test_robot_that_has_changed_for_good_is_gone_back_for_no_more() -> None:
    guard = Safeguard(learned(0))
    # To the best, then to what was believed at first, which does not help either.
    found = used(guard, [5, 5, 5, *[40] * 40])
    assert (guard.returns, found.count(0)) == (2, 1)
    assert found[-1] > 30


def test_passes_that_stay_worse_than_the_first_end_at_what_was_believed_then() -> None:
    guard = Safeguard(learned(0))
    # Neither clearly worse than the best, which was luck, nor of any use.
    assert used(guard, [10, 30, 9, 50, 20, 16, 18, 10, 30]) == [1, 2, 3, 4, 5, 6, 0, 4, 6.5]
    assert (guard.share, guard.returns) == (0.5, 1)


def test_where_the_first_pass_was_luck_it_is_not_gone_back_to() -> None:
    guard = Safeguard(learned(0))
    used(guard, [10, 14, 12, 16, 14, 11, 14, 13, 15, 14, 12])
    assert guard.returns == 0
