"""Hands pieces of work out to a crew, and gives those out again whose worker was lost."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

TRIES = 3
"""How often a piece is given to workers that get lost before it counts as failed."""

PATIENCE = 0.5
"""Seconds for which a crew that has nothing to tell keeps its owner waiting."""

Piece = TypeVar("Piece", bound=Hashable)
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Outcome(Generic[Piece, Result]):
    """What has become of a piece of work that was given to a crew.

    Attributes:
        piece: The piece.
        result: What the work gave; None if there is nothing.
        reason: Why there is nothing.
        is_final: Trying again is of no use.
        error: What the work has raised in this very process.
    """

    piece: Piece
    result: Result | None
    reason: str = ""
    is_final: bool = False
    error: Exception | None = None


class Crew(Protocol[Piece, Result]):
    """Some workers that do the same with each piece that they are given."""

    @property
    def workers(self) -> int:
        """How many there are."""
        ...

    def takes(self) -> bool:
        """Whether it can be given another piece now."""
        ...

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        ...

    def outcomes(self) -> list[Outcome[Piece, Result]]:
        """Returns what has become of some pieces; waits a while for it, and may come back empty."""
        ...

    def dismiss(self) -> None:
        """Stops all work at once and leaves no process behind."""
        ...


class Alone(Generic[Piece, Result]):
    """A crew that is this process: for work that is over before a worker would have started."""

    workers = 1

    def __init__(self, work: Callable[[Piece], Result]) -> None:
        self._work = work
        self._given: list[Piece] = []

    def takes(self) -> bool:
        """Whether it can be given another piece now."""
        return not self._given

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        self._given.append(piece)

    def outcomes(self) -> list[Outcome[Piece, Result]]:
        """Does the work on the piece that was given."""
        given, self._given = self._given, []
        return [self._outcome(piece) for piece in given]

    def _outcome(self, piece: Piece) -> Outcome[Piece, Result]:
        try:
            return Outcome(piece, self._work(piece))
        except Exception as error:
            return Outcome(piece, None, f"{type(error).__name__}: {error}", True, error)

    def dismiss(self) -> None:
        """Stops nobody: there are no other workers."""


def hand_out(
    pieces: Iterable[Piece], crew: Crew[Piece, Result], go_on: Callable[[], None]
) -> Iterator[Outcome[Piece, Result]]:
    """Has a crew work on all pieces.

    Args:
        pieces: What there is to do.
        crew: Who does it.
        go_on: Called now and then; may raise to stop.

    Yields:
        What has become of each piece, as soon as it is known. One without a result is final, or
        has been lost as often as it is tried.
    """
    waiting = deque(pieces)
    under_way = 0
    lost: Counter[Piece] = Counter()
    while waiting or under_way:
        while waiting and crew.takes():
            crew.give(waiting.popleft())
            under_way += 1
        go_on()
        for outcome in crew.outcomes():
            under_way -= 1
            if outcome.result is None and not outcome.is_final:
                lost[outcome.piece] += 1
                if lost[outcome.piece] < TRIES:
                    waiting.appendleft(outcome.piece)
                    continue
            yield outcome


def available_cores() -> int:
    """Returns the number of cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1
