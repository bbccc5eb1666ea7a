"""Tables of logs as programs write them: units, clocks, quaternions and names of many kinds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.logs.csv_logs import parse_table
from hilc_cli.logs.log import Log, Twists, WheelSpeeds
from hilc_cli.logs.options import ReadOptions

START = 1_700_000_000
K = range(12)


def parsed(header: str, rows: list[str], columns: Mapping[str, str] | None = None) -> Log:
    content = "\n".join([header, *rows, ""]).encode()
    return parse_table(Path("log.csv"), content, "", ReadOptions(columns=columns or {}))


POSES: dict[str, tuple[str, list[str]]] = {
    "units in names": ("t_ms,x_mm,y_cm,yaw_deg", [f"{100 * k},{10 * k},{2 * k},{k}" for k in K]),
    "units in brackets": (
        "Time [ms];X [mm];Y [cm];Yaw [deg]",
        [f"{100 * k};{10 * k};{2 * k};{k}" for k in K],
    ),
    "a row of units": (
        "time\tx\ty\ttheta\nms\tmm\tcm\tdeg",
        [f"{100 * k}\t{10 * k}\t{2 * k}\t{k}" for k in K],
    ),
    "a comment of units": (
        "# time, x, y, theta\n# [ms], [mm], [cm], [deg]",
        [f"{100 * k},{10 * k},{2 * k},{k}" for k in K],
    ),
    "nanoseconds": (
        "stamp_ns,x,y,theta",
        [f"{START * 10**9 + k * 10**8},{k / 100},{k / 50},{math.radians(k)!r}" for k in K],
    ),
    "since 1970 in microseconds": (
        "timestamp,x,y,theta",
        [f"{START * 10**6 + k * 10**5},{k / 100},{k / 50},{math.radians(k)!r}" for k in K],
    ),
    "a clock in two columns": (
        "header.stamp.sec,header.stamp.nanosec,pose.pose.position.x,pose.pose.position.y,yaw",
        [f"{START + k // 10},{k % 10 * 10**8},{k / 100},{k / 50},{math.radians(k)!r}" for k in K],
    ),
    "rostopic": (
        "%time,field.header.stamp,field.pose.position.x,field.pose.position.y,"
        "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,"
        "field.pose.orientation.w",
        [
            f"{START * 10**9 + k * 10**8},{k},{k / 100},{k / 50},0,0,"
            f"{math.sin(math.radians(k) / 2)!r},{math.cos(math.radians(k) / 2)!r}"
            for k in K
        ],
    ),
    "what was wanted beside": (
        "t,x_ref,y_ref,yaw_target,x,y,yaw",
        [f"{k / 10},9,9,9,{k / 100},{k / 50},{math.radians(k)!r}" for k in K],
    ),
}


@pytest.mark.parametrize("case", POSES)
def test_poses_are_in_seconds_metres_and_radians(case: str) -> None:
    poses = parsed(*POSES[case]).poses
    k = np.arange(12)
    # A double counts nanoseconds since 1970 in steps of 256, and seconds of 240 of them.
    assert poses.times - poses.times[0] == pytest.approx(k / 10, abs=1e-6)
    assert poses.times[0] in (0.0, START)
    assert poses.x == pytest.approx(k / 100)
    assert poses.y == pytest.approx(k / 50)
    assert poses.heading == pytest.approx(np.radians(k))


@pytest.mark.parametrize(
    ("names", "given", "told"),
    [
        ("left_wheel_rpm,right_wheel_rpm", (60.0, -30.0), (2 * math.pi, -math.pi)),
        ("cmd_left [deg/s],cmd_right [deg/s]", (180.0, 90.0), (math.pi, math.pi / 2)),
        ("left_rad_s,right_rad_s", (3.0, 4.0), (3.0, 4.0)),
        ("wl (rev/s),wr (rev/s)", (1.0, 2.0), (2 * math.pi, 4 * math.pi)),
    ],
)
def test_wheel_speeds_are_in_radians_a_second(
    names: str, given: tuple[float, float], told: tuple[float, float]
) -> None:
    commands = parsed(f"t,x,y,{names}", [f"{k},{k},0,{given[0]},{given[1]}" for k in K]).commands
    assert isinstance(commands, WheelSpeeds)
    assert commands.left == pytest.approx(np.full(12, told[0]))
    assert commands.right == pytest.approx(np.full(12, told[1]))


def test_twists_are_in_metres_and_radians_a_second() -> None:
    log = parsed("t,x,y,v_kmh,yaw_rate_deg_s", [f"{k},{k},0,3.6,90" for k in K])
    assert isinstance(log.commands, Twists)
    assert log.commands.speed == pytest.approx(np.ones(12))
    assert log.commands.yaw_rate == pytest.approx(np.full(12, math.pi / 2))


def test_a_note_tells_what_was_read_in_which_unit() -> None:
    notes = parsed(*POSES["a row of units"]).notes
    assert "read t from ms, x from mm, y from cm, heading from deg" in notes


def test_the_last_of_several_iterations_is_read() -> None:
    log = parsed("iteration,t,x,y", [f"{i},{k},{k + 100 * i},0" for i in range(3) for k in K])
    assert log.poses.x == pytest.approx(np.arange(12) + 200)
    assert log.notes[0].startswith("12 rows of iteration 2 with the columns")


def test_a_column_that_the_user_names_has_the_unit_of_its_name() -> None:
    rows = [f"{100 * k},{10 * k},{k}" for k in K]
    log = parsed("# clk_ms,a_mm,b", rows, {"t": "clk_ms", "x": "a_mm", "y": "b"})
    assert log.poses.times[1] == pytest.approx(0.1)
    assert log.poses.x[1] == pytest.approx(0.01)
    assert log.poses.y[1] == 1


@pytest.mark.parametrize(
    ("header", "message"),
    [
        (
            "t,x [furlong],y",
            "names a unit of x that is not known; give m, cm, mm, km, ft or in",
        ),
        (
            "t,x,y,left [m/s],right [m/s]",
            "names a unit of left that is not known; give rad/s, deg/s, rpm or rev/s",
        ),
        (
            "t,time,x,y",
            "names several columns that may be t; say which with --columns 't=NAME'",
        ),
    ],
)
def test_what_a_header_does_not_tell_is_asked_for(header: str, message: str) -> None:
    with pytest.raises(UsageError) as caught:
        parsed(header, [",".join(["1"] * (header.count(",") + 1))] * 12)
    assert str(caught.value) == f"log.csv:1: {message}"
