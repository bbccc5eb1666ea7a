"""What a notebook gets of each result: a picture, figures, and nothing of a stranger's but text."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree

import pytest

import hilc_cli as hilc_api
from hilc_cli.comparisons.comparing import Comparison, compare_runs
from hilc_cli.html_reports import in_notebooks
from hilc_cli.identification.believed import believed_of
from hilc_cli.identification.identifying import identified
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import summarise
from hilc_cli.sweeps.data import SweepData
from tests.conftest import Write
from tests.html_reports.test_report import HOSTILE, SVG, a_sweep
from tests.identification.test_identifying import TRUE, log_of, wheels_of
from tests.labs.robots import driven, scenario
from tests.leaderboards.test_leaderboard_folder import DATA
from tests.made_up_runs import MakeRun, circle
from tests.made_up_sweeps import numbers, sweep

MOST = 300_000  # letters of a result in a notebook
KEPT = {"class", "src", "width", "height", "alt", "scope", "tabindex", "role", "aria-label"}


class Part(HTMLParser):
    """The elements and texts of a part of a page."""

    def __init__(self, result: object) -> None:
        super().__init__()
        assert isinstance(result, InNotebooks)
        self.source = result._repr_html_()
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.texts: list[str] = []
        self.feed(self.source)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {key: value or "" for key, value in attrs}))

    def handle_data(self, data: str) -> None:
        self.texts.append(data.strip())

    @property
    def pictures(self) -> list[dict[str, str]]:
        return [attributes for tag, attributes in self.tags if tag == "img"]


def a_lab(folder: Path, trials: int) -> hilc_api.Lab:
    lab = hilc_api.Lab.start(scenario(), folder)
    for _ in range(trials):
        times, poses = driven(lab.plan, seed=len(lab.trials), noise=1e-4)
        lab.add(poses, times)
    return lab


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, InNotebooks]]:
    """A result of each kind."""
    place = tmp_path_factory.mktemp("results")
    bend = hilc_api.load_scenario(scenario(iterations=2))
    run = hilc_api.run(bend)
    lab = a_lab(place / "lab", 2)
    few = hilc_api.plan_reproduction(["fig4"], reading="literal", overrides={"iterations": 1})
    yield {
        "run": run,
        "sweep": a_sweep(),
        "comparison": hilc_api.compare([run, run]),
        "laws": hilc_api.LeaderboardData(DATA.name, DATA.after, DATA.tolerance, DATA.entries),
        "path": hilc_api.show(bend),
        "check": hilc_api.check("example:turn-in-place"),
        "check of a law that theory knows": hilc_api.check(
            hilc_api.load_scenario("example:fig3-circle", {"trajectory.sample_time": "20 ms"})
        ),
        "lab": lab,
        "empty lab": a_lab(place / "empty", 0),
        "state": lab.state,
        "reproduction": hilc_api.reproduce(few),
        "identification": identified([log_of(TRUE, wheels_of())], believed_of([])),
    }


def test_each_kind_of_result_is_shown(results: dict[str, InNotebooks]) -> None:
    known, waiting = set[type](), [InNotebooks]
    while waiting:
        below = waiting.pop().__subclasses__()
        waiting += below
        # Where a class has slots, there is another one that it was made of.
        known |= {
            each for each in below if vars(sys.modules[each.__module__])[each.__name__] is each
        }
    told = tuple(in_notebooks._CHAPTERS)
    assert known and all(issubclass(kind, told) for kind in known)
    for kind in {*told} - {hilc_api.LawComparison}:  # which is shown as its data
        assert any(isinstance(each, kind) for each in results.values()), kind


def test_results_of_the_interface_show_themselves() -> None:
    kinds = [getattr(hilc_api, name) for name in dir(hilc_api)]
    with_tables = {kind for kind in kinds if inspect.isclass(kind) and hasattr(kind, "to_pandas")}
    assert len(with_tables) > 9
    assert all(issubclass(kind, InNotebooks) for kind in with_tables)


def test_a_picture_in_lines_words_and_few_letters(results: dict[str, InNotebooks]) -> None:
    for name, result in results.items():
        part = Part(result)
        assert len(part.source) < MOST, name
        assert all(set(attributes) <= KEPT for _, attributes in part.tags), name
        if name == "identification":  # of which nothing draws a picture
            assert not part.pictures and "left wheel radius" in part.texts
            continue
        (picture,) = part.pictures
        assert len(picture["alt"]) > 10 and int(picture["width"]) > 100
        if name != "reproduction":
            root = ElementTree.fromstring(unquote(picture["src"].removeprefix(SVG)))
            assert root.tag.endswith("svg") and len(list(root.iter())) > 100


def test_figures_are_those_of_the_run(make_run: MakeRun) -> None:
    run = replace(make_run("only"), warnings=("beware",))
    part = Part(run)
    assert f"{summarise(run).final['rms_position_error_m']:.4g} m" in part.texts
    assert summarise(run).headline in part.texts
    assert "beware" in part.texts and "Warning:" in part.texts


def test_any_number_of_them_may_stand_on_one_page(make_run: MakeRun) -> None:
    part = Part(make_run("twice"))
    assert "id" not in {key for _, attributes in part.tags for key in attributes}
    (style,) = [text for text in part.texts if text.startswith(".hilc-result")]
    rules = [line for line in style.splitlines() if "{" in line and not line.startswith("/*")]
    assert len(rules) > 10
    for rule in rules:
        heads = rule.rpartition("{")[0].removeprefix("@media (prefers-color-scheme: dark) {")
        assert all(".hilc-result" in head for head in heads.split("{")[0].split(",")), rule


def test_names_of_strangers_stay_text(make_run: MakeRun) -> None:
    run = replace(make_run(HOSTILE), warnings=(HOSTILE,), settings={"law": HOSTILE})
    cases = sweep({HOSTILE: numbers(0.1, 1.0)}, lambda v: float(v[HOSTILE]), name=HOSTILE)  # type: ignore[arg-type]
    pair = (run, replace(run, name="b" + HOSTILE))
    for result in (
        run,
        cases,
        Comparison(pair, compare_runs(pair)),
        replace(DATA, name=HOSTILE),
        replace(DATA, entries=tuple(replace(e, law=HOSTILE + e.law) for e in DATA.entries)),
    ):
        part = Part(result)
        assert HOSTILE in "".join(part.texts)
        assert {"script"}.isdisjoint(tag for tag, _ in part.tags)
        assert all(each["src"].startswith(SVG) for each in part.pictures) and part.pictures
        assert not [key for _, attributes in part.tags for key in attributes if key[:2] == "on"]


def test_a_picture_of_too_many_lines_is_made_of_pixels(make_run: MakeRun) -> None:
    part = Part(make_run("long", circle(samples=300), [1 - 0.99**n for n in range(250)]))
    (picture,) = part.pictures
    assert picture["src"].startswith("data:image/png;base64,iVBOR")
    assert len(part.source) < MOST


def test_many_warnings_are_counted(make_run: MakeRun) -> None:
    warnings = tuple(f"number {number}" for number in range(9))
    part = Part(replace(make_run("w"), warnings=warnings))
    assert "number 5" in part.texts and "number 6" not in part.texts
    assert "And 3 more warnings." in part.texts


def test_nothing_recorded_and_no_case_are_shown_without_a_picture(make_run: MakeRun) -> None:
    run = make_run("none")
    bare = RunData(run.name, run.reference, run.metrics)
    none = SweepData("none", {}, True, {}, {n: c[:0] for n, c in a_sweep().columns.items()})
    for result in (bare, none):
        part = Part(result)
        assert not part.pictures and "none" in part.texts


def test_a_check_tells_why_it_cannot_work(write: Write) -> None:
    write()
    wrong = hilc_api.check(
        hilc_api.load_scenario("example:fig8c", {"trajectory.sample_time": "20 ms"})
    )
    part = Part(wrong)
    assert "Error:" in part.texts and wrong.failures[0] in part.texts
