"""The pages as Sphinx is to read them, in a folder of their own: `docs/` stays plain Markdown.

The folder is laid out as the checkout is, so that links between pages stay as they are. Comments
are taken out, since the site takes no HTML, and the README becomes the front page.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path

from website.contents import AT_THE_TOP, DOCS, FRONT, LIST, ROOT, all_pages, notebooks, sections
from website.notebooks import page_of, title_of

INDEX = "index.md"
LINKED_FOLDERS = ("scenarios", "trajectories", "programs")
"""Folders of files that pages link to."""

_FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})")
_COMMENT = re.compile(r"^\s*<!--.*-->\s*$")
_LINK = re.compile(r"\]\((?![a-z]+:)([^)\s#]+)(#[^)\s]*)?\)")


def stage(folder: Path, generated: Mapping[str, Iterable[str]]) -> None:
    """Writes all pages into a folder, and the table of contents into the front page.

    Args:
        folder: Where; it holds the generated pages already.
        generated: Pages that are made from the program, by the heading below which they stand.

    Raises:
        ValueError: A page is not listed, or is listed and not there.
    """
    contents = sections()
    listed = {page for pages in contents.values() for page in pages}
    if listed != all_pages():
        raise ValueError(f"{LIST}: forgotten or not there: {sorted(listed ^ all_pages())}")
    for page in (*AT_THE_TOP, *(path.relative_to(ROOT).as_posix() for path in DOCS.rglob("*.md"))):
        text = for_sphinx((ROOT / page).read_text(encoding="utf-8"), page)
        if page == FRONT:
            text += table_of_contents(contents, generated)
        _write(folder / (INDEX if page == FRONT else page), text)
    for book in notebooks():
        made = page_of(book, folder / "docs" / "notebooks")
        _write(folder / "docs" / "notebooks" / f"{book.stem}.md", for_sphinx(made, ""))
    shutil.copytree(DOCS / "images", folder / "docs" / "images", dirs_exist_ok=True)
    for name in LINKED_FOLDERS:
        shutil.copytree(ROOT / name, folder / name, dirs_exist_ok=True)


def for_sphinx(text: str, page: str) -> str:
    """Returns a page without comments, its links to the README and to notebooks as on the site."""
    lines = []
    fence = ""
    for line in text.splitlines():
        found = _FENCE.match(line)
        if fence:
            fence = "" if found and line.strip() == fence else fence
        elif found:
            fence = found[1]
        elif _COMMENT.match(line):
            continue
        else:
            line = _LINK.sub(lambda link: f"]({_target(link[1], page)}{link[2] or ''})", line)
        lines.append(line)
    return "\n".join(lines) + "\n"


def _target(link: str, page: str) -> str:
    """Where a link leads on the site."""
    if link.endswith(".ipynb"):
        return link.removesuffix(".ipynb") + ".md"
    folder = os.path.dirname(page)  # noqa: PTH120  # a path of the site, not of this machine
    if os.path.normpath(os.path.join(folder, link)) == FRONT:  # noqa: PTH118
        return os.path.relpath(INDEX, folder or ".")
    return link


def table_of_contents(
    contents: Mapping[str, Iterable[str]], generated: Mapping[str, Iterable[str]]
) -> str:
    """Returns the tables of contents of the front page, which the theme shows beside all pages.

    Raises:
        ValueError: Generated pages stand below a heading that the list does not have.
    """
    if not set(generated) <= set(contents):
        raise ValueError(f"{LIST}: has no heading {sorted(set(generated) - set(contents))}")
    parts: list[str] = []
    for heading, pages in contents.items():
        names = [page for page in pages if page != FRONT]
        if not parts:
            names.append(LIST)
        names += generated.get(heading, ())
        names = [_entry(name) for name in names]
        options = f":hidden:\n:caption: {heading}\n:maxdepth: 1\n"
        parts.append("\n".join(["\n```{toctree}", options, *names, "```\n"]))
    return "".join(parts)


def _entry(page: str) -> str:
    """Returns the line of a table of contents for a page."""
    name = page.rpartition(".")[0]
    return f"All pages <{name}>" if page == LIST else name


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def list_of_notebooks(folder: Path) -> str:
    """Writes the page that lists the notebooks, and returns its name."""
    names = [book.stem for book in notebooks()]
    lines = [
        "# Notebooks",
        "",
        "With the results that are kept in them; each can be had as a file, to run it.",
        "",
    ]
    for book in notebooks():
        lines.append(f"- [{title_of(book)}]({book.stem}.md): [{book.name}]({book.name})")
    lines += ["", "```{toctree}", ":hidden:", "", *names, "```"]
    name = "docs/notebooks/index.md"
    _write(folder / name, "\n".join(lines) + "\n")
    return name
