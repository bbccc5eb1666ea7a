"""``hilc reproduce``: what it writes and tells, and what it leaves alone."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hilc_cli.cli.main import main
from hilc_cli.cli.reproduce import ReadingChoice, _stage
from hilc_cli.cli.session import STOPPED
from hilc_cli.paper import reproducing
from hilc_cli.paper.claim import Claim, Evidence, Figure, Finding, Verdict
from hilc_cli.paper.contents import FIGURES
from hilc_cli.paper.plan import ReproductionPlan, plan_reproduction
from hilc_cli.paper.reading import CHOICES, LITERAL
from hilc_cli.paper.report import print_claims
from hilc_cli.paper.reproducing import reproduce
from hilc_cli.workers import crews
from tests.cli.inputs import listing, put_odd_things
from tests.cli.processes import run_hilc
from tests.conftest import Hilc, Outcome

PANELS = {
    "fig3": [f"{row}{column}" for row in "abcd" for column in "123"],
    "fig4": [f"{row}{column}" for row in "ab" for column in "123"],
    "fig5": [f"{row}{column}" for row in "abc" for column in "123"],
    "fig6": list("abcdefghi"),
    "fig7": [f"{row}{column}" for row in "abcd" for column in "123"],
    "fig8": [f"{row}{column}" for row in "abc" for column in "123"],
}
READINGS = ("literal", "derivative")
EVERY_FIGURE = {
    *("manifest.json", "index.md", "claims.csv", "claims.md", "data"),
    *(f"{figure}-{reading}.png" for figure in PANELS for reading in READINGS),
    *(
        f"data/{figure}{panel}-{reading}.csv"
        for figure, panels in PANELS.items()
        for panel in panels
        for reading in READINGS
    ),
}
ITERATIONS = 2  # instead of 100


def judge(evidence: Evidence) -> Finding:
    """Where the first iteration without any motion must be: at the start, 20 m off at most."""
    error = evidence["fig3-circle"].metrics["max_position_error_m"][0]
    return Finding(Verdict.HOLDS, (Figure("error at rest, circle", float(error), "m"),))


def refuse(evidence: Evidence) -> Finding:
    told = f"{len(evidence.runs)} runs, {evidence.reading.name}, say no."
    return Finding(Verdict.FAILS, (Figure("none of it", None),), told)


CLAIMS = (
    Claim("A-1", "At rest, the error is the diameter", "Fig. 3", "Error", "Holds if 20 m", judge),
    Claim("B-2", "Something else", "Fig. 6", "Nothing", "Holds never", refuse),
)


def quick(
    figures: Sequence[str] = (),
    *,
    reading: str = "both",
    overrides: Mapping[str, Any] | None = None,
) -> ReproductionPlan:
    """A plan of the same figures with few iterations, and with claims that need no more."""
    values = {"iterations": ITERATIONS, **(overrides or {})}
    plan = plan_reproduction(figures, reading=reading, overrides=values)
    assert not plan.claims  # the paper's are not judged with other values than the paper's
    return replace(plan, claims=() if figures else CLAIMS)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hilc_cli.paper.plan.plan_reproduction", quick)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, dict[str, Any]]]:
    """All figures, once: the folder, and what was told of it."""
    working = tmp_path_factory.mktemp("whole")
    before = {number: signal.getsignal(number) for number in STOPPED}
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as told:
        patch.chdir(working)
        patch.setattr("hilc_cli.paper.plan.plan_reproduction", quick)
        patch.setattr(sys, "argv", ["hilc", "reproduce"])
        with pytest.raises(SystemExit) as stop:
            main(["reproduce", "--dpi", "30", "--json"])
    for number, handler in before.items():
        signal.signal(number, handler)
    assert stop.value.code == 0
    yield working / "runs" / "reproduce", json.loads(told.getvalue())


def links(text: str) -> list[str]:
    return re.findall(r"\]\(([^)]*)\)", text)


def test_all_figures_are_written_and_nothing_else(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, _ = whole
    assert set(listing(folder)) == EVERY_FIGURE
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["kind"] == "hilc reproduce"
    assert set(manifest["files"]) == EVERY_FIGURE - {"data"}
    assert list(folder.parent.glob(".*")) == []  # no draft is left


def test_index_leads_everywhere(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, _ = whole
    text = (folder / "index.md").read_text(encoding="utf-8")
    linked = {link.partition("#")[0] for link in links(text)}
    assert linked == EVERY_FIGURE - {"manifest.json", "index.md", "data"}
    caption = r"\(([a-i]\d?)\) (?:path|final|maximum|average|l₁)"
    for figure, panels in PANELS.items():
        _, _, section = text.partition(f"\n## Figure {figure[3:]}\n")
        section = section.partition("\n## ")[0]
        for reading in READINGS:
            _, _, part = section.partition(f"\n### Figure {figure[3:]}, {reading}: ")
            part = part.partition("\n### ")[0]
            assert re.findall(caption, part) == panels
            assert f"![Figure {figure[3:]}, {reading}]({figure}-{reading}.png)" in part
    assert "\nhilc reproduce --dpi 30\n" in text
    assert "7 pi/15 (cardioid) and 31 pi/60 (spiral) for the printed" in text
    assert "cardioid from (2, 0) m at 84° (7π/15, printed: 14π/15)" in text
    assert "| [B-2](claims.md#b-2) | does not hold | does not hold | Something else |" in text
    claims = (folder / "claims.md").read_text(encoding="utf-8")
    anchors = {f"#{name.lower()}" for name in re.findall(r"^## (.*)$", claims, re.MULTILINE)}
    assert anchors == {"#a-1", "#b-2"} == set(links(claims))


def test_index_names_scenario_and_final_errors(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, told = whole
    text = (folder / "index.md").read_text(encoding="utf-8")
    starts = {"fig5-cardioid": "7*pi/15", "fig5-spiral": "31*pi/60"}
    for reading, runs in told["runs"].items():
        assert len(runs) == 25
        for name, final in runs.items():
            words = f"example:{name}"
            if reading == "derivative":
                words += " --set controller.gains.derivative=0.1"
                if name in starts:
                    words += f" --set 'initial_pose.heading={starts[name]}'"
            row = next(line for line in text.splitlines() if f"`{words}`" in line)
            cells = [cell.strip() for cell in row.split("|")]
            assert cells[6] == str(ITERATIONS)
            assert float(cells[7]) == pytest.approx(final["max_position_error_m"], rel=5e-4)
            assert float(cells[8]) == pytest.approx(final["mean_position_error_m"], rel=5e-4)


def test_claims_are_judged_from_all_runs(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, told = whole
    with (folder / "claims.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == [claim.name for claim in CLAIMS]
    for reading in READINGS:
        name, _, value = rows[0][f"{reading}_figures"].partition("=")
        assert name == "error at rest, circle"
        assert float(value.removesuffix(" m")) == pytest.approx(20, abs=1e-9)
        assert rows[1][f"{reading}_reason"] == f"25 runs, {reading}, say no."
        verdicts = [claim["verdict"][reading] for claim in told["claims"]]
        assert verdicts == ["holds", "does not hold"]
        figures = told["claims"][1]["figures"][reading]
        assert figures == [{"name": "none of it", "unit": "", "value": None}]


def test_json_names_figures_panels_and_files(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, told = whole
    assert told["folder"] == "runs/reproduce"
    assert [reading["name"] for reading in told["readings"]] == list(READINGS)
    assert told["readings"][1]["derivative_s"] == 0.1
    assert told["readings"][1]["starts"]["fig5-spiral"] == {
        "heading": "31*pi/60",
        "printed": "31*pi/30",
    }
    found = {
        (figure["name"], figure["reading"]): [panel["panel"] for panel in figure["panels"]]
        for figure in told["figures"]
    }
    assert found == {(n, reading): of for n, of in PANELS.items() for reading in READINGS}
    for figure in told["figures"]:
        assert all((folder / name).is_file() for name in figure["files"])
        assert all((folder / panel["data"]).is_file() for panel in figure["panels"])
        runs = told["runs"][figure["reading"]]
        assert all(panel["scenario"] in runs for panel in figure["panels"])


def test_data_are_those_of_the_scenario(
    whole: tuple[Path, dict[str, Any]], hilc: Hilc, folder: Path
) -> None:
    reproduced, _ = whole
    options = ("--set", f"iterations={ITERATIONS}", "--no-plots", "-q")
    derivative = ("--set", "controller.gains.derivative=0.1")
    assert hilc("run", "example:fig7c", *options, "--out", "literal").code == 0
    assert hilc("run", "example:fig7c", *options, *derivative, "--out", "derivative").code == 0
    columns = {
        ("fig7c2", "input"): ("t_s", "left_wheel_rad_s", "right_wheel_rad_s"),
        ("fig7c3", "iterations"): ("iteration", "max_position_error_m", "saturated_samples"),
        ("fig7c1", "samples"): ("iteration", "sample", "reference_x_m", "reference_y_m", "x_m"),
    }
    for ((panel, table), names), reading in product(columns.items(), READINGS):
        files = reproduced / f"data/{panel}-{reading}.csv", folder / reading / f"{table}.csv"
        texts = [file.read_text() for file in files]
        one, other = (
            [[row[name] for name in names] for row in csv.DictReader(text.splitlines())]
            for text in texts
        )
        assert one == other


def test_some_figures_in_two_formats(hilc: Hilc, folder: Path, few: None) -> None:
    formats = ("--format", "svg", "--format", "pdf", "--format", "svg")
    outcome = hilc("reproduce", "4", *formats, "--out", "mine")
    assert outcome == Outcome(
        0,
        "Claims are judged only together with all figures: hilc reproduce\n"
        "Written to mine; begin with mine/index.md\n",
        "",
    )
    data = {f"data/fig4{panel}-{reading}.csv" for panel in PANELS["fig4"] for reading in READINGS}
    pictures = {f"fig4-{reading}.{kind}" for reading in READINGS for kind in ("svg", "pdf")}
    files = {"manifest.json", "index.md", "data"} | pictures | data
    assert set(listing(folder / "mine")) == files
    text = (folder / "mine/index.md").read_text(encoding="utf-8")
    assert "# Figure 4 of the paper" in text
    assert "![Figure 4, literal](fig4-literal.svg)" in text
    assert "Not judged" in text
    assert "\nhilc reproduce fig4 --format svg --format pdf\n" in text
    assert all((folder / "mine" / link).is_file() for link in links(text))


def test_pdf_alone_is_joined_by_pictures_that_the_index_shows(
    hilc: Hilc, folder: Path, few: None
) -> None:
    options = ("--reading", "literal", "--dpi", "20", "--out", "mine", "--json")
    told = hilc("reproduce", "fig4", "--format", "pdf", *options)
    text = (folder / "mine/index.md").read_text(encoding="utf-8")
    assert "![Figure 4, literal](fig4-literal.png)" in text
    assert all((folder / "mine" / link).is_file() for link in links(text))
    assert json.loads(told.out)["figures"][0]["files"] == [
        *("fig4-literal.pdf", "fig4-literal.png"),
    ]
    assert "\nhilc reproduce fig4 --reading literal --format pdf --dpi 20\n" in text


def test_more_figures_of_the_same_scenarios_complete_a_folder(
    hilc: Hilc, folder: Path, few: None
) -> None:
    options = ("--dpi", "20", "-q")
    assert hilc("reproduce", "fig4", *options, "--reading", "derivative").code == 0
    mine = folder / "runs/reproduce"
    alone = listing(mine)
    assert not [name for name in alone if "literal" in name]
    text = (mine / "index.md").read_text(encoding="utf-8")
    assert "\nhilc reproduce fig4 --reading derivative --dpi 20\n" in text
    manifest = json.loads((mine / "manifest.json").read_text())
    assert manifest["readings"] == ["derivative"]
    (mine / "notes.txt").write_text("mine")
    # Another reading alone would take away what is there; with it beside, it is completed.
    other = hilc("reproduce", "fig4", *options, "--reading", "literal")
    assert (other.code, "other figures, readings or scenarios" in other.err) == (1, True)
    assert hilc("reproduce", "fig4", "fig8", *options) == Outcome(0, "", "")
    both = listing(mine)
    for figure, reading in product(("fig4", "fig8"), READINGS):
        assert f"{figure}-{reading}.png" in both
    assert {name for name in alone if both[name] != alone[name]} == {"manifest.json", "index.md"}
    assert (mine / "notes.txt").read_text() == "mine"

    before = listing(mine)
    assert hilc("reproduce", "fig4", *options).code == 1, "fig8 would be lost"
    manifest = json.loads((mine / "manifest.json").read_text())
    name = "literal/fig4-compensated"
    kinds: list[object] = [{name: "0" * 64}, {name: {}}, [], None]
    for damaged in kinds:
        text = json.dumps({**manifest, "checksum": "", "scenarios_sha256": damaged})
        (mine / "manifest.json").write_text(text)
        assert hilc("reproduce", "fig4", "fig8", *options).code == 1, "from other scenarios"
    assert {**listing(mine), "manifest.json": None} == {**before, "manifest.json": None}


def test_bar_tells_what_is_going_on() -> None:
    plan = quick()
    runs, claims = plan.runs, 2 * len(plan.claims)
    stages = [_stage(plan, done) for done in (0, runs - 1, runs, runs + claims - 1, runs + claims)]
    assert [stage.split()[1] for stage in stages] == [
        *("simulating", "simulating", "judging", "judging", "drawing"),
    ]
    assert "compiled" in stages[2]


@pytest.mark.slow
def test_a_second_time_gives_the_same_bytes(hilc: Hilc, folder: Path, few: None) -> None:
    formats = ("--format", "png", "--format", "svg", "--format", "pdf", "--dpi", "20")
    for out in ("one", "two"):
        assert hilc("reproduce", "fig4", *formats, "-q", "--out", out) == Outcome(0, "", "")
    one, two = listing(folder / "one"), listing(folder / "two")
    del one["manifest.json"], two["manifest.json"]
    assert one == two


def test_same_figures_are_replaced_and_own_files_stay(hilc: Hilc, folder: Path, few: None) -> None:
    same = ("reproduce", "fig4", "--reading", "literal", "--dpi", "20", "-q")
    assert hilc(*same).code == 0
    mine = folder / "runs/reproduce"
    before = listing(mine)
    (mine / "notes.txt").write_text("mine")
    (mine / "index.md").write_text("damaged")
    assert hilc(*same).code == 0
    after = listing(mine)
    assert after.pop("notes.txt") == b"mine"
    assert {**after, "manifest.json": None} == {**before, "manifest.json": None}

    (mine / "data/notes.txt").write_text("mine")
    before = listing(mine)
    for force in ((), ("--force",)):
        assert hilc(*same, *force) == Outcome(
            1,
            "",
            "hilc: runs/reproduce/data/notes.txt: is no file of a reproduction, which would be "
            "replaced; move it elsewhere\n",
        )
    assert listing(mine) == before


def test_other_figures_are_replaced_by_force_only(hilc: Hilc, folder: Path, few: None) -> None:
    options = ("--reading", "literal", "--dpi", "20")
    assert hilc("reproduce", "fig4", *options, "-q").code == 0
    before = listing(folder)
    assert hilc("reproduce", "fig5", *options, "-q") == Outcome(
        1,
        "",
        "hilc: runs/reproduce: holds the results of other figures, readings or scenarios; "
        "choose another folder with --out, or replace it with --force\n",
    )
    assert listing(folder) == before
    outcome = hilc("reproduce", "fig5", *options, "-qv", "--force")
    assert (outcome.code, outcome.out) == (0, "")
    assert re.fullmatch(
        r"(hilc: (simulation|claims|figures and tables): \d+\.\d{3} s\n){3}", outcome.err
    )
    assert (folder / "runs/reproduce/fig5-literal.png").exists()
    assert not (folder / "runs/reproduce/fig4-literal.png").exists()


@pytest.mark.parametrize("out", ["full", "fifo", "dangling", "."])
@pytest.mark.parametrize("force", [(), ("--force",)])
def test_what_is_no_reproduction_is_never_touched(
    hilc: Hilc, folder: Path, few: None, out: str, force: tuple[str, ...]
) -> None:
    put_odd_things(folder)
    before = listing(folder)
    outcome = hilc("reproduce", "fig4", "--out", out, *force)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
    assert listing(folder) == before


def interrupt() -> None:
    raise KeyboardInterrupt


def terminate() -> None:
    os.kill(os.getpid(), signal.SIGTERM)


@pytest.mark.parametrize(("stop", "code"), [(interrupt, 130), (terminate, 143)])
def test_signal_while_it_is_written(
    hilc: Hilc,
    folder: Path,
    few: None,
    monkeypatch: pytest.MonkeyPatch,
    stop: Callable[[], None],
    code: int,
) -> None:
    def stopped(*arguments: object) -> None:
        stop()

    monkeypatch.setattr(reproducing, "index_text", stopped)
    outcome = hilc("reproduce", "fig4", "--dpi", "20")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (code, "", 1)
    assert [entry.name for entry in folder.iterdir()] == ["runs"]
    assert list((folder / "runs").iterdir()) == []


def test_claims_are_printed_with_their_verdicts(capsys: pytest.CaptureFixture[str]) -> None:
    result = reproduce(quick(["fig4"], overrides={"iterations": 0}))
    found = {"literal": refuse(Evidence(LITERAL, {})), "derivative": Finding(Verdict.HOLDS, ())}
    print_claims(replace(result, judged=((CLAIMS[1], found),)))
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == [
        "1 claim, literal reading: 0 hold, 0 hold in part, 1 does not hold",
        "1 claim, derivative reading: 1 holds, 0 hold in part, 0 do not hold",
    ]
    told = [re.split("  +", line.strip()) for line in lines[2:] if "─" not in line]
    assert [cells for cells in told if len(cells) > 1] == [
        ["claim", "literal", "derivative", "what the paper's text says"],
        ["B-2", "does not hold", "holds", "Something else"],
    ]
    rest = " ".join(lines[2:])
    assert "Holds under derivative alone: B-2" in rest
    assert "headings of 7 pi/15 (cardioid) and 31 pi/60 (spiral) for the printed" in rest
    assert "Which of the two the authors ran, if either, is not known" in rest


@pytest.mark.slow
def test_worker_processes_give_the_same_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = quick(["fig4"])
    alone = reproduce(plan)
    monkeypatch.setattr(reproducing, "_MANY", 1)
    monkeypatch.setattr(crews, "available_cores", lambda: 2)
    shared = reproduce(plan)
    for reading, name in product(READINGS, ("fig4-uncompensated", "fig4-compensated")):
        one, other = alone.runs[reading][name], shared.runs[reading][name]
        assert one.trials.keys() == other.trials.keys()
        np.testing.assert_array_equal(one.last.x, other.last.x)
        np.testing.assert_array_equal(one.last.left, other.last.left)


def test_unknown_figure_is_told(tmp_path: Path) -> None:
    assert run_hilc("reproduce", "fig2", cwd=tmp_path) == Outcome(
        2,
        "",
        "hilc: fig2: is no figure of the paper's results; "
        "known: fig3, fig4, fig5, fig6, fig7, fig8\n",
    )
    assert list(tmp_path.iterdir()) == []


def test_completion_knows_the_figures() -> None:
    from hilc_cli.cli.reproduce import complete_figure

    assert complete_figure("") == [figure.name for figure in FIGURES]
    assert complete_figure("fig4") == ["fig4"]


def test_option_knows_all_readings() -> None:
    assert [choice.value for choice in ReadingChoice] == list(CHOICES)
