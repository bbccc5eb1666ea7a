"""Pieces are handed out, and handed out again where their worker was lost."""

from __future__ import annotations

from collections import Counter

import pytest

from hilc_cli.workers.handing_out import TRIES, Alone, Outcome, hand_out
from hilc_cli.workers.processes import Processes


class Forgetful:
    """Two workers of which each loses a piece so many times."""

    workers = 2

    def __init__(self, losses: dict[int, int]) -> None:
        self.losses, self.given, self.tries = losses, list[int](), Counter[int]()

    def takes(self) -> bool:
        return len(self.given) < self.workers

    def give(self, piece: int) -> None:
        self.given.append(piece)
        self.tries[piece] += 1

    def outcomes(self) -> list[Outcome[int, int]]:
        given, self.given = self.given, []
        return [
            Outcome(piece, piece**2 if self.tries[piece] > self.losses.get(piece, 0) else None)
            for piece in given
        ]

    def dismiss(self) -> None:
        pass


def test_lost_pieces_are_tried_again_but_not_for_ever() -> None:
    crew = Forgetful({1: 1, 3: TRIES - 1, 4: TRIES})
    found = {outcome.piece: outcome.result for outcome in hand_out(range(6), crew, lambda: None)}
    assert found == {0: 0, 1: 1, 2: 4, 3: 9, 4: None, 5: 25}
    assert crew.tries == {0: 1, 1: 2, 2: 1, 3: TRIES, 4: TRIES, 5: 1}


def test_whoever_stops_it_is_asked_before_each_piece() -> None:
    done: list[int] = []

    def stop() -> None:
        if len(done) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        for outcome in hand_out("abcd", Alone(str.upper), stop):
            assert outcome.result == outcome.piece.upper()
            done.append(1)


@pytest.mark.parametrize("make", [Alone, lambda work: Processes(work, 1)])
def test_work_that_fails_says_why_and_is_not_tried_again(make: type[Alone[str, int]]) -> None:
    crew = make(int)
    try:
        bad, good = sorted(hand_out(["1", "x"], crew, lambda: None), key=lambda o: o.reason == "")
    finally:
        crew.dismiss()
    assert (good.piece, good.result) == ("1", 1)
    assert (bad.piece, bad.result, bad.is_final) == ("x", None, True)
    assert bad.reason == "ValueError: invalid literal for int() with base 10: 'x'"
