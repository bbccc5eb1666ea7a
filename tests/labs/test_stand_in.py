"""The stand-in for a robot that the documents drive."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.pages import ROOT


@pytest.mark.parametrize("body", [[], ["--mujoco"]])
def test_it_drives_a_plan_and_writes_what_its_camera_saw(tmp_path: Path, body: list[str]) -> None:
    plan, log = tmp_path / "plan.csv", tmp_path / "log.csv"
    speeds = (
        [0.0] * 5 + np.linspace(0, 3, 50).tolist() + [3.0] * 50 + np.linspace(3, 0, 50).tolist()
    )
    rows = [f"{0.02 * k},{speed},{1.2 * speed}" for k, speed in enumerate(speeds)]
    plan.write_text("\n".join(["t_s,left_wheel_rad_s,right_wheel_rad_s", *rows, f"{0.02 * 155},,"]))
    program = ROOT / "programs/stand_in_robot.py"
    given = ["--wheel-radius", "0.05", "--wheel-separation", "0.2", "--delay", "0.1", *body]
    subprocess.run([sys.executable, str(program), str(plan), str(log), *given], check=True)
    with log.open(newline="") as file:
        seen = np.array([[float(cell) for cell in row.values()] for row in csv.DictReader(file)])
    times, x, y, heading = seen.T
    assert times[0] == 100
    assert np.diff(times) == pytest.approx(1 / 30, abs=2e-3)
    # Both wheels turn by 6 and 7.2 rad, on an arc, and not before the delay is over.
    turn, way = 0.05 * 1.2 / 0.2, 0.05 * 6.6
    near = 0.03 if body else 1e-3
    assert heading[-1] == pytest.approx(turn, rel=near)
    assert np.hypot(x[-1], y[-1]) == pytest.approx(2 * way / turn * np.sin(turn / 2), rel=near)
    assert np.hypot(x, y)[times < 100 + 0.6 + 0.1 + 0.1].max() < 1e-4
