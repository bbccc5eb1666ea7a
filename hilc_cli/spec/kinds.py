"""What kind of file has been given in the place of another."""

from __future__ import annotations

import re
from collections.abc import Collection

from hilc_cli.shipped_files import KINDS, LEADERBOARDS, SCENARIOS, TRAJECTORIES, is_example
from hilc_cli.spec.nodes import MapNode, Node, Scalar, describe

# The keys without which a file is none of its kind; the first that fits.
_KEYS = {
    SCENARIOS: {"controller"},
    LEADERBOARDS: {"cases", "laws"},
    TRAJECTORIES: {"segments"},
}
# The keys of which a file of a kind has at least one, however much else is wrong with it.
_TELLING = {
    SCENARIOS: {
        "trajectory", "robot", "controller", "model", "iterations", "initial_pose",
        "initial_input", "disturbance", "sweep",
    },
    LEADERBOARDS: {"cases", "laws", "beliefs", "disturbances"},
    TRAJECTORIES: {"sample_time", "segments"},
}  # fmt: skip
_HAS = {
    SCENARIOS: "a scenario has trajectory, robot and controller",
    LEADERBOARDS: "a leaderboard has cases and laws",
    TRAJECTORIES: "a trajectory has sample_time, start and segments",
}
_ONE = {SCENARIOS: "scenario", LEADERBOARDS: "leaderboard", TRAJECTORIES: "trajectory"}
_INSTEAD = {
    (LEADERBOARDS, SCENARIOS): "give it to hilc compare --laws",
    (TRAJECTORIES, SCENARIOS): "name it under 'trajectory:' in a scenario",
    (SCENARIOS, LEADERBOARDS): "name it under 'cases:' in a leaderboard",
    (TRAJECTORIES, LEADERBOARDS): "give a leaderboard, such as example:leaderboard",
    (SCENARIOS, TRAJECTORIES): "name a trajectory file",
    (LEADERBOARDS, TRAJECTORIES): "name a trajectory file",
}


def mentions_keys_of(text: str, kind: str) -> bool:
    """Whether a text that is no YAML seems to be meant for a file of a kind, of `KINDS`."""
    keys = "|".join(sorted(_TELLING[kind]))
    gap = "[ \t\"']{0,40}"  # no longer, so that a hostile text is searched in no time
    return re.search(f"(?mi)(^|[{{,]){gap}({keys}){gap}:", text) is not None


def is_no(kind: str, tree: Node) -> str | None:
    """What is wrong with a file that is neither of a kind nor of another one that is known.

    Args:
        kind: The kind that is needed, of `KINDS`.
        tree: What the file holds, of which nothing is shown.

    Returns:
        The message; None if it is of a kind, however much else is wrong with it.
    """
    if not isinstance(tree, MapNode):
        is_text = isinstance(tree, Scalar) and tree.value is not None
        got = "a single value" if is_text else describe(tree)
        return f"is no {_ONE[kind]}, got {got}; write a mapping of keys and values"
    known = {key.lower() for key in tree.entries}
    if not _TELLING[kind].isdisjoint(known) or mistaken(tree.entries, kind) is not None:
        return None
    return f"is no {_ONE[kind]}; {_HAS[kind]}"


def mistaken(keys: Collection[str], wanted: str, shown: str = "") -> str | None:
    """What is wrong with a file of another kind, and where it belongs.

    Args:
        keys: Of its outermost mapping.
        wanted: The kind that is needed, of `KINDS`.
        shown: What to show of it, if its place does not tell.

    Returns:
        The message; None if it is of that kind, or of none that is known.
    """
    given = next((kind for kind, needed in _KEYS.items() if needed <= set(keys)), wanted)
    return None if given == wanted else _not_but(given, wanted, shown)


def mistaken_example(text: str, wanted: str) -> str | None:
    """The same for ``example:NAME``; None also for any other text."""
    if is_example(text, wanted):
        return None
    return next((_not_but(kind, wanted, "") for kind in KINDS if is_example(text, kind)), None)


def _not_but(given: str, wanted: str, shown: str) -> str:
    got = f", got {shown}" if shown else ""
    return f"is a {_ONE[given]}, not a {_ONE[wanted]}{got}; {_INSTEAD[given, wanted]}"
