"""The chapters on readings and on tau: their tables are the scripts', which agree with hilc."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.engine.lanes.batch import simulate_many

ROOT = Path(__file__).resolve().parents[1]
SCENARIOS = {  # of the paper's situations
    "3-circle": "fig3-circle",
    "3-cardioid": "fig3-cardioid",
    "4a": "fig4-uncompensated",
    "4b": "fig4-compensated",
    "5-spiral": "fig5-spiral",
    "7a": "fig7a",
    "8b": "fig8b",
    "8c": "fig8c",
}


def script(name: str) -> ModuleType:
    """A benchmark as a module."""
    specification = importlib.util.spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    sys.modules[name] = module  # its dataclasses look themselves up there
    specification.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def readings() -> ModuleType:
    return script("readings")


def rows_of(page: str, header: str) -> list[list[str]]:
    """The cells of a table of a page."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    found = re.search(rf"^\| {re.escape(header)} \|.*\n\|[-:|]+\n((?:\|.*\n)+)", text, re.MULTILINE)
    assert found is not None
    return [line.strip("|").split("|") for line in found[1].replace(" ", "").splitlines()]


def test_the_page_has_all_readings_and_adds_up(readings: ModuleType) -> None:
    rows = rows_of("readings.md", "reading | changes")
    told = [(name, changes) for name, changes, *_ in rows]
    assert told == [
        (each.name.replace(" ", ""), each.changes.replace(" ", "")) for each in readings.READINGS
    ]
    for _, _, *cells in rows:
        *points, total = map(int, cells)
        assert (len(points), sum(points)) == (10, total)
        assert set(points) <= {0, 1, 2}
    sums = {name: cells[-1] for name, _, *cells in rows}
    # What the text says of them.
    assert [sums[name] for name in ("literal", "pureD", "pureD,0.05s")] == ["12", "13", "9"]
    assert [sums[f"{half}e+0.1sde/dt"] for half in ("", "0.5")] == ["16", "16"]


def test_readings_are_those_of_the_engine(
    readings: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(readings, "ITERATIONS", 3)
    situations = {each.name: each for each in readings.situations()}
    read = (readings.LITERAL, readings.DERIVATIVE)
    cases = [(reading, situations[name]) for reading in read for name in SCENARIOS]
    theirs = np.array([outcome.largest for outcome in readings.simulate(cases)])
    ours = []
    for reading, situation in cases:
        changes = {"iterations": 3, "controller.gains.derivative": reading.derivative}
        run = hilc.run(hilc.load_scenario(f"example:{SCENARIOS[situation.name]}", changes))
        ours.append(run.metrics["max_position_error_m"] / run.reference.size)
    np.testing.assert_allclose(theirs, ours, rtol=1e-6)


@pytest.mark.slow
def test_scores_of_the_page_are_measured(readings: ModuleType) -> None:
    assert readings.main(["--check"]) == 0


@pytest.mark.slow
def test_the_page_on_tau_is_measured() -> None:
    tau, name = script("why_tau"), "fig3-circle"
    plain = tau.experiment(name)
    advised, _ = tau.waves_of(plain).suggested
    (ends,) = (row for row in rows_of("why-tau.md", "scenario | l1") if row[0] == name)
    derived = tau.with_gains(plain, 1.0, advised)
    left = simulate_many([plain, derived]).errors[:, 100] / plain.reference.size
    told = [tau.share_text(share).replace(" ", "") for share in left.tolist()]
    assert [ends[3], ends[5]] == told
    assert float(ends[4]) == advised
    (waves,) = (row for row in rows_of("why-tau.md", "scenario | wave [Hz]") if row[0] == name)
    predicted, measured = map(float, waves[4].split("/"))
    assert tau.predicted_factor(derived, 200) == pytest.approx(predicted, abs=1e-5)
    assert tau.measured_factors(derived, 200, 2).mean() == pytest.approx(measured, abs=1e-5)
