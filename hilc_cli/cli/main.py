"""The entry point: the one place where failures and signals become exit codes.

Nothing heavy is imported here: ``hilc --help`` starts at once.
"""

from __future__ import annotations

try:
    import io
    import os
    import shlex
    import signal
    import sys
    import traceback
    from collections.abc import Sequence
    from contextlib import suppress
    from pathlib import Path
    from typing import NoReturn

    from hilc_cli.cli.session import STOPPED, InterruptedBySignal, Session
    from hilc_cli.errors import HilcError, InvalidInputError
    from hilc_cli.surroundings import settle
    from hilc_cli.wording import near_word, printable, shortened
except KeyboardInterrupt:  # nothing has begun yet
    raise SystemExit(130) from None

DONE = 0
COULD_NOT = 1
WRONG_USAGE = 2
_SHORTAGES = (
    "start new thread",
    "Too many open files",
    "Cannot allocate memory",
    "failed to map segment",
)
"""What libraries say for which the system has nothing more."""
AFTER_SIGNAL = 128  # plus its number: 129, 130, 131, 143


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Runs a command line and exits with its code."""
    arguments = sys.argv[1:] if arguments is None else arguments
    session = Session(arguments)
    try:
        session.listen()
        _open_closed_streams()
        settle()
        code = _invoke(arguments, session)
        sys.stdout.flush()
    except BaseException as error:
        session.leave()
        code = _exit_code(error, session)
    session.leave()
    _leave(code)


def _open_closed_streams() -> None:
    """Gives closed standard streams a place to go, and makes all names printable."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open(mode))  # noqa: SIM115  # for ever
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _invoke(arguments: Sequence[str], session: Session) -> int:
    import typer
    from typer.main import get_command

    from hilc_cli.cli.app import COMMANDS, make_app
    from hilc_cli.cli.completion import REQUEST, complete, use_own_script

    use_own_script()
    first = arguments[0] if arguments else ""
    # Completion may be of any command, and a wrong one is held against all of them.
    is_alone = first in COMMANDS and REQUEST not in os.environ
    command = get_command(make_app([first] if is_alone else COMMANDS))
    if REQUEST in os.environ:
        complete(lambda: command.main(args=list(arguments), prog_name="hilc", complete_var=REQUEST))
        return DONE
    usage_error: type[Exception] = typer.BadParameter.__mro__[1]  # it has no public name
    try:
        with command.make_context("hilc", list(arguments), obj=session) as context:
            command.invoke(context)
    except typer.Exit as stop:
        return stop.exit_code
    except typer.Abort:
        raise KeyboardInterrupt from None
    except usage_error as error:
        known = getattr(command, "commands", {})
        _say(_usage(error, next((name for name in arguments if name in known), ""), arguments))
        return WRONG_USAGE
    return DONE


def _exit_code(error: BaseException, session: Session) -> int:
    """Says in one line what went wrong, and returns the exit code."""
    if session.verbose and not isinstance(error, SystemExit | BrokenPipeError):
        _trace(error)
    if session.signal_number is not None:  # whatever came of it, such as a terminal that is gone
        error = InterruptedBySignal(session.signal_number)
    match error:
        case BrokenPipeError():
            return DONE  # whoever read from us has seen enough
        case SystemExit():
            return error.code if isinstance(error.code, int) else COULD_NOT
        case KeyboardInterrupt() | InterruptedBySignal():
            number = signal.Signals(getattr(error, "number", signal.SIGINT))
            _say(f"hilc: {STOPPED[number]}; nothing was left half written")
            return AFTER_SIGNAL + number
        case InvalidInputError():
            _say(str(error))
            return error.exit_code
        case HilcError():
            _say(f"hilc: {printable(str(error))}")
            return error.exit_code
        case OSError():
            _say(printable(f"hilc: {_what(error)}the system refused: {error.strerror or error}"))
            return COULD_NOT
        case MemoryError():
            _say("hilc: out of memory; record fewer iterations")
            return COULD_NOT
        case ImportError() | RuntimeError() if any(words in str(error) for words in _SHORTAGES):
            _say(f"hilc: the system refused: {printable(str(error))}; see 'ulimit -a'")
            return COULD_NOT
        case _:
            _trace(error)
            _say("hilc: this is a bug; please report the lines above")
            return COULD_NOT


def _what(error: OSError) -> str:
    """What the system has refused, if that can be told."""
    if not error.filename:
        try:
            os.stat(os.getcwd())  # noqa: PTH109, PTH116  # which libraries ask for as they are loaded
        except FileNotFoundError:
            return "the working folder: "
    return f"{error.filename}: " if error.filename else ""


def _usage(error: Exception, subcommand: str, arguments: Sequence[str]) -> str:
    """One line for a command line that cannot be parsed."""
    command = f"hilc {subcommand}".rstrip()
    if hasattr(error, "possibilities"):  # an option that is not there
        option, parameters = error.option_name, error.ctx.command.params  # type: ignore[attr-defined]
        options = [name for each in parameters for name in each.opts]
        meant = option_meant(option, options, arguments)
        hint = f"did you mean: {shortened(meant)}" if meant else f"see '{command} --help'"
        return printable(f"hilc: no such option: {shortened(option)}; {hint}")
    message: str = error.format_message()  # type: ignore[attr-defined]
    message = " ".join(message.replace("Value error, ", "").split()).rstrip(".")
    return printable(f"hilc: {message[:1].lower()}{message[1:]}; see '{command} --help'")


def _trace(error: BaseException) -> None:
    """Where a failure comes from, without what its texts would do to a terminal."""
    lines = "".join(traceback.format_exception(error)).split("\n")
    _say("\n".join(map(printable, lines)).rstrip("\n"))


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


_SET = "--set"
_MOST_KEYS = 2


def option_meant(option: str, options: Sequence[str], arguments: Sequence[str]) -> str | None:
    """What to write in the place of an unknown option; None if nothing is near.

    Args:
        option: What was written, such as ``--iterations``.
        options: Those that the command has.
        arguments: The whole command line.
    """
    if _SET in options:
        value = _value(option, arguments)
        keys = _keys_meant(option)
        if keys:
            return " or ".join(f"{_SET} {shlex.quote(f'{key}={value}')}" for key in keys)
    near = near_word(option.strip("-"), [name.strip("-") for name in options])
    return f"--{near}" if near else None


def _keys_meant(option: str) -> list[str]:
    """The keys of a scenario that an option may stand for, if these are few."""
    from hilc_cli.scenario.scenario import ScenarioSpec
    from hilc_cli.yaml_input.known_keys import known_keys, spelled_out

    words = option.lstrip("-").split(".")
    # What has keys below it has no single value, but for a trajectory: that may be a file.
    known = [
        key for key in known_keys(ScenarioSpec) if not key.has_keys or key.dotted == "trajectory"
    ]
    found = spelled_out(known, words, len(words))
    return found if len(found) <= _MOST_KEYS else []


def _value(option: str, arguments: Sequence[str]) -> str:
    """What stands behind the option."""
    for index, argument in enumerate(arguments):
        if argument.startswith(f"{option}="):
            return argument.partition("=")[2]
        if argument == option:
            following = arguments[index + 1 : index + 2]
            return following[0] if following and not following[0].startswith("--") else "..."
    return "..."
