"""Packages beside hilc, installed from what a page says of them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

PAGE = Path(__file__).resolve().parent.parent / "docs" / "plug-ins.md"


def blocks(language: str) -> list[str]:
    """The blocks of the page that are in a language."""
    text = PAGE.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def modules() -> dict[str, str]:
    """The modules of the page, by the names of their files."""
    text = PAGE.read_text(encoding="utf-8")
    return dict(
        re.findall(r"^`(\w+\.py)`:\n\n```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    )


def install(site: Path, project: str, files: dict[str, str]) -> None:
    """Puts a package where an installer would.

    Args:
        site: The folder of installed packages.
        project: The text of its pyproject.toml.
        files: Its modules, by the names of their files.
    """
    table = tomllib.loads(project)["project"]
    name, version = table["name"], table["version"]
    info = site / f"{name.replace('-', '_')}-{version}.dist-info"
    info.mkdir(parents=True)
    metadata = f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"
    (info / "METADATA").write_text(metadata, encoding="utf-8")
    points = "".join(
        f"[{group}]\n" + "".join(f"{key} = {value}\n" for key, value in entries.items())
        for group, entries in table["entry-points"].items()
    )
    (info / "entry_points.txt").write_text(points, encoding="utf-8")
    (info / "top_level.txt").write_text("".join(f"{Path(file).stem}\n" for file in files))
    for file, text in files.items():
        (site / file).write_text(text, encoding="utf-8")
