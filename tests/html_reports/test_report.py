"""The page: what is in it, that it asks for nothing, and that names of strangers stay text."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.html_reports.report import Place, Results, read_results, report
from hilc_cli.html_reports.templates import template
from hilc_cli.labs.lab import Lab
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import summarise
from hilc_cli.sweeps.data import SweepData
from tests.labs.robots import driven, scenario, write_log
from tests.leaderboards.test_leaderboard_folder import DATA
from tests.made_up_runs import MakeRun
from tests.made_up_sweeps import L1, L2, numbers, sweep

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&<!--"
SVG = "data:image/svg+xml,"
RUNS = {"src", "href", "srcset", "action", "data", "poster", "background"}


class Page(HTMLParser):
    """The elements and texts of a page."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.source = file.read_text(encoding="utf-8")
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.texts: list[str] = []
        self.scripts: list[str] = []
        self._in = ""
        self.feed(self.source)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {key: value or "" for key, value in attrs}))
        self._in = tag

    def handle_data(self, data: str) -> None:
        if self._in == "script":
            self.scripts.append(data)
        elif self._in != "style":
            self.texts.append(data.strip())

    def handle_endtag(self, tag: str) -> None:
        self._in = ""

    def of(self, tag: str) -> list[dict[str, str]]:
        return [attributes for each, attributes in self.tags if each == tag]


def results_of(
    *runs: RunData,
    sweeps: Sequence[SweepData] = (),
    boards: Sequence[LeaderboardData] = (),
    at: Path = Path(),
) -> Results:
    folders: dict[Place, RunData] = {at / f"run{place}": run for place, run in enumerate(runs)}
    of_sweeps: dict[Place, SweepData] = {
        at / f"sweep{place}": each for place, each in enumerate(sweeps)
    }
    of_boards: dict[Place, LeaderboardData] = {
        at / f"board{place}": each for place, each in enumerate(boards)
    }
    return Results((*folders, *of_sweeps, *of_boards), folders, of_sweeps, of_boards)


def a_sweep() -> SweepData:
    return sweep({L1: numbers(0.1, 1.0), L2: numbers(0.0, 2.0)}, lambda v: float(v[L1]) + 1)  # type: ignore[arg-type]


def test_choices_of_a_sweep_have_a_table_and_pictures(folder: Path) -> None:
    axes = {L1: numbers(0.1, 1.0, 3.0), "robot.wheel_radius": numbers(0.19, 0.2)}
    errors = np.array([0.3, 0.4, 0.2, 0.25, 0.1, math.inf])
    data = replace(sweep(axes, errors), over=("robot.wheel_radius",))
    page = Page(report(results_of(sweeps=[data]), folder / "choices.html"))
    texts = page.texts
    assert "Best choices by their worst max_position_error_m" in texts
    first = texts.index("Worst case") + 1
    row = ["1", "1", "0.2500", "0.2475", "0.2250", "0.2250", "0 of 2", "3"]
    assert [text for text in texts[first:] if text and text != "[m]"][: len(row)] == row
    assert "All 3 choices are in choices.csv." in texts
    captions = [each["alt"] for each in page.of("img")]
    assert any("what happens" in caption for caption in captions)
    assert len(captions) == 2  # the curve of the worst cases, and the spread


@pytest.fixture
def page(make_run: MakeRun, folder: Path) -> Page:
    """A page with a result of each kind."""
    runs = (make_run("first"), make_run("second", factors=(0.3, 0.99)))
    results = results_of(*runs, sweeps=[a_sweep()], boards=[DATA])
    return Page(report(results, folder / "all.html"))


def test_everything_is_in_the_file(page: Page) -> None:
    for tag, attributes in page.tags:
        for name in RUNS & attributes.keys():
            assert attributes[name].startswith(("data:", "#")), (tag, name)
        assert not [name for name in attributes if name.startswith("on")]
        assert "style" not in attributes
    (link,) = page.of("link")
    assert link["href"] == "data:,"
    assert "url(" not in re.sub(r"url\(#\$\{clip\}\)", "", page.source)


def test_browser_is_told_to_run_the_pages_own_program_alone(page: Page) -> None:
    policies = [each["content"] for each in page.of("meta") if "http-equiv" in each]
    (policy,) = policies
    own = re.findall(r"'(sha256-[^']+)'", policy)
    programs = re.findall(r"<script>(.*?)</script>", page.source, re.DOTALL)
    styles = re.findall(r"<style>(.*?)</style>", page.source, re.DOTALL)
    sums = [hashlib.sha256(text.encode()).digest() for text in (*styles, *programs)]
    assert own == [f"sha256-{base64.b64encode(each).decode()}" for each in sums]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy


def test_a_chapter_of_each_result_in_its_order(page: Page) -> None:
    ids = [each["id"] for each in page.of("section")]
    assert ids == [f"chapter-{number}" for number in range(1, 6)]
    titles = [each["aria-label"] for each in page.of("section")]
    assert titles == ["Comparison of 2 runs", "first", "second", "sweep", "test"]
    assert [each["href"] for each in page.of("a")] == [f"#{each}" for each in ids]


def test_each_picture_has_words_and_a_size(page: Page) -> None:
    pictures = page.of("img")
    assert len(pictures) > 8
    for each in pictures:
        assert len(each["alt"]) > 10
        assert int(each["width"]) > 100
        content = unquote(each["src"].removeprefix(SVG))
        assert content.startswith("<?xml") and "<svg" in content
    for each in page.of("th"):
        assert each["scope"] in ("col", "row")
    assert page.of("html") == [{"lang": "en"}]


def test_figures_are_those_of_the_run(make_run: MakeRun, folder: Path) -> None:
    run = make_run("only")
    page = Page(report(results_of(run), folder / "one.html"))
    final = summarise(run).final
    for metric in ("max_position_error_m", "rms_position_error_m", "final_position_error_m"):
        assert f"{final[metric]:.4g} m" in page.texts
    assert summarise(run).headline in page.texts
    played = json.loads(page.scripts[0])
    assert [each["number"] for each in played["iterations"]] == [0, 1, 2, 3]
    assert not page.of("nav")


def test_names_of_strangers_stay_text(make_run: MakeRun, folder: Path) -> None:
    settings = {"law": HOSTILE, HOSTILE: "x"}
    runs = [
        replace(make_run(HOSTILE), settings=settings, warnings=(HOSTILE,)),
        replace(make_run("b"), reference=replace(make_run().reference, name=HOSTILE)),
    ]
    cases = sweep({HOSTILE: numbers(0.1, 1.0)}, lambda v: float(v[HOSTILE]), name=HOSTILE)  # type: ignore[arg-type]
    board = replace(DATA, name=HOSTILE)
    file = report(
        results_of(*runs, sweeps=[cases], boards=[board]), folder / "x.html", title=HOSTILE
    )
    page = Page(file)
    assert len(page.of("script")) == 3  # two runs to play, and the program
    assert all(each["src"].startswith(SVG) for each in page.of("img"))
    assert not [a for _, a in page.tags if any(name.startswith("on") for name in a)]
    assert page.texts.count(HOSTILE) >= 4
    assert not re.search(r"<script>alert|<img src=x", page.source)


def test_default_run_is_small(folder: Path) -> None:
    run = hilc_api.run("example:fig4-compensated")
    assert report(results_of(run), folder / "small.html").stat().st_size < 1_500_000


def test_as_much_as_a_run_may_be_is_below_3_mb(folder: Path) -> None:
    # 24 recorded iterations of noise, in which no sample can be left out.
    noise = {"state": {"bound": [0.01, 0.01, 0.05]}, "output": {"bound": [0.1, 0.1, 0.1]}}
    changes = {"disturbance": noise, "controller.gains.derivative": 0.1}
    run = hilc_api.run(hilc_api.load_scenario("example:fig3-circle", overrides=changes))
    assert len(run.trials) == 24
    assert report(results_of(run), folder / "noise.html").stat().st_size < 3_000_000


def test_the_same_results_give_the_same_bytes(make_run: MakeRun, folder: Path) -> None:
    pages = [report(results_of(make_run()), folder / f"{n}.html").read_bytes() for n in range(2)]
    assert pages[0] == pages[1]


def test_many_runs_have_few_pictures_each(make_run: MakeRun, folder: Path) -> None:
    runs = [make_run(f"run-{number}") for number in range(5)]
    page = Page(report(results_of(*runs), folder / "many.html"))
    assert len(page.of("img")) == 1 + 5 * 2


def test_report_of_the_same_results_is_replaced_and_nothing_else(
    make_run: MakeRun, folder: Path
) -> None:
    file = folder / "report.html"
    report(results_of(make_run("a")), file)
    report(results_of(make_run("a", factors=(0.5, 0.6))), file)
    before = file.read_bytes()
    with pytest.raises(ExistingResultsError, match="no report of the same results"):
        report(results_of(make_run("b")), file)
    assert file.read_bytes() == before
    report(results_of(make_run("b")), file, force=True)
    assert file.read_bytes() != before
    file.write_text("<p>mine</p>")
    with pytest.raises(ExistingResultsError, match="exists"):
        report([folder / "not-even-read"], file)
    assert file.read_text() == "<p>mine</p>"


def test_link_is_not_written_through(make_run: MakeRun, folder: Path) -> None:
    (folder / "report.html").symlink_to("elsewhere")
    with pytest.raises(ExistingResultsError):
        report(results_of(make_run()), folder / "report.html")
    report(results_of(make_run()), folder / "report.html", force=True)
    assert not (folder / "elsewhere").exists()
    assert not (folder / "report.html").is_symlink()


@pytest.mark.parametrize(
    ("name", "message"), [("report.pdf", "no name of a page"), ("there.html", "is a folder")]
)
def test_names_that_are_none(make_run: MakeRun, folder: Path, name: str, message: str) -> None:
    (folder / "there.html").mkdir()
    with pytest.raises(UsageError, match=message):
        report(results_of(make_run()), folder / name)


def test_iterations_that_are_not_recorded(make_run: MakeRun, folder: Path) -> None:
    with pytest.raises(UsageError, match=r"iterations 7, 9 not recorded; recorded: 0, 1, 2, 3"):
        report(results_of(make_run()), folder / "a.html", iterations={1, 7, 9})
    assert not (folder / "a.html").exists()


def test_folders_without_results(folder: Path) -> None:
    (folder / "empty").mkdir()
    for wrong in ("empty", "nowhere"):
        with pytest.raises(UsageError, match=f"{wrong}: holds no run, lab, sweep or leaderboard"):
            read_results([wrong])
    with pytest.raises(UsageError, match="nothing to report"):
        read_results([])


def test_jinja_escapes_whatever_it_gets() -> None:
    assert template("report.html.j2").environment.autoescape is True


def test_lab_tells_its_logs(folder: Path) -> None:
    lab = Lab.start(scenario(), folder / "lab")
    with pytest.raises(UsageError, match="lab: has no trial yet; add the first with 'hilc learn"):
        report(folder / "lab", folder / "lab.html")
    for _ in range(2):
        times, poses = driven(lab.plan)
        lab.add_log(write_log(folder / "pass<1>.csv", times, poses))
    page = Page(report(folder / "lab", folder / "lab.html"))
    assert [each["aria-label"] for each in page.of("section")] == [lab.scenario.name]
    assert "After 2 trials" in page.texts
    assert page.texts.count("pass<1>.csv") == 2
    played = json.loads(page.scripts[0])
    assert [each["number"] for each in played["iterations"]] == [0, 1]
    assert played["robot"]["wheelRadius"] == pytest.approx(0.033)


def test_damaged_log_of_a_lab_is_told(folder: Path) -> None:
    lab = Lab.start(scenario(), folder / "lab")
    times, poses = driven(lab.plan)
    lab.add(poses, times)
    (folder / "lab/trials/000/report.json").write_text("{}", encoding="utf-8")
    with pytest.raises(UsageError, match=r"trials/000/report\.json: is damaged"):
        report(folder / "lab", folder / "lab.html")
    assert not (folder / "lab.html").exists()
