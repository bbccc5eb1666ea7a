"""Notebooks as pages: text and pictures that are kept in them, nothing that a browser runs."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import pytest

from website import notebooks, staging

PNG = base64.b64encode(b"\x89PNG of a test").decode()
CELLS = [
    {"cell_type": "markdown", "source": ["# Two laws\n", "\n", "[a page](../paths.md)"]},
    {
        "cell_type": "code",
        "source": "print('```')\nrun",
        "outputs": [
            {"name": "stdout", "text": ["\x1b[1m```\x1b[0m\n"]},
            {"data": {"text/html": "<script>alert(1)</script>", "text/plain": "Run(...)"}},
            {"data": {"text/html": "<b>only this</b>"}},
            {"data": {"image/png": PNG, "text/plain": "<Figure>"}},
        ],
    },
    {"cell_type": "raw", "source": "<script>alert(2)</script>"},
    {"cell_type": "code", "source": "", "outputs": []},
]


@pytest.fixture
def book(tmp_path: Path) -> Path:
    file = tmp_path / "two-laws.ipynb"
    file.write_text(json.dumps({"nbformat": 4, "metadata": {}, "cells": CELLS}))
    return file


def test_page_has_text_code_and_results_and_no_html(book: Path, tmp_path: Path) -> None:
    page = notebooks.page_of(book, tmp_path / "pages")
    assert page == (
        "# Two laws\n\n[a page](../paths.md)\n\n"
        "````python\nprint('```')\nrun\n````\n\n"
        "````text\n```\n````\n\n"
        "```text\nRun(...)\n```\n\n"
        "![Result of the code above](two-laws-1-3.png)\n"
    )
    assert (tmp_path / "pages" / "two-laws-1-3.png").read_bytes() == b"\x89PNG of a test"
    assert (tmp_path / "pages" / book.name).read_bytes() == book.read_bytes()


def test_list_of_notebooks_has_titles_and_files(
    book: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = tmp_path / "plain.ipynb"
    plain.write_text(json.dumps({"cells": CELLS[2:]}))
    monkeypatch.setattr(staging, "notebooks", lambda: [book, plain])
    page = (tmp_path / "site" / staging.list_of_notebooks(tmp_path / "site")).read_text()
    assert "- [Two laws](two-laws.md): [two-laws.ipynb](two-laws.ipynb)\n" in page
    assert "- [plain](plain.md): [plain.ipynb](plain.ipynb)\n" in page
    assert "\ntwo-laws\nplain\n```" in page
