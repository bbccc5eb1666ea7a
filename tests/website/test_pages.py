"""Which pages the site has: all of them, in the order of the list, without HTML."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.test_documents import links
from website.contents import AT_THE_TOP, FRONT, LIST, ROOT, all_pages, sections
from website.staging import INDEX, for_sphinx, stage, table_of_contents

MARKDOWN = sorted({*all_pages(), LIST})


def test_every_page_is_listed_once_in_the_order_of_a_newcomer() -> None:
    contents = sections()
    listed = [page for pages in contents.values() for page in pages]
    assert sorted(listed) == sorted(all_pages())
    assert set(AT_THE_TOP) <= set(listed)
    order = [
        *(FRONT, "docs/ten-minutes.md", "docs/my-robot.md", "docs/real-robot.md", "docs/paths.md"),
        *("docs/laws.md", "docs/sweeps.md", "docs/paper.md", "docs/scenario.md", "ARCHITECTURE.md"),
    ]
    assert sorted(order, key=listed.index) == order


def test_page_that_is_listed_twice_is_told() -> None:
    row = "| look | [a](paths.md) |\n"
    assert sections(f"## A\n{row}## B\n| law | [b](laws/pid.md), [c](../README.md#x) |\n") == {
        "A": ["docs/paths.md"],
        "B": ["docs/laws/pid.md"],
    }
    with pytest.raises(ValueError, match=r"docs/README.md: docs/paths.md is listed twice"):
        sections(f"## A\n{row}## B\n{row}")


def test_page_that_is_not_listed_stops_the_site(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("website.staging.all_pages", lambda: {*all_pages(), "docs/new.md"})
    with pytest.raises(ValueError, match=r"forgotten or not there: \['docs/new.md'\]"):
        stage(tmp_path, {})


def test_staged_pages_have_no_comments_and_links_that_lead_somewhere(tmp_path: Path) -> None:
    stage(tmp_path, {})
    staged = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.md")}
    assert staged >= ({*all_pages(), LIST} - {FRONT}) | {INDEX}
    for page in sorted(staged):
        text = (tmp_path / page).read_text(encoding="utf-8")
        assert "<!-- not run" not in outside_of_code(text)
        for link in links(str(tmp_path / page)):
            assert ((tmp_path / page).parent / link.partition("#")[0]).exists(), (page, link)
    contents = (tmp_path / INDEX).read_text(encoding="utf-8").partition("```{toctree}")[2]
    entries = re.findall(r"^(?:All pages <)?([\w/-]+)>?$", contents, re.MULTILINE)
    notebooks = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("notebooks/*.md")}
    assert {f"{entry}.md" for entry in entries} == staged - {INDEX} - notebooks


def test_links_to_the_readme_and_to_notebooks_are_those_of_the_site() -> None:
    text = "<!-- why -->\n[a](../../README.md#six-commands) [b](../notebooks/x.ipynb) [c](y.md)\n"
    assert for_sphinx(text, "docs/laws/pid.md") == (
        "[a](../../index.md#six-commands) [b](../notebooks/x.md) [c](y.md)\n"
    )
    code = "```html\n<!-- why -->\n[a](../README.md)\n```\n"
    assert for_sphinx(code, "docs/show.md") == code


def test_generated_pages_stand_below_a_heading_that_is_there() -> None:
    table = table_of_contents({"One": [FRONT], "Two": ["docs/a.md"]}, {"Two": ["docs/b.rst"]})
    assert ":caption: Two\n:maxdepth: 1\n\ndocs/a\ndocs/b\n```" in table
    with pytest.raises(ValueError, match=r"has no heading \['Three'\]"):
        table_of_contents({"One": []}, {"Three": []})


@pytest.mark.parametrize("page", MARKDOWN)
def test_page_is_plain_markdown(page: str) -> None:
    text = outside_of_code((ROOT / page).read_text(encoding="utf-8"))
    assert not re.findall(r"</?[a-zA-Z][^>\n]*>", text)
    assert not re.findall(r"^`{3,}\{|\{[a-z]+\}`|^\+\+\+|^:::|^\([\w-]+\)=", text, re.MULTILINE)


def outside_of_code(text: str) -> str:
    """A page without its code, but with the fences."""
    text = re.sub(r"^(```.*)\n(?:.*\n)*?```$", r"\1", text, flags=re.MULTILINE)
    text = re.sub(r"^    .*$", "", text, flags=re.MULTILINE)
    return re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", "", text, flags=re.DOTALL)
