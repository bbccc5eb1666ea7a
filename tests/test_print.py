"""What goes to print: sheets of all features, options of all commands, and how hilc is cited."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from matplotlib.figure import Figure

from hilc_cli import __version__
from hilc_cli.checks.picture import transient_figure
from hilc_cli.comparisons.picture import comparison_figure
from hilc_cli.drawing.looks import picture_look
from hilc_cli.drawing.sheet import Sheet
from hilc_cli.leaderboards.comparing import LawComparison
from hilc_cli.leaderboards.picture import leaderboard_figure
from hilc_cli.paper.citation import BIBTEX
from hilc_cli.paper.sheet import sheet_figure
from hilc_cli.paths.picture import path_figure
from hilc_cli.paths.showing import show
from hilc_cli.results.look import Look
from hilc_cli.sweeps.data import Bands, OwnValues
from hilc_cli.sweeps.pictures.catalogue import draw_sweep
from hilc_cli.variation import Range
from tests.checks.test_picture import FALLING
from tests.conftest import Hilc, Write
from tests.drawing.reading import overlaps
from tests.drawing.test_looks import smallest_text
from tests.leaderboards.test_picture import DATA
from tests.made_up_runs import MakeRun, straight
from tests.made_up_sweeps import (
    HEADING,
    L1,
    L2,
    L3,
    NAME,
    RATES,
    SEED,
    SPEED,
    STEPS,
    WORDS,
    bowl,
    number,
    sweep,
)
from tests.pages import ROOT, blocks
from tests.paper.test_sheet import SPEEDS, row

BANDS = Bands(np.array([9.0, 9, 5]), np.array([[1.0, 2, 3, 4, 5]] * 3))
SWEEPS = {
    "curve": sweep({L1: RATES, HEADING: WORDS}, bowl, name=NAME),
    "map": sweep({L1: RATES, SPEED: Range(100.0, 200.0, "linear", 9)}, bowl),
    "best": sweep({L1: RATES, L2: STEPS, L3: STEPS, HEADING: WORDS}, bowl),
    "effects": sweep({L1: RATES, L2: STEPS, L3: STEPS, HEADING: WORDS}, bowl),
    "bands": sweep({L1: RATES}, bowl, bands=BANDS),
    "search": replace(sweep({L1: RATES}, bowl), as_it_is=OwnValues({L1: 1.0}, 3.0)),
}
OF_SEEDS = sweep({SEED: Range(0, 100, "integer")}, lambda case: 1e-3 * (1 + number(case[SEED])))
BOUNDED = replace(sweep({L1: RATES, L2: STEPS}, bowl), path_size=5.0, tolerance=1.0)


def sheets(make_run: MakeRun, look: Look) -> dict[str, Figure]:
    """A picture of each kind that is not one of runs."""
    runs = [make_run("a-long-name-of-a-run-with-many-letters", saturated=3), make_run("b")]
    other = make_run("along-a-line", reference=straight())
    pictures = {kind: draw_sweep(kind, data, look) for kind, data in SWEEPS.items()}
    pictures["distribution"] = draw_sweep("curve", OF_SEEDS, look)
    pictures["bounded map"] = draw_sweep("map", BOUNDED, look)
    pictures["comparison"] = comparison_figure(runs, look)
    pictures["of several paths"] = comparison_figure([*runs, other], look)
    pictures["leaderboard"] = leaderboard_figure(DATA, look)
    law = "Eq. 17, l1 1, l2 0, l3 0"
    pictures["transient"] = transient_figure("circle", FALLING, 3, runs[0], 0.1, law, look)
    pictures["path"] = path_figure(show("example:square-lap"), look)
    pictures["path with wheels"] = path_figure(show("example:rounded-square"), look)
    rows = [row("a", runs[0]), row("b", other, SPEEDS)]
    title, reading = "Figure 9. A title of some length", "Literal reading: the law as printed"
    pictures["paper"] = sheet_figure(title, reading, rows, look)
    return pictures


@pytest.mark.parametrize("width", [85, 175])
def test_sheets_fit_one_column_and_two(make_run: MakeRun, width: int) -> None:
    for kind, figure in sheets(make_run, picture_look(width=f"{width}mm")).items():
        assert isinstance(figure, Sheet)
        across = figure.get_size_inches()[0] * figure.scale
        assert across == pytest.approx(width / 25.4), kind
        assert overlaps(figure) == [], kind
        assert smallest_text(figure) > 6.5, kind


def media_box(path: Path) -> list[float]:
    """Width and height of the page of a PDF [pt]."""
    found = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", path.read_bytes())
    (sides,) = found
    return [float(side) for side in sides]


COLUMN = ("--format", "pdf", "--width", "3.4in", "--font", "DejaVu Serif", "--no-title")


def test_every_command_that_draws_takes_a_width(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    style = folder / "mine.mplstyle"
    style.write_text("axes.linewidth: 0.4\n")
    options = (*COLUMN, "--font-size", "7", "--style", "mine.mplstyle")
    for name in ("a", "b"):
        named = ("run", "scenario.yaml", "--set", f"name={name}", "--out", f"runs/{name}")
        assert hilc(*named, *(("--no-plots",) if name == "b" else options)).code == 0
    tables = [Path("runs", name, "samples.csv").read_bytes() for name in ("a", "b")]
    assert tables[0] == tables[1], "tables have no look"
    done = [
        hilc("plot", "runs/b", "--kind", "error", *options),
        hilc("check", "scenario.yaml", "--plot", "--out", "checked", *options),
        hilc("show", "scenario.yaml", "--out", "shown", *options),
        hilc("compare", "runs/a", "runs/b", "--out", "both", *options),
        hilc("sweep", "scenario.yaml", "--vary", "controller.gains.l1=0.1:1:3", "--out", "swept",
             "--workers", "1", *options),
    ]  # fmt: skip
    assert [outcome.code for outcome in done] == [0] * len(done)
    drawn = sorted(folder.rglob("*.pdf"))
    assert {path.name for path in drawn} >= {
        "error.pdf",
        "transient.pdf",
        "path.pdf",
        "comparison.pdf",
    }
    for path in drawn:
        assert media_box(path)[0] == pytest.approx(3.4 * 72, abs=1e-6), path
        assert b"/Type3" not in path.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "scenario.yaml", "--width", "85"), "--width 85: has no unit; give a width"),
        (("run", "scenario.yaml", "--font", "Dejavu Serf"), "--font Dejavu Serf: there is no"),
        (("plot", "x", "--style", "bad"), "bad:1: text.usetex: is not allowed in a style file"),
        (("sweep", "scenario.yaml", "--width", "5mm"), "--width 5mm: must be from 60mm to"),
        (("compare", "a", "b", "--width", "9km"), "--width 9km: is no width"),
        (("reproduce", "fig3", "--width", "9km"), "--width 9km: is no width"),
        (("check", "scenario.yaml", "--width", "85mm"), "--width, --font, --style and --no-title "
         "are about the picture; add --plot"),
        (("compare", "--laws", "example:leaderboard", "--rows", "gains"), "--rows is for a table"),
        (("compare", "a", "b", "--rows", "gains,rms_eror_m"), "there is no row 'rms_eror_m'"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_told_in_a_line_before_anything_is_done(
    hilc: Hilc, write: Write, folder: Path, arguments: tuple[str, ...], message: str
) -> None:
    write({"bad": "text.usetex: True\n"})
    outcome = hilc(*arguments)
    assert (outcome.code, outcome.out) == (2, "")
    # Lines about a file begin with its name, so that editors find the place.
    assert outcome.err.removeprefix("hilc: ").startswith(message)
    assert outcome.err.count("\n") == 1
    assert not Path("runs").exists()


def test_rows_of_a_comparison_are_chosen_in_all_formats(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    write()
    for gain in ("0.1", "0.5"):
        set_ = ("--set", f"name=l{gain}", "--set", f"controller.gains.l1={gain}")
        assert hilc("run", "scenario.yaml", *set_, "--no-plots", "--out", f"l{gain}").code == 0
    rows = ("--rows", "rms_position_error_m, gains", "--rows", "saturated_samples")
    command = ("compare", "l0.1", "l0.5", "--no-plots", "--out", "both", *rows)
    document = json.loads(hilc(*command, "--json").out)
    names = ["run", "rms_position_error_m", "gains", "saturated_samples"]
    assert list(document["runs"][0]) == names
    assert list(document["best"]) == ["rms_position_error_m"]
    assert Path("both/comparison.csv").read_text().splitlines()[0] == ",".join(names)
    words = {"terminal": "RMS position error", "markdown": "| RMS ", "latex": "$l_1 = 0.5$"}
    for kind, word in words.items():
        printed = hilc(*command, "--table", kind).out
        assert word in printed and "Maximum" not in printed.partition("Errors and the")[0]


def test_the_paper_is_cited_as_it_says_itself(hilc: Hilc) -> None:
    outcome = hilc("reproduce", "--bibtex")
    assert (outcome.code, outcome.out, outcome.err) == (0, BIBTEX, "")
    assert not Path("runs").exists()
    assert BIBTEX.count("{") == BIBTEX.count("}")
    (shown,) = (block.text for block in blocks("docs/print.md") if block.language == "bibtex")
    assert shown == BIBTEX
    (doi,) = re.findall(r"\[doi (\S+)\]", (ROOT / "docs/paper.md").read_text("utf-8"))
    assert f"doi     = {{{doi}}}" in BIBTEX


def test_the_citation_file_is_one_of_cff_1_2_0() -> None:
    data = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert data["cff-version"] == "1.2.0"
    # Keys that the schema of 1.2.0 requires of the file, and of a reference.
    assert all(data[key] for key in ("message", "title", "authors"))
    assert (data["version"], data["type"], data["license"]) == (__version__, "software", "MIT")
    assert all(set(author) <= {"name", "family-names", "given-names"} for author in data["authors"])
    (paper,) = data["references"]
    assert all(paper[key] for key in ("authors", "title", "type"))
    title = " ".join(BIBTEX.partition("title   = {")[2].partition("}")[0].split())
    assert (paper["type"], paper["title"]) == ("article", title)
    people = " and ".join(f"{p['family-names']}, {p['given-names']}" for p in paper["authors"])
    for text in (people, paper["journal"], paper["year"], paper["volume"], paper["doi"]):
        assert f"{{{text}}}" in BIBTEX


def test_each_table_of_a_leaderboard_has_a_label_of_its_own() -> None:
    text = LawComparison(DATA, "", {}).text("latex")
    labels = re.findall(r"\\label\{tab:(.*)\}", text)
    assert labels == ["test-none", "test-noise", "test-worst", "test-cases"]
