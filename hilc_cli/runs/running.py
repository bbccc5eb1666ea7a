"""One run: load a scenario, simulate it, keep it, draw it, and say what its author hardly meant."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.engine.loop import MeasuredTrials
from hilc_cli.errors import DivergedError, UsageError
from hilc_cli.files import folder_to_read, merge_folder
from hilc_cli.laws.law import Plan
from hilc_cli.results.folder import DRAWN_WITH, INITIAL_INPUT, SCENARIO, origin
from hilc_cli.results.learning import LEARNING, LearningTable, write_learning
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import MetricsTable
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import Summary, summarise
from hilc_cli.results.tables import (
    write_gravity_center,
    write_input,
    write_iterations,
    write_plan,
    write_samples,
)
from hilc_cli.results.trial import Trial
from hilc_cli.runs.run_folder import (
    GRAVITY_CENTER,
    INPUT,
    ITERATIONS,
    PLAN,
    RUN_FOLDER,
    SAMPLES,
    holds_scenario,
    read_run,
    robot_to_data,
)
from hilc_cli.scenario.experiment import Scenario, settings_of
from hilc_cli.scenario.loading import ScenarioSource, as_scenario, load_scenario
from hilc_cli.scenario.scenario import recorded_iterations
from hilc_cli.scenario.yardsticks import yardsticks_of
from hilc_cli.theory.feasibility.feasibility import beyond_tyres, beyond_wheels
from hilc_cli.theory.noise import seen_in, seen_warnings
from hilc_cli.wording import printable

__all__ = [
    "Run",
    "RunData",
    "RunSource",
    "Scenario",
    "ScenarioSource",
    "Summary",
    "check_folder",
    "load_scenario",
    "plot",
    "read_run",
    "run",
    "warnings_before",
]


OnIteration = Callable[[int], None]
"""Told the number of each completed iteration."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Run(RunData):
    """The results of a scenario, and how they came to be.

    Attributes:
        scenario: What was run.
        started: When, in UTC.
        timings: Seconds that each step took.
    """

    scenario: Scenario = field(kw_only=True)
    started: datetime = field(kw_only=True)
    timings: dict[str, float] = field(kw_only=True)

    def summary(self) -> Summary:
        """The few figures that tell how the run went."""
        return summarise(self)

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        plots: bool = True,
        look: Look = USUAL,
        command: Sequence[str] = (),
    ) -> dict[str, float]:
        """Writes the run folder: tables, resolved scenario, manifest and pictures.

        Args:
            folder: The very folder that is written; it is there as a whole or not at all.
            force: Replace the folder of another scenario's run.
            formats: Of the pictures: png, svg, pdf.
            plots: Whether to draw pictures.
            look: How they are to look, from `picture_look`.
            command: Command line to note in the manifest.

        Returns:
            Seconds that tables and pictures took.

        Raises:
            ExistingResultsError: The folder holds another scenario's run, or is no run folder.
            FileAccessError: It cannot be written.
            UsageError: There is no such picture format.
        """
        timings: dict[str, float] = {}
        clock = time.perf_counter()
        scenario, sample_time = self.scenario, self.reference.sample_time
        text = scenario.resolved_yaml()

        def fill(into: Path) -> None:
            (into / SCENARIO).write_text(text, encoding="utf-8")
            write_iterations(into / ITERATIONS, self.metrics)
            write_samples(into / SAMPLES, self.reference, self.trials.values())
            write_input(into / INPUT, sample_time, *self.learned_input)
            if self.plan is not None:
                write_plan(into / PLAN, sample_time, self.plan)
            if scenario.initial_input is not None:
                write_input(into / INITIAL_INPUT, sample_time, *scenario.initial_input)
            if self.learning.names:
                write_learning(into / LEARNING, self.learning)
            if scenario.spec.record.gravity_center:
                paths = {number: self.gravity_center_path(number) for number in self.trials}
                write_gravity_center(into / GRAVITY_CENTER, self.reference.times, paths)
            if plots:
                from hilc_cli.runs.pictures.catalogue import save_figures  # starts slowly

                start = time.perf_counter()
                save_figures([self], into, formats=formats, look=look)
                timings["pictures"] = time.perf_counter() - start

        def manifest() -> Mapping[str, Any]:
            timings["tables"] = time.perf_counter() - clock - timings.get("pictures", 0.0)
            return self._manifest(command, timings)

        RUN_FOLDER.write(
            Path(folder), fill, manifest, lambda there: _check(there, scenario, text, force=force)
        )
        return timings

    def _manifest(self, command: Sequence[str], writing: Mapping[str, float]) -> Mapping[str, Any]:
        spec = self.scenario.spec
        return {
            "name": self.name,
            "trajectory": self.reference.name,
            "iterations": len(self.metrics) - 1,
            "compensation": self.scenario.compensates,
            "speed_limit_rad_s": self.speed_limit,
            "settings": dict(self.settings),
            "readings_off_m": self.readings_off_m,
            "yardsticks": {name: dict(values) for name, values in self.yardsticks.items()},
            "gravity_center_m": list(self.gravity_center),
            "robot": None if self.robot is None else robot_to_data(self.robot),
            "diverged_at": self.diverged_at,
            "warnings": list(self.warnings),
            "seed": spec.disturbance.seed,
            **origin(self.started, (*DRAWN_WITH, *spec.robot.libraries), self.scenario.plug_ins),
            "command": list(command),
            "timings_s": {**self.timings, **writing},
            "inputs_sha256": dict(self.scenario.checksums),
        }


def run(scenario: ScenarioSource, *, on_iteration: OnIteration | None = None) -> Run:
    """Simulates a scenario.

    A simulation that diverges ends early: the result then holds the iterations before, and
    says so in ``diverged_at``.

    Args:
        scenario: From `load_scenario`, or what it takes: ``example:NAME``, a file, a dictionary.
        on_iteration: Told of each completed iteration.

    Raises:
        InvalidInputError: The scenario is not valid.
        DivergedError: Not even the first iteration stayed within the finite numbers.
    """
    scenario = as_scenario(scenario)
    started, clock = datetime.now(UTC), time.perf_counter()
    experiment = scenario.experiment()
    learner = Learning(experiment)
    kept = recorded_iterations(scenario.spec.record.iterations, experiment.iterations)
    metrics, learning = MetricsTable(), LearningTable()
    trials: dict[int, Trial] = {}
    measured = MeasuredTrials(experiment, learner)
    for trial, row in measured:
        metrics.append(row)
        learning.append(trial.figures)
        if trial.iteration in kept:
            trials[trial.iteration] = trial
        if on_iteration is not None:
            on_iteration(trial.iteration)
    if measured.last is None:
        raise DivergedError(0)
    trials[measured.last.iteration] = measured.last  # however far it came
    result = Run(
        name=scenario.name,
        reference=experiment.reference,
        metrics=metrics,
        trials=trials,
        speed_limit=scenario.speed_limit,
        gravity_center=experiment.robot.gravity_center,
        diverged_at=measured.diverged_at,
        readings_off_m=max(experiment.disturbance.output.bound[:2]),
        learning=learning,
        settings=settings_of(scenario),
        yardsticks=yardsticks_of(scenario),
        robot=experiment.robot,
        scenario=scenario,
        started=started,
        plan=_sendable(learner.plan(), scenario) if measured.diverged_at is None else None,
        timings={"simulation": time.perf_counter() - clock},
    )
    warnings = (*warnings_before(scenario), *warnings_after(result, scenario, experiment))
    return replace(result, warnings=warnings)


def _sendable(plan: Plan, scenario: Scenario) -> Plan | None:
    """Returns the plan within the limits of every plan; None if it cannot be sent to anybody."""
    if not np.isfinite([*plan.left, *plan.right, *plan.poses.ravel()]).all():
        return None
    limits = scenario.spec.safety_limits
    return limits.applied(plan, scenario.spec.trajectory.sample_time)


RunSource = RunData | str | Path
"""A run, or its folder."""


def as_run(source: RunSource) -> RunData:
    """The run itself, or the one that is read from a folder.

    Raises:
        HilcError: It is no run, the folder is no run folder, or damaged.
    """
    if isinstance(source, RunData):
        return source
    if not isinstance(source, str | Path):
        raise UsageError(
            "a run is what run or read_run has returned, or the folder of one; "
            f"got {type(source).__name__}"
        )
    return read_run(source)


def as_runs(runs: RunSource | Sequence[RunSource]) -> list[RunData]:
    """One or several runs, those read that are folders.

    Runs that are called alike take the names of their folders, if those differ.

    Raises:
        HilcError: A folder is no run folder, or damaged.
    """
    alone = isinstance(runs, RunData | str | Path) or not isinstance(runs, Iterable)
    sources: list[RunSource] = [runs] if alone else list(runs)  # type: ignore[list-item, arg-type]
    found = [as_run(each) for each in sources]
    if len({run.name for run in found}) == len(found) or any(
        isinstance(each, RunData) for each in sources
    ):
        return found
    folders = [Path(each) for each in sources if not isinstance(each, RunData)]
    names = [folder_to_read(folder).name for folder in folders]
    if len(set(names)) < len(names) and len(set(map(str, folders))) == len(folders):
        names = [str(folder) for folder in folders]
    return [replace(run, name=printable(name)) for run, name in zip(found, names, strict=True)]


def plot(
    runs: RunSource | Sequence[RunSource],
    folder: str | Path,
    *,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    iterations: Collection[int] | None = None,
    look: Look = USUAL,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws pictures of one run, or of several laid over each other.

    Args:
        runs: One or several, from `run` or `read_run`, or the folders of runs.
        folder: Where to put KIND.FORMAT; made if it is not there.
        kinds: path-change, final-path, error-along-path, error, wheel-speeds, summary, learning;
            all that there are of these runs by default. Of one run, if asked for, animation, which
            is a GIF.
        formats: png, svg, pdf.
        dpi: Resolution of png and gif.
        iterations: Recorded iterations to draw; all by default.
        look: How pictures are to look, from `picture_look`.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such kind, format or recorded iteration, or no such picture of
            these runs.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    from hilc_cli.runs.pictures.catalogue import save_figures  # Matplotlib starts slowly

    if not 1 <= dpi <= 10_000:
        raise UsageError(f"dpi must be from 1 to 10000, got {dpi}")
    drawn_runs = as_runs(runs)

    def draw(into: Path) -> list[Path]:
        return save_figures(drawn_runs, into, kinds, formats, dpi, iterations, look)

    return merge_folder(Path(folder), draw, may_replace)


def check_folder(scenario: ScenarioSource, folder: str | Path, *, force: bool = False) -> None:
    """Whether the results of a scenario may be written to a folder, before it is simulated.

    Raises:
        ExistingResultsError: The folder holds another scenario's run, or is no run folder.
    """
    scenario = as_scenario(scenario)
    _check(Path(folder), scenario, scenario.resolved_yaml(), force=force)


def _check(folder: Path, scenario: Scenario, text: str, *, force: bool) -> None:
    """Does what `check_folder` does, with the resolved scenario as a text."""
    given = scenario.initial_input
    RUN_FOLDER.check(folder, lambda there: holds_scenario(folder, text, given), force=force)


def warnings_before(scenario: ScenarioSource) -> list[str]:
    """Says what is probably not meant, and what no law can do, before anything is simulated."""
    scenario = as_scenario(scenario)
    feasibility = scenario.feasibility()
    return [*scenario.warnings(), *beyond_wheels(feasibility), *beyond_tyres(feasibility)]


def warnings_after(run: RunData, scenario: Scenario, experiment: Experiment) -> list[str]:
    """Says what was probably not meant and only a simulation shows, by its last iteration."""
    figures = run.learning.last() if run.learning.names else {}
    told = scenario.spec.controller.warnings_after(figures)
    return [*seen_warnings(seen_in(run.last, experiment)), *told]
