"""The folder of a run: what is in it, when it may be replaced, and how it is read back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from hilc_cli.errors import UsageError
from hilc_cli.files import folder_to_read, is_there, read_file
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.learning import LEARNING, read_learning
from hilc_cli.results.picture_kinds import RUN_PICTURES
from hilc_cli.results.reading import Count, Document, Name, Pair, damaged
from hilc_cli.results.run import RunData
from hilc_cli.results.tables import (
    read_iterations,
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
    files=frozenset({PLAN}),
)
_MAX_SCENARIO_BYTES = 10_000_000


class _Manifest(Document):
    """What is read of the manifest of a run."""

    kind: str
    name: Name
    trajectory: Name
    speed_limit_rad_s: Annotated[float, Field(gt=0, le=1e9)] | None
    settings: dict[str, str]
    yardsticks: dict[str, dict[str, float]]
    gravity_center_m: Pair
    diverged_at: Count | None
    readings_off_m: Annotated[float, Field(ge=0)] = 0.0
    warnings: list[str]


def read_run(folder: str | Path) -> RunData:
    """The results in a run folder, from its tables.

    The manifest adds the names, the speed limit, the noise, the settings and the yardsticks, if it
    is there.

    Raises:
        HilcError: There is no such folder, or a file is missing or damaged.
    """
    path = Path(folder)
    if not is_there(path) or not is_there(path / ITERATIONS):
        raise UsageError(f"{path}: is no run folder; give a folder that hilc run has written")
    manifest = RUN_FOLDER.read(path, _Manifest) if is_there(path / MANIFEST) else None
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
    )
    if manifest is None:
        return data
    return replace(
        data,
        name=manifest.name,
        speed_limit=manifest.speed_limit_rad_s,
        gravity_center=manifest.gravity_center_m,
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
    """Whether the run in a folder is one of a resolved scenario.

    Args:
        path: The folder.
        scenario_yaml: The scenario.
        initial_input: Left and right wheel speeds of the input file that it names, if it does.
    """
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
