"""Shell completion, also of ``example:NAME`` in bash, which takes a colon for a word of its own."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, MutableMapping
from contextlib import redirect_stdout, suppress

from hilc_cli.shipped_files import PREFIX

REQUEST = "_HILC_COMPLETE"
"""The variable by which a shell asks for completions."""


def complete(answer: Callable[[], object]) -> None:
    """Answers the shell.

    Args:
        answer: Prints the completions of what the environment says of the command line.
    """
    if not join_split_example(os.environ):
        answer()
        return
    output = io.StringIO()
    with redirect_stdout(output), suppress(SystemExit):
        answer()
    # bash puts the answer in the place of what stands behind the colon only.
    for line in output.getvalue().splitlines():
        print(line.removeprefix(PREFIX))


def join_split_example(environment: MutableMapping[str, str]) -> bool:
    """Puts ``example``, ``:`` and the rest together again in what bash says of the command line.

    Args:
        environment: Holds COMP_WORDS and COMP_CWORD; changed in place.

    Returns:
        Whether there was such a word at the cursor.
    """
    words = environment.get("COMP_WORDS", "").split(" ")
    cursor = int(environment.get("COMP_CWORD") or 0)
    colon = next((i for i in (cursor, cursor - 1) if words[i : i + 1] == [":"]), 0)
    if colon < 1 or f"{words[colon - 1]}:" != PREFIX:
        return False
    rest = "".join(words[colon + 1 : cursor + 1])
    environment["COMP_WORDS"] = " ".join([*words[: colon - 1], PREFIX + rest])
    environment["COMP_CWORD"] = str(colon - 1)
    return True
