"""Notebooks as pages: text, code and the results that are kept in them; nothing is run."""

from __future__ import annotations

import base64
import json
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

_ANSI = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")


def page_of(notebook: Path, folder: Path) -> str:
    """Returns a notebook as Markdown, and writes its pictures and itself into a folder.

    Of results only text and PNG pictures are taken: no HTML, no program of a page.

    Args:
        notebook: An ``.ipynb`` file of format 4.
        folder: Where pages of notebooks are.
    """
    content = json.loads(notebook.read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(notebook, folder / notebook.name)
    language = content.get("metadata", {}).get("language_info", {}).get("name", "python")
    parts = []
    for number, cell in enumerate(content["cells"]):
        source = _text(cell["source"]).rstrip("\n")
        if cell["cell_type"] == "markdown":
            parts.append(source)
        elif cell["cell_type"] == "code" and source:
            parts.append(_fenced(source, language))
            parts += _results(cell, folder, f"{notebook.stem}-{number}")
    return "\n\n".join(parts) + "\n"


def title_of(notebook: Path) -> str:
    """Returns the first heading of a notebook; its file's name if it has none."""
    for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
        found = re.search(r"^# (.+)$", _text(cell["source"]), re.MULTILINE)
        if cell["cell_type"] == "markdown" and found:
            return found[1].strip()
    return notebook.stem


def _results(cell: Mapping[str, Any], folder: Path, stem: str) -> Iterator[str]:
    """Returns what a cell has given."""
    for number, output in enumerate(cell.get("outputs", ())):
        data = output.get("data", {})
        if "image/png" in data:
            name = f"{stem}-{number}.png"
            (folder / name).write_bytes(base64.b64decode(_text(data["image/png"])))
            yield f"![Result of the code above]({name})"
        elif "text/plain" in data or output.get("name") == "stdout":
            text = _text(data.get("text/plain", output.get("text", "")))
            yield _fenced(_ANSI.sub("", text).rstrip("\n"), "text")


def _text(lines: str | list[str]) -> str:
    return lines if isinstance(lines, str) else "".join(lines)


def _fenced(text: str, language: str) -> str:
    """Returns a fenced block, whatever fences the text has itself."""
    longest = max(map(len, re.findall(r"`{3,}", text)), default=2)
    fence = "`" * (longest + 1)
    return f"{fence}{language}\n{text}\n{fence}"
