"""Learning that goes back where it made passes worse."""

from __future__ import annotations

import numpy as np

from hilc_cli.laws.norm_optimal.safeguard import Learned, Safeguard


def learned(number: float) -> Learned:
    return Learned(np.full(6, number), np.full((4, 3), number))


def number_of(found: Learned) -> float:
    assert np.all(found.parameters == found.parameters[0])
    assert np.all(found.beside == found.parameters[0])
    return float(found.parameters[0])


def test_learning_that_gets_better_is_left_alone() -> None:
    guard = Safeguard(learned(0))
    for number, error in enumerate([900, 50, 7, 4, 2.5, 2.9, 0.2, 0.9, 0.1], start=1):
        found, went_back = guard.next(error, learned(number))
        assert (number_of(found), went_back) == (number, False)
    assert guard.step == 1


def test_one_bad_pass_is_bad_luck() -> None:
    guard = Safeguard(learned(0))
    for number, error in enumerate([5, 5, 5, 500, 5, 5, 400, 5, 5], start=1):
        assert guard.next(error, learned(number))[1] is False


def test_what_does_not_count_as_an_error_is_never_worse() -> None:
    guard = Safeguard(learned(0))
    for number, error in enumerate([0.001, 0.001, 0.001, 0.8, 0.9, 0.9, 2.9, 2.9], start=1):
        assert guard.next(error, learned(number))[1] is False


def test_it_goes_back_to_the_best_and_takes_half_steps_from_there() -> None:
    guard = Safeguard(learned(0))
    for number, error in enumerate([9, 5, 4], start=1):
        guard.next(error, learned(number))
    # The median pass of these, with 5, ran on what was learned from the first.
    assert guard.next(50, learned(10))[1] is False
    found, went_back = guard.next(60, learned(20))
    assert (number_of(found), went_back) == (1, True)
    assert guard.step == 0.5
    found, went_back = guard.next(6, learned(3))
    assert (number_of(found), went_back) == (2, False)
    assert number_of(guard.next(6, learned(4))[0]) == 3
    assert number_of(guard.next(6, learned(4))[0]) == 3.5


def test_robot_that_has_changed_for_good_is_gone_back_for_once() -> None:
    guard = Safeguard(learned(0))
    errors = [5, 5, 5, *[40] * 12]
    back = [guard.next(error, learned(number))[1] for number, error in enumerate(errors)]
    assert sum(back) == 1
