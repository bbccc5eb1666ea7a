from __future__ import annotations

import re
from pathlib import Path

import pytest

from hilc_cli.scenario.units import unit_of
from hilc_cli.sweeps.pictures.key_axis import (
    key_labels,
    key_labels_in_lines,
    short_names,
    shortened_words,
    value_text,
)
from hilc_cli.variation import Value
from tests.made_up_sweeps import HEADING, L1, LONG_KEY

PAGES = Path(__file__).parents[3] / "docs" / "laws"
ROW = re.compile(r"^\| (`[^|]*`) \| ([^|]+) \| [^|]* \| [^|]* \|$", re.MULTILINE)


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("controller.b_w", "rad/s"),
        ("controller.gains.l1", ""),
        ("controller.gain_heading", ""),
        ("controller.h", "samples"),
        ("robot.wheel_radius", "m"),
        ("initial_pose.heading", "rad"),
        ("trajectory.start.y", "m"),
        ("trajectory.segments.0.arc.sweep", "rad"),
        ("trajectory.segments.0.arc.center.1", "m"),
        ("disturbance.state.bound.1", "m"),
        ("disturbance.state.bound.2", "rad"),
        ("disturbance.state.bound.7", ""),
        ("sweep.seed", ""),
        ("controller.gains.kp", ""),
        ("iterations", ""),
        ("0", ""),
    ],
)
def test_units_of_keys(key: str, unit: str) -> None:
    assert unit_of(key) == unit


def test_labels_are_short_names_with_units() -> None:
    keys = [L1, "robot.wheel_radius", "controller.b_w", "disturbance.output.bound.2"]
    assert list(key_labels(keys).values()) == [
        "l1",
        "wheel_radius [m]",
        "b_w [rad/s]",
        "bound.2 [rad]",
    ]
    twice = ["robot.wheel_radius", "model.wheel_radius"]
    assert list(key_labels(twice).values()) == [f"{key} [m]" for key in twice]
    (label,) = key_labels(["a" * 100 + "_wheel_radius"]).values()
    assert label.startswith("aaa") and label.endswith("_wheel_radius") and len(label) == 32


def test_names_are_as_short_as_they_are_different() -> None:
    assert short_names(["robot.wheel_radius", "model.wheel_radius", "controller.h"]) == {
        "robot.wheel_radius": "robot.wheel_radius",
        "model.wheel_radius": "model.wheel_radius",
        "controller.h": "h",
    }
    assert short_names(["x", "initial_pose.x"]) == {"x": "x", "initial_pose.x": "initial_pose.x"}


def test_units_are_those_of_the_pages_of_the_laws() -> None:
    units = {
        f"controller.{key}": unit
        for page in PAGES.glob("*.md")
        for keys, unit in ROW.findall(page.read_text(encoding="utf-8"))
        for key in re.findall(r"`([a-z_0-9.]+)`", keys)
    }
    assert len(units) >= 19
    for key, unit in units.items():
        assert unit_of(key) == ("" if unit == "-" else unit.replace("^2", "²")), key


WEIGHTS = "controller.weights"


def test_labels_side_by_side_break_at_dots_and_before_units() -> None:
    keys = ["controller.b_w", f"{WEIGHTS}.position", "initial_pose.position", HEADING, L1]
    assert key_labels_in_lines(keys, 19) == {
        "controller.b_w": "b_w [rad/s]",
        f"{WEIGHTS}.position": "weights.\nposition [m]",
        "initial_pose.position": "initial_pose.\nposition [m]",
        HEADING: "gain_heading",
        L1: "l1",
    }
    keys = [f"{WEIGHTS}.heading", "robot.wheel_radius", "model.wheel_radius"]
    assert key_labels_in_lines(keys, 19) == {
        f"{WEIGHTS}.heading": "heading [rad]",
        "robot.wheel_radius": "robot.\nwheel_radius [m]",
        "model.wheel_radius": "model.\nwheel_radius [m]",
    }


def test_lines_are_never_longer_and_labels_differ() -> None:
    keys = [LONG_KEY, "x" * 200, "x", "initial_pose.x", f"y.{'x' * 200}"]
    found = key_labels_in_lines(keys, 18)
    assert list(found) == keys
    for label in found.values():
        assert max(map(len, label.split("\n"))) <= 18
    assert found[LONG_KEY] == "half_track [m]"
    assert (found["x"], found["initial_pose.x"]) == ("x [m]", "initial_pose.x [m]")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "null"),
        (True, "true"),
        (180, "180"),
        (1234567, "1234567"),
        (2**63, "9.223e18"),
        (0.123456, "0.1235"),
        ("measured", "measured"),
        ("w" * 30, "w" * 11 + "…" + "w" * 12),
    ],
)
def test_values(value: Value, text: str) -> None:
    assert value_text(value) == text


def test_words_lose_first_what_they_have_in_common() -> None:
    assert shortened_words(["same-1", "same-2"], 6) == ["same-1", "same-2"]
    assert shortened_words(["same-1", "same-2"], 4) == ["…1", "…2"]
    assert shortened_words(["same-1.csv", "same-12.csv"], 5) == ["…1…", "…12…"]
    assert shortened_words(["aaab", "aab"], 3) == ["…ab", "…b"]
    assert shortened_words(["abcdefgh"], 4) == ["a…gh"]
