"""Trees from files and standard input, with a trajectory and values of ``--set`` put into them."""

from __future__ import annotations

import hashlib
import os
import re
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from hilc_cli.errors import FileAccessError, InvalidInputError, Problem, UsageError
from hilc_cli.files import read_file, reading, reason, resolved
from hilc_cli.shipped_files import (
    KINDS,
    LEADERBOARDS,
    PREFIX,
    SCENARIOS,
    TRAJECTORIES,
    example_meant,
    is_example,
    resolve_example,
)
from hilc_cli.wording import shortened
from hilc_cli.yaml_input.nodes import (
    ListNode,
    MapNode,
    Node,
    Place,
    Scalar,
    Source,
    describe,
    from_data,
    with_entry,
)
from hilc_cli.yaml_input.syntax_errors import hint
from hilc_cli.yaml_input.tree import LONGEST_KEY, MAX_BYTES, parse_yaml

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

_OF_POINTS = frozenset({".csv", ".tsv", ".txt", ".tum"})
"""Ends of names of files that hold points."""
_AS_SEGMENT = "'path: {file: points.csv, speed: 0.5}'"


def _holds_points(name: str) -> bool:
    """Whether a file is called like one with points."""
    return Path(name).suffix.lower() in _OF_POINTS


def mentions_keys_of(text: str, kinds: Sequence[str]) -> bool:
    """Whether a text that is no YAML seems to be meant for a file of some kinds, of `KINDS`."""
    keys = "|".join(sorted(key for kind in kinds for key in _TELLING[kind]))
    gap = "[ \t\"']{0,40}"  # no longer, so that a hostile text is searched in no time
    return re.search(f"(?mi)(^|[{{,]){gap}({keys}){gap}:", text) is not None


def is_no(kinds: Sequence[str], tree: Node) -> str | None:
    """What is wrong with a file that is neither of some kinds nor of another one that is known.

    Args:
        kinds: Those that will do, of `KINDS`.
        tree: What the file holds, of which nothing is shown.

    Returns:
        The message; None if it is of a kind, however much else is wrong with it.
    """
    wanted = " and no ".join(_ONE[kind] for kind in kinds)
    if not isinstance(tree, MapNode):
        is_text = isinstance(tree, Scalar) and tree.value is not None
        got = "a single value" if is_text else describe(tree)
        remedy = "write a mapping of keys and values"
        if SCENARIOS in kinds and _holds_points(tree.place.source.label):
            remedy = f"points go into a segment of a scenario's trajectory, as {_AS_SEGMENT}"
        return f"is no {wanted}, got {got}; {remedy}"
    known = {key.lower() for key in tree.entries}
    if any(not _TELLING[kind].isdisjoint(known) for kind in kinds):
        return None
    if mistaken(tree.entries, *kinds) is not None:
        return None
    return f"is no {wanted}; {', '.join(_HAS[kind] for kind in kinds)}"


def kind_of(keys: Collection[str], kinds: Sequence[str]) -> str:
    """Which of some kinds a file is of that is of one of them.

    Args:
        keys: Of its outermost mapping.
        kinds: Those that it may be of, of `KINDS`; the first if nothing tells.
    """
    given = _told_by(keys)
    if given is not None and given in kinds:
        return given
    known = {key.lower() for key in keys if isinstance(key, str)}  # of Python, they may be anything
    return next((kind for kind in kinds if not _TELLING[kind].isdisjoint(known)), kinds[0])


def _told_by(keys: Collection[str]) -> str | None:
    """The kind without whose keys a file is none of it; None if there is no such kind."""
    return next((kind for kind, needed in _KEYS.items() if needed <= set(keys)), None)


def mistaken(keys: Collection[str], *wanted: str, shown: str = "") -> str | None:
    """What is wrong with a file of another kind, and where it belongs.

    Args:
        keys: Of its outermost mapping.
        wanted: The kinds that will do, of `KINDS`.
        shown: What to show of it, if its place does not tell.

    Returns:
        The message; None if it is of such a kind, or of none that is known.
    """
    given = _told_by(keys)
    return None if given is None or given in wanted else _not_but(given, wanted, shown)


def _not_but(given: str, wanted: Sequence[str], shown: str) -> str:
    got = f", got {shown}" if shown else ""
    other = " and no ".join(_ONE[kind] for kind in wanted)
    negation = f"not a {other}" if len(wanted) == 1 else f"no {other}"
    return f"is a {_ONE[given]}, {negation}{got}; {_INSTEAD[given, wanted[0]]}"


STDIN = "-"
_OF_A_SWEEP = "sweep.json"
"""What the folder of a sweep has, and no other."""


@dataclass(slots=True)
class Inputs:
    """Reads files and remembers what was read.

    Attributes:
        checksums: SHA-256 of each input, by the name that the user knows it by.
        problems: What is wrong with single values in the YAML that was read.
    """

    checksums: dict[str, str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def file(self, path: Path, limit: int) -> bytes:
        """The content of a file.

        Raises:
            HilcError: It cannot be read, or is no regular file.
        """
        content = read_file(path, limit)
        self.checksums[str(path)] = hashlib.sha256(content).hexdigest()
        return content

    def tree(self, source: object, *kinds: str) -> Node:
        """The YAML tree of a file, of standard input (``-``), of an example, or of data.

        Args:
            source: Which.
            kinds: Of the file or example, a scenario if none is given. Of an example that there
                is of several kinds, the first counts.

        Raises:
            HilcError: It cannot be read, is no valid YAML, or something else is given.
        """
        kinds = kinds or (SCENARIOS,)
        if isinstance(source, Mapping):
            label = kind_of(source, kinds).removesuffix("s")
            return from_data(source, Place(Source(label, Path(), has_lines=False)))
        if not isinstance(source, str | os.PathLike):
            what = " or ".join(_ONE[kind] for kind in kinds)
            raise UsageError(
                f"a {what} is a file, example:NAME, a dictionary, or what was loaded of one; "
                f"got {type(source).__name__}"
            )
        name = str(source)
        if name == STDIN:
            content = _read_stdin()
            self.checksums["<stdin>"] = hashlib.sha256(content).hexdigest()
            return self._parsed(content, Source("<stdin>", Path()), kinds)
        return self._of_file(_file_of(name, kinds, Path(name)), kinds)

    def with_trajectory(self, tree: MapNode) -> MapNode:
        """The scenario with its trajectory file, if it names one, in the place of the path.

        Raises:
            InvalidInputError: The file cannot be read, or is no trajectory.
        """
        node = tree.entries.get("trajectory")
        if node is None or isinstance(node, MapNode):
            return tree
        if not isinstance(node, Scalar) or not isinstance(node.value, str) or not node.value:
            message = (
                "must be the path of a trajectory file or a mapping, "
                f"got {describe(node)}; name a trajectory file"
            )
            raise InvalidInputError.of(node.place, "trajectory", message)
        if _holds_points(node.value):
            message = (
                f"must be a trajectory file, got {describe(node)}; points go into a segment of "
                f"one, as {_AS_SEGMENT}"
            )
            raise InvalidInputError.of(node.place, "trajectory", message)
        try:
            path = short_path(node.place.source.folder / node.value)
            kinds = (TRAJECTORIES,)
            trajectory = self._of_file(_file_of(node.value, kinds, path), kinds)
        except (UsageError, FileAccessError) as error:
            message = f"{error}{hint(node.value, quoted=node.quoted)}"
            raise InvalidInputError.of(node.place, "trajectory", message) from None
        if isinstance(trajectory, MapNode):
            other = mistaken(trajectory.entries, TRAJECTORIES, shown=node.value)
            if other is not None:
                raise InvalidInputError.of(node.place, "trajectory", other)
        return with_entry(tree, "trajectory", trajectory, trajectory.place)

    def _of_file(self, path: Path, kinds: Sequence[str]) -> Node:
        with reading(path):
            is_folder = path.is_dir()
        if is_folder and SCENARIOS in kinds and (path / _OF_A_SWEEP).is_file():
            raise UsageError(
                f"{path}: is the folder of a sweep; run one of its cases with hilc run {path} "
                f"--case N or --best; {path / 'scenario.yaml'} is the scenario of all of them"
            )
        for kind in kinds if is_folder else ():
            inside = path / f"{_ONE[kind]}.yaml"  # as result folders have it
            if inside.is_file():
                raise UsageError(f"{path}: is a folder; give the {_ONE[kind]} in it, {inside}")
        return self._parsed(self.file(path, MAX_BYTES), Source(str(path), path.parent), kinds)

    def _parsed(self, content: bytes, source: Source, kinds: Sequence[str]) -> Node:
        """The tree of a file that is of some kinds, or of another one that is known.

        A path may lead to anything. Nothing of a file that hilc has no business with is shown,
        only where it stops being what it should be.
        """
        problems: list[Problem] = []
        shown = mentions_keys_of(content.decode("utf-8", "replace"), kinds)
        tree = parse_yaml(content, source, problems, show=shown)
        message = is_no(kinds, tree)
        if message is not None:
            raise InvalidInputError.of(tree.place, "", message)
        self.problems.extend(problems)
        return tree


def _file_of(name: str, kinds: Sequence[str], path: Path) -> Path:
    """Returns the file that a text stands for: the example that it names, or what is at a path."""
    if name.startswith(PREFIX):
        given = next((each for each in (*kinds, *KINDS) if is_example(name, each)), kinds[0])
        if given not in kinds:
            raise UsageError(f"{name}: {_not_but(given, kinds, '')}")
        return resolve_example(name, kinds)
    meant = None if os.path.lexists(path) else example_meant(name, kinds)
    if meant is not None:
        raise UsageError(f"{path}: there is no such file; did you mean '{meant}'?")
    return path


def _read_stdin() -> bytes:
    """Standard input as bytes, no more than may be read."""
    try:
        stream = getattr(sys.stdin, "buffer", None)
        if stream is None:
            raise UsageError("<stdin>: cannot be read here; give a file")
        content: bytes = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise FileAccessError(f"<stdin>: cannot be read: {reason(error)}") from error
    if len(content) > MAX_BYTES:
        raise UsageError(f"<stdin>: is larger than {MAX_BYTES} bytes, the most that is read")
    return content


def short_path(path: Path) -> Path:
    """The path without detours such as ``scenarios/../trajectories``, where that is the same."""
    short = Path(os.path.normpath(path))
    try:
        return short if resolved(short) == resolved(path) else path
    except (OSError, ValueError):  # a loop of links, a NUL character
        return path


_SHOWN_OF_LONG_KEYS = 40


def parse_override(text: str) -> tuple[tuple[str, ...], Node]:
    """Keys and value of ``KEY=VALUE``, the value read as YAML.

    Raises:
        InvalidInputError: There is no key or no equals sign, or the value is no YAML.
    """
    key, equals, value = text.partition("=")
    source = _source(f"--set {text}")
    keys = parts_of_key(key.strip(), "--set")
    if not equals or not all(keys):
        message = "must read KEY=VALUE, such as controller.gains.l1=0.5"
        raise InvalidInputError.of(source.label, "", message)
    if not value.strip():
        return keys, Scalar(Place(source), None, "null")
    try:
        return keys, parse_yaml(value.encode("utf-8", "surrogateescape"), source)
    except InvalidInputError as error:
        problems = [replace(problem, path=key.strip()) for problem in error.problems]
        raise InvalidInputError(problems) from None


def parts_of_key(key: str, option: str) -> tuple[str, ...]:
    """The parts of a dotted key; some may be empty.

    Args:
        key: The key.
        option: What it has been given with.

    Raises:
        InvalidInputError: It is so long that it is no key, whatever it says.
    """
    if not isinstance(key, str):
        raise UsageError(f"a key must be a text such as controller.gains.l1, got {key!r}")
    if len(key) > LONGEST_KEY:
        shown = f"{option} {shortened(key, _SHOWN_OF_LONG_KEYS)}"
        message = f"has a key of {len(key)} characters; give keys with dots between them, such as "
        raise InvalidInputError.of(shown, "", f"{message}controller.gains.l1")
    return tuple(key.split("."))


def data_override(key: str, value: object) -> tuple[tuple[str, ...], Node]:
    """Keys and value of an override that comes from Python."""
    keys = parts_of_key(key, "override")
    place = Place(_source(f"override {key}"))
    if not all(keys):
        message = "must be keys with dots between them, such as controller.gains.l1"
        raise InvalidInputError.of(place, "", message)
    return keys, from_data(value, place)


def apply_override(
    tree: MapNode,
    keys: tuple[str, ...],
    value: Node,
    inline: Callable[[MapNode], MapNode],
    default: Callable[[tuple[str, ...]], object] = lambda keys: None,
) -> MapNode:
    """The tree with one value replaced or added.

    Args:
        tree: The scenario.
        keys: Keys and list indices on the way to the value; missing mappings are added.
        value: The value.
        inline: Puts the trajectory in the place of its path, for keys that lead into it.
        default: What a list that is not in the tree is by default, for keys that lead into it.

    Raises:
        InvalidInputError: The way leads through a value that has no keys, or past a list's end.
    """
    if len(keys) > 1 and keys[0] == "trajectory":
        tree = inline(tree)
    changed = _put(tree, keys, value, (), default)
    assert isinstance(changed, MapNode)  # a mapping stays one
    return changed


def _put(
    node: Node | None,
    keys: tuple[str, ...],
    value: Node,
    above: tuple[str, ...],
    default: Callable[[tuple[str, ...]], object],
) -> Node:
    if not keys:
        return value
    key, rest = keys[0], keys[1:]
    here = (*above, key)
    if node is None and key.isdecimal():
        known = default(above)
        node = None if known is None else from_data(known, value.place)
    if node is None or (isinstance(node, Scalar) and node.value is None):
        node = MapNode(value.place)
    if isinstance(node, MapNode):
        return with_entry(
            node, key, _put(node.entries.get(key), rest, value, here, default), value.place
        )
    path = ".".join(here)
    if isinstance(node, ListNode):
        if key.isdecimal() and int(key) < len(node.items):
            items = list(node.items)
            items[int(key)] = _put(items[int(key)], rest, value, here, default)
            return replace(node, items=tuple(items))
        last = len(node.items) - 1
        message = f"is no entry of the list; give a number from 0 to {last}"
    else:
        message = f"cannot be set, since {'.'.join(above)} is a single value; set that instead"
    raise InvalidInputError.of(value.place, path, message)


def _source(label: str) -> Source:
    return Source(label, Path(), has_lines=False)
