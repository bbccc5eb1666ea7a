"""Files with points: the kinds that people have, and everything that is wrong with others."""
# ruff: noqa: E501

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.errors import UsageError
from hilc_cli.reference.waypoints import MOST_POINTS, Waypoints, parse_waypoints

SAMPLES = (
    "iteration,sample,t_s,reference_x_m,reference_y_m,reference_heading_rad,x_m,y_m,heading_rad,"
    "error_x_m,error_y_m,error_heading_rad,left_wheel_rad_s,right_wheel_rad_s\n"
)


def parsed(text: str | bytes) -> Waypoints:
    content = text.encode() if isinstance(text, str) else text
    return parse_waypoints(Path("f.csv"), content)


KINDS: dict[str, tuple[str, dict[str, list[float]]]] = {
    "header": ("x,y\n1,2\n3,4.5\n", {}),
    "spaces": ("1 2\n  3\t4.5 \n", {}),
    "commas": ("1, 2\n3, 4.5\n", {}),
    "semicolons": ("1;2\n3;4.5\n", {}),
    "windows": ("\ufeffX;Y\r\n1;2\r\n3;4.5\r\n\r\n", {}),
    "quoted": ('"x [m]","y [m]"\n1,2\n3,4.5\n', {}),
    "other columns": ("name,y_m,x_m\na,2,1\nb,4.5,3\n", {}),
    "trailing comma": ("x,y\n1,2,\n3,4.5,\n", {}),
    "comments": ("# made by hand\n1,2\n# half way\n3,4.5\n", {}),
    "other comments": ("% made by hand\n// in a hurry\n1,2\n3,4.5\n", {}),
    "quoted numbers": ('"x","y"\n"1","2"\n"3","4.5"\n', {}),
    "northing first": ("northing;easting;elevation\n2;1;412\n4.5;3;412\n", {}),
    "flat": ("1,2,0\n3,4.5,0.0\n", {}),
    "comment with x and y": ("# the points x and y of it\n1,2\n3,4.5\n", {}),
    "track": ("# x_m,y_m,w_tr_right_m,w_tr_left_m\n1,2,1.1,1.2\n3,4.5,1.1,1.2\n", {}),
    "racing line": (
        "# 4ed0\n# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n"
        "0; 1; 2; 0.3; 0; 7; 1\n2; 3; 4.5; 0.4; 0; 8; 1\n",
        {"speeds": [7, 8], "headings": [0.3, 0.4]},
    ),
    "speed": ("1,2,7\n3,4.5,8\n", {"speeds": [7, 8]}),
    "ros": (
        "x,y,theta,v\n1,2,0.3,7\n3,4.5,0.4,8\n",
        {"speeds": [7, 8], "headings": [0.3, 0.4]},
    ),
    "bag": (
        "%time,field.header.seq,field.pose.position.x,field.pose.position.y,field.pose.position.z\n"
        "17000000000,4,1,2,0\n17500000000,5,3,4.5,0\n",
        {"times": [17, 17.5]},
    ),
    "millimetres": ("x_mm,y [mm]\n1000,2000\n3000,4500\n", {}),
    "centimetres": ("X (cm)\tY (cm)\n100\t200\n300\t450\n", {}),
    "inches": (
        "x_in;y_in\n39.37007874015748;78.74015748031496\n118.11023622047244;177.16535433070865\n",
        {},
    ),
    "milliseconds": ("t_ms,x,y\n0,1,2\n500,3,4.5\n", {"times": [0, 0.5]}),
    "milliseconds in brackets": (
        "time [ms]  x [m]  y [m]\n0 1 2\n500 3 4.5\n",
        {"times": [0, 0.5]},
    ),
    "microseconds": ("timestamp_us,x,y\n0,1,2\n500000,3,4.5\n", {"times": [0, 0.5]}),
    "nanoseconds": ("stamp_ns,x,y\n0,1,2\n500000000,3,4.5\n", {"times": [0, 0.5]}),
    "nanoseconds in camels": (
        "timestampNs,posX,posY\n0,1,2\n500000000,3,4.5\n",
        {"times": [0, 0.5]},
    ),
    "seconds and nanoseconds": (
        "sec,nanosec,x,y\n17,900000000,1,2\n18,400000000,3,4.5\n",
        {"times": [17.9, 18.4]},
    ),
    "of a bag": (
        "Time,header.stamp.secs,header.stamp.nsecs,header.frame_id,pose.position.x,pose.position.y\n"
        "17.95,17,900000000,map,1,2\n18.45,18,400000000,map,3,4.5\n",
        {"times": [17.95, 18.45]},
    ),
    "of a topic": (
        "header.stamp.sec,header.stamp.nanosec,pose.pose.position.x,pose.pose.position.y,"
        "pose.pose.orientation.x,pose.pose.orientation.y,twist.twist.linear.x\n"
        "17,900000000,1,2,0,0,-0.1\n18,400000000,3,4.5,0,0,0.1\n",
        {"times": [17.9, 18.4]},
    ),
    "seconds twice": (
        "t_s,t_ns,x,y\n0.5,500000000,1,2\n1.5,1500000000,3,4.5\n",
        {"times": [0.5, 1.5]},
    ),
    "since 1970": (
        "1700000000000000000 1 2 0 0 0 0 1\n1700000000500000256 3 4.5 0 0 0 0 1\n",
        {"times": [1.7e9, 1.7e9 + 0.5], "headings": [0, 0]},
    ),
    "since 1970 in milliseconds": (
        "timestamp;x;y\n1700000000000;1;2\n1700000000500;3;4.5\n",
        {"times": [1.7e9, 1.7e9 + 0.5]},
    ),
    "kilometres per hour": (
        "x,y,v_kmh\n1,2,3.6\n3,4.5,36\n",
        {"speeds": [1, 10]},
    ),
    "kilometres per hour in brackets": (
        "x;y;speed (km/h)\n1;2;3.6\n3;4.5;36\n",
        {"speeds": [1, 10]},
    ),
    "millimetres per second": (
        "x,y,velocity_mm_s\n1,2,1000\n3,4.5,10000\n",
        {"speeds": [1, 10]},
    ),
    "metres per second": ("x,y,v_m_s\n1,2,1\n3,4.5,10\n", {"speeds": [1, 10]}),
    "degrees": ("x,y,yaw_deg\n1,2,90\n3,4.5,-180\n", {"headings": [math.pi / 2, -math.pi]}),
    "degrees by their sign": (
        "x,y,heading [\u00b0]\n1,2,90\n3,4.5,-180\n",
        {"headings": [math.pi / 2, -math.pi]},
    ),
    "said to Excel": ("sep=;\nx;y\n1;2\n3;4.5\n", {}),
    "old lines": ("x,y\r1,2\r3,4.5\r", {}),
    "tabs with gaps": ("name\tx\ty\tnote\n\t1\t2\t\n\t3\t4.5\t\n", {}),
    "units in brackets": ("x (m) y (m) v (km / h)\n1 2 3.6\n3 4.5 36\n", {"speeds": [1, 10]}),
    "units below": ("t;x;y\n[ms];[m];[m]\n0;1;2\n500;3;4.5\n", {"times": [0, 0.5]}),
    "units in a comment below": ("x,y\n# mm, mm\n1000,2000\n3000,4500\n", {}),
    "header twice": ("# x, y\nx,y\n1,2\n3,4.5\n", {}),
    "hours": ("time [h],x,y\n0,1,2\n0.5,3,4.5\n", {"times": [0, 1800]}),
    "parts of a velocity": ("x,y,vx,vy\n1,2,-1,1\n3,4.5,1,-1\n", {}),
    "units in words": (
        "Zeit in ms,Position X in mm,Position Y in mm\n0,1000,2000\n500,3000,4500\n",
        {"times": [0, 0.5]},
    ),
    "units as quotients": (
        "t / ms;x / mm;y / mm\n0;1000;2000\n500;3000;4500\n",
        {"times": [0, 0.5]},
    ),
    "any topic": (
        "__time,/amcl_pose/pose/pose/position/x,/amcl_pose/pose/pose/position/y,/amcl_pose/c[0;1]\n"
        "0,1,2,9\n0.5,3,4.5,9\n",
        {"times": [0, 0.5]},
    ),
    "motion capture": (
        "Frame,Time (Seconds),TX [mm],TY [mm],TZ [mm]\n1,0,1000,2000,5\n2,0.5,3000,4500,5\n",
        {"times": [0, 0.5]},
    ),
    "drone": (
        "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w []\n"
        "500000000,1,2,0,1\n1000000000,3,4.5,0,1\n",
        {"times": [0.5, 1]},
    ),
    "simulator": (
        "location.x,location.y,location.z,rotation.yaw\n1,2,0.1,0.3\n3,4.5,0.1,0.4\n",
        {"headings": [0.3, 0.4]},
    ),
    "index": (",x,y\n0,1,2\n1,3,4.5\n", {}),
    "beside latitudes": ("lat,lon,utm_x,utm_y\n48,11,1,2\n48,11,3,4.5\n", {}),
    "comma in a name": ('"name","x, m","y"\n"a, b",1,2\n"c",3,4.5\n', {}),
    "beside a reference": ("x_ref,y_ref,x,y\n9,9,1,2\n9,9,3,4.5\n", {}),
    "backward beside times": ("t,x,y,v\n0,1,2,-7\n1,3,4.5,-8\n", {"times": [0, 1]}),
    "german": (
        "Zeit [ms];Rechtswert;Hochwert\n0;1;2\n500;3;4.5\n",
        {"times": [0, 0.5]},
    ),
    "many commas at the end": ("x,y,,,\n1,2,,,\n3,4.5,,,\n", {}),
    "log": (
        "t_s,x_m,y_m,heading_rad\n0,1,2,0.3\n0.5,3,4.5,0.4\n",
        {"times": [0, 0.5], "headings": [0.3, 0.4]},
    ),
    "tum": (
        "# timestamp tx ty tz qx qy qz qw (a comment)\n"
        "10.0 1 2 0 0 0 0.6 0.8\n10.5 3 4.5 0 0 0 0 1\n",
        {"times": [10, 10.5], "headings": [2 * math.atan2(0.6, 0.8), 0]},
    ),
    "times rather than speeds": ("t,x,y,v\n0,1,2,7\n1,3,4.5,8\n", {"times": [0, 1]}),
    "samples.csv": (
        SAMPLES
        + "0,0,0.0,9,9,9,8,8,8,0,0,0,1,1\n0,1,0.1,9,9,9,8,8,8,0,0,0,,\n"
        + "7,0,0.0,9,9,9,1,2,0.3,0,0,0,1,1\n7,1,0.1,9,9,9,3,4.5,0.4,0,0,0,,\n",
        {"times": [0, 0.1], "headings": [0.3, 0.4]},
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_points_are_read_from_what_people_have(kind: str) -> None:
    text, others = KINDS[kind]
    found = parsed(text)
    np.testing.assert_allclose(found.points, [[1.0, 2.0], [3.0, 4.5]], rtol=1e-15)
    for name in ("times", "speeds", "headings"):
        values = getattr(found, name)
        if name in others:
            np.testing.assert_allclose(values, np.array(others[name], float), rtol=1e-12)
        else:
            assert values is None
    assert found.iteration == (7 if kind == "samples.csv" else None)


def test_rows_that_say_the_same_are_counted_and_standing_still_is_kept() -> None:
    found = parsed("t,x,y\n0,1,2\n0,1,2\n1,1,2\n2,3,4.5\n2,3,4.5\n")
    assert (found.dropped, found.columns) == (2, ("x", "y", "t_s"))
    np.testing.assert_array_equal(found.times, [0, 1, 2])


def test_every_number_reads_back_exactly() -> None:
    numbers = [[0.1 + 0.2, -1e-300], [5_432_109.123456789, 7.0]]
    text = "".join(f"{x!r},{y!r}\n" for x, y in numbers)
    np.testing.assert_array_equal(parsed(text).points, numbers)


@pytest.mark.parametrize(("heading", "looks_back"), [("0.1", False), ("3.0", True), ("1.6", False)])
def test_headings_against_the_way_are_seen(heading: str, looks_back: bool) -> None:
    assert parsed(f"x,y,yaw\n0,0,{heading}\n1,0,{heading}\n").look_back == looks_back
    assert not parsed("x,y\n0,0\n1,0\n").look_back


def zigzag(count: int, noise: float, seed: int = 3) -> str:
    """A circle of 10 m radius with noise."""
    angles = 2 * np.pi * np.arange(count) / count
    points = 10 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points += noise * np.random.default_rng(seed).standard_normal(points.shape)
    return "".join(f"{x:.5f},{y:.5f}\n" for x, y in points.tolist())


def test_noise_of_points_is_measured_where_it_makes_them_zigzag() -> None:
    assert parsed(zigzag(2_000, 0.02)).noise == pytest.approx(0.02, rel=0.05)
    # In steps of 60 cm as little noise turns the way by less than 0.05 rad, and without any by less.
    assert parsed(zigzag(100, 0.001)).noise is None
    assert parsed(zigzag(2_000, 0.0)).noise is None
    cones = "".join(f"{i},{(-1) ** i}\n" for i in range(9))
    assert parsed(cones).noise is None


COLUMNS = "call them x,y (beside them heading, speed and t_s if they are known)"
PUT = "put a header in front: x,y (beside them heading, speed and t_s if they are known)"
WRONG: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "f.csv: has no points; give at least two lines with x and y"),
    "comments": ("# x,y\n", "f.csv: has no points; give at least two lines with x and y"),
    "header": ("x,y\n", "f.csv: has fewer than two points; give at least two lines with x and y"),
    "one": ("1,2\n", "f.csv: has fewer than two points; give at least two lines with x and y"),
    "latin": (b"1,2\n3,\xe9\n", "f.csv:2: is not UTF-8 text; save it as CSV in UTF-8"),
    "commas": ("1,5;2,5\n3,5;4,5\n", "f.csv:1: has decimal commas; write decimal points"),
    "german": ("x y\n1,5 2,5\n3,5 4,5\n", "f.csv:2: has decimal commas; write decimal points"),
    "names": ("easting;height\n1;2\n", f"f.csv:1: names no columns x and y; {COLUMNS}"),
    "twice": ("x,x_m,y\n1,2,3\n", "f.csv:1: names several columns that may be x; keep one of them"),
    "y twice": ("x,y,y\n1,2,3\n", "f.csv:1: names several columns that may be y; keep one of them"),
    "degrees": (
        "lat,lon\n48.1,11.5\n48.2,11.5\n",
        "f.csv:1: names latitude and longitude; project them to metres first, such as to UTM",
    ),
    "degrees in a comment": (
        "# longitude; latitude\n48.1;11.5\n48.2;11.5\n",
        "f.csv:1: names latitude and longitude; project them to metres first, such as to UTM",
    ),
    "degrees of a receiver": (
        "%time,field.latitude,field.longitude\n1,48.1,11.5\n",
        "f.csv:1: names latitude and longitude; project them to metres first, such as to UTM",
    ),
    "json": (
        "[[0, 0], [1, 1]]\n",
        "f.csv:1: begins with a bracket, as no CSV does; save it as one with the header x,y (beside them heading, speed and t_s if they are known)",
    ),
    "pixels": ("x [px],y [px]\n1,2\n", "f.csv:1: names a unit of x that is not known; give m, cm, mm, km, ft or in"),
    "grads": ("x,y,yaw [gon]\n1,2,3\n", "f.csv:1: names a unit of heading that is not known; give rad or deg"),
    "dates": (
        "time,x,y\n2024-01-01T12:00:00,1,2\n2024-01-01T12:00:01,3,4\n",
        "f.csv:2: holds something that is no number where t_s should stand; give seconds, or take the times out",
    ),
    "nanoseconds from 0": (
        "time,x,y\n0,1,2\n900000000000,3,4\n",
        "f.csv:3: has a time beyond 1e+11 s; give seconds, or tell its unit in the header, such as t_ms",
    ),
    "microseconds from 0": (
        "time,x,y\n0,1,2\n7800000,3,4\n",
        "f.csv:3: has times that are 7.8e+06 s apart; tell their unit in the header, such as t_ms",
    ),
    "cut off": ("t,x,y\n0,1,2\n1,3,4\n2,5,", "f.csv:4: holds something that is no number where y should stand; mend the line, or leave it out"),
    "empty cells": ("x,y\n,\n1,2\n", "f.csv:2: holds something that is no number where x should stand; mend the line, or leave it out"),
    "bars": (
        "1|2\n3|4\n",
        "f.csv:1: is parted neither by commas, semicolons nor white space; save it with commas",
    ),
    "colons below a header": (
        "x,y\n1:2\n3:4\n",
        "f.csv:2: has 1 cells where 2 should stand; mend the line, or leave it out",
    ),
    "one decimal comma": ("x;y\n1;2\n3,5;4\n5;6\n", "f.csv:3: has decimal commas; write decimal points"),
    "headings without a header": (
        "1,2,0.5\n3,4,-0.5\n",
        f"f.csv:1: has a third column with numbers below 0 and no header that tells what they are; {PUT}",
    ),
    "back in time": ("t,x,y\n1,1,2\n2,3,4\n1.5,5,6\n", "f.csv:4: has a time that is not after the one before; sort the lines by time and keep one of each, or take the times out"),
    "words": ("secret words\n", f"f.csv:1: names no columns x and y; {COLUMNS}"),
    "four": (
        "1,2,3,4\n",
        f"f.csv:1: has 4 columns and no header that tells what they are; {PUT}",
    ),
    "clock": (
        "0,1,2\n0.1,3,4\n0.2,5,6\n",
        f"f.csv:1: has 3 columns and no header that tells what they are; {PUT}",
    ),
    "cells": ("x,y\n1,2\n3\n", "f.csv:3: has 1 cells where 2 should stand; mend the line, or leave it out"),
    "more cells": ("1 2\n3 4 5\n", "f.csv:2: has 3 cells where 2 should stand; mend the line, or leave it out"),
    "word": ("x,y\n1,2\n3,secret\n", "f.csv:3: holds something that is no number where y should stand; mend the line, or leave it out"),
    "gap": ("x,y\n1,2\n,3\n", "f.csv:3: holds something that is no number where x should stand; mend the line, or leave it out"),
    "underscore": ("1,2\n1_0,2\n", "f.csv:2: holds something that is no number where x should stand; mend the line, or leave it out"),
    "nan": ("1,2\nnan,2\n", "f.csv:2: has a number that is not finite where x should stand; mend the line, or leave it out"),
    "long": (f"1,2\n{'9' * 5000},2\n", "f.csv:2: has a number that is not finite where x should stand; mend the line, or leave it out"),
    "far": ("1,2\n3,1e9\n", "f.csv:2: has an y beyond 1e+08 m; give metres"),
    "times": ("t,x,y\n0,1,2\n0,3,4\n", "f.csv:3: has a time that is not after the one before; sort the lines by time and keep one of each, or take the times out"),
    "nanoseconds": ("t,x,y\n1,1,2\n17e17,3,4\n", "f.csv:3: has a time beyond 1e+11 s; give seconds, or tell its unit in the header, such as t_ms"),
    "backward": (
        "x,y,v\n1,2,1\n3,4,-1\n",
        "f.csv:3: has a speed that is below 0 or too high; say that it drives backward by 'reverse: true'",
    ),
    "quaternion": (
        "0 1 2 3 4 5 6 7\n1 1 2 3 4 5 6 7\n",
        f"f.csv:1: has no unit quaternion at its end, as the lines of a TUM file have; {PUT}",
    ),
    "line": (
        f"1,2\n3,{' ' * 10_000}secret\n",
        "f.csv:2: has a line of 10009 characters; give a CSV file",
    ),
    "many": (
        "".join(f"{i},0\n" for i in range(MOST_POINTS + 1)),
        "f.csv: has more than 10000 points; take fewer, such as every second one",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_be_read_is_told_with_its_line_and_without_its_content(case: str) -> None:
    text, message = WRONG[case]
    with pytest.raises(UsageError) as caught:
        parsed(text)
    assert str(caught.value) == message
    assert "secret" not in message


@given(st.text("0123456789.,;-+eE xy#\n\t_naif\"'", max_size=60) | st.text(max_size=40))
def test_any_text_is_points_or_one_line_of_error(text: str) -> None:
    try:
        found = parsed(text.encode("utf-8", "replace"))
    except UsageError as error:
        assert str(error).startswith("f.csv:")
        assert "\n" not in str(error)
    else:
        assert np.isfinite(found.points).all() and len(found.points) >= 2
