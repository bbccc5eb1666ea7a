"""``hilc check``: verdicts on learning, predictions that are rough, and the table of errors."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.conftest import Hilc, Write

COARSE = ("--set", "trajectory.sample_time=10 ms")


def test_prediction_out_of_range_is_called_rough(hilc: Hilc) -> None:
    outcome = hilc("check", "example:fig6c", "--set", "controller.b_w=null", *COARSE)
    assert outcome.code == 0
    assert outcome.out.startswith("fig6c: unclear, ")
    assert "  Learning         unclear: the last error is out of the " in outcome.out
    assert " m (rough) in iteration 100\n" in outcome.out
    assert "\nwarning: the error of iteration 100 cannot be foretold, since " in outcome.out
    more = hilc(
        "check", "example:fig6c", "--set", "controller.b_w=null", "-v", "--theory", *COARSE
    ).out
    assert " m, rough\n" in more
    assert "; without speed limit it has none if gains are taken" in more.replace("\n", " ")


@pytest.mark.parametrize(
    ("name", "verdict"),
    [("fig3-circle", "learns"), ("fig8a", "learns-then-grows-later"), ("fig8c", "made-worse")],
)
def test_verdict_of_the_papers_gains(hilc: Hilc, name: str, verdict: str) -> None:
    outcome = hilc("check", f"example:{name}", "--json", *COARSE)
    fails = verdict == "made-worse"
    assert outcome.code == (3 if fails else 0)
    document = json.loads(outcome.out)
    learning = document["learning"]
    assert learning["verdict"] == verdict
    assert len(learning["predicted_max_position_error_by_iteration_m"]) == 101
    told = [text.startswith("no learning is to be expected") for text in document["failures"]]
    assert told == [True] * fails
    rough = learning["predicted_rough_from_iteration"]
    assert (rough is not None and rough <= 100) is fails


def test_plot_writes_its_numbers(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    outcome = hilc("check", "scenario.yaml", "--simulate", "--plot", "--out", "out")
    assert outcome.code == 0
    assert outcome.out.endswith("Written to out/transient.png\nWritten to out/transient.csv\n")
    header, first, *rows = (folder / "out" / "transient.csv").read_text().splitlines()
    assert header == "iteration,predicted_max_position_error_m,simulated_max_position_error_m"
    # 1 m of line, from wheels at rest.
    assert [float(cell) for cell in first.split(",")] == pytest.approx([0, 1, 1])
    assert len(rows) == 5000
    assert rows[1].partition(",")[0] == "2"
    assert not rows[1].endswith(",")
    assert rows[2].endswith(",")


def test_theorems_of_a_law_with_a_derivative(hilc: Hilc) -> None:
    # L1 B = l1 I: 1 - l1 tau in the limit, and 1 - l1 (tau + d) with samples of 10 ms.
    derived = ("check", "example:fig4-compensated", "--set", "controller.gains.derivative=0.1")
    shown = hilc(*derived, "--theory", "-v", *COARSE).out
    title = "  Eqs. 19 and 23 with tau, ||I - tau L1 B||   "
    assert f"{title}rho = 0.95, below 1, holds for small d_k\n" in shown
    assert "\n  Theorem 2 with tau and d_k                  rho = 0.945, below 1\n" in shown
    assert "\n  Speaks of this law                          Theorem 2\n" in shown
    assert "as printed" not in shown
    assert "\nWith tau: L1 acts on e_i(k+1) + tau (e_i(k+1) - e_i(k)) / d_k: rho is " in shown
    found = json.loads(hilc(*derived, "--json", *COARSE, "--set", "controller.gains.l1=21").out)[
        "theory"
    ]
    assert found["rho_without_sample_time"] == pytest.approx(1.1)
    assert (found["condition_holds"], found["rho_theorem_2_printed"]) == (False, None)
    assert list(found["bounds"]) == ["corrected", "corrected, within the speed limit"]
