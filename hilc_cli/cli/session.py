"""What the entry point and the commands are to know of each other."""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import FrameType

STOPPED = {
    signal.SIGHUP: "hung up",
    signal.SIGINT: "interrupted",
    signal.SIGQUIT: "quit",
    signal.SIGTERM: "terminated",
}
"""Signals to stop, and what a process has been that gets one."""

_CLEANING = 2.0
"""Seconds in which whoever has been told to stop is not told again: terminals and service managers
send several signals at once, which are not to interrupt the cleaning up."""


class InterruptedBySignal(BaseException):
    """A signal to stop has arrived; drafts are cleaned up on the way out.

    Attributes:
        number: Of the signal.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__(number)


@dataclass(slots=True)
class Session:
    """One run of the program.

    Attributes:
        arguments: The command line.
        verbose: Whether failures show their traceback.
        signal_number: Of the first signal that has arrived, if one has.
    """

    arguments: Sequence[str] = ()
    verbose: bool = False
    signal_number: int | None = None
    _told_at: float = -math.inf

    def listen(self) -> None:
        """From now on a signal to stop raises InterruptedBySignal.

        One that is ignored stays so: ``nohup`` and shells ask for that.
        """
        for number in STOPPED:
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, self._stop)

    def leave(self) -> None:
        """From now on no signal to stop changes anything: the exit code is settled.

        Python would otherwise put back at its end what ends a process by the signal itself.
        """
        for number in STOPPED:
            signal.signal(number, signal.SIG_IGN)

    def go_on(self) -> None:
        """Called now and then by what takes long.

        An exception that a signal raises in a callback from C code gets lost there: then it is
        raised here.

        Raises:
            InterruptedBySignal: A signal has arrived.
        """
        if self.signal_number is not None:
            raise InterruptedBySignal(self.signal_number)

    def counting(self, advance: Callable[[int], None]) -> Callable[[int], None]:
        """Makes of what is told how many are done what is told each number, from 0.

        Args:
            advance: Told how many are done, unless a signal has come.
        """

        def on_number(number: int) -> None:
            self.go_on()
            advance(number + 1)

        return on_number

    def _stop(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if now - self._told_at < _CLEANING:
            return
        self.signal_number, self._told_at = self.signal_number or number, now
        self.go_on()
