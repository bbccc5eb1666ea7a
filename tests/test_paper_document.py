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
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.paper.measuring import shipped
from hilc_cli.paper.reading import DERIVATIVE
from hilc_cli.results.metrics import settled_at
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.theory.learning.gains import ripple_growth
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.transient import predict_transient
from tests.cli.processes import HILC, environment

DOCUMENT = Path(__file__).resolve().parent.parent / "docs" / "paper.md"
READINGS = ("literal", "derivative")
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


def claims(folder: Path) -> dict[str, dict[str, str]]:
    """The rows of ``claims.csv`` by the names of the claims."""
    with (folder / "claims.csv").open(encoding="utf-8", newline="") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def figures_of(claim: dict[str, str], reading: str) -> dict[str, float]:
    """What was measured for a claim under a reading; not-a-number for what was never reached."""
    named = (text.partition("=")[::2] for text in rejoined(claim[f"{reading}_figures"]))
    return {name: float(value.split()[0].replace("none", "nan")) for name, value in named}


def rejoined(figures: str) -> list[str]:
    """Figures as ``name=value unit``, although a name may have an equals sign, too."""
    return [re.sub(r"l1 = ", "l1 ", text) for text in figures.split("; ")]


@pytest.mark.slow
def test_verdicts_in_the_document_are_the_measured_ones(reproduction: Path) -> None:
    columns = ("id", "literal_verdict", "derivative_verdict", "sentence")
    measured = [tuple(row[name] for name in columns) for row in claims(reproduction).values()]
    assert len(measured) == 15
    _, _, table = DOCUMENT.read_text(encoding="utf-8").partition("<!-- claims:")
    rows = re.findall(r"^\| ([TF]\d\S*) \| (.*) \| (.*) \| (.*) \|$", table, re.MULTILINE)
    assert rows == measured


@pytest.mark.slow
def test_errors_in_the_document_are_the_measured_ones(reproduction: Path) -> None:
    measured = claims(reproduction)
    second_half = "maximum error of the second half"
    named = [
        *(("F3-1", path) for path in ("circle", "arc-and-line", "cardioid", "spiral")),
        ("F4-2", second_half),
        *(("F5-1", f"{second_half}, {path}") for path in ("arc-and-line", "cardioid", "spiral")),
        ("F6-1", "error after 100 iterations with l1 25"),
        ("F8-1", "maximum error (8b)"),
        ("F8-2", "maximum error (8c)"),
    ]
    _, _, table = DOCUMENT.read_text(encoding="utf-8").partition("<!-- errors:")
    rows = re.findall(r"\| ([\d.]+) % \| ([\d.]+) % \|$", table, re.MULTILINE)
    assert rows == [
        tuple(f"{figures_of(measured[claim], reading)[name]:.2f}" for reading in READINGS)
        for claim, name in named
    ]


@pytest.mark.slow
def test_derivative_reading_ends_where_an_independent_simulation_did(reproduction: Path) -> None:
    # Shares of the path's size [%] by benchmarks/readings.py, which shares no code with hilc.
    measured = claims(reproduction)
    paths = figures_of(measured["F3-1"], "derivative")
    assert [round(paths[name], 2) for name in ("circle", "arc-and-line", "cardioid", "spiral")] == [
        *(0.23, 0.18, 0.22, 0.30),
    ]
    circle = figures_of(measured["F4-2"], "derivative")
    others = figures_of(measured["F5-1"], "derivative")
    assert round(circle["maximum error of the second half"], 1) == 2.0
    assert [
        round(others[f"maximum error of the second half, {name}"], 2)
        for name in ("arc-and-line", "cardioid", "spiral")
    ] == [0.62, 0.26, 0.39]
    size = 20.0  # of the circle [m]
    without, contradicting = (
        figures_of(measured[claim], "derivative")[f"maximum error ({panel})"] * size / 100
        for claim, panel in (("F8-1", "8b"), ("F8-2", "8c"))
    )
    assert (round(without, 2), round(contradicting)) == (0.15, 21)
    too_large = [shipped(DERIVATIVE, "fig6a", f"controller.gains.l1={gain}") for gain in (25, 40)]
    for error in simulate_batch(too_large).errors[:, -1]:
        assert 20.5 <= error <= 23


@pytest.mark.slow
def test_caption_of_figure_6_has_the_measured_counts(reproduction: Path) -> None:
    measured = claims(reproduction)
    captions = " ".join(DOCUMENT.read_text(encoding="utf-8").split())
    for reading in READINGS:
        figures = {**figures_of(measured["F6-1"], reading), **figures_of(measured["F6-3"], reading)}
        needed = {letter: figures[f"needed (6{letter})"] for letter in "defghi"}
        needed |= {"b": figures["needed with l1 1"], "c": figures["needed with l1 10"]}
        assert math.isnan(figures["needed with l1 0.1"])
        _, _, caption = captions.partition(f"{reading}: never (a), ")
        for letter, count in needed.items():
            assert f"{count:.0f} ({letter})" in caption.partition("iterations")[0]


@pytest.mark.slow
def test_all_figures_and_data_are_there(reproduction: Path) -> None:
    for name in (f"{figure}-{reading}.png" for figure in FIGURES for reading in READINGS):
        assert (reproduction / name).stat().st_size > 10_000
        assert (DOCUMENT.parent / "images" / "paper" / name).stat().st_size > 10_000
    # Panels of the captions: 4 x 3, 2 x 3, 3 x 3, 9, 4 x 3 and 3 x 3.
    assert len(list((reproduction / "data").glob("*.csv"))) == 2 * (12 + 6 + 9 + 9 + 12 + 9)


@pytest.mark.slow
def test_counts_without_knowledge_of_the_platform_in_the_document(reproduction: Path) -> None:
    text = " ".join(DOCUMENT.read_text(encoding="utf-8").split())
    for reading, told in (
        ("literal", "1 % takes {0:.0f} iterations instead of {1:.0f}, and"),
        ("derivative", "with the derivative {0:.0f} instead of {1:.0f}."),
    ):
        figures = figures_of(claims(reproduction)["F8-1"], reading)
        names = ("iterations to 1 % (8b)", "iterations to 1 % with R and B, scalars of 8b")
        assert told.format(*(figures[name] for name in names)) in text


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
    assert cell(document, "predicted, errors linear too") == str(
        settled_linearly(circle, 0.2, 1300)
    )
    for name, row in (("fig8a", "worst ripple of situation 11"), ("fig6i", "worst ripple of 6i")):
        growth = 100 * (ripple_growth(experiment(name)).factor - 1)
        assert cell(document, row) == f"grows by {growth:.2g} % an iteration"


def settled_linearly(lifted: LiftedIteration, bound: float, iterations: int) -> int | None:
    """The iteration from which on the linear theory's own errors stay within a bound [m]."""
    errors, current = np.empty(iterations + 1), lifted.first()
    for iteration in range(iterations + 1):
        errors[iteration] = np.hypot(current.errors[:, 0], current.errors[:, 1]).max()
        current = lifted.next(current)
    return settled_at(errors, bound)


@pytest.mark.slow
def test_predicted_counts_in_the_document_are_the_computed_ones() -> None:
    document = DOCUMENT.read_text(encoding="utf-8")

    def row(name: str) -> dict[str, str]:
        (cells,) = re.findall(rf"^\| {name} \|(.*)\|$", document, re.MULTILINE)
        return dict(zip(names, (cell.strip() for cell in cells.split("|")), strict=True))

    (header,) = re.findall(r"^\| scenario \|(.*)\|$", document, re.MULTILINE)
    names = [name.strip() for name in header.split("|")]
    predicted, linearly = row("predicted"), row("predicted, errors linear too")
    horizons = {"fig3-arc-and-line": 2600, "fig8b": 2100, "fig6e": 300}
    for name, last in horizons.items():
        lifted = experiment(name, "controller.b_w=null")
        bound = 0.01 * lifted.reference.size
        assert predicted[name] == str(predict_transient(lifted, last).settled_at(0.01))
        assert linearly[name] == str(settled_linearly(LiftedIteration(lifted), bound, last))


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
