"""Logs of simulated robots laid over their plans."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.alignment import AlignOptions, align, into_start_frame
from hilc_cli.logs.reading import read_log
from hilc_cli.plants.kinematic import Robot
from tests.logs.made_up_logs import MadeUpRobot, winding_plan, write_csv

ROBOT = Robot(0.1, 0.25, "rep103")
BELIEVED = Motor(0.1, 0.1, -0.25, 0.0, 0.05, 0.0)


def test_a_log_without_commands_begins_where_the_motion_tells(tmp_path: Path) -> None:
    plan = winding_plan()
    wheels = np.stack([plan.left, plan.right], axis=1)
    log = read_log(write_csv(tmp_path / "log.csv", MadeUpRobot().drive(0.02, wheels)))
    trial = align(log, plan, BELIEVED, ROBOT, AlignOptions(lag_is_known=True))
    assert trial.start_time == pytest.approx(1000.0, abs=0.002)
    assert trial.start_time_error < 0.002
    assert trial.first == 0
    assert np.array_equal(trial.left, plan.left)
    assert trial.x == pytest.approx(plan.reference.x, abs=0.05)


def test_a_start_that_is_off_is_taken_back(tmp_path: Path) -> None:
    plan = winding_plan()
    wheels = np.stack([plan.left, plan.right], axis=1)
    robot = MadeUpRobot(lag=0.0, position_noise=1e-5, heading_noise=1e-5)
    seen = robot.drive(0.02, wheels, start=(0.02, -0.03, 0.1))
    log = read_log(write_csv(tmp_path / "log.csv", seen))
    trial = align(log, plan, BELIEVED._replace(lag=0.0), ROBOT, AlignOptions(lag_is_known=True))
    assert trial.start == pytest.approx([0.02, -0.03, 0.1], abs=1e-4)
    own = into_start_frame(trial, plan.reference)
    assert own.x == pytest.approx(plan.reference.x, abs=1e-3)
    assert own.heading == pytest.approx(plan.reference.heading, abs=1e-3)


def test_commands_of_the_log_tell_the_start_and_what_was_sent(tmp_path: Path) -> None:
    plan = winding_plan()
    wheels = np.stack([plan.left, plan.right], axis=1)
    seen = MadeUpRobot(delay=0.12).drive(0.02, wheels)
    sent = np.column_stack([1000.0 + plan.times, wheels])
    log = read_log(write_csv(tmp_path / "log.csv", seen, np.vstack([sent, [1008.0, 0, 0]])))
    trial = align(log, plan, BELIEVED, ROBOT)
    assert trial.start_time == pytest.approx(1000.0, abs=1e-6)
    assert trial.left == pytest.approx(plan.left, abs=1e-6)


@pytest.mark.parametrize(("rate", "sample_time"), [(30.0, 0.02), (100.0, 0.05), (50.0, 0.02)])
def test_samples_have_the_readings_of_their_own_time_and_no_others(
    tmp_path: Path, rate: float, sample_time: float
) -> None:
    plan = winding_plan(sample_time)
    wheels = np.stack([plan.left, plan.right], axis=1)
    seen = MadeUpRobot(rate=rate).drive(sample_time, wheels)
    exact = MadeUpRobot(rate=1000.0, position_noise=0.0, heading_noise=0.0)
    times, *true = exact.drive(sample_time, wheels).T
    log = read_log(write_csv(tmp_path / "log.csv", seen))
    options = AlignOptions(start_time=1000.0, lag_is_known=True)
    trial = align(log, plan, BELIEVED, ROBOT, options)
    at = np.arange(len(trial.x)) * sample_time
    count = (np.abs(seen[:, :1] - 1000 - at) < sample_time / 2).sum(axis=0)
    assert np.array_equal(trial.read, count > 0)
    off = trial.poses - np.stack([np.interp(at + 1000, times, each) for each in true], axis=1)
    # Each is the mean of its own readings, carried over some milliseconds of a known motion.
    white = (off * np.sqrt(count)[:, None])[trial.read] / 2e-3
    assert np.sqrt(np.square(white).mean()) == pytest.approx(1, abs=0.1)
    following = trial.read[1:] & trial.read[:-1]
    both = [(off * np.sqrt(count)[:, None])[rows] for rows in (slice(1, None), slice(None, -1))]
    correlation = (both[0] * both[1])[following].mean() / 2e-3**2
    assert abs(correlation) < 4 / np.sqrt(3 * following.sum())
