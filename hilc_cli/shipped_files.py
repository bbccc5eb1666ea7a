"""The example trajectories, scenarios, leaderboards and programs that travel with hilc."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.files import write_file, writing
from hilc_cli.wording import suggestion

PREFIX = "example:"
SCENARIOS, TRAJECTORIES, LEADERBOARDS = KINDS = ("scenarios", "trajectories", "leaderboards")
PROGRAMS = "programs"

_BESIDE_SCENARIOS = frozenset({"leaderboard", "leaderboard-robots", "small-robot-laws"})
"""Leaderboards, which stand in the scenarios' folder."""


def examples_folder() -> Path:
    """The folder that holds the example folders: in the package, or in the checkout."""
    package = Path(__file__).resolve().parent
    installed = package / "shipped"
    return installed if installed.is_dir() else package.parent


def examples(kind: str = SCENARIOS) -> Iterator[Path]:
    """The example files of one kind, by name."""
    folder = examples_folder() / (TRAJECTORIES if kind == TRAJECTORIES else SCENARIOS)
    files = sorted(folder.glob("*.yaml"), key=lambda file: file.stem)
    if kind == TRAJECTORIES:
        return iter(files)
    return (file for file in files if (file.stem in _BESIDE_SCENARIOS) == (kind == LEADERBOARDS))


def programs() -> list[Path]:
    """The example programs, by name: they stand beside hilc and a robot, and are to be copied."""
    return sorted((examples_folder() / PROGRAMS).glob("*.py"))


def is_example(text: str, kind: str) -> bool:
    """Whether a text is ``example:NAME`` with the name of an example of one kind."""
    return text.startswith(PREFIX) and _name(text) in {path.stem for path in examples(kind)}


def resolve_example(text: str, kinds: Sequence[str] = (SCENARIOS,)) -> Path:
    """The file behind ``example:NAME``; of the first kind that has such a name.

    Raises:
        UsageError: There is no such example.
    """
    name = _name(text)
    known = {path.stem: path for kind in reversed(kinds) for path in examples(kind)}
    if name not in known:
        # Its last character may be the wrong one: of several that fit, none is guessed.
        begun = [stem for stem in known if name and stem.startswith(name)] or [
            stem for stem in known if name[:-1] and stem.startswith(name[:-1])
        ]
        hint = f"known: {', '.join(begun)}" if len(begun) > 1 else suggestion(name, begun or known)
        raise UsageError(f"{text}: there is no such example; {hint}")
    return known[name]


def example_meant(text: str, kinds: Sequence[str]) -> str | None:
    """The ``example:NAME`` that somebody may mean who gives a file that is not there."""
    stem = Path(text).name.removesuffix(".yaml").lower()
    known = {path.stem for kind in kinds for path in examples(kind)}
    return f"{PREFIX}{stem}" if stem in known else None


def _name(text: str) -> str:
    return text.removeprefix(PREFIX).removesuffix(".yaml")


def copy_examples(folder: Path, *, force: bool = False) -> list[Path]:
    """Writes all examples below a folder, each file as a whole.

    Args:
        folder: Where to put ``scenarios/``, ``trajectories/`` and ``programs/``.
        force: Replace files of the same name that differ.

    Returns:
        The files written.

    Raises:
        ExistingResultsError: A file of the same name differs; nothing has been written then.
        FileAccessError: The system refused.
    """
    paths = [*(path for kind in KINDS for path in examples(kind)), *programs()]
    files = {folder / path.parent.name / path.name: path.read_bytes() for path in paths}
    with writing(folder):
        link = next((path.parent for path in files if path.parent.is_symlink()), None)
        if link is not None:
            raise ExistingResultsError(
                f"{link}: is a link, and nothing is written through links; choose another folder"
            )
        changed = [path for path, new in files.items() if path.exists() and _differs(path, new)]
        if changed and not force:
            raise ExistingResultsError(
                f"{changed[0]}: exists and differs from the example; "
                "choose another folder, or replace it with --force"
            )
        for path, content in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_file(path, lambda draft, content=content: draft.write_bytes(content))  # type: ignore[misc]
    return list(files)


def _differs(path: Path, content: bytes) -> bool:
    if not path.is_file() or path.stat().st_size != len(content):
        return True
    return path.read_bytes() != content
