"""``hilc check --simulate``: a run beside the theory."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.theory.learning import transient
from tests.cli.inputs import TRAJECTORY, trajectory
from tests.conftest import Hilc, Outcome, Write

ERRORS = """
                                              Predicted     Simulated
Maximum position error                  [without limit]  [with limit]
─────────────────────────────────────────────────────────────────────
Iteration 0                                         1 m           1 m
Iteration 2                                    0.8083 m      0.8083 m
  in its second half                                  -      0.8083 m
Largest                                             1 m           1 m
  in iteration                                        0             0
  times that of iteration 0                           1             1
Iterations to 1 % of the path's size                 87      not in 2
Iterations to 0.1 % of the path's size              166      not in 2
"""
TURNING = TRAJECTORY + "  - semicircle: {radius: 1, turn: left, duration: 0.5 s}\n"
OUTPUT = "disturbance={seed: 5, output: {bound: [0.01, 0.01, 0.02]}}"
STATE = (
    "disturbance={seed: 5, state: {bound: [0.001, 0.002, 0.01], distribution: truncated-normal}}"
)
POSE = "disturbance.initial_pose={bound: [0.05, 0.05, 0.1], repeat: true}"
CASES: Sequence[tuple[str, ...]] = (
    (),
    ("controller.b_w=45", "controller.gains={l1: 3, l2: 1, l3: 0.5}"),
    (OUTPUT, "controller.gains.l1=2"),
    (STATE, "controller.gain_heading=previous"),
    (POSE, "controller.h=3"),
    ("initial_pose={x: 0.2, y: 0.1, heading: 0.3}", "controller={gains: {l1: 1}, h: 2}"),
    ("controller.gain_matrix=[[0.5, 0.2, B/R], [cos, sin, -B/R]]", "controller.gains.l2=1"),
    ("robot.turn_convention=rep103", "model.wheel_radius=0.25", "initial_input=feedforward"),
    ("controller.gains.l1=60", "controller.b_w=null", "iterations=300"),
)


@pytest.fixture(autouse=True)
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 300)


def settings(changes: Sequence[str]) -> list[str]:
    return [word for change in changes for word in ("--set", change)]


@pytest.mark.parametrize("changes", CASES, ids=[f"{number}" for number in range(len(CASES))])
def test_figures_are_those_of_the_run(hilc: Hilc, write: Write, changes: Sequence[str]) -> None:
    write({"path.yaml": TURNING})
    options = ("scenario.yaml", "--json", "--set", "iterations=12", *settings(changes))
    run = json.loads(hilc("run", *options, "--no-plots").out)
    found = json.loads(hilc("check", *options, "--simulate").out)
    simulated = found["learning"]["simulated"]
    last = {"max_position_error_m", "max_position_error_second_half_m"}
    shared = set(simulated) - last
    assert shared == {
        *("iterations", "peak_max_position_error_m", "peak_iteration"),
        *("settled_at", "diverged_at"),
    }
    assert {key: simulated[key] for key in shared} == {key: run[key] for key in shared}
    assert {key: simulated[key] for key in last} == {key: run["final"][key] for key in last}
    beside = found["theory"]["simulated"]
    assert list(beside) == list(found["theory"]["bounds"])
    for name in ("corrected", "corrected, within the speed limit"):
        for part in beside.get(name, {}).values():
            assert part["violated_iterations"] == []
    assert not any("please report it" in text for text in found["warnings"])


def test_simulated_errors_stand_beside_the_predicted_ones(hilc: Hilc, write: Write) -> None:
    # Along a line the linear theory is exact: 0.80833 m, as in tests/cli/test_compare.py.
    write()
    outcome = hilc("check", "scenario.yaml", "--simulate")
    assert (outcome.code, outcome.err) == (0, "")
    assert ERRORS in outcome.out
    assert "Simulated with disturbances, if there are any.\n" in outcome.out
    single = hilc("check", "scenario.yaml", "--simulate", "--set", "iterations=0").out
    assert single.count("\nIteration 0  ") == 1


def test_violated_printed_bounds_are_shown(hilc: Hilc, write: Write) -> None:
    # The first sample's input error falls by 1 - l1 d = 0.95. Eq. 37 has A = 0.75, with d_k 0.975.
    write()
    out = hilc("check", "scenario.yaml", "--simulate", "--theory").out
    rows = [line.split() for line in out.partition("\nlog10 of ")[2].splitlines()]
    (first, *_) = [row[5:] for row in rows if row[:3] == ["least", "room", "below"]]
    above = [row[3:] for row in rows if row[:3] == ["iterations", "above", "it"]]
    assert first == [f"{2 * math.log10(0.75 / 0.95):.2f}", "0.00", "0.00", "0.00"]
    assert above == [["2", "0", "0", "0"], ["0"] * 4, ["0"] * 4]
    simulated = next(row[3:] for row in rows if row[:2] == ["simulated,", "last"])
    wheels = math.log10(50 / 3)
    norms = (wheels + math.log10(2) / 2, wheels + math.log10(2))  # Euclidean, and the sum
    assert simulated == [f"{norms[index]:.2f}" for index in (0, 0, 1, 1)]
    document = json.loads(hilc("check", "scenario.yaml", "--simulate", "--json").out)
    part = document["theory"]["simulated"]["as printed"]["input"]
    assert part["violated_iterations"] == [1, 2]
    assert part["smallest_looseness_log10"] == pytest.approx(2 * math.log10(0.75 / 0.95))
    assert part["last_log10"] == pytest.approx(norms[0])


def test_diverged_simulation_is_an_error(hilc: Hilc, write: Write) -> None:
    # Three samples: the first is multiplied by 1 - 60 * 0.1 = -5 in each iteration.
    write()
    changes = settings(("controller.gains.l1=60", "controller.b_w=null", "iterations=300"))
    outcome = hilc("check", "scenario.yaml", "--simulate", *changes)
    assert outcome.code == 3
    document = json.loads(hilc("check", "scenario.yaml", "--simulate", "--json", *changes).out)
    at = document["learning"]["simulated"]["diverged_at"]
    assert 140 / math.log10(5) - 10 < at <= 140 / math.log10(5) + 1
    assert document["learning"]["simulated"]["iterations"] == at - 1
    assert document["failures"][1] == (
        f"the simulation diverged to non-finite values in iteration {at}; lower the gains, or set "
        "controller.b_w"
    )
    assert outcome.err.endswith("(1 more in the report)\n")
    assert f"\nerror: {document['failures'][1]}\n" in outcome.out
    (row,) = [line for line in outcome.out.splitlines() if line.startswith("Iteration 300 ")]
    assert row.endswith(f"  diverged in {at}")


def test_simulation_without_a_single_iteration_leaves_the_rest(hilc: Hilc, write: Write) -> None:
    # Feedback of 1e12 over 30 samples: beyond 1e300 in the first pass.
    write({"path.yaml": trajectory("0.3 s", "3 s")})
    changes = settings(
        (
            *("controller.gains={l1: 0.5, l2: 1e12}", "controller.b_w=null"),
            "initial_trial=feedback",
        )
    )
    outcome = hilc("check", "scenario.yaml", "--simulate", *changes)
    text = (
        "the simulation diverged to non-finite values in iteration 0; lower the gains, or set "
        "controller.b_w"
    )
    assert (outcome.code, outcome.err) == (3, f"hilc: {text}\n")
    assert f"\nerror: {text}\n" in outcome.out
    assert "  Simulated\n" not in outcome.out
    assert "\nMore: -v " in outcome.out


def test_law_without_a_theory_is_simulated_and_no_more(
    hilc: Hilc, write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(HybridLaw, "theory", None)
    write()
    outcome = hilc("check", "scenario.yaml", "--simulate", "--plot")
    assert "--theory" not in outcome.out
    assert (outcome.code, outcome.err) == (
        *(0, "hilc: nothing is drawn: nothing is predicted of this law\n"),
    )
    assert re.search(
        "^  Theory +nothing is known of law hybrid before it is run$", outcome.out, re.MULTILINE
    )
    more = hilc("check", "scenario.yaml", "--theory").out
    assert "  Theory   none: this is another law\n" in more
    assert not (folder / "runs").exists()
    document = json.loads(hilc("check", "scenario.yaml", "--simulate", "--json").out)
    assert (list(document["learning"]), document["theory"]) == (["simulated"], {})
    assert re.search("^Iteration 2 +0.8083 m$", outcome.out, re.MULTILINE)


def test_quiet_simulation_prints_nothing(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc("check", "scenario.yaml", "--simulate", "-q") == Outcome(0, "", "")
