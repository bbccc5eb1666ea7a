"""What somebody meant whose command line has an option that is not there."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from hilc_cli.errors import near_word

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
