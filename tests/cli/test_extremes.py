"""Scenarios of the largest and smallest valid numbers: results or one line, and no warnings."""

from __future__ import annotations

import random
import warnings

import pytest

from tests.conftest import Hilc, Write


def extreme(seed: int) -> str:
    """A scenario of which every number is near an end of its range, or ordinary."""
    any_of = random.Random(seed).choice

    def coordinate() -> float:
        return any_of((-1e8, 0.0, 0.0, 1e-12, 1.0, 1e8))

    def gain() -> float:
        return any_of((0.0, 1e-30, 0.5, 1.0, 1e6, 1e12))

    def bounds() -> list[float]:
        return [any_of((0.0, 1e-30, 1e-3, 1e6)) for _ in range(3)]

    sample_time = any_of((1e-6, 1e-3, 0.1, 1e4))
    time = f"duration: {any_of((1, 2, 7, 30))}*{sample_time!r}"
    length, sweep = any_of((1e-6, 1.0, 1e8)), any_of((1e-12, 1.0, 7.0, 1e6))
    arc = f"arc: {{radius: {length!r}, turn: left, sweep: {sweep!r}, {time}}}"
    segment = any_of((f"line: {{length: {length!r}, {time}}}", arc))
    law = any_of((
        f"gains: {{l1: {gain()!r}, l2: {gain()!r}, lateral: {any_of((0, 1e-30, 1e9))!r}}}",
        f"gains: {{l1: {gain()!r}, l3: {gain()!r}}}, gain_matrix: unit, compensation: on",
        f"law: pid, gains: {{kp: {gain()!r}, ki: {gain()!r}, kd: {any_of((0, 1e-30, 1e9))!r}}}",
        "law: norm-optimal",
        f"law: feedback, gains: {{k_x: {gain()!r}, k_y: {any_of((1e-30, 8, 1e9))!r}}}",
    ))  # fmt: skip
    radii = [any_of((1e-5, 0.03, 0.2, 1e3)) for _ in range(3)]
    return f"""\
name: extreme
trajectory:
  name: path
  sample_time: {sample_time!r}
  start: {{x: {coordinate()!r}, y: {coordinate()!r}, heading: {any_of((0, 1, -1e6))!r}}}
  segments: [{segment}]
robot: {{wheel_radius: {radii[0]!r}, half_track: {radii[1]!r}, turn_convention: ros}}
model: {{wheel_radius: {radii[2]!r}}}
initial_pose: {{x: {coordinate()!r}, heading: {any_of((0, 1e6))!r}}}
initial_input: {any_of(("zero", "feedforward"))}
iterations: {any_of((0, 1, 9))}
controller: {{{law}, b_w: {any_of(("null", "1e-9", "180", "1e9"))}}}
disturbance: {{state: {{bound: {bounds()}}}, output: {{bound: {bounds()}}}}}
"""


@pytest.mark.parametrize("seed", range(12))
def test_no_valid_number_makes_numpy_warn(hilc: Hilc, write: Write, seed: int) -> None:
    write({"scenario.yaml": extreme(seed)})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for command in (["check"], ["run", "--no-plots"]):
            outcome = hilc(command[0], "scenario.yaml", *command[1:])
            assert outcome.code in (0, 3), outcome.err
            assert all(line.startswith("hilc: ") for line in outcome.err.splitlines())
