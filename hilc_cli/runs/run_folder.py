"""The folder of a run: what is in it, when it may be replaced, and how it is read back."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from hilc_cli.errors import UsageError, printable
from hilc_cli.files import folder_to_read, is_there, read_file, write_folder
from hilc_cli.laws.law import Plan
from hilc_cli.names import name_from
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import PICTURE_FORMATS, check_replaceable, keep_pictures, read_manifest
from hilc_cli.results.learning import read_learning, write_learning
from hilc_cli.results.run import RunData
from hilc_cli.results.tables import (
    read_iterations,
    read_samples,
    read_stored_input,
    write_gravity_center,
    write_input,
    write_iterations,
    write_plan,
    write_samples,
)

SCENARIO = "scenario.yaml"
MANIFEST = "manifest.json"
ITERATIONS = "iterations.csv"
SAMPLES = "samples.csv"
INPUT = "input.csv"
PLAN = "plan.csv"
INITIAL_INPUT = "initial-input.csv"
GRAVITY_CENTER = "gravity-center.csv"
LEARNING = "learning.csv"
TABLES = frozenset(
    {SCENARIO, MANIFEST, ITERATIONS, SAMPLES, INPUT, PLAN, INITIAL_INPUT, GRAVITY_CENTER, LEARNING}
)

PICTURE_KINDS = ("path-change", "final-path", "error", "wheel-speeds", "summary", "learning")
PICTURES = frozenset(f"{kind}.{suffix}" for kind in PICTURE_KINDS for suffix in PICTURE_FORMATS)

KIND = "hilc run"
_MAX_SCENARIO_BYTES = 10_000_000


def write_run_folder(
    path: Path,
    run: RunData,
    scenario_yaml: str,
    manifest: Callable[[], Mapping[str, Any]],
    *,
    plan: Plan | None = None,
    initial_input: tuple[Floats, Floats] | None = None,
    gravity_center: bool = False,
    force: bool = False,
    draw: Callable[[Path], None] | None = None,
) -> None:
    """Writes a run folder as a whole.

    Args:
        path: The folder.
        run: The results.
        scenario_yaml: The resolved scenario.
        manifest: Gives what else is to be known of the run, asked last; the file names are added.
        plan: The plan of the iteration after the last one; None if there is none.
        initial_input: Left and right wheel speeds of the input file that the scenario names.
        gravity_center: Whether to write the path of the gravity centre.
        force: Replace the folder of another run.
        draw: Draws the pictures into the folder that it is given.

    Raises:
        ExistingResultsError: The folder holds another run, or is no run folder.
        FileAccessError: It cannot be written.
    """

    def fill(folder: Path) -> None:
        (folder / SCENARIO).write_text(scenario_yaml, encoding="utf-8")
        write_iterations(folder / ITERATIONS, run.metrics)
        write_samples(folder / SAMPLES, run.reference, run.trials.values())
        write_input(folder / INPUT, run.reference.sample_time, *run.learned_input)
        if plan is not None:
            write_plan(folder / PLAN, run.reference.sample_time, plan)
        if initial_input is not None:
            write_input(folder / INITIAL_INPUT, run.reference.sample_time, *initial_input)
        if run.learning.names:
            write_learning(folder / LEARNING, run.learning)
        if gravity_center:
            paths = {number: run.gravity_center_path(number) for number in run.trials}
            write_gravity_center(folder / GRAVITY_CENTER, run.reference.times, paths)
        if draw is not None:
            draw(folder)
        keep_pictures(path, folder, TABLES - {MANIFEST, PLAN}, PICTURES)
        files = sorted([*(file.name for file in folder.iterdir()), MANIFEST])
        text = json.dumps({"kind": KIND, **manifest(), "files": files}, indent=2)
        (folder / MANIFEST).write_text(text + "\n", encoding="utf-8")

    def may_replace(folder: Path) -> bool:
        check_output_folder(folder, scenario_yaml, initial_input, force=force)
        return True

    write_folder(path, fill, may_replace, keeps=lambda name: not _is_own(name))


def check_output_folder(
    path: Path,
    scenario_yaml: str,
    initial_input: tuple[Floats, Floats] | None = None,
    *,
    force: bool = False,
) -> None:
    """Whether a run may be written to a folder; to be asked before a long simulation.

    Args:
        path: The folder.
        scenario_yaml: The resolved scenario of the run.
        initial_input: Left and right wheel speeds of the input file that the scenario names.
        force: Replace the folder of another run.

    Raises:
        ExistingResultsError: The folder holds another run, or is no run folder.
    """
    check_replaceable(
        path,
        "run",
        "another scenario",
        is_own=lambda: is_run_folder(path),
        is_same=lambda: force or _same_scenario(path, scenario_yaml, initial_input),
    )


def is_run_folder(path: Path) -> bool:
    """Whether a folder has been written by `write_run_folder`."""
    return bool(read_manifest(path / MANIFEST, KIND))


def read_run_folder(path: Path) -> RunData:
    """The results in a run folder, from its tables.

    The manifest adds the names, the speed limit, the noise, the settings and the yardsticks, if it
    is there.

    Raises:
        HilcError: There is no such folder, or a table is missing or damaged.
    """
    if not is_there(path) or not is_there(path / ITERATIONS):
        raise UsageError(f"{path}: is no run folder; give a folder that hilc run has written")
    manifest = read_manifest(path / MANIFEST)
    metrics = read_iterations(path / ITERATIONS)
    own_name = printable(folder_to_read(path).name)
    name, trajectory = (
        name_from(manifest[key], f"{path / MANIFEST}: {key}") if key in manifest else own_name
        for key in ("name", "trajectory")
    )
    reference, trials = read_samples(path / SAMPLES, trajectory)
    if max(trials) >= len(metrics):
        raise UsageError(f"{path / SAMPLES}: is damaged: it has iterations that {ITERATIONS} lacks")
    saturated = metrics["saturated_samples"]
    limit, diverged_at = manifest.get("speed_limit_rad_s"), manifest.get("diverged_at")
    off = manifest.get("readings_off_m")
    ahead, aside = _pair(manifest.get("gravity_center_m"))
    return RunData(
        name=name,
        reference=reference,
        metrics=metrics,
        trials={
            number: replace(trial, saturated_samples=int(saturated[number]))
            for number, trial in trials.items()
        },
        speed_limit=float(limit) if isinstance(limit, int | float) else None,
        gravity_center=(ahead, aside),
        diverged_at=diverged_at if isinstance(diverged_at, int) else None,
        readings_off_m=float(off) if _is_number(off) else 0.0,
        learning=read_learning(path / LEARNING),
        settings=_texts(manifest.get("settings")),
        yardsticks=_numbers(manifest.get("yardsticks")),
        warnings=_lines(manifest.get("warnings")),
    )


def _pair(value: object) -> tuple[float, float]:
    match value:
        case [int() | float() as first, int() | float() as second]:
            return float(first), float(second)
        case _:
            return 0.0, 0.0


def _texts(value: object) -> dict[str, str]:
    if not isinstance(value, dict):
        return {}
    return {key: printable(text) for key, text in value.items() if isinstance(text, str)}


def _lines(value: object) -> tuple[str, ...]:
    if not isinstance(value, list):
        return ()
    return tuple(printable(text) for text in value if isinstance(text, str))


def _numbers(value: object) -> dict[str, dict[str, float]]:
    if not isinstance(value, dict):
        return {}
    return {
        column: {
            printable(name): float(number) for name, number in named.items() if _is_number(number)
        }
        for column, named in value.items()
        if isinstance(named, dict)
    }


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and math.isfinite(value)


def _same_scenario(
    path: Path, scenario_yaml: str, initial_input: tuple[Floats, Floats] | None
) -> bool:
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


def _is_own(name: str) -> bool:
    """Whether hilc writes files of that name; anything else in a run folder is somebody's own."""
    return name in TABLES or name in PICTURES
