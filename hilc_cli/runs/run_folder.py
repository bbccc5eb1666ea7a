"""The folder of a run: what is in it, when it may be replaced, and how it is read back.

A lab, which is a run on a real robot that goes on from log to log, is read back in the same way.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from hilc_cli.errors import UsageError
from hilc_cli.files import folder_to_read, is_there, read_file
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.learning import LEARNING, read_learning
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES
from hilc_cli.results.reading import Count, Document, Name, Pair, damaged
from hilc_cli.results.run import RunData
from hilc_cli.results.tables import (
    read_iterations,
    read_plan,
    read_samples,
    read_stored_input,
)
from hilc_cli.wording import printable

MANIFEST = "manifest.json"
ITERATIONS = "iterations.csv"
SAMPLES = "samples.csv"
INPUT = "input.csv"
PLAN = "plan.csv"
GRAVITY_CENTER = "gravity-center.csv"

RUN_FOLDER = ResultFolder(
    what="run",
    kind="hilc run",
    other="another scenario",
    tables=frozenset(
        {SCENARIO, ITERATIONS, SAMPLES, INPUT, INITIAL_INPUT, GRAVITY_CENTER, LEARNING}
    ),
    pictures=tuple(RUN_PICTURES),
    moving=tuple(MOVING_PICTURES),
    files=frozenset({PLAN}),
)
LAB_TRIALS, LAB_NEXT = "trials", "next"
LAB_FOLDER = ResultFolder(
    what="lab",
    kind="hilc lab",
    other="another scenario, or trials",
    pictures=tuple(RUN_PICTURES),
    moving=tuple(MOVING_PICTURES),
    files=frozenset({SCENARIO, ITERATIONS, SAMPLES, INITIAL_INPUT, LEARNING, LAB_TRIALS, LAB_NEXT}),
)
_MAX_SCENARIO_BYTES = 10_000_000


class _Robot(Document):
    """The true platform, as the manifest of a run has it."""

    wheel_radius_m: Annotated[float, Field(gt=0, le=1e9)]
    half_track_m: Annotated[float, Field(gt=0, le=1e9)]
    turn_convention: Literal["paper", "rep103"]


def robot_to_data(robot: Robot) -> dict[str, Any]:
    """What the manifest of a run says of the true platform, but for its centre of gravity."""
    return {
        "wheel_radius_m": robot.wheel_radius,
        "half_track_m": robot.half_track,
        "turn_convention": robot.turn_convention,
    }


class _Manifest(Document):
    """What is read of the manifest of a run, or of a lab."""

    kind: str
    name: Name
    trajectory: Name
    speed_limit_rad_s: Annotated[float, Field(gt=0, le=1e9)] | None
    settings: dict[str, str]
    yardsticks: dict[str, dict[str, float]]
    gravity_center_m: Pair
    robot: _Robot | None = None
    diverged_at: Count | None
    readings_off_m: Annotated[float, Field(ge=0)] = 0.0
    warnings: list[str]


def read_run(folder: str | Path) -> RunData:
    """The results in a run folder or a lab, from its tables.

    The manifest adds the names, the speed limit, the noise, the settings and the yardsticks, if it
    is there.

    Raises:
        HilcError: There is no such folder, or a file is missing or damaged.
    """
    path = Path(folder)
    kind = LAB_FOLDER if LAB_FOLDER.is_at(path) else RUN_FOLDER
    if not is_there(path) or not is_there(path / ITERATIONS):
        if kind is LAB_FOLDER:
            raise UsageError(f"{path}: has no trial yet; add the first with 'hilc learn add'")
        raise UsageError(f"{path}: is no run folder; give a folder that hilc run has written")
    manifest = kind.read(path, _Manifest) if is_there(path / MANIFEST) else None
    metrics = read_iterations(path / ITERATIONS)
    own_name = printable(folder_to_read(path).name)
    reference, trials = read_samples(
        path / SAMPLES, own_name if manifest is None else manifest.trajectory
    )
    if max(trials) >= len(metrics):
        raise damaged(path / SAMPLES, f"it has iterations that {ITERATIONS} lacks")
    learning = read_learning(path / LEARNING)
    if learning.names and len(learning) != len(metrics):
        raise damaged(path / LEARNING, f"it has {len(learning)} iterations, not {len(metrics)}")
    saturated = metrics["saturated_samples"]
    data = RunData(
        name=own_name,
        reference=reference,
        metrics=metrics,
        trials={
            number: replace(trial, saturated_samples=int(saturated[number]))
            for number, trial in trials.items()
        },
        learning=learning,
        plan=read_plan(path / (f"{LAB_NEXT}/{PLAN}" if kind is LAB_FOLDER else PLAN), reference),
    )
    if manifest is None:
        return data
    robot, center = manifest.robot, manifest.gravity_center_m
    return replace(
        data,
        name=manifest.name,
        speed_limit=manifest.speed_limit_rad_s,
        gravity_center=center,
        robot=None
        if robot is None
        else Robot(robot.wheel_radius_m, robot.half_track_m, robot.turn_convention, center),
        diverged_at=manifest.diverged_at,
        readings_off_m=manifest.readings_off_m,
        settings={key: printable(text) for key, text in manifest.settings.items()},
        yardsticks={
            column: {printable(name): value for name, value in named.items()}
            for column, named in manifest.yardsticks.items()
        },
        warnings=tuple(map(printable, manifest.warnings)),
    )


def holds_scenario(
    path: Path, scenario_yaml: str, initial_input: tuple[Floats, Floats] | None
) -> bool:
    """Whether the run in a folder is one of a resolved scenario and its input, if it has a file."""
    try:
        text = read_file(path / SCENARIO, _MAX_SCENARIO_BYTES).decode("utf-8")
    except (UsageError, UnicodeDecodeError):
        return False
    if text != scenario_yaml:
        return False
    if initial_input is None:
        return True
    try:
        _, *stored = read_stored_input(path / INITIAL_INPUT)
    except UsageError:
        return False
    return all(map(np.array_equal, stored, initial_input))
