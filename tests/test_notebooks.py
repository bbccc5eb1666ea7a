"""The notebooks: valid, small, nobody's own; and what they show is still what comes of them."""

from __future__ import annotations

import ast
import json
import re
import warnings
from pathlib import Path
from typing import Any

import nbformat
import pytest

from tests.notebooks import FOLDER, NOTEBOOKS, executed, read, told
from tests.test_documents import anchors

MOST = 300_000  # bytes of a notebook with its outputs
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_ALIKE = 0.05  # what other machines and versions may change of a number; more is another result
_SMALL = 2e-3  # and of one near 0


def words_and_numbers(text: str) -> tuple[list[str], list[str]]:
    """What a text says, but for the room between its words, and the numbers in it."""
    return _NUMBER.sub("#", text).split(), _NUMBER.findall(text)


def last_place(number: str) -> float:
    """What a step of the last digit is of a number with decimals; it was rounded to that."""
    digits, _, exponent = number.partition("e")
    decimals = len(digits.partition(".")[2])
    return 10.0 ** (int(exponent or 0) - decimals) if decimals else 0.0


def assert_alike(before: list[str], now: list[str], where: str) -> None:
    for one, other in zip(before, now, strict=True):
        rounded = 1.001 * max(last_place(one), last_place(other), _SMALL)
        assert float(one) == pytest.approx(float(other), rel=_ALIKE, abs=rounded), where


@pytest.fixture(params=NOTEBOOKS, ids=[file.stem for file in NOTEBOOKS])
def file(request: pytest.FixtureRequest) -> Path:
    path: Path = request.param
    return path


def test_there_are_three() -> None:
    assert [file.stem for file in NOTEBOOKS] == [
        "choosing-gains-under-uncertainty",
        "first-steps",
        "from-simulation-to-a-robot",
    ]


def test_it_is_a_valid_notebook_of_few_bytes(file: Path) -> None:
    notebook = read(file)
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        nbformat.validate(notebook)
    assert file.stat().st_size < MOST


def test_nothing_of_a_machine_is_in_it(file: Path) -> None:
    notebook = read(file)
    assert notebook["metadata"].keys() == {"kernelspec", "language_info"}
    assert all(not cell["metadata"] for cell in notebook["cells"])
    shown = json.dumps([told(cell) for cell in notebook["cells"]])
    assert not re.search(r"/(home|root|tmp|work|Users|usr|opt)/|[A-Z]:\\", shown)


def test_cells_are_plain_python(file: Path) -> None:
    for cell in read(file)["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "code":
            assert ast.parse(source).body, cell["id"]  # no magics
            assert max(map(len, source.splitlines())) <= 100, cell["id"]


def test_its_links_lead_somewhere(file: Path) -> None:
    texts = ["".join(c["source"]) for c in read(file)["cells"] if c["cell_type"] == "markdown"]
    links = re.findall(r"\]\(([^)\s]+)\)", "\n".join(texts))
    assert links
    for link in links:
        target, _, anchor = link.partition("#")
        assert (FOLDER / target).exists(), link
        assert not anchor or anchor in anchors(FOLDER / target), link


def test_what_it_shows_is_what_comes_of_it(
    file: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    anew = "python -m tests.notebooks stores it anew"
    stored: dict[str, Any] = read(file)
    for before, now in zip(stored["cells"], executed(stored)["cells"], strict=True):
        texts = [list(map(words_and_numbers, told(cell))) for cell in (before, now)]
        for (words, numbers), (words_now, numbers_now) in zip(*texts, strict=True):
            assert words == words_now, f"{before['id']}: {anew}"
            assert_alike(numbers, numbers_now, before["id"])


@pytest.mark.parametrize(
    ("before", "now", "alike"),
    [("0.05", "0.04", True), ("0.05", "0.03", False), ("3", "4", False), ("2.1e-05", "2e-05", True),
     ("100.7", "107.0", False), ("12.34", "12.9", True)],
)  # fmt: skip
def test_numbers_are_alike_but_for_rounding_and_a_few_percent(
    before: str, now: str, alike: bool
) -> None:
    try:
        assert_alike([before], [now], "")
    except AssertionError:
        assert not alike
    else:
        assert alike


def test_each_is_named_where_python_is_told_of() -> None:
    page = (FOLDER.parent / "python.md").read_text(encoding="utf-8")
    for file in NOTEBOOKS:
        assert f"(notebooks/{file.name})" in page
