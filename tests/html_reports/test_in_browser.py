"""The page in a browser: it asks for nothing, complains of nothing, and plays."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from hilc_cli.html_reports.report import report
from hilc_cli.plants.kinematic import Robot
from tests.html_reports.chromium import Page, browser, open_browser
from tests.html_reports.test_report import HOSTILE, a_sweep, results_of
from tests.leaderboards.test_leaderboard_folder import DATA
from tests.made_up_runs import MakeRun

PROGRAM = browser()
pytestmark = pytest.mark.skipif(
    PROGRAM is None, reason="there is no Chromium here; apt-get install chromium"
)

ROBOT = "document.querySelector('.player .robot').getAttribute('transform')"
TOLD = "document.querySelector('.player .told').textContent"
DRIVEN = "document.querySelector('.panels .path path.driven').getAttribute('d')"
FOCUS = "document.querySelector('.player').focus()"


@pytest.fixture(scope="module")
def place_of_all(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the page and the browser's things are, for all tests."""
    return tmp_path_factory.mktemp("browser")


@pytest.fixture
def page(place_of_all: Path, make_run: MakeRun) -> Iterator[Page]:
    """A report of runs, a sweep and a leaderboard, with hostile names, open in a browser."""
    file = place_of_all / "report.html"
    if not file.exists():
        first = replace(make_run(HOSTILE), robot=Robot(0.2, 0.518), warnings=(HOSTILE,))
        results = results_of(first, make_run("b"), sweeps=[a_sweep()], boards=[DATA])
        report(results, file, title=HOSTILE)
    assert PROGRAM is not None
    with open_browser(PROGRAM, place_of_all / "home") as page:
        page.open(file)
        yield page
        assert page.requests() == []
        assert page.complaints() == []


@pytest.mark.parametrize(
    ("marks", "turned"),
    [
        ('data-jp-theme-light="true"', False),
        ('data-jp-theme-light="false"', True),
        ('class="vscode-dark"', True),
        ('style="color: #eee; background: #222"', False),  # dark, and does not say so
    ],
)
def test_results_in_a_notebook_are_legible_light_and_dark(
    tmp_path: Path, place_of_all: Path, make_run: MakeRun, marks: str, turned: bool
) -> None:
    file = tmp_path / "notebook.html"
    parts = [make_run(HOSTILE)._repr_html_(), a_sweep()._repr_html_()]
    file.write_text(f"<!doctype html><meta charset=utf-8><body {marks}>{''.join(parts)}")
    assert PROGRAM is not None
    with open_browser(PROGRAM, place_of_all / "home") as page:
        page.open(file)
        assert page.run("document.images.length") == 2
        assert page.run("[...document.images].every(i => i.complete && i.naturalWidth > 0)")
        of_picture = "getComputedStyle(document.images[1])"
        assert ("invert" in page.run(f"{of_picture}.filter")) == turned
        assert page.run(f"{of_picture}.backgroundColor") == "rgb(255, 255, 255)"
        words = "getComputedStyle(document.querySelector('.hilc-result td')).color"
        assert page.run(words) == page.run("getComputedStyle(document.body).color")
        assert page.requests() == page.complaints() == []


def slide(page: Page, name: str, value: int) -> None:
    page.run(
        f"(() => {{ const s = document.querySelector('.player .{name} input');"
        f" s.value = {value}; s.dispatchEvent(new Event('input')); }})()"
    )


def place(page: Page) -> tuple[float, float]:
    """Where the first robot is drawn [pixel]."""
    found = re.match(r"translate\((\S+) (\S+)\)", page.run(ROBOT))
    assert found is not None
    return float(found[1]), float(found[2])


def test_nothing_is_asked_for_and_no_script_of_a_name_runs(page: Page) -> None:
    assert page.run("document.title") == HOSTILE
    assert page.run("document.scripts.length") == 3
    assert page.run("document.querySelectorAll('img[onerror]').length") == 0
    assert page.run("[...document.images].every(i => i.complete && i.naturalWidth > 0)")


def test_slider_of_the_time_moves_the_robot_along_its_path(page: Page) -> None:
    # On a circle about the origin from (10, 0) counterclockwise, blown up by 0.95 about that point.
    view = "document.querySelector('.panels .path > svg').viewBox.baseVal.width"
    assert page.run(view) > 300
    slide(page, "time", 0)
    start = place(page)
    slide(page, "time", 40)
    half = place(page)
    assert half[0] < start[0] - 100  # the other side of the circle
    assert half[1] == pytest.approx(start[1], abs=1.5)
    slide(page, "time", 20)
    quarter = place(page)
    radius = (start[0] - half[0]) / 2
    assert quarter[0] == pytest.approx((start[0] + half[0]) / 2, abs=2)
    assert quarter[1] == pytest.approx(start[1] - radius, abs=2)
    assert ", 0.500 s:" in page.run(TOLD)  # sample 20 of 25 ms


def test_slider_of_the_iterations_changes_path_error_and_wheels(page: Page) -> None:
    before = page.run(DRIVEN)
    errors = "document.querySelector('.panels .error path.driven').getAttribute('d')"
    past = "document.querySelector('.player').querySelectorAll('.path svg g path.past').length"
    error = page.run(errors)
    assert page.run(past) == 3
    slide(page, "iteration", 0)
    assert page.run(DRIVEN) != before
    assert page.run(errors) != error
    assert page.run(past) == 0
    assert page.run(TOLD).startswith("Iteration 0,")


def test_what_is_told_is_the_error_of_the_run(page: Page, make_run: MakeRun) -> None:
    slide(page, "time", 40)
    slide(page, "iteration", 1)
    expected = make_run(HOSTILE).position_error(1)[40]
    found = re.search(r"position error ([0-9.]+) m,", page.run(TOLD))
    assert found is not None
    assert float(found[1]) == pytest.approx(expected, rel=5e-3)


def test_keys(page: Page) -> None:
    page.run(FOCUS)
    page.key("Home", 36)
    assert ", 0.000 s" in page.run(TOLD)
    page.key("ArrowRight", 39)
    assert ", 0.025 s" in page.run(TOLD)  # a sample of 25 ms, as a hundredth of the pass is less
    page.key("ArrowDown", 40)
    assert page.run(TOLD).startswith("Iteration 2,")
    page.key("ArrowUp", 38)
    page.key("End", 35)
    assert page.run(TOLD).startswith("Iteration 3, 2.000 s")


def test_space_plays_through_the_passes_to_the_end(page: Page) -> None:
    page.run("document.querySelector('.player select').value = '50'")
    page.run(FOCUS)
    page.key(" ", 32, " ")
    assert page.run("document.querySelector('.play').textContent") == "Pause"
    ended = (
        "new Promise(r => { const look = () => document.querySelector('.play').textContent"
        " === 'Play' ? r(1) : setTimeout(look, 50); look(); })"
    )
    assert page.run(ended) == 1
    assert page.run(TOLD).startswith("Iteration 3, 2.000 s")


def test_dark_light_and_paper_are_read_well(page: Page) -> None:
    color = "getComputedStyle(document.body).{}"
    filtered = "getComputedStyle(document.images[0]).filter"

    def contrast() -> float:
        return ratio(page.run(color.format("color")), page.run(color.format("backgroundColor")))

    assert page.run(color.format("backgroundColor")) == "rgb(255, 255, 255)"
    assert contrast() > 7
    page.media(prefers_color_scheme="dark")
    assert page.run(color.format("backgroundColor")) == "rgb(25, 25, 25)"
    assert contrast() > 7
    assert "invert" in page.run(filtered)
    page.media("print", prefers_color_scheme="dark")
    assert page.run(color.format("backgroundColor")) == "rgb(255, 255, 255)"
    assert page.run(filtered) == "none"
    assert page.run("getComputedStyle(document.querySelector('.controls')).display") == "none"
    page.media()
    page.run("document.getElementById('theme').click()")
    page.run("document.getElementById('theme').click()")
    assert page.run("document.documentElement.dataset.theme") == "dark"
    assert contrast() > 7


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_colours_stand_out(page: Page, theme: str) -> None:
    page.run(f"document.documentElement.dataset.theme = '{theme}'")
    page.run("document.body.style.backgroundColor = 'var(--raised)'")
    behind = page.run("getComputedStyle(document.body).backgroundColor")
    for name in ("ink", "muted", "accent", "driven", "left", "right", "warning"):
        page.run(f"document.body.style.color = 'var(--{name})'")
        shown = page.run("getComputedStyle(document.body).color")
        assert ratio(shown, behind) >= 4.5, name


def ratio(first: str, second: str) -> float:
    """Contrast of two colours.

    Source:
        Web Content Accessibility Guidelines 2.2, W3C, definitions of contrast ratio and relative
        luminance.
    """

    def luminance(color: str) -> float:
        parts = [int(number) / 255 for number in re.findall(r"\d+", color)[:3]]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(first), luminance(second)))
    return (high + 0.05) / (low + 0.05)


def test_telephone_has_no_sideways_scrolling(page: Page) -> None:
    page.resize(360, 740)
    page.frames()
    assert page.run("document.documentElement.scrollWidth") <= 360
    assert page.run("document.querySelector('.panels .path > svg').clientWidth") > 280
    sizes = "[...document.querySelectorAll('.panels .tick')].map(t => parseFloat("
    assert min(page.run(f"{sizes}getComputedStyle(t).fontSize))")) >= 12


def test_everything_that_is_used_has_a_name(page: Page) -> None:
    unnamed = (
        "[...document.querySelectorAll('button, input, select, [role=img], [role=group], img')]"
        ".filter(e => !(e.textContent.trim() || e.ariaLabel || e.alt || e.labels?.length)).length"
    )
    assert page.run(unnamed) == 0
    values = "[...document.querySelectorAll('input[type=range]')].every(e => e.ariaValueText)"
    assert page.run(values)
