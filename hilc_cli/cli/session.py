"""What the entry point and the commands are to know of each other."""

from __future__ import annotations

import signal
from dataclasses import dataclass
from types import FrameType


class InterruptedBySignal(BaseException):
    """SIGINT or SIGTERM has arrived; drafts are cleaned up on the way out.

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
        verbose: Whether failures show their traceback.
        signal_number: Of the signal that has arrived, if one has.
    """

    verbose: bool = False
    signal_number: int | None = None

    def listen(self) -> None:
        """From now on a signal to stop raises InterruptedBySignal."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._stop)

    def go_on(self) -> None:
        """Called now and then by what takes long.

        An exception that a signal raises in a callback from C code gets lost there: then it is
        raised here.

        Raises:
            InterruptedBySignal: A signal has arrived.
        """
        if self.signal_number is not None:
            raise InterruptedBySignal(self.signal_number)

    def _stop(self, number: int, frame: FrameType | None) -> None:
        self.signal_number = number
        self.go_on()
