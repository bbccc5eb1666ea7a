"""The entry point: the one place where failures and signals become exit codes.

Nothing heavy is imported here: ``hilc --help`` starts at once.
"""

from __future__ import annotations

import os
import signal
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import FrameType
from typing import NoReturn

import typer
from typer.main import get_command

from hilc_cli.errors import HilcError, InvalidInputError

DONE = 0
COULD_NOT = 1
INTERRUPTED = 130
TERMINATED = 143

# Wrong usage as the parser of the command line reports it; its class has no public name.
_ParserError: type[Exception] = typer.BadParameter.__mro__[1]


class TerminatedError(BaseException):
    """SIGTERM has arrived; drafts are cleaned up on the way out."""


@dataclass(slots=True)
class Session:
    """What the exception handler is to know of the command that ran."""

    verbose: bool = False


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Runs a command line and exits with its code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    session = Session()
    try:
        signal.signal(signal.SIGTERM, _terminate)
        code = _invoke(arguments, session)
        sys.stdout.flush()
    except BaseException as error:
        code = _exit_code(error, session)
    _leave(code)


def _terminate(number: int, frame: FrameType | None) -> NoReturn:
    raise TerminatedError


def _invoke(arguments: Sequence[str], session: Session) -> int:
    from hilc_cli.cli.app import app

    command = get_command(app)
    if "_HILC_COMPLETE" in os.environ:  # the shell asks for completions
        command.main(args=list(arguments), prog_name="hilc", complete_var="_HILC_COMPLETE")
    try:
        with command.make_context("hilc", list(arguments), obj=session) as context:
            command.invoke(context)
    except typer.Exit as stop:
        return stop.exit_code
    return DONE


def _exit_code(error: BaseException, session: Session) -> int:
    """Says in one line what went wrong, and returns the exit code."""
    if session.verbose and not isinstance(error, SystemExit | BrokenPipeError):
        with suppress(OSError):
            traceback.print_exception(error)
    match error:
        case BrokenPipeError():
            return DONE  # whoever read from us has seen enough
        case SystemExit():
            return error.code if isinstance(error.code, int) else COULD_NOT
        case KeyboardInterrupt() | typer.Abort():
            _say("hilc: interrupted; nothing was left half written")
            return INTERRUPTED
        case TerminatedError():
            _say("hilc: terminated; nothing was left half written")
            return TERMINATED
        case InvalidInputError():
            _say(str(error))
            return error.exit_code
        case HilcError():
            _say(f"hilc: {error}")
            return error.exit_code
        case OSError():
            _say(f"hilc: cannot write the output: {error.strerror or error}")
            return COULD_NOT
        case MemoryError():
            _say("hilc: out of memory; record fewer iterations")
            return COULD_NOT
        case _ if isinstance(error, _ParserError):
            _say(_usage(error))
            return 2
        case _:
            traceback.print_exception(error)
            _say("hilc: this is a bug; please report the lines above")
            return COULD_NOT


def _usage(error: Exception) -> str:
    """One line for a command line that cannot be parsed."""
    context = getattr(error, "ctx", None)
    command = "hilc" if context is None else context.command_path
    message: str = error.format_message()  # type: ignore[attr-defined]
    message = " ".join(message.replace("Value error, ", "").split()).rstrip(".")
    return f"hilc: {message[:1].lower()}{message[1:]}; see '{command} --help'"


def _say(text: str) -> None:
    with suppress(OSError):
        print(text, file=sys.stderr, flush=True)


def _leave(code: int) -> NoReturn:
    """Exits without the interpreter's complaint about output that nobody takes any more."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    sys.exit(code)


if __name__ == "__main__":
    main()
