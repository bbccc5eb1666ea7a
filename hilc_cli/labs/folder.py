"""The folder of a lab: written as a whole or not at all, and read back with care."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hilc_cli.files import is_there
from hilc_cli.labs.state import LabState
from hilc_cli.labs.trials import FILES, LabTrial, read_trial, trial_folder, write_trial
from hilc_cli.results.folder import DRAWN_WITH, INITIAL_INPUT, SCENARIO, origin
from hilc_cli.results.learning import LEARNING, write_learning
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.reading import Count, Document, damaged
from hilc_cli.results.tables import write_input, write_iterations, write_plan, write_samples
from hilc_cli.runs.run_folder import (
    ITERATIONS,
    LAB_FOLDER,
    LAB_NEXT,
    LAB_TRIALS,
    PLAN,
    SAMPLES,
    robot_to_data,
)
from hilc_cli.scenario.loading import load_scenario


class _Manifest(Document):
    """What is read of the manifest of a lab."""

    kind: str
    trials: Count


def read_state(folder: Path, *, trust: bool = False) -> LabState:
    """Reads what a lab knows; it may come from anybody.

    Args:
        folder: The lab's.
        trust: Whether classes that its scenario names may be imported.

    Raises:
        HilcError: It is no lab, it is damaged, or its scenario is not valid.
    """
    manifest = LAB_FOLDER.read(folder, _Manifest)
    scenario = load_scenario(folder / SCENARIO, trust=trust)
    reference, lead_in = scenario.spec.reference, scenario.lead_in
    if is_there(trial_folder(folder, manifest.trials)):
        raise damaged(folder / LAB_FOLDER.manifest, "trials: there are more of them")
    trials = [
        read_trial(trial_folder(folder, number), reference, lead_in)
        for number in range(manifest.trials)
    ]
    return LabState(scenario, tuple(trials))


def write_state(
    folder: Path,
    state: LabState,
    check: Callable[[Path], None],
    *,
    new: tuple[LabTrial, str] | None = None,
    plots: bool = False,
    look: Look = USUAL,
    command: Sequence[str] = (),
) -> None:
    """Puts a state of a lab in the place of what stands in its folder.

    Args:
        folder: The lab's; trials that it has already are taken over as they are.
        state: What is to stand there.
        check: Raises ExistingResultsError if what stands there may not be replaced.
        new: The last trial and the table of its log, if that is not there yet.
        plots: Whether to draw pictures.
        look: How they are to look.
        command: Command line to note in the manifest.

    Raises:
        ExistingResultsError: What stands there may not be replaced.
        FileAccessError: It cannot be written. In either case it is as it was.
    """
    started = datetime.now(UTC)
    scenario, data = state.scenario, state.run
    sample_time = data.reference.sample_time

    def fill(into: Path) -> None:
        (into / SCENARIO).write_text(scenario.resolved_yaml(), encoding="utf-8")
        if scenario.initial_input is not None:
            write_input(into / INITIAL_INPUT, sample_time, *scenario.initial_input)
        (into / LAB_TRIALS).mkdir()
        for number in range(len(state.trials) - (new is not None)):
            _copy_trial(trial_folder(folder, number), trial_folder(into, number))
        if new is not None:
            place = trial_folder(into, len(state.trials) - 1)
            place.mkdir()
            write_trial(place, *new, sample_time)
        (into / LAB_NEXT).mkdir()
        assert data.plan is not None
        stops = scenario.spec.safety_limits.stop_at_end
        write_plan(into / LAB_NEXT / PLAN, sample_time, data.plan, stops=stops)
        if not state.trials:
            return
        write_iterations(into / ITERATIONS, data.metrics)
        write_samples(into / SAMPLES, data.reference, data.trials.values())
        if data.learning.names:
            write_learning(into / LEARNING, data.learning)
        if plots:
            from hilc_cli.runs.pictures.catalogue import save_figures  # starts slowly

            save_figures([data], into, look=look)

    LAB_FOLDER.write(folder, fill, lambda: _manifest(state, started, command), check)


def _manifest(state: LabState, started: datetime, command: Sequence[str]) -> Mapping[str, Any]:
    data = state.run
    assert data.robot is not None
    return {
        "name": data.name,
        "trajectory": data.reference.name,
        "trials": len(state.trials),
        "speed_limit_rad_s": data.speed_limit,
        "settings": dict(data.settings),
        "yardsticks": {name: dict(values) for name, values in data.yardsticks.items()},
        "gravity_center_m": list(data.gravity_center),
        "robot": robot_to_data(data.robot),
        "diverged_at": None,
        "warnings": list(data.warnings),
        **origin(started, DRAWN_WITH, state.scenario.plug_ins),
        "command": list(command),
    }


def _copy_trial(old: Path, new: Path) -> None:
    """Copies the files of a trial, which have been read and are regular ones."""
    new.mkdir()
    for name in FILES:
        shutil.copyfile(old / name, new / name)
