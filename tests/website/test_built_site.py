"""The site as it is built, in a browser, from a file: it is searched, and asks for nothing."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.html_reports.chromium import Page, browser, open_browser
from website.contents import ROOT
from website.links import broken_links

PROGRAM = browser()
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        importlib.util.find_spec("sphinx") is None, reason="the extra docs is not installed"
    ),
]
PAGES = (
    *("index.html", "docs/ten-minutes.html", "docs/laws.html", "docs/reference/commands/run.html"),
    *("docs/reference/gallery.html", "docs/reference/python/runs.html", "genindex.html"),
)
PHONE, DESK = 360, 1280


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site without the pictures that the gallery draws."""
    folder = tmp_path_factory.mktemp("site") / "site"
    done = subprocess.run(
        [sys.executable, "website/build.py", "--no-gallery", "--out", folder],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    return folder


@pytest.fixture
def page(site: Path, tmp_path: Path) -> Iterator[Page]:
    if PROGRAM is None:
        pytest.skip("there is no Chromium here; apt-get install chromium")
    with open_browser(PROGRAM, tmp_path / "home") as page:
        yield page
        assert all(request.startswith("file://") for request in page.requests())
        assert page.complaints() == []


def test_links_of_the_site_lead_somewhere(site: Path) -> None:
    assert broken_links(site) == []
    assert len(list(site.rglob("*.html"))) > 50


@pytest.mark.parametrize("name", PAGES)
def test_page_fits_the_window_on_a_desk_and_on_a_telephone(
    site: Path, page: Page, name: str
) -> None:
    page.open(site / name, DESK)
    for width in (DESK, PHONE):
        page.resize(width)
        page.frames()
        assert page.run("document.documentElement.scrollWidth") <= width
    assert page.run("document.querySelectorAll('.sidebar-tree .caption').length") >= 9


@pytest.mark.parametrize(
    ("words", "found"),
    [("delay margin", "What hilc check says"), ("picture_look", "picture_look"), ("tau", "tau")],
)
def test_search_from_a_file_finds_pages(site: Path, page: Page, words: str, found: str) -> None:
    page.open(site / "search.html")
    page.run(f"location.href = {(site / 'search.html').as_uri() + '?q=' + words!r}")
    end = time.monotonic() + 20
    while "Search finished" not in (told := page.run("document.body?.innerText ?? ''")):
        assert time.monotonic() < end, told
        time.sleep(0.1)
    results = page.run("document.querySelector('#search-results ul.search').innerText")
    assert found in results
