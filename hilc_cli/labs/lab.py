"""Learning on a real robot, one log at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.labs.driving import Drive
from hilc_cli.labs.folder import read_state, write_state
from hilc_cli.labs.lock import locked
from hilc_cli.labs.logged import log_of_arrays, logged_trial
from hilc_cli.labs.state import LabState
from hilc_cli.labs.trials import LabTrial
from hilc_cli.laws.law import Plan
from hilc_cli.logs.log import RefusedTrialError
from hilc_cli.logs.options import ReadOptions
from hilc_cli.logs.reading import read_log
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.runs.run_folder import LAB_FOLDER, LAB_NEXT, PLAN
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import Overrides, ScenarioSource, load_scenario
from hilc_cli.theory.feasibility.feasibility import beyond_wheels
from hilc_cli.wording import counted, in_short

if TYPE_CHECKING:
    from pandas import DataFrame

_FIRST_INPUT = "initial_input"


class Lab(InNotebooks):
    """Learning on a real robot: `plan` is to be driven, `add` takes in what came of it.

    Attributes:
        folder: Where it is kept; what is there changes as a whole or not at all.
    """

    def __init__(self, folder: str | Path, *, trust: bool = False) -> None:
        """Reads a lab, which may come from anybody.

        Args:
            folder: The lab's.
            trust: Whether classes that its scenario names may be imported.

        Raises:
            HilcError: It is no lab, it is damaged, or its scenario is not valid.
        """
        self.folder = Path(folder)
        self._seen = LAB_FOLDER.look(self.folder)
        self._state = read_state(self.folder, trust=trust)
        check_limited(self.scenario)

    def __repr__(self) -> str:
        trials = counted(len(self.trials), "trial")
        return in_short(f"Lab {str(self.folder)!r}: {self.scenario.name}, {trials}")

    @classmethod
    def start(
        cls,
        scenario: ScenarioSource,
        folder: str | Path,
        overrides: Overrides = (),
        *,
        trust: bool = False,
        command: Sequence[str] = (),
    ) -> Self:
        """Begins a lab: its folder holds the first plan.

        The first input is the reference's own, of the believed robot, unless the scenario or an
        override says which.

        Args:
            scenario: From `load_scenario`, or what it takes.
            folder: The lab's folder, which must not be there yet, or be empty.
            overrides: As for `load_scenario`; not of a scenario that has been read.
            trust: As for `load_scenario`.
            command: Command line to note in the manifest.

        Raises:
            InvalidInputError: The scenario is not valid.
            UsageError: Nothing limits the speed of the wheels, or overrides are given of a
                scenario that has been read.
            ExistingResultsError: Something stands in the folder.
            FileAccessError: It cannot be written.
        """
        scenario = load_scenario(scenario, overrides, trust=trust)
        check_limited(scenario)
        path = Path(folder)
        _check_free(path)
        write_state(path, LabState(_with_first_input(scenario)), _check_free, command=command)
        return cls(path, trust=trust)

    @property
    def state(self) -> LabState:
        """All that is known: the scenario, the trials, and what follows from them."""
        return self._state

    @property
    def scenario(self) -> Scenario:
        """What is to be learned, and how."""
        return self._state.scenario

    @property
    def trials(self) -> tuple[LabTrial, ...]:
        """All that were added, in order."""
        return self._state.trials

    @property
    def plan(self) -> Plan:
        """What to send next, within all limits: what `plan_file` holds, feedback is left out."""
        return self._state.plan.shortest

    @property
    def plan_file(self) -> Path:
        """Where the next plan is, for whoever drives the robot."""
        return self.folder / LAB_NEXT / PLAN

    @property
    def run(self) -> RunData:
        """All trials as the iterations of a run."""
        return self._state.run

    def to_pandas(self, table: str = "iterations") -> DataFrame:
        """As `LabState.to_pandas`."""
        return self._state.to_pandas(table)

    def add_log(
        self,
        log: str | Path,
        options: ReadOptions | None = None,
        *,
        start_time: float | None = None,
        dry_run: bool = False,
        plots: bool = False,
        look: Look = USUAL,
        command: Sequence[str] = (),
    ) -> LabState:
        """Takes a log in as the next trial, learns from it, and writes the next plan.

        Args:
            log: A CSV or TUM file, or the folder of a ROS 2 bag.
            options: How it is to be read.
            start_time: When sample 0 was sent, in the log's clock [s]; None: that is found.
            dry_run: Change nothing.
            plots: Whether to draw pictures.
            look: How they are to look.
            command: Command line to note in the manifest.

        Returns:
            What the lab knows with the trial.

        Raises:
            RefusedTrialError: The log is no trial of the plan; the lab is as it was.
            HilcError: The log or the lab cannot be read or written.
        """
        read = read_log(Path(log), options)
        new = logged_trial(read, self._state, start_time=start_time)
        self._check_is_new(new[0], str(log))
        if dry_run:
            return self._state.after(new[0])
        return self.take_in(new, plots=plots, look=look, command=command)

    def add(
        self,
        poses: Floats,
        times: Floats,
        *,
        sent: Floats | None = None,
        sent_times: Floats | None = None,
        start_time: float | None = None,
        plots: bool = False,
    ) -> None:
        """Takes measured poses in as the next trial, as `add_log` does those of a log.

        Args:
            poses: x [m], y [m] and, unless it was not measured, heading [rad] of the wheel
                midpoint, shape (m, 3) or (m, 2).
            times: When they were measured, in any clock [s], shape (m,).
            sent: Wheel speeds that were sent [rad/s], shape (c, 2); None: those of the plan.
            sent_times: When they were sent, in the clock of the poses [s], shape (c,).
            start_time: When sample 0 was sent, in that clock [s]; None: that is found.
            plots: Whether to draw pictures.

        Raises:
            RefusedTrialError: They are no trial of the plan; the lab is as it was.
            UsageError: The arrays do not fit.
            HilcError: The lab cannot be written.
        """
        log = log_of_arrays(poses, times, sent, sent_times)
        new = logged_trial(log, self._state, start_time=start_time)
        self._check_is_new(new[0], "this trial")
        self.take_in(new, plots=plots)

    def drive(self) -> Drive:
        """Returns the controller of the next trial, feedback included, to be driven line by line.

        What came of it is taken in by `add_driven`.
        """
        learning = self._state.learning
        limits = self.scenario.spec.safety_limits
        return Drive(learning.plan(), learning.reference, limits)

    def add_driven(
        self,
        drive: Drive,
        *,
        plots: bool = False,
        look: Look = USUAL,
        command: Sequence[str] = (),
    ) -> LabState:
        """Takes in a pass that `drive` was driven by.

        Raises:
            RefusedTrialError: It did not come to its end, or is no trial of the plan; the lab is
                as it was.
            HilcError: The lab cannot be written.
        """
        if not drive.is_whole:
            why = drive.stopped or "the input ended"
            raise RefusedTrialError(
                f"{self.folder}: the pass was over after {drive.progress}: {why}; nothing is added"
            )
        times, poses, sent = drive.log
        log = log_of_arrays(poses, times, sent, times)
        lead_in = self._state.learning.lead_in * self.scenario.spec.trajectory.sample_time
        new = logged_trial(
            log,
            self._state,
            start_time=drive.start_time + lead_in,
            replayed=self._state.plan.feedback is None,
        )
        return self.take_in(new, plots=plots, look=look, command=command)

    def take_in(
        self,
        new: tuple[LabTrial, str],
        *,
        plots: bool = False,
        look: Look = USUAL,
        command: Sequence[str] = (),
    ) -> LabState:
        """Takes in a trial, with the table of its log, and writes the next plan.

        Returns:
            What the lab knows now.

        Raises:
            HilcError: The lab cannot be written; it is as it was.
        """
        state = self._state.after(new[0])
        self._replace(state, new=new, plots=plots, look=look, command=command)
        return state

    def undo(self, *, plots: bool = False, look: Look = USUAL, command: Sequence[str] = ()) -> None:
        """Drops the last trial: the lab is as it was before that was added.

        Raises:
            UsageError: There is none.
            HilcError: The lab cannot be written; it is as it was.
        """
        if not self.trials:
            raise UsageError(f"{self.folder}: has no trial that could be dropped")
        self._replace(self._state.without_last, plots=plots, look=look, command=command)

    def _check_is_new(self, trial: LabTrial, what: str) -> None:
        for number, each in enumerate(self.trials):
            if each.report.log_sha256 == trial.report.log_sha256:
                raise UsageError(
                    f"{what}: is trial {number} of {self.folder} already; give the log of the "
                    "plan that was driven last"
                )

    def _replace(self, state: LabState, **how: Any) -> None:
        """Puts another state in the place of this one, if this one is still there."""

        def check(folder: Path) -> None:
            if LAB_FOLDER.look(folder) != self._seen:
                raise ExistingResultsError(
                    f"{folder}: has changed since it was read, and is left as it is now; look at "
                    "'hilc learn status', then try again"
                )

        # Whatever cannot be learned fails before anything is written.
        _ = state.run
        with locked(self.folder):
            write_state(self.folder, state, check, **how)
            self._seen = LAB_FOLDER.look(self.folder)
        self._state = state


def warnings_before(scenario: Scenario) -> list[str]:
    """Says what is probably not meant, before a robot has driven."""
    found = [*scenario.warnings(), *beyond_wheels(scenario.feasibility())]
    if not scenario.spec.controller.learns:
        found.append(
            f"law {scenario.spec.controller.law} does not learn: each plan is the same; its "
            "feedback answers under 'hilc drive'"
        )
    return found


def check_limited(scenario: Scenario) -> None:
    """Makes sure that wheels are never told to turn faster than somebody has allowed.

    Raises:
        UsageError: Nothing limits their speed.
    """
    if math.isinf(scenario.spec.safety_limits.wheel_speed):
        raise UsageError(
            f"{scenario.name}: nothing limits the speed of the wheels, and no plan goes to a robot "
            "without; set safety.wheel_speed [rad/s], the top speed over the wheel radius"
        )


def _check_free(folder: Path) -> None:
    """Makes sure that nothing stands where a new lab is to be.

    Raises:
        ExistingResultsError: Something does.
    """
    if LAB_FOLDER.is_at(folder):
        raise ExistingResultsError(
            f"{folder}: is a lab already, whose trials are not to be lost; choose another folder "
            "with --out, or remove it"
        )
    LAB_FOLDER.check(folder, lambda there: False)


def _with_first_input(scenario: Scenario) -> Scenario:
    """The scenario, with the reference's own input as the first one if it does not say which."""
    spec = scenario.spec
    if _FIRST_INPUT in spec.model_fields_set:
        return scenario
    return replace(scenario, spec=spec.model_copy(update={_FIRST_INPUT: "feedforward"}))
