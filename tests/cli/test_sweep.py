"""``hilc sweep``: the same numbers as single runs, the same files again, and what is printed."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.results.metrics import METRICS
from hilc_cli.shipped_files import examples
from tests.cli.inputs import TRAJECTORY, plus, replaced, scenario
from tests.conftest import Hilc, Outcome, Write
from tests.shipped import LIKE_OTHERS

SWEEP = ("sweep", "scenario.yaml", "--no-plots", "-q")
L1 = "controller.gains.l1"


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(
    ("number", "name"),
    [
        pytest.param(number, path.stem, marks=pytest.mark.slow if path.stem in LIKE_OTHERS else ())
        for number, path in enumerate(examples())
    ],
    ids=lambda v: str(v),
)
def test_case_has_the_numbers_of_a_run(number: int, name: str) -> None:
    iterations = 3 + number % 4
    loaded = hilc_api.load_scenario(f"example:{name}")
    loaded = replace(loaded, spec=loaded.spec.model_copy(update={"sweep": None}))
    run = hilc_api.run(hilc_api.load_scenario(f"example:{name}", {"iterations": iterations}))
    errors = run.metrics["max_position_error_m"]
    tolerance = float(np.sort(errors)[len(errors) // 2]) * (1 + 1e-6)
    plan = hilc_api.plan_sweep(loaded, {"iterations": [iterations]}, tolerance=tolerance)
    sweep = hilc_api.sweep(plan)
    for metric in METRICS:
        expected = run.metrics.row(-1)[metric]
        assert sweep.columns[metric][0] == pytest.approx(expected, rel=1e-9, abs=1e-11), metric
    assert sweep.columns["peak_max_position_error_m"][0] == pytest.approx(max(errors), rel=1e-9)
    settled = [i for i in range(len(errors)) if all(error <= tolerance for error in errors[i:])]
    expected = float(settled[0]) if settled else math.nan
    np.testing.assert_equal(sweep.columns["iterations_to_tolerance"][0], expected)
    assert sweep.columns["diverged"][0] == 0


@pytest.mark.parametrize("name", ["gain-map", "gain-map-no-limit"])
def test_map_of_gains(hilc: Hilc, folder: Path, name: str) -> None:
    assert hilc("sweep", f"example:{name}", "--set", "iterations=3", "-q") == Outcome(0, "", "")
    results = folder / "runs" / f"{name}+iterations=3-sweep"
    rows = table(results / "cases.csv")
    assert len(rows) == 40 * 40
    gains = 0.02 * 1000 ** (np.arange(40) / 39)
    np.testing.assert_allclose([float(row[L1]) for row in rows[::40]], gains, rtol=1e-12)
    limited = max(float(row["max_wheel_speed_rad_s"]) for row in rows) <= 180
    assert limited == (name == "gain-map")
    assert (results / "map.png").stat().st_size > 0


def test_seeds_are_separate_runs(write: Write) -> None:
    write()
    changes = {"disturbance.output.bound": [0.1, 0.1, 0.1], "iterations": 5}
    plan = hilc_api.plan_sweep(
        hilc_api.load_scenario("scenario.yaml", changes), {"disturbance.seed": "0..19"}
    )
    sweep = hilc_api.sweep(plan)
    expected = [
        hilc_api.run(
            hilc_api.load_scenario("scenario.yaml", {**changes, "disturbance.seed": seed})
        ).metrics.row(-1)
        for seed in range(20)
    ]
    for metric in METRICS:
        numbers = [row[metric] for row in expected]
        np.testing.assert_allclose(sweep.columns[metric], numbers, rtol=1e-9, atol=1e-12)
    assert len(set(sweep.columns["max_position_error_m"])) == 20


SECTION = "sweep: {vary: {controller.gains.l1: [0.1, 0.2]}}\n"


def test_run_ignores_what_a_sweep_varies(hilc: Hilc, write: Write, folder: Path) -> None:
    write({"swept.yaml": plus(SECTION)})
    run = ("--no-plots", "-q", "--out")
    assert hilc("run", "scenario.yaml", *run, "one") == Outcome(0, "", "")
    assert hilc("run", "swept.yaml", *run, "other") == Outcome(0, "", "")
    for name in ("iterations.csv", "samples.csv", "scenario.yaml"):
        assert (folder / "one" / name).read_bytes() == (folder / "other" / name).read_bytes()


LONG = replaced(replaced(TRAJECTORY, "name: path", "name: long"), "0.3 s", "7 s")
MOVED = replaced(replaced(TRAJECTORY, "name: path", "name: moved"), "x: 0", "x: 3")
NORMAL = "disturbance.output.distribution=truncated-normal"


@pytest.mark.parametrize(
    "arguments",
    [
        ("--vary", "controller.gains.l1=0.1:1:7", "--vary", "controller.b_w=null,5"),
        ("--vary", "trajectory=path.yaml,long.yaml,moved.yaml"),
        ("--vary", "trajectory=path.yaml,long.yaml", "--vary", "controller.h=1,3"),
        ("--vary", "iterations=1:300:7:log", "--vary", "trajectory.start.x=0,1"),
        ("--vary", "robot.wheel_radius=15 cm:0.3:4", "--vary", "robot.half_track=0.1:1:3"),
        ("--vary", "disturbance.output.bound.0=1 cm,1", "--set", NORMAL),
        ("--vary", "disturbance.output.repeat=true,false", "--set", NORMAL),
        ("--vary", "controller.gains.l1=0.1:10:log", "--sample", "random", "--cases", "40",
         "--seed", "3", "--bands", "--tolerance", "5 cm"),
        ("--vary", "iterations=1:30:log", "--vary", "controller.gain_heading=measured,previous",
         "--sample", "sobol", "--cases", "33"),
        ("--vary", "controller.gains.l1=1,2", "--set", "initial_input=input.csv"),
        ("--vary", "initial_pose.heading=80 deg:100 deg:3"),
        ("--vary", "controller.gain_matrix.0.0=1,0.5,cos/R",
         "--set", "controller.gain_matrix=[[1,0,0],[0,1,0]]"),
    ],
)  # fmt: skip
def test_scenario_of_a_sweep_gives_the_same_table(
    hilc: Hilc, write: Write, folder: Path, arguments: tuple[str, ...]
) -> None:
    write({"long.yaml": LONG, "moved.yaml": MOVED})
    assert hilc(*SWEEP, *arguments, "--out", "a") == Outcome(0, "", "")
    again = ("sweep", "a/scenario.yaml", "--no-plots", "-q", "--out", "b")
    assert hilc(*again) == Outcome(0, "", "")
    assert (folder / "a/cases.csv").read_bytes() == (folder / "b/cases.csv").read_bytes()
    assert (folder / "a/scenario.yaml").read_bytes() == (folder / "b/scenario.yaml").read_bytes()
    checksums = [json.loads((folder / f"{n}/sweep.json").read_text())["checksum"] for n in "ab"]
    assert checksums[0] == checksums[1]
    hilc_api.read_sweep("a")


def test_sweeps_that_differ_in_what_follows_have_different_checksums(write: Write) -> None:
    write()
    vary = {"robot.wheel_radius": [0.1, 0.2]}
    follows = hilc_api.plan_sweep(hilc_api.load_scenario("scenario.yaml"), vary)
    stays = hilc_api.plan_sweep(
        hilc_api.load_scenario("scenario.yaml", {"model.wheel_radius": 0.2}), vary
    )
    assert follows.checksum() != stays.checksum()


def test_json_is_one_document(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc(*SWEEP, "--vary", f"{L1}=0.1,0.5,1", "--json", "--tolerance", "0.3")
    document = json.loads(outcome.out, parse_constant=pytest.fail)
    assert (outcome.code, outcome.err) == (0, "")
    assert document["folder"] == "runs/test-sweep"
    assert (document["cases"], document["diverged"], document["failed"]) == (3, 0, 0)
    assert document["metric"] == "max_position_error_m"
    best = document["best"]
    assert [case["metric"] for case in best] == sorted(case["metric"] for case in best)
    assert best[0]["values"] == {L1: [0.1, 0.5, 1][best[0]["case"]]}
    assert document["failures"] == []


def test_cases_are_ranked_by_the_metric(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    metric = "max_wheel_speed_rad_s"
    outcome = hilc(*SWEEP, "--vary", f"{L1}=0.5,0.1,1", "--json", "--metric", metric)
    document = json.loads(outcome.out)
    column = [float(row[metric]) for row in table(folder / "runs/test-sweep/cases.csv")]
    assert [case["case"] for case in document["best"]] == [int(i) for i in np.argsort(column)]
    assert document["median"] == sorted(column)[1]
    assert document["worst"] == max(column)


def test_summary_names_the_best_cases(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc("sweep", "scenario.yaml", "--no-plots", "--vary", f"{L1}=0.1,0.5")
    assert (outcome.code, outcome.err) == (0, "")
    lines = outcome.out.splitlines()
    assert "test, 2 cases" in outcome.out
    assert [line.split(":")[0].strip() for line in lines if "case " in line] == ["case 1", "case 0"]
    assert lines[-1] == "Written to runs/test-sweep"


def test_divergence_is_a_result(hilc: Hilc, write: Write, folder: Path) -> None:
    write(
        {"scenario.yaml": scenario("  b_w: 180\n", "").replace("iterations: 2", "iterations: 400")}
    )
    vary = ("--vary", "controller.gains.l1=0.5,1e4", "--tolerance", "1", "--bands")
    outcome = hilc(*SWEEP, *vary, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out, parse_constant=pytest.fail)
    assert (document["diverged"], len(document["best"])) == (1, 1)
    rows = table(folder / "runs/test-sweep/cases.csv")
    assert [row["diverged"] for row in rows] == ["0", "1"]
    assert rows[1]["iterations_to_tolerance"] == ""
    assert float(rows[1]["peak_max_position_error_m"]) > 1e100
    bands = table(folder / "runs/test-sweep/bands.csv")
    assert [row["cases"] for row in bands] == ["2"] * 401
    assert bands[-1]["max_position_error_m_p95"] == "inf"
    assert float(bands[0]["max_position_error_m_p95"]) < 2


def test_case_that_fails_is_told(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    duration = "trajectory.segments.0.line.duration"
    outcome = hilc(*SWEEP, "--vary", f"{duration}=0.1:0.4:3", "--json")
    assert outcome.code == 3
    document = json.loads(outcome.out)
    assert (document["cases"], document["failed"]) == (3, 1)
    assert (document["failures"][0]["first"], document["failures"][0]["last"]) == (1, 1)
    assert "2.5 samples of 0.1 s" in document["failures"][0]["reason"]
    assert outcome.err.splitlines()[0].startswith("hilc: case 1 failed: ")
    rows = table(folder / "runs/test-sweep/cases.csv")
    assert [row["diverged"] for row in rows] == ["0", "", "0"]
    data = hilc_api.read_sweep("runs/test-sweep")
    assert data.failed.tolist() == [False, True, False]
    assert hilc(*SWEEP, "--vary", f"{duration}=0.1:0.4:3", "--dry-run").code == 0


@pytest.mark.parametrize(
    ("vary", "cases", "samples"),
    [
        (["controller.gains.l1=0:1:7"], 7, 7 * 3 * 3),
        (["iterations=0..9", "controller.gains.l1=1,2"], 20, 2 * 3 * sum(range(1, 11))),
        (["trajectory=path.yaml,long.yaml"], 2, 3 * (3 + 70)),
        (["iterations=1,3", "trajectory.segments.0.line.duration=0.1,0.5"], 4, (2 + 4) * (1 + 5)),
    ],
)
def test_dry_run_says_what_it_would_cost(
    hilc: Hilc, write: Write, folder: Path, vary: list[str], cases: int, samples: int
) -> None:
    write({"long.yaml": LONG})
    options = [word for text in vary for word in ("--vary", text)]
    outcome = hilc(*SWEEP, *options, "--dry-run", "--json", "--workers", "3")
    document = json.loads(outcome.out)
    assert (outcome.code, outcome.err) == (0, "")
    assert (document["cases"], document["samples"]) == (cases, pytest.approx(samples))
    assert (document["workers"], document["seconds"] > 0) == (3, True)
    assert not (folder / "runs").exists()
    text = hilc("sweep", "scenario.yaml", *options, "--dry-run").out
    assert "not computed" in text


def test_same_sweep_may_be_written_again_and_another_may_not(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc(*SWEEP, "--vary", f"{L1}=1,2").code == 0
    assert hilc(*SWEEP, "--vary", f"{L1}=1,2").code == 0
    outcome = hilc(*SWEEP, "--vary", f"{L1}=1,3")
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err == (
        "hilc: runs/test-sweep: holds the results of another sweep; "
        "choose another folder with --out, or replace it with --force\n"
    )
    assert hilc(*SWEEP, "--vary", f"{L1}=1,3", "--force") == Outcome(0, "", "")


def test_scenario_may_come_from_standard_input(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    outcome = hilc("sweep", "-", "--no-plots", "-q", stdin=plus(SECTION).encode())
    assert outcome == Outcome(0, "", "")
    assert [row[L1] for row in table(folder / "runs/test-sweep/cases.csv")] == ["0.1", "0.2"]
