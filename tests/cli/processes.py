"""The command line as a process of its own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from tests.conftest import Outcome

HILC = (sys.executable, "-m", "hilc_cli")
TIMEOUT = 60.0


def environment(changes: Mapping[str, str] | None = None) -> dict[str, str]:
    """This environment without what would change the output, and with some changes."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("_HILC", "NO_COLOR", "TERM", "COLUMNS", "FORCE_COLOR"))
    }
    return {**kept, "TERM": "xterm-256color", "MPLBACKEND": "agg", **(changes or {})}


def uncovered(variables: dict[str, str]) -> dict[str, str]:
    """An environment in which coverage is not measured.

    A process that gets a signal needs it: the exception may be raised while coverage holds its
    lock, which is then never given back.
    """
    return {name: value for name, value in variables.items() if "COVERAGE" not in name}


def run_hilc(
    *arguments: str,
    cwd: Path,
    stdin: bytes = b"",
    changes: Mapping[str, str] | None = None,
    timeout: float = TIMEOUT,
    before: Callable[[], None] | None = None,
    covered: bool = True,
) -> Outcome:
    """Runs a command line to its end; a run that lasts longer than the timeout is killed."""
    variables = environment(changes)
    done = subprocess.run(
        [*HILC, *arguments],
        cwd=cwd,
        input=stdin,
        capture_output=True,
        env=variables if covered else uncovered(variables),
        timeout=timeout,
        preexec_fn=before,
        check=False,
    )
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


@contextmanager
def started(
    *arguments: str, cwd: Path, changes: Mapping[str, str] | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    """A running command line; killed by its handle if it still runs in the end."""
    process = subprocess.Popen(
        [*HILC, *arguments],
        cwd=cwd,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=uncovered(environment(changes)),
        # A test run in the background of a shell would pass on that it ignores interrupts.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def outcome_of(process: subprocess.Popen[bytes]) -> Outcome:
    """What a process leaves behind, once it has ended."""
    out, err = process.communicate(timeout=TIMEOUT)
    return Outcome(process.returncode, out.decode(), err.decode())
