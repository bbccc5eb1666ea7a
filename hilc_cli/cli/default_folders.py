"""Which folders commands mean: where results go without --out, and which hold what is wanted."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from hilc_cli.errors import UsageError
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.wording import printable

RUNS = Path("runs")
SWEEP = "-sweep"
_MOST_BYTES = 200  # of a folder's name, which the system lets have 255
_LONGEST = 80  # characters of all changes together: a name has 255 bytes, and others come behind
_DIGITS = 6
_UNSAFE = r"[^A-Za-z0-9._-]+"


def default_folder(name: str, overrides: Sequence[str] | None, ending: str = "") -> Path:
    """The folder of a scenario's results, such as ``runs/NAME+l1=0.5-sweep``.

    What ``--set`` has changed stands behind the name: the last part of the key, or more of it where
    two keys end alike, and the value, with ``-`` for characters that a shell or a file system could
    take for something else. A text that is cut short has digits of the whole one behind it. Whether
    a folder may be written is not told by its name: two values that are spelled alike are found out
    when the scenario that stands there is compared.

    Args:
        name: Of the scenario, as it is after all changes.
        overrides: ``KEY=VALUE`` as on the command line.
        ending: What kind of results they are, such as ``-sweep``.
    """
    return RUNS / f"{name}{_changes(overrides or [])}{ending}"


def shard_folder(folder: Path, number: int, shards: int) -> Path:
    """Where one of several shards of a sweep goes that is to end up in a folder."""
    return folder.with_name(f"{folder.name}.{number}-of-{shards}")


def folder_of_shards(name: str, shards: Sequence[Path]) -> Path:
    """The default folder of a sweep that is put together of shards.

    Args:
        name: Of the scenario.
        shards: Their folders. What ``--set`` has changed is known by their names alone.
    """
    plain = f"{name}{SWEEP}"
    found = {re.sub(r"\.[0-9]+-of-[0-9]+$", "", shard.name) for shard in shards}
    with_changes = min(found)
    # Its folders may come from anybody: what hilc has made has no other characters.
    own = re.fullmatch(rf"{re.escape(name)}\+[A-Za-z0-9._+=-]+{SWEEP}", with_changes)
    if len(found) == 1 and own is not None:
        return RUNS / with_changes
    return RUNS / plain


def _changes(overrides: Sequence[str]) -> str:
    values: dict[tuple[str, ...], str] = {}
    for text in overrides:
        key, _, value = text.partition("=")
        keys = tuple(key.strip().split("."))
        values.pop(keys, None)  # the last of several values counts, and its place
        values[keys] = value.strip() or "null"
    values.pop(("name",), None)  # is what the folder is called anyway
    shown = "".join(
        f"+{_safe(_ending(keys, list(values)))}={_safe(value)}" for keys, value in values.items()
    )
    if len(shown) <= _LONGEST and "=+" not in f"{shown}+":
        return shown
    whole = "\0".join(f"{'.'.join(keys)}={value}" for keys, value in values.items())
    digits = hashlib.sha256(whole.encode("utf-8", "surrogateescape")).hexdigest()[:_DIGITS]
    return f"{shown[: _LONGEST - _DIGITS - 1]}-{digits}"


def _ending(keys: tuple[str, ...], others: Sequence[tuple[str, ...]]) -> str:
    """The fewest last parts of a key that name something and tell it from the others."""
    for count in range(1, len(keys)):
        ending = keys[-count:]
        alike = sum(other[-count:] == ending for other in others)
        if alike == 1 and not ending[0].isdecimal():
            return ".".join(ending)
    return ".".join(keys)


def _safe(text: str) -> str:
    """The text without brackets and quotes around it, and ``-`` for what is unsafe within."""
    bare = re.sub(rf"^{_UNSAFE}|{_UNSAFE}$", "", text)
    return re.sub(_UNSAFE, "-", bare)


_TABLES = _OF_RUNS, _OF_SWEEPS, _ = ("iterations.csv", "cases.csv", "leaderboard.csv")
"""Which runs, sweeps and leaderboards have, and nothing else does."""


def result_folders(folder: Path) -> Iterator[tuple[float, Path]]:
    """Runs, sweeps and leaderboards directly below a folder, each with when it was written [s].

    Pictures that have been drawn later count for nothing.
    """
    with suppress(OSError):  # there is no such folder, or it cannot be read
        for place in folder.iterdir():
            for table in _TABLES:
                # A name with a dot in front is that of an unfinished folder.
                if not place.name.startswith(".") and (place / table).is_file():
                    yield (place / table).stat().st_mtime, place


def newest_results(folder: Path, kinds: Sequence[str] = ()) -> Path:
    """The run, sweep or leaderboard below a folder that has been written last.

    Args:
        folder: The folder.
        kinds: Pictures that it must have, such as ``error``, which sweeps have not.

    Raises:
        UsageError: There is none.
    """
    drawn = {_OF_RUNS: {**RUN_PICTURES, **MOVING_PICTURES}, _OF_SWEEPS: SWEEP_PICTURES}
    tables = [table for table in _TABLES if set(kinds) <= set(drawn.get(table, ()))]
    fitting = (
        (written, place)
        for written, place in result_folders(folder)
        if any((place / table).is_file() for table in tables)
    )
    _, newest = max(fitting, default=(0.0, None))
    if newest is None:
        such = f" with pictures {', '.join(kinds)}" if kinds else ""
        raise UsageError(
            f"there are no results{such} in {folder} to draw; name the folder of a run"
        )
    return newest


def without_comparisons(folders: Sequence[Path], *, with_laws: bool = False) -> list[Path]:
    """The folders but those of earlier comparisons, which a pattern such as runs/fig4* finds too.

    What is left out is told.

    Args:
        folders: The folders.
        with_laws: Whether leaderboards, which are comparisons of laws, are kept.
    """
    from hilc_cli.comparisons.formats import FILES
    from hilc_cli.files import is_there
    from hilc_cli.leaderboards.folder import is_leaderboard
    from hilc_cli.reporting.terminal import say
    from hilc_cli.runs.run_folder import ITERATIONS

    kept = []
    for folder in folders:
        tables = (FILES["csv"], ITERATIONS) if is_there(folder) else ()
        found = [is_there(folder / name) for name in tables]
        if found == [True, False] or (not with_laws and is_leaderboard(folder)):
            say(f"{folder}: holds a comparison and no run, so it is left out")
        else:
            kept.append(folder)
    return kept


def shared_folder(folders: Sequence[Path]) -> Path:
    """Where the results of several runs go by default, such as runs/A-vs-B.

    More than two, and names too long for one, are told from other such sets by a few digits, which
    follow from where they are.
    """
    from hilc_cli.files import folder_to_read

    places = [folder_to_read(folder) for folder in folders]
    names = [printable(place.name) for place in places]
    both = f"{names[0]}-vs-{names[1]}"
    if len(names) == 2 and len(os.fsencode(both)) <= _MOST_BYTES:
        return RUNS / both
    listed = "\0".join(map(os.path.relpath, places))
    digits = hashlib.sha256(os.fsencode(listed)).hexdigest()[:6]
    first = os.fsdecode(os.fsencode(names[0])[: _MOST_BYTES // 2])
    return RUNS / f"{first}-and-{len(names) - 1}-more-{digits}"


def report_file(folders: Sequence[Path]) -> Path:
    """Where the report of some results goes by default, such as runs/NAME.html."""
    from hilc_cli.files import folder_to_read

    if len(folders) > 1:
        shared = shared_folder(folders)
        return shared.with_name(f"{shared.name}.html")
    return RUNS / f"{printable(folder_to_read(folders[0]).name)}.html"


def check_shared_folder(folder: Path) -> None:
    """Makes sure that results of several runs do not end up among those of one.

    Raises:
        UsageError: The folder is that of a run, of a sweep or of a leaderboard, or a link.
        FileAccessError: Nothing can be written there.
    """
    from hilc_cli.files import output_place, writing
    from hilc_cli.leaderboards.folder import LEADERBOARD_FOLDER
    from hilc_cli.runs.run_folder import LAB_FOLDER, RUN_FOLDER
    from hilc_cli.sweeps.sweep_folder import SWEEP_FOLDER

    if folder.is_symlink():
        raise UsageError(f"--out {folder}: is a link; name the folder that it leads to")
    with writing(folder):
        output_place(folder)
    for kind in (RUN_FOLDER, LAB_FOLDER, SWEEP_FOLDER, LEADERBOARD_FOLDER):
        if kind.is_at(folder):
            raise UsageError(
                f"--out {folder}: is the folder of one {kind.what}; name another for several"
            )
