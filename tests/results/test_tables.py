"""The CSV files: exact headers, a small golden example, and numbers that read back exactly."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from hypothesis.extra import numpy as npst

import hilc_cli as hilc_api
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.tables import read_input, read_samples, write_input, write_samples
from hilc_cli.results.trial import Trial
from tests.conftest import Hilc, Outcome, Write

ITERATIONS = (
    "iteration,max_position_error_m,mean_position_error_m,rms_position_error_m,"
    "final_position_error_m,max_abs_error_x_m,max_abs_error_y_m,max_abs_error_heading_rad,"
    "max_wheel_speed_rad_s,saturated_samples,input_change_rms_rad_s,"
    "max_position_error_second_half_m,mean_position_error_second_half_m"
)
SAMPLES = (
    "iteration,sample,t_s,reference_x_m,reference_y_m,reference_heading_rad,x_m,y_m,heading_rad,"
    "error_x_m,error_y_m,error_heading_rad,left_wheel_rad_s,right_wheel_rad_s"
)
INPUT = "sample,t_s,left_wheel_rad_s,right_wheel_rad_s"

# A line of 3 m in 3 s, from rest: u_1 = u_0 + l1 e_0(k + 1) / R = 0.5 (k + 1) / 0.2, on a line
# without any turn, so that R u_1 is 0.5, 1 and 1.5 m/s; the limit of 6 rad/s makes the last 1.2.
GOLDEN_SCENARIO = """\
name: golden
trajectory:
  name: line
  sample_time: 1
  start: {x: 0, y: 0, heading: 0}
  segments: [{line: {length: 3, duration: 3}}]
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper, gravity_center: [0.5, 0.25]}
iterations: 1
controller: {gains: {l1: 0.5}, b_w: 6}
record: {gravity_center: true}
"""
GOLDEN_SAMPLES = """\
0,0,0,0,0,0,0,0,0,0,0,0,0,0
0,1,1,1,0,0,0,0,0,1,0,0,0,0
0,2,2,2,0,0,0,0,0,2,0,0,0,0
0,3,3,3,0,0,0,0,0,3,0,0,,
1,0,0,0,0,0,0,0,0,0,0,0,2.5,2.5
1,1,1,1,0,0,0.5,0,0,0.5,0,0,5,5
1,2,2,2,0,0,1.5,0,0,0.5,0,0,6,6
1,3,3,3,0,0,2.7,0,0,0.3,0,0,,
"""
# Errors 0, 1, 2, 3 and 0, 0.5, 0.5, 0.3; the input changes by 2.5, 5, 6 at both wheels.
GOLDEN_ITERATIONS: list[list[float]] = [
    [0, 3, 1.5, math.sqrt(14 / 4), 3, 3, 0, 0, 0, 0, 0, 3, 2.5],
    [
        *(
            1,
            0.5,
            0.325,
            math.sqrt(0.59 / 4),
            0.3,
            0.5,
            0,
            0,
            6,
            1,
            math.sqrt((6.25 + 25 + 36) / 3),
        ),
        *(0.5, 0.4),
    ],
]
GOLDEN_INPUT: list[list[float]] = [[0, 0, 2.5, 2.5], [1, 1, 5, 5], [2, 2, 6, 6]]
# 5 rad/s of correction per metre of e(k+1) times 0.5, within 6 rad/s; what is aimed at is the line.
GOLDEN_PLAN: list[list[float]] = [
    [0, 0, 3.75, 3.75, 0, 0, 0],
    [1, 1, 6, 6, 1, 0, 0],
    [2, 2, 6, 6, 2, 0, 0],
    [3, 3, math.nan, math.nan, 3, 0, 0],
]
GOLDEN_GRAVITY_CENTER: list[list[float]] = [
    *([0, k, k, 0.5, 0.25, 0] for k in range(4)),
    *([1, k, k, x + 0.5, 0.25, 0] for k, x in enumerate([0, 0.5, 1.5, 2.7])),
]


def rows(path: Path) -> list[list[str]]:
    with path.open(newline="") as file:
        return list(csv.reader(file))


def numbers(path: Path) -> list[list[float]]:
    return [[float(cell) if cell else math.nan for cell in row] for row in rows(path)[1:]]


@pytest.fixture
def golden(hilc: Hilc, write: Write, folder: Path) -> Path:
    write({"golden.yaml": GOLDEN_SCENARIO})
    assert hilc("run", "golden.yaml", "--no-plots", "-q") == Outcome(0, "", "")
    return folder / "runs" / "golden"


@pytest.mark.parametrize(
    ("name", "header"),
    [
        ("iterations.csv", ITERATIONS),
        ("samples.csv", SAMPLES),
        ("input.csv", INPUT),
        ("plan.csv", f"{INPUT},x_m,y_m,heading_rad"),
        ("gravity-center.csv", "iteration,sample,t_s,x_m,y_m,heading_rad"),
    ],
)
def test_headers(golden: Path, name: str, header: str) -> None:
    assert (golden / name).read_text().partition("\n")[0] == header


def test_golden_iterations(golden: Path) -> None:
    np.testing.assert_allclose(numbers(golden / "iterations.csv"), GOLDEN_ITERATIONS, atol=1e-12)


def test_golden_samples(golden: Path) -> None:
    expected = [
        [float(cell) if cell else math.nan for cell in line.split(",")]
        for line in GOLDEN_SAMPLES.splitlines()
    ]
    np.testing.assert_allclose(numbers(golden / "samples.csv"), expected, atol=1e-12)


def test_golden_input(golden: Path) -> None:
    np.testing.assert_allclose(numbers(golden / "input.csv"), GOLDEN_INPUT, atol=1e-12)
    np.testing.assert_allclose(numbers(golden / "plan.csv"), GOLDEN_PLAN, atol=1e-12)


def test_golden_gravity_center(golden: Path) -> None:
    found = numbers(golden / "gravity-center.csv")
    np.testing.assert_allclose(found, GOLDEN_GRAVITY_CENTER, atol=1e-12)


def test_wheel_cells_of_the_last_sample_are_empty(golden: Path) -> None:
    for row in rows(golden / "samples.csv")[1:]:
        is_last = row[1] == "3"
        assert [cell == "" for cell in row] == [False] * 12 + [is_last] * 2


def test_whole_numbers_are_written_as_such(golden: Path) -> None:
    for row in rows(golden / "iterations.csv")[1:]:
        assert row[0].isdigit() and row[9].isdigit()
    for row in rows(golden / "samples.csv")[1:]:
        assert row[0].isdigit() and row[1].isdigit()


def test_input_change_of_the_first_iteration_is_zero(golden: Path) -> None:
    assert rows(golden / "iterations.csv")[1][10] == "0.0"


@pytest.mark.parametrize("name", ["iterations.csv", "samples.csv", "input.csv"])
def test_lines_end_as_on_unix_in_plain_ascii(golden: Path, name: str) -> None:
    content = (golden / name).read_bytes()
    assert content.isascii()
    assert b"\r" not in content
    assert content.endswith(b"\n") and not content.endswith(b"\n\n")


def test_input_is_the_last_iteration_s(golden: Path) -> None:
    samples = rows(golden / "samples.csv")
    learned = [row[12:] for row in samples if row[0] == "1" and row[12]]
    assert [row[2:] for row in rows(golden / "input.csv")[1:]] == learned


def test_learned_input_continues_where_the_run_ended(
    hilc: Hilc, golden: Path, folder: Path
) -> None:
    outcome = hilc(
        *("run", "golden.yaml", "--no-plots", "-q", "--out", "next"),
        *("--set", "initial_input=runs/golden/input.csv"),
    )
    assert outcome == Outcome(0, "", "")
    before, after = hilc_api.read_run(golden), hilc_api.read_run(folder / "next")
    np.testing.assert_array_equal(after.trials[0].left, before.last.left)
    np.testing.assert_array_equal(after.trials[0].x, before.last.x)


FINITE = st.floats(allow_nan=False, allow_infinity=False, width=64)


def columns(count: int) -> st.SearchStrategy[Floats]:
    return npst.arrays(np.float64, count, elements=FINITE)


@given(data=st.data(), steps=st.integers(1, 6))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
def test_input_reads_back_exactly(tmp_path: Path, data: st.DataObject, steps: int) -> None:
    left, right = data.draw(columns(steps)), data.draw(columns(steps))
    path = tmp_path / "input.csv"
    write_input(path, 0.001, left, right)
    read = read_input(path, path.read_bytes(), steps, 0.001)
    np.testing.assert_array_equal(read, (left, right))
    assert np.array_equal(np.signbit(read), np.signbit((left, right)))


@given(data=st.data(), steps=st.integers(1, 5), count=st.integers(1, 3))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
def test_samples_read_back_exactly(
    tmp_path: Path, data: st.DataObject, steps: int, count: int
) -> None:
    small = npst.arrays(np.float64, steps + 1, elements=st.floats(-1e140, 1e140))
    wheels = npst.arrays(np.float64, steps, elements=st.floats(-1e200, 1e200))
    x, y, heading = (data.draw(small) for _ in range(3))
    reference = Reference("r", 0.005, x, y, heading)
    trials = []
    for number in range(count):
        x, y, heading = (data.draw(small) for _ in range(3))
        trials.append(Trial(3 * number, x, y, heading, data.draw(wheels), data.draw(wheels)))
    path = tmp_path / "samples.csv"
    write_samples(path, reference, trials)
    found, read = read_samples(path, "r")
    assert found.sample_time == reference.sample_time
    for field in ("x", "y", "heading"):
        np.testing.assert_array_equal(getattr(found, field), getattr(reference, field))
    assert list(read) == [trial.iteration for trial in trials]
    for trial in trials:
        for field in ("x", "y", "heading", "left", "right"):
            np.testing.assert_array_equal(
                getattr(read[trial.iteration], field), getattr(trial, field)
            )


@pytest.mark.parametrize("ending", ["\r\n", "\n"])
def test_input_of_a_spreadsheet_is_read(ending: str) -> None:
    text = ending.join(["\ufeff" + INPUT, '"0","0.0","1.5","-2"', "1,0.1, 1e3,-.5", ""])
    left, right = read_input(Path("input.csv"), text.encode(), 2, 0.1)
    assert left.tolist() == [1.5, 1000.0]
    assert right.tolist() == [-2.0, -0.5]
