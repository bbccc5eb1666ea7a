"""A worker process; started by `hilc_cli.workers.crews`, by nobody else."""

from __future__ import annotations

import ctypes
import logging
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from multiprocessing.connection import Connection

_LOOK_AROUND = 0.5  # [s]
_PARENT_DEATH_SIGNAL = 1


def serve(pipe: Connection) -> None:
    """Works on pieces until the pipe ends.

    Args:
        pipe: Gives a function first, then pieces; takes what it returns for each, or a text that
            says why there is no result, or an ImportError if there can be none at all.
    """
    try:
        try:
            work = pipe.recv()
        except EOFError:
            raise
        except Exception as error:  # its modules cannot be loaded
            pipe.send(ImportError(f"{type(error).__name__}: {error}"))
            return
        while True:
            piece = pipe.recv()
            try:
                answer: object = work(piece)
            except Exception as error:
                answer = f"{type(error).__name__}: {error}"
            pipe.send(answer)
    except (EOFError, OSError):
        return


def _end_with(owner: int) -> None:
    """Ends this process, whatever it is doing, when its owner has ended."""
    with suppress(AttributeError, OSError):  # Linux sees to it, others look around
        ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGKILL)

    def watch() -> None:
        while os.getppid() == owner:
            time.sleep(_LOOK_AROUND)
        os._exit(1)

    with suppress(RuntimeError):  # as many threads as there may be
        threading.Thread(target=watch, daemon=True).start()


if __name__ == "__main__":
    # Asked for here, the owner's number might already be that of whoever adopts orphans.
    _end_with(int(sys.argv[2]))
    # What is no fault, but takes longer, the owner has told for all.
    logging.getLogger("hilc_cli").setLevel(logging.ERROR)
    serve(Connection(int(sys.argv[1])))
