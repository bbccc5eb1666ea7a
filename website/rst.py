"""Pages that are made from the program, as reStructuredText."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

_OPTION = re.compile(r"(?<![^\s(])(--?[a-z][a-z-]*)(?![\w=-])")


def page(folder: Path, name: str, lines: Iterable[str]) -> str:
    """Writes a page and returns its name."""
    file = folder / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return name


def heading(text: str, mark: str) -> Iterator[str]:
    """Returns a heading, underlined with a character."""
    yield from (literal(text), mark * len(literal(text)), "")


def code(text: str, language: str) -> Iterator[str]:
    """Returns a block of code."""
    yield f".. code-block:: {language}\n"
    yield from (f"   {line}".rstrip() for line in text.splitlines())
    yield ""


def contents(names: Iterable[str]) -> Iterator[str]:
    """Returns a table of contents that is shown beside the pages only."""
    yield from (".. toctree::", "   :hidden:", "", *(f"   {name}" for name in names), "")


def prose(text: str) -> str:
    """Returns a text in which options are code and nothing else is markup."""
    parts = _OPTION.split(text)
    return "".join(
        f"``{part}``" if number % 2 else literal(part) for number, part in enumerate(parts)
    )


def literal(text: str) -> str:
    """Returns a text in which no character is markup."""
    return re.sub(r"([\\*`_|<>:])", r"\\\1", text)
