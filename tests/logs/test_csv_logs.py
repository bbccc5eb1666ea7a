"""Tables as people have them, and what is done to them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.logs.log import Log, Twists, WheelSpeeds
from hilc_cli.logs.log_columns import parse_columns
from hilc_cli.logs.options import ReadOptions
from hilc_cli.logs.reading import read_log

K = np.arange(20)
WANTED = {"times": 5 + K / 10, "x": K / 100, "y": -K / 50, "heading": 0.3 * K}


def read(folder: Path, text: str, **options: object) -> Log:
    path = folder / "log.csv"
    path.write_text(text)
    return read_log(path, ReadOptions(**options))  # type: ignore[arg-type]


def rows(form: str) -> str:
    """A line for each row, with t, x, y, wrapped heading, z and w of the quaternion, and k."""
    lines = []
    for k, t, x, y, h in zip(K, *WANTED.values(), strict=True):
        wrapped = math.remainder(h, math.tau)
        z, w = math.sin(h / 2), math.cos(h / 2)
        lines.append(form.format(t=t, x=x, y=y, h=wrapped, d=math.degrees(wrapped), z=z, w=w, k=k))
    return "\n".join(lines) + "\n"


KINDS = {
    "own": "t_s,x_m,y_m,heading_rad\n" + rows("{t},{x},{y},{h}"),
    "semicolons": "time;x;y;yaw\n" + rows("{t};{x};{y};{h}"),
    "spaces": "stamp x y theta\n" + rows("  {t}  {x}\t{y} {h}"),
    "comment": "# t x y heading\n" + rows("{t} {x} {y} {h}"),
    "windows": "\ufeffT_S,X_M,Y_M,Heading\r\n" + rows("{t},{x},{y},{h}").replace("\n", "\r\n"),
    "brackets": '"t [s]","x [m]","y [m]","heading [rad]"\n' + rows("{t},{x},{y},{h}"),
    "other columns": "id,y_m,x_m,quality,t,yaw_rad\n" + rows("{k},{y},{x},good,{t},{h}"),
    "trailing comma": "t,x,y,yaw,\n" + rows("{t},{x},{y},{h},"),
    "quaternion": "t,x,y,qx,qy,qz,qw\n" + rows("{t},{x},{y},0,0,{z},{w}"),
    "ros": "%time,pose.position.x,pose.position.y,pose.orientation.x,pose.orientation.y,"
    "pose.orientation.z,pose.orientation.w\n" + rows("{t}e9,{x},{y},0,0,{z},{w}"),
    "tum": rows("{t} {x} {y} 0 0 0 {z} {w}"),
    "tum with a comment": "# timestamp tx ty tz qx qy qz qw\n" + rows("{t} {x} {y} 0 0 0 {z} {w}"),
    "milliseconds": "t_ms,x_mm,y_cm,heading_deg\n" + rows("{t}e3,{x}e3,{y}e2,{d}"),
    "later iteration": "iteration,t_s,x_m,y_m,heading_rad\n"
    + rows("0,{t},9,9,9") + rows("1,{t},{x},{y},{h}"),
    "gaps": "t_s,x_m,y_m,heading_rad,note\n7,,,,begin\n" + rows("{t},{x},{y},{h},") + "8,,,,end\n",
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_table_tells_the_same(tmp_path: Path, kind: str) -> None:
    poses = read(tmp_path, KINDS[kind]).poses
    assert poses.times == pytest.approx(WANTED["times"])
    assert poses.x == pytest.approx(WANTED["x"], abs=1e-12)
    assert poses.y == pytest.approx(WANTED["y"], abs=1e-12)
    assert poses.heading == pytest.approx(WANTED["heading"], abs=1e-9)


def test_columns_are_named(tmp_path: Path) -> None:
    text = "when,east,north,look,a,b\n" + rows("{t},{x},{y},{h},1,2")
    columns = parse_columns("t=when, x=east,y=north,heading=look,left=a,right=b")
    log = read(tmp_path, text, columns=columns)
    assert log.poses.x == pytest.approx(WANTED["x"])
    assert isinstance(log.commands, WheelSpeeds)
    assert log.commands.right == pytest.approx(np.full(20, 2.0))


def test_commands_between_the_poses(tmp_path: Path) -> None:
    text = "t_s,x_m,y_m,left_wheel_rad_s,right_wheel_rad_s\n" + rows("{t},{x},{y},,")
    text += "5.05,,,3,4\n6.05,,,5,6\n"
    log = read(tmp_path, text)
    assert log.poses.heading is None
    assert isinstance(log.commands, WheelSpeeds)
    assert log.commands.times.tolist() == [5.05, 6.05]
    assert log.commands.left.tolist() == [3, 5]
    assert log.one_clock


@pytest.mark.parametrize("names", ["v,omega", "linear.x,angular.z", "speed,yaw_rate"])
def test_twists(tmp_path: Path, names: str) -> None:
    log = read(tmp_path, f"t_s,x_m,y_m,{names}\n" + rows("{t},{x},{y},0.5,-1"))
    assert isinstance(log.commands, Twists)
    assert log.commands.yaw_rate == pytest.approx(np.full(20, -1.0))


def test_revolutions_a_minute_and_measured_speeds(tmp_path: Path) -> None:
    names = "left_rpm,right_rpm,encoder_left,encoder_right"
    log = read(tmp_path, f"t_s,x_m,y_m,{names}\n" + rows("{t},{x},{y},60,30,1,2"))
    assert isinstance(log.commands, WheelSpeeds)
    assert log.commands.left == pytest.approx(np.full(20, 2 * math.pi))
    assert log.wheels is not None
    # A measured speed stands for the time halfway to its neighbours.
    assert log.wheels.times == pytest.approx(4.95 + K / 10)


def test_commands_with_a_clock_of_their_own(tmp_path: Path) -> None:
    names = "command_t_s,left_wheel_rad_s,right_wheel_rad_s"
    log = read(tmp_path, f"t_s,x_m,y_m,{names}\n" + rows("{t},{x},{y},0.{k},1,2"))
    assert not log.one_clock
    assert isinstance(log.commands, WheelSpeeds)
    assert log.commands.times.max() < 1


def test_a_marker_is_moved_to_the_wheel_midpoint(tmp_path: Path) -> None:
    log = read(tmp_path, KINDS["own"], marker=(0.2, -0.1))
    cos, sin = np.cos(WANTED["heading"]), np.sin(WANTED["heading"])
    # The midpoint and 0.2 ahead, 0.1 to the right of it, is where the marker was measured.
    assert log.poses.x + 0.2 * cos + 0.1 * sin == pytest.approx(WANTED["x"], abs=1e-12)
    assert log.poses.y + 0.2 * sin - 0.1 * cos == pytest.approx(WANTED["y"], abs=1e-12)


def test_what_is_out_of_order_or_twice_is_put_right_and_told(tmp_path: Path) -> None:
    lines = rows("{t},{x},{y},{h}").splitlines()
    lines[3], lines[4] = lines[4], lines[3]
    lines.insert(8, lines[7].replace("0.07", "0.09"))
    log = read(tmp_path, "\n".join(["t_s,x_m,y_m,heading_rad", *lines]))
    assert log.poses.times == pytest.approx(WANTED["times"])
    assert log.poses.x[7] == 0.09
    told = " ".join(log.notes)
    assert "1 pose had a time before the one in front of it; sorted by time" in told
    assert "1 pose had the same time as the next; left out" in told


def test_gaps_and_jumps_are_told(tmp_path: Path) -> None:
    lines = [f"{t},{0.1 * t},0,0" for t in np.arange(0, 10, 0.1).tolist() if not 4 < t < 6]
    lines += [f"{t},{3 + 0.1 * t},0,0" for t in np.arange(10, 15, 0.1).tolist()]
    told = " ".join(read(tmp_path, "\n".join(["t,x,y,yaw", *lines])).notes)
    assert "poses come every 0.1 s, but for 1 gap; the longest is 2 s at 4.000 s" in told
    assert "1 jump of position; the first is 3.01 m at 9.900 s" in told


def test_poses_that_jump_away_and_back_are_left_out(tmp_path: Path) -> None:
    times = np.arange(0, 10, 0.1)
    x = 0.05 * times
    x[[20, 50, 51, 52]] += 1.0
    text = "\n".join(["t,x,y,yaw", *(f"{t},{each},0,0" for t, each in zip(times, x, strict=True))])
    log = read(tmp_path, text)
    assert len(log.poses) == 96
    assert np.abs(log.poses.x - 0.05 * log.poses.times).max() < 1e-12
    assert "4 poses jumped away and back, the first at 2.000 s; left out" in log.notes


def test_a_robot_that_starts_at_once_and_turns_back_keeps_its_poses(tmp_path: Path) -> None:
    # At 8 Hz and 0.5 m/s from one reading to the next, standing nine tenths of the time.
    way = np.concatenate([np.zeros(200), np.arange(11), np.arange(10, -1, -1), np.zeros(200)])
    times = np.arange(len(way)) / 8
    lines = [f"{t},{each / 16},0,0" for t, each in zip(times, way, strict=True)]
    log = read(tmp_path, "\n".join(["t,x,y,yaw", *lines]))
    assert len(log.poses) == len(way)
