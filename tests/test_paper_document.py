"""The whole paper reproduced once, and what docs/paper.md says of it."""

from __future__ import annotations

import csv
import math
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.special import eval_laguerre

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.theory.learning.gains import ripple_growth
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.transient import predict_transient
from tests.cli.processes import HILC, environment

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "paper.md"
FIGURES = ["fig3", "fig4", "fig5", "fig6", "fig7", "fig8"]


@pytest.fixture(scope="module")
def reproduction(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("paper")
    done = subprocess.run(
        [*HILC, "reproduce", "--out", "all", "--dpi", "40", "-q"],
        cwd=folder,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder / "all"


@pytest.mark.slow
def test_verdicts_in_the_document_are_the_measured_ones(reproduction: Path) -> None:
    with (reproduction / "claims.csv").open(encoding="utf-8", newline="") as file:
        measured = [(row["id"], row["sentence"], row["verdict"]) for row in csv.DictReader(file)]
    assert len(measured) == 15
    _, _, table = DOCUMENT.read_text(encoding="utf-8").partition("<!-- claims:")
    rows = re.findall(r"^\| ([TF]\d\S*) \| (.*) \| (.*) \|$", table, re.MULTILINE)
    assert rows == measured


@pytest.mark.slow
def test_caption_of_figure_6_has_the_measured_counts(reproduction: Path) -> None:
    with (reproduction / "claims.csv").open(encoding="utf-8", newline="") as file:
        measured = {row["id"]: row["figures"] for row in csv.DictReader(file)}
    needed = dict(re.findall(r"needed \(6(\w)\)=(\d+)\.0 iterations", measured["F6-3"]))
    for letter, gain in (("b", "1"), ("c", "10")):
        (needed[letter],) = re.findall(rf"l1 = {gain}=(\d+)\.0 iterations", measured["F6-1"])
    assert sorted(needed) == list("bcdefghi")
    caption = " ".join(DOCUMENT.read_text(encoding="utf-8").split())
    for letter, count in needed.items():
        assert f" {count} ({letter})" in caption


@pytest.mark.slow
def test_all_figures_and_data_are_there(reproduction: Path) -> None:
    for name in FIGURES:
        assert (reproduction / f"{name}.png").stat().st_size > 10_000
        assert (DOCUMENT.parent / "images" / "paper" / f"{name}.png").stat().st_size > 10_000
    # Panels of the captions: 4 x 3, 2 x 3, 3 x 3, 9, 4 x 3 and 3 x 3.
    assert len(list((reproduction / "data").glob("*.csv"))) == 12 + 6 + 9 + 9 + 12 + 9


def experiment(name: str, *overrides: str) -> Experiment:
    return hilc.load_scenario(f"example:{name}", overrides).experiment()


def cell(document: str, row: str) -> str:
    """The second cell of a table's row in the document."""
    (found,) = re.findall(rf"^\| {re.escape(row)}[^|]*\| ([^|]*) \|", document, re.MULTILINE)
    return str(found)


def test_figures_in_the_document_are_the_computed_ones() -> None:
    document = DOCUMENT.read_text(encoding="utf-8")
    circle = LiftedIteration(experiment("fig3-circle"))
    assert cell(document, "spectral radius").startswith(f"{circle.spectral_radius().value:.3f}, ")
    sigma = f"{circle.largest_singular_value().value:.1f}"
    assert cell(document, "largest singular value") == sigma
    assert (
        cell(document, "ripples along") == f"{ripple_growth(experiment('fig3-circle')).factor:.4f}"
    )
    predicted = predict_transient(experiment("fig3-circle"), 1300).settled_at(0.01)
    assert cell(document, "iterations to 1 % of the path's size, predicted") == str(predicted)
    for name, row in (("fig8a", "worst ripple of situation 11"), ("fig6i", "worst ripple of 6i")):
        growth = 100 * (ripple_growth(experiment(name)).factor - 1)
        assert cell(document, row) == f"grows by {growth:.2g} % an iteration"


@pytest.mark.parametrize(
    ("name", "row"),
    [("fig4-compensated", "circle, 1 m"), ("fig5-arc-and-line", "arc-and-line, 1 m")],
)
def test_where_learning_rests_in_the_document(name: str, row: str) -> None:
    document = DOCUMENT.read_text(encoding="utf-8")
    (cells,) = re.findall(rf"^\| {row} inside \|(.*)\|$", document, re.MULTILINE)
    closed, after, at_the_end, _ = (float(text.split()[0]) for text in cells.split("|"))
    free = experiment(name, "controller.b_w=null")
    rest = fixed_point(free)
    assert rest is not None
    assert after == pytest.approx(rest.position_error_m[201], rel=3e-3)
    assert at_the_end == pytest.approx(rest.position_error_m[-1], rel=3e-3)
    # The closed form, by summing what it integrates.
    times = (np.arange(200_000) + 0.5) * 1e-6
    rate = math.pi if name == "fig4-compensated" else 2 * math.pi
    weight = 10 * (1 - times / 0.2) * np.exp(-times)
    assert closed == pytest.approx(
        1 + rate * (weight * np.sin(rate * times)).sum() * 1e-6, rel=2e-3
    )


def test_slow_heading_errors_in_the_document() -> None:
    document = DOCUMENT.read_text(encoding="utf-8")

    def row(name: str) -> list[float]:
        (cells,) = re.findall(rf"^\| {name} \|(.*)\|$", document, re.MULTILINE)
        return [float(cell) for cell in cells.split("|")]

    counts = [20, 100, 320, 1000]
    times = np.linspace(0, 2, 2001)
    second_half = slice(1000, None)
    polynomial = [np.abs(eval_laguerre(n, times[second_half])).max() for n in counts]
    assert row("Laguerre polynomial") == pytest.approx(polynomial, abs=5e-3)
    errors, sampled = np.ones(2001), []
    for iteration in range(1, 1001):
        errors[1:] -= 1e-3 * np.cumsum(errors[1:])  # the heading's part of Eqs. 8 and 17
        if iteration in counts:
            sampled.append(float(np.abs(errors[second_half]).max()))
    assert row("samples of 1 ms") == pytest.approx(sampled, abs=5e-3)
