"""The example trajectories and scenarios that travel with hilc."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from hilc_cli.errors import UsageError, suggestion

PREFIX = "example:"
FOLDERS = ("scenarios", "trajectories")


def examples_folder() -> Path:
    """The folder that holds the example folders: in the package, or in the checkout."""
    package = Path(__file__).resolve().parent
    installed = package / "shipped"
    return installed if installed.is_dir() else package.parent


def examples(folder: str = "scenarios") -> Iterator[Path]:
    """The example files of one folder, by name."""
    return iter(sorted((examples_folder() / folder).glob("*.yaml")))


def resolve_example(text: str, folder: str = "scenarios") -> Path:
    """The file behind ``example:NAME``; any other text is a path as it is.

    Raises:
        UsageError: There is no such example.
    """
    if not text.startswith(PREFIX):
        return Path(text)
    name = text.removeprefix(PREFIX).removesuffix(".yaml")
    known = {path.stem: path for path in examples(folder)}
    if name not in known:
        raise UsageError(f"{text}: there is no such example; {suggestion(name, known)}")
    return known[name]
