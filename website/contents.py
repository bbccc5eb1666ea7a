"""Which pages the site has, and in which order: as `docs/README.md` lists them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
NOTEBOOKS = DOCS / "notebooks"

LIST = "docs/README.md"
FRONT = "README.md"
AT_THE_TOP = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")
"""Pages outside of ``docs/``."""

_LINK = re.compile(r"\]\(([^)\s#]+\.md)\)")


def sections(text: str | None = None) -> dict[str, list[str]]:
    """Returns the pages below each heading of the list, as paths from the top of the checkout.

    Args:
        text: The list; without it, that of the checkout.

    Raises:
        ValueError: A page is listed twice.
    """
    found: dict[str, list[str]] = {}
    seen: set[str] = set()
    heading = ""
    for line in (text or (ROOT / LIST).read_text(encoding="utf-8")).splitlines():
        if line.startswith("## "):
            heading = line.removeprefix("## ").strip()
            found[heading] = []
        elif heading and line.startswith("| "):
            for page in pages_in(line):
                if page in seen:
                    raise ValueError(f"{LIST}: {page} is listed twice")
                seen.add(page)
                found[heading].append(page)
    return found


def pages_in(row: str) -> Iterator[str]:
    """Returns the pages that a row of the list links to."""
    for link in _LINK.findall(row):
        parts: list[str] = []
        for part in (PurePosixPath(LIST).parent / link).parts:
            if part == "..":
                parts.pop()
            else:
                parts.append(part)
        yield "/".join(parts)


def all_pages() -> set[str]:
    """Returns the pages that there are, listed or not, but for the list itself."""
    inside = {page.relative_to(ROOT).as_posix() for page in DOCS.rglob("*.md")}
    return (inside | set(AT_THE_TOP)) - {LIST}


def notebooks() -> list[Path]:
    """Returns the notebooks, by name; none if there are none."""
    return sorted(NOTEBOOKS.glob("*.ipynb"))
