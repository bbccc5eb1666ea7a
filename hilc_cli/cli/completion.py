"""Shell completion, also of words that bash takes apart, such as ``example:NAME`` and ``KEY=``."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Callable, Iterable, MutableMapping
from contextlib import redirect_stdout, suppress
from pathlib import Path

from hilc_cli.cli.default_folders import RUNS
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.shipped_files import LEADERBOARDS, PREFIX, SCENARIOS, TRAJECTORIES, examples

REQUEST = "_HILC_COMPLETE"
"""The variable by which a shell asks for completions."""

_BREAK = re.compile(r"[:=]+")
"""What bash makes a word of its own, unless COMP_WORDBREAKS says otherwise."""

_BASH = """
%(complete_func)s() {
    local IFS=$'\\n'
    COMPREPLY=( $( env COMP_WORDS="${COMP_WORDS[*]}" \\
                   COMP_CWORD=$COMP_CWORD \\
                   %(autocomplete_var)s=complete_bash $1 ) )
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=/] ]] && compopt -o nospace 2>/dev/null
    return 0
}

complete -o default -F %(complete_func)s %(prog_name)s
"""
"""Puts no space behind what is to go on: a key and its equals sign, a folder and its slash."""


def complete(answer: Callable[[], object]) -> None:
    """Answers the shell.

    Args:
        answer: Prints the completions of what the environment says of the command line.
    """
    kept = join_split_words(os.environ)
    output = io.StringIO()
    with redirect_stdout(output), suppress(SystemExit):
        answer()
    for line in output.getvalue().splitlines():
        print(line.removeprefix(kept))


def join_split_words(environment: MutableMapping[str, str]) -> str:
    """Puts words that bash has taken apart together again.

    Args:
        environment: Holds COMP_WORDS, a line each, and COMP_CWORD; changed in place.

    Returns:
        The part of the word at the cursor that bash keeps: it puts a completion behind it.
    """
    if "COMP_WORDS" not in environment:
        return ""
    given = environment["COMP_WORDS"]
    parts = re.split(r"\n" if "\n" in given else " ", given)
    cursor = int(environment.get("COMP_CWORD") or 0)
    words: list[str] = []
    kept = ""
    for place, part in enumerate(parts[: cursor + 1]):
        is_break = _BREAK.fullmatch(part) is not None
        follows = place > 0 and _BREAK.fullmatch(parts[place - 1]) is not None
        if words and part and (is_break or follows):
            kept = words[-1] + (part if is_break else "")
            words[-1] += part
        else:
            kept = ""
            words.append(part)
    environment["COMP_WORDS"] = "\n".join(words)
    environment["COMP_CWORD"] = str(len(words) - 1)
    return kept


def use_own_script() -> None:
    """Lets --install-completion and --show-completion give the script for bash of this module.

    Where Typer keeps its scripts is its own matter: without this, its script serves, and puts a
    space behind an equals sign.
    """
    with suppress(ImportError, AttributeError, TypeError):
        from typer import _completion_shared

        _completion_shared._completion_scripts["bash"] = _BASH.strip()


_PLAIN = re.compile(r"[\w./:=+,@%~-]+")
"""What a shell takes for one word: a file may be called ``x;reboot``, by whoever has made it."""

_YAML = (".yaml", ".yml")
_WITHOUT_EFFECT = ("name", "description", "record.", "sweep", "trajectory.name")


def complete_scenario(incomplete: str) -> list[str]:
    """Example names and YAML files that a scenario argument may go on with."""
    names = [f"{PREFIX}{path.stem}" for path in examples()]
    return _begun([*names, *_files(incomplete)], incomplete)


def complete_path(incomplete: str) -> list[str]:
    """Example names and YAML files that an argument for a scenario or trajectory may go on with."""
    names = [
        f"{PREFIX}{path.stem}" for kind in (SCENARIOS, TRAJECTORIES) for path in examples(kind)
    ]
    return _begun([*dict.fromkeys(names), *_files(incomplete)], incomplete)


def complete_leaderboard(incomplete: str) -> list[str]:
    """Example names and YAML files that an argument for a leaderboard may go on with."""
    names = [f"{PREFIX}{path.stem}" for path in examples(LEADERBOARDS)]
    return _begun([*names, *_files(incomplete)], incomplete)


def complete_key(incomplete: str) -> list[str]:
    """Keys of a scenario with their equals sign, those of all laws."""
    from hilc_cli.scenario.scenario import ScenarioSpec  # Pydantic models start slowly
    from hilc_cli.yaml_input.known_keys import value_keys

    return _begun([f"{key}=" for key in dict.fromkeys(value_keys(ScenarioSpec))], incomplete)


def complete_varied_key(incomplete: str) -> list[str]:
    """Keys that a sweep may vary, with their equals sign: those on which results depend."""
    return [key for key in complete_key(incomplete) if not key.startswith(_WITHOUT_EFFECT)]


def complete_metric(incomplete: str) -> list[str]:
    """Metrics of an iteration."""
    from hilc_cli.results.metrics import METRICS

    return _begun(METRICS, incomplete)


def complete_case_metric(incomplete: str) -> list[str]:
    """Metrics of a case of a sweep."""
    from hilc_cli.results.metrics import CASE_METRICS

    return _begun(CASE_METRICS, incomplete)


def complete_picture(incomplete: str) -> list[tuple[str, str]]:
    """Kinds of pictures, each with what it shows."""
    kinds = {**RUN_PICTURES, **MOVING_PICTURES, **SWEEP_PICTURES}
    return [(name, kinds[name].shows) for name in _begun(kinds, incomplete)]


def complete_font(incomplete: str) -> list[str]:
    """Families of fonts that are one word."""
    from hilc_cli.drawing.looks import font_families

    return _begun(font_families(), incomplete)


def complete_row(incomplete: str) -> list[str]:
    """What a table of runs can tell, behind what is named already."""
    from hilc_cli.comparisons.comparing import ROWS

    named, comma, begun = incomplete.rpartition(",")
    return [f"{named}{comma}{row}" for row in _begun(ROWS, begun) if row not in named.split(",")]


def complete_results(incomplete: str) -> list[str]:
    """Folders with results below runs/; where there are none, the shell goes on with files."""
    from hilc_cli.cli.default_folders import result_folders

    return _begun(sorted(str(place) for _, place in result_folders(RUNS)), incomplete)


def _begun(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete) and _PLAIN.fullmatch(name)]


def _files(incomplete: str) -> list[str]:
    """Folders and YAML files."""
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    if not folder.is_dir():
        return []
    return [
        f"{path}/" if path.is_dir() else str(path)
        for path in sorted(folder.iterdir())
        if path.is_dir() or path.suffix in _YAML
    ]
