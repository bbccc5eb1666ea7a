"""How to go on with a sweep that has been stopped."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hilc_cli.errors import ExistingResultsError, UsageError


@contextmanager
def resumable(work: Path) -> Iterator[None]:
    """Tells how to go on when a sweep has been stopped and left something to go on with."""
    try:
        yield
    except BaseException as error:  # of any kind: a signal may end in another than its own
        from hilc_cli import api
        from hilc_cli.cli.terminal import say

        useless = isinstance(error, ExistingResultsError | UsageError)
        if not useless and api.is_resumable(work):
            words = [word for word in sys.argv[1:] if word != "--resume"]
            say(f"go on with: {shlex.join(['hilc', *words, '--resume'])}")
        raise
