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
from pathlib import Path
from typing import Any

import pytest

from hilc_cli.cli.main import main
from hilc_cli.cli.reproduce import _stage
from hilc_cli.cli.session import STOPPED
from hilc_cli.paper import reproducing
from hilc_cli.paper.claim import Claim, Evidence, Figure, Finding, Verdict
from hilc_cli.paper.contents import FIGURES
from hilc_cli.paper.plan import ReproductionPlan, plan_reproduction
from hilc_cli.paper.report import print_claims
from hilc_cli.paper.reproducing import reproduce
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
EVERY_FIGURE = {
    *("manifest.json", "index.md", "claims.csv", "claims.md", "data"),
    *(f"{figure}.png" for figure in PANELS),
    *(f"data/{figure}{panel}.csv" for figure, panels in PANELS.items() for panel in panels),
}
ITERATIONS = 2  # instead of 100


def judge(evidence: Evidence) -> Finding:
    """Where the first iteration without any motion must be: at the start, 20 m off at most."""
    error = evidence["fig3-circle"].metrics["max_position_error_m"][0]
    return Finding(Verdict.HOLDS, (Figure("error at rest, circle", float(error), "m"),))


def refuse(evidence: Evidence) -> Finding:
    return Finding(Verdict.FAILS, (Figure("none of it", None),), f"{len(evidence)} runs say no.")


CLAIMS = (
    Claim("A-1", "At rest, the error is the diameter", "Fig. 3", "Error", "Holds if 20 m", judge),
    Claim("B-2", "Something else", "Fig. 6", "Nothing", "Holds never", refuse),
)


def quick(
    figures: Sequence[str] = (), *, overrides: Mapping[str, Any] | None = None
) -> ReproductionPlan:
    """A plan of the same figures with few iterations, and with claims that need no more."""
    values = {"iterations": ITERATIONS, **(overrides or {})}
    plan = plan_reproduction(figures, overrides=values)
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
    for figure, panels in PANELS.items():
        _, _, section = text.partition(f"\n## Figure {figure[3:]}\n")
        section = section.partition("\n## ")[0]
        caption = r"\(([a-i]\d?)\) (?:path|final|maximum|average|l₁)"
        assert re.findall(caption, section) == panels
        assert f"![Figure {figure[3:]}]({figure}.png)" in section
    assert "\nhilc reproduce --dpi 30\n" in text
    assert "| [B-2](claims.md#b-2) | Something else | does not hold |" in text
    claims = (folder / "claims.md").read_text(encoding="utf-8")
    anchors = {f"#{name.lower()}" for name in re.findall(r"^## (.*)$", claims, re.MULTILINE)}
    assert anchors == {"#a-1", "#b-2"} == set(links(claims))


def test_index_names_scenario_and_final_errors(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, told = whole
    text = (folder / "index.md").read_text(encoding="utf-8")
    for name, final in told["runs"].items():
        row = next(line for line in text.splitlines() if f"`example:{name}`" in line)
        cells = [cell.strip() for cell in row.split("|")]
        assert cells[6] == str(ITERATIONS)
        assert float(cells[7]) == pytest.approx(final["max_position_error_m"], rel=5e-4)
        assert float(cells[8]) == pytest.approx(final["mean_position_error_m"], rel=5e-4)


def test_claims_are_judged_from_all_runs(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, told = whole
    with (folder / "claims.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == [claim.name for claim in CLAIMS]
    name, _, value = rows[0]["figures"].partition("=")
    assert name == "error at rest, circle"
    assert float(value.removesuffix(" m")) == pytest.approx(20, abs=1e-9)
    assert rows[1]["reason"] == "25 runs say no."
    assert [claim["verdict"] for claim in told["claims"]] == ["holds", "does not hold"]
    assert told["claims"][1]["figures"] == [{"name": "none of it", "unit": "", "value": None}]


def test_json_names_figures_panels_and_files(whole: tuple[Path, dict[str, Any]]) -> None:
    folder, told = whole
    assert told["folder"] == "runs/reproduce"
    found = {
        figure["name"]: [panel["panel"] for panel in figure["panels"]] for figure in told["figures"]
    }
    assert found == PANELS
    for figure in told["figures"]:
        assert all((folder / name).is_file() for name in figure["files"])
        assert all((folder / panel["data"]).is_file() for panel in figure["panels"])
        assert all(panel["scenario"] in told["runs"] for panel in figure["panels"])


def test_data_are_those_of_the_scenario(
    whole: tuple[Path, dict[str, Any]], hilc: Hilc, folder: Path
) -> None:
    reproduced, _ = whole
    options = ("--set", f"iterations={ITERATIONS}", "--no-plots", "-q")
    assert hilc("run", "example:fig7c", *options).code == 0
    run = folder / f"runs/fig7c+iterations={ITERATIONS}"
    columns = {
        ("fig7c2", "input"): ("t_s", "left_wheel_rad_s", "right_wheel_rad_s"),
        ("fig7c3", "iterations"): ("iteration", "max_position_error_m", "saturated_samples"),
        ("fig7c1", "samples"): ("iteration", "sample", "reference_x_m", "reference_y_m", "x_m"),
    }
    for (panel, table), names in columns.items():
        texts = [(reproduced / f"data/{panel}.csv").read_text(), (run / f"{table}.csv").read_text()]
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
    data = {f"data/fig4{panel}.csv" for panel in PANELS["fig4"]}
    files = {"manifest.json", "index.md", "fig4.svg", "fig4.pdf", "data"} | data
    assert set(listing(folder / "mine")) == files
    text = (folder / "mine/index.md").read_text(encoding="utf-8")
    assert "# Figure 4 of the paper" in text
    assert "![Figure 4](fig4.svg)" in text
    assert "Not judged" in text
    assert "\nhilc reproduce fig4 --format svg --format pdf\n" in text
    assert all((folder / "mine" / link).is_file() for link in links(text))


def test_pdf_alone_is_joined_by_pictures_that_the_index_shows(
    hilc: Hilc, folder: Path, few: None
) -> None:
    told = hilc("reproduce", "fig4", "--format", "pdf", "--dpi", "20", "--out", "mine", "--json")
    text = (folder / "mine/index.md").read_text(encoding="utf-8")
    assert "![Figure 4](fig4.png)" in text
    assert all((folder / "mine" / link).is_file() for link in links(text))
    assert json.loads(told.out)["figures"][0]["files"] == ["fig4.pdf", "fig4.png"]
    assert "\nhilc reproduce fig4 --format pdf --dpi 20\n" in text


def test_more_figures_of_the_same_scenarios_complete_a_folder(
    hilc: Hilc, folder: Path, few: None
) -> None:
    options = ("--dpi", "20", "-q")
    assert hilc("reproduce", "fig4", *options).code == 0
    mine = folder / "runs/reproduce"
    (mine / "notes.txt").write_text("mine")
    assert hilc("reproduce", "fig4", "fig8", *options) == Outcome(0, "", "")
    assert (mine / "fig4.png").exists() and (mine / "fig8.png").exists()
    assert (mine / "notes.txt").read_text() == "mine"

    before = listing(mine)
    assert hilc("reproduce", "fig4", *options).code == 1, "fig8 would be lost"
    manifest = json.loads((mine / "manifest.json").read_text())
    kinds: list[object] = [{"fig4-compensated": "0" * 64}, {"fig4-compensated": {}}, [], None]
    for damaged in kinds:
        text = json.dumps({**manifest, "checksum": "", "scenarios_sha256": damaged})
        (mine / "manifest.json").write_text(text)
        assert hilc("reproduce", "fig4", "fig8", *options).code == 1, "from other scenarios"
    assert {**listing(mine), "manifest.json": None} == {**before, "manifest.json": None}


def test_bar_tells_what_is_going_on() -> None:
    plan = quick()
    runs, claims = len(plan.scenarios), len(plan.claims)
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
    both = ("reproduce", "fig4", "--dpi", "20", "-q")
    assert hilc(*both).code == 0
    mine = folder / "runs/reproduce"
    before = listing(mine)
    (mine / "notes.txt").write_text("mine")
    (mine / "index.md").write_text("damaged")
    assert hilc(*both).code == 0
    after = listing(mine)
    assert after.pop("notes.txt") == b"mine"
    assert {**after, "manifest.json": None} == {**before, "manifest.json": None}

    (mine / "data/notes.txt").write_text("mine")
    before = listing(mine)
    for force in ((), ("--force",)):
        assert hilc(*both, *force) == Outcome(
            1,
            "",
            "hilc: runs/reproduce/data/notes.txt: is no file of a reproduction, which would be "
            "replaced; move it elsewhere\n",
        )
    assert listing(mine) == before


def test_other_figures_are_replaced_by_force_only(hilc: Hilc, folder: Path, few: None) -> None:
    assert hilc("reproduce", "fig4", "--dpi", "20", "-q").code == 0
    before = listing(folder)
    assert hilc("reproduce", "fig5", "--dpi", "20", "-q") == Outcome(
        1,
        "",
        "hilc: runs/reproduce: holds the results of other figures or scenarios; "
        "choose another folder with --out, or replace it with --force\n",
    )
    assert listing(folder) == before
    outcome = hilc("reproduce", "fig5", "--dpi", "20", "-qv", "--force")
    assert (outcome.code, outcome.out) == (0, "")
    assert re.fullmatch(
        r"(hilc: (simulation|claims|figures and tables): \d+\.\d{3} s\n){3}", outcome.err
    )
    assert (folder / "runs/reproduce/fig5.png").exists()
    assert not (folder / "runs/reproduce/fig4.png").exists()


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

    monkeypatch.setattr(reproducing, "write_panel", stopped)
    outcome = hilc("reproduce", "fig4", "--dpi", "20")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (code, "", 1)
    assert [entry.name for entry in folder.iterdir()] == ["runs"]
    assert list((folder / "runs").iterdir()) == []


def test_claims_are_printed_with_their_verdicts(capsys: pytest.CaptureFixture[str]) -> None:
    result = reproduce(quick(["fig4"], overrides={"iterations": 0}))
    judged = replace(result, judged=((CLAIMS[1], refuse({})),))
    print_claims(judged)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "1 claim: 0 hold, 0 hold in part, 1 does not hold"
    told = [re.split("  +", line.strip()) for line in lines[1:] if "─" not in line]
    assert [cells for cells in told if cells != [""]] == [
        ["claim", "verdict", "the paper says"],
        ["B-2", "does not hold", "Something else"],
    ]


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
