"""The links of the built site: they lead somewhere, and nothing is loaded from elsewhere.

Addresses of other sites are collected, not asked for.
"""

from __future__ import annotations

from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_LOADED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src"}
_NO_LOADING = {"canonical", "index", "search", "prev", "next"}


class _Page(HTMLParser):
    """What a page has of anchors, of links, and of what a browser loads with it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Takes note of a tag."""
        values = {name: value or "" for name, value in attrs}
        self.anchors.update(values[name] for name in ("id", "name") if name in values)
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        elif tag in _LOADED and values.get("rel", "") not in _NO_LOADING:
            place = values.get(_LOADED[tag], "")
            if place:
                self.loaded.append(place)


def broken_links(site: Path) -> list[str]:
    """Returns a line for each link that leads nowhere and for what is loaded from elsewhere."""
    pages = _pages(site)
    found = []
    for file, page in pages.items():
        for link in [*page.links, *page.loaded]:
            parts = urlsplit(link)
            if parts.scheme == "data":
                continue
            if parts.scheme or parts.netloc:
                if link in page.loaded:
                    found.append(f"{file.relative_to(site)}: loads {link}")
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            anchors = pages[target].anchors if target in pages else None
            if not target.is_file():
                found.append(f"{file.relative_to(site)}: {link}: no such file")
            elif anchors is not None and unquote(parts.fragment) not in {"", *anchors}:
                found.append(f"{file.relative_to(site)}: {link}: no such anchor")
    return found


def external_links(site: Path) -> list[str]:
    """Returns the addresses of other sites that pages link to."""
    links = {link for page in _pages(site).values() for link in page.links}
    return sorted(link for link in links if urlsplit(link).scheme in ("http", "https"))


def _pages(site: Path) -> dict[Path, _Page]:
    return {file: _Page(file.read_text(encoding="utf-8")) for file in _files(site.resolve())}


def _files(site: Path) -> Iterator[Path]:
    yield from sorted(site.rglob("*.html"))
