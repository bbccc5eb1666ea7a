"""A metric and a kind of picture are one entry each: everything else follows from that."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hilc_cli
from hilc_cli.engine.lanes.lanes import SUM_ROWS
from hilc_cli.results.metrics import METRICS, Sums
from hilc_cli.results.picture_kinds import RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.sweeps.pictures.catalogue import SweepPicture

METRIC = """
        Metric(
            "median_position_error_m", "median position error", _AFTER,
            lambda motion: float(np.median(motion.position_error)),
            lambda sums: sums.final_error,
        ),
"""
LAST_METRIC = "lambda sums: sums.later_errors * (1 / (sums.samples // 2 + 1)),\n        ),\n"
KIND = '    ("still-life", "still_life", "fruit"),\n'
LAST_KIND = '"what the law has learned of the robot"),\n'
STILL_LIFE = """
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.drawing import layout

PICTURE = RunPicture(
    lambda runs, iterations, look: layout.panel_figure(
        "fruit", lambda axes: axes.plot([0, 1]), 3.0, 2.0, look=look
    )
)
"""


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A folder with a copy of the package and the files that come with it."""
    package = Path(hilc_cli.__file__).parent
    for folder in (package, package.parent / "scenarios", package.parent / "trajectories"):
        shutil.copytree(
            folder, tmp_path / folder.name, ignore=shutil.ignore_patterns("__pycache__")
        )
    return tmp_path


def insert(file: Path, behind: str, text: str) -> None:
    """Puts a text behind one that stands in a file once."""
    content = file.read_text(encoding="utf-8")
    assert content.count(behind) == 1
    file.write_text(content.replace(behind, behind + text.removeprefix("\n")), encoding="utf-8")


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs the copy in a folder."""
    command = [sys.executable, "-m", "hilc_cli", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def hilc(folder: Path, *arguments: str) -> str:
    """What the copy in a folder prints."""
    done = run(folder, *arguments)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return done.stdout


def problem(folder: Path, *arguments: str) -> str:
    """What the copy in a folder says of wrong input."""
    done = run(folder, *arguments)
    assert (done.returncode, done.stdout) == (2, ""), done.stderr
    return done.stderr


@pytest.mark.slow
def test_a_new_metric_is_one_entry(copy: Path) -> None:
    insert(copy / "hilc_cli/results/metrics.py", LAST_METRIC, METRIC)
    name = "median_position_error_m"
    bound = f"{name}:le:1000 m"
    hilc(copy, "run", "example:fig3-circle", "--set", "iterations=1", "-q", "--require", bound)
    table = copy / "runs/fig3-circle+iterations=1/iterations.csv"
    assert table.read_text().splitlines()[0].endswith(f",{name}")
    vary = ("--vary", "controller.gains.kp=0.1,0.2", "--metric", name)
    hilc(
        *(copy, "sweep", "example:pid-figure-eight", "--set", "iterations=1", "--out", "s", *vary),
        *("--workers", "1", "-q", "--format", "svg"),
    )
    columns = (copy / "s/cases.csv").read_text().splitlines()[0].split(",")
    assert columns[columns.index(name) + 1] == "iterations_to_tolerance"
    assert (copy / "s/curve.svg").is_file()
    schema = hilc(copy, "schema", "scenario")
    assert name in schema


@pytest.mark.slow
def test_a_new_kind_of_picture_is_a_file_and_an_entry(copy: Path) -> None:
    insert(copy / "hilc_cli/results/picture_kinds.py", LAST_KIND, KIND)
    (copy / "hilc_cli/runs/pictures/still_life.py").write_text(STILL_LIFE, encoding="utf-8")
    assert "learning, still-life; of a sweep" in " ".join(hilc(copy, "plot", "--help").split())
    hilc(copy, "run", "example:fig3-circle", "--set", "iterations=1", "--out", "r", "-q")
    assert (copy / "r/still-life.png").is_file()
    assert hilc(copy, "plot", "r", "--kind", "still-life", "--format", "svg") == (
        "r/still-life.svg\n"
    )
    # The folder knows it for its own, and keeps it where the same run is written again.
    hilc(copy, "run", "example:fig3-circle", "--set", "iterations=1", "--out", "r", "--no-plots")
    assert (copy / "r/still-life.svg").is_file()


PLANT = """
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from hilc_cli.plants.kinematic_plant import KinematicPlant, KinematicSpec
from hilc_cli.yaml_input.quantities import SampleTime


class LaggingSpec(KinematicSpec):
    plant: Literal["lagging"] = Field(default=..., description="plant")
    lag: SampleTime = Field(description="time constant of the motors")
"""


def test_a_new_plant_is_a_file_and_an_entry(copy: Path) -> None:
    (copy / "hilc_cli/plants/lagging.py").write_text(PLANT, encoding="utf-8")
    registry = copy / "hilc_cli/plants/registry.py"
    insert(registry, "OWN = {\n", '    "lagging": "hilc_cli.plants.lagging:LaggingSpec",\n')
    at_once = ("--set", "iterations=1", "--no-plots", "-q")
    robot = "robot={plant: lagging, wheel_radius: 0.2, half_track: 0.5, turn_convention: paper"
    hilc(copy, "run", "example:fig3-circle", *at_once, "--set", f"{robot}, lag: 0.1 s}}")
    told = problem(copy, "check", "example:fig3-circle", "--set", f"{robot}}}")
    assert told.endswith("robot.lag: is missing; give it (time constant of the motors)\n")
    told = problem(copy, "check", "example:fig3-circle", "--set", f"{robot}, lagg: 0.1 s}}")
    assert "did you mean 'lag'?" in told
    assert "time constant of the motors" in hilc(copy, "schema", "scenario")


def test_every_kind_of_picture_has_its_home() -> None:
    assert all(isinstance(kind.load(), RunPicture) for kind in RUN_PICTURES.values())
    assert all(isinstance(kind.load(), SweepPicture) for kind in SWEEP_PICTURES.values())
    assert not set(RUN_PICTURES) & set(SWEEP_PICTURES)


def test_lanes_keep_what_metrics_of_sums_are_made_of() -> None:
    assert len(Sums._fields) == SUM_ROWS + 1
    # By hand: errors 3, 4 at samples 1 and 2 of n = 2, none at sample 0.
    one = [np.array([value]) for value in (16.0, 7, 25, 3, 4, 0.5, 9, 1, 8, 16, 7, 4)]
    found = {
        name: metric.of_sums(Sums(np.array([2]), *one)).item() for name, metric in METRICS.items()
    }
    assert found == pytest.approx(
        {
            "max_position_error_m": 4,
            "mean_position_error_m": 7 / 3,
            "rms_position_error_m": (25 / 3) ** 0.5,
            "final_position_error_m": 4,
            "max_abs_error_x_m": 3,
            "max_abs_error_y_m": 4,
            "max_abs_error_heading_rad": 0.5,
            "max_wheel_speed_rad_s": 9,
            "saturated_samples": 1,
            "input_change_rms_rad_s": 2**0.5,
            "max_position_error_second_half_m": 4,
            "mean_position_error_second_half_m": 3.5,
        },
        rel=1e-15,
    )
