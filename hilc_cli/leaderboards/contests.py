"""The runs of a leaderboard: what becomes of each law in each case, and who computes that."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import MeasuredTrials, prepare_machine_code
from hilc_cli.errors import DivergedError, HilcError
from hilc_cli.leaderboards.plan import Contest
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.metrics import (
    FASTEST_WHEEL,
    MAX_ERROR,
    MAX_ERROR_SECOND_HALF,
    MEAN_ERROR_SECOND_HALF,
    first_within,
    settled_at,
    share_within,
)
from hilc_cli.wording import in_short, listed
from hilc_cli.workers.crews import Alone, Crew, Processes, hand_out

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, slots=True)
class Entry:
    """One law in one case.

    Errors are position errors over the second half of the trajectory, unless something else is
    said. A run that diverges has infinite errors from there on.

    Attributes:
        case: Name of the case.
        belief: Name of what the controller believes.
        disturbance: Name of the disturbance.
        law: Name of the law.
        max_m: Largest error after each number of iterations that is looked at [m].
        mean_m: Mean error, likewise [m].
        whole_max_m: Largest error over the whole path, likewise [m].
        within_at: First iteration whose largest error is within the tolerance; None if none is.
        within_share: Share of the iterations from that one to the last that are; None likewise.
        settled_at: First iteration from which on the largest error keeps the tolerance; None if
            the last does not.
        peak_m: Largest error over the whole path in any iteration but 0, which is mostly the first
            input alone and tells nothing of the law [m]; None if there is no other.
        fastest_wheel_rad_s: Largest wheel speed in any iteration [rad/s].
        speed_limit_rad_s: b_w [rad/s]; None for no limit.
        diverged_at: The iteration that left the finite numbers; None if none did.
        seconds_per_iteration: Processor time of the whole program for an iteration [s].
    """

    case: str
    belief: str
    disturbance: str
    law: str
    max_m: tuple[float, ...]
    mean_m: tuple[float, ...]
    whole_max_m: tuple[float, ...]
    within_at: int | None
    within_share: float | None
    settled_at: int | None
    peak_m: float | None
    fastest_wheel_rad_s: float
    speed_limit_rad_s: float | None
    diverged_at: int | None
    seconds_per_iteration: float

    @property
    def keeps_limit(self) -> bool | None:
        """Whether no wheel was faster than the limit in any sample of any iteration.

        None if there is no limit.
        """
        limit = self.speed_limit_rad_s
        return None if limit is None else self.fastest_wheel_rad_s <= limit


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LeaderboardData(InNotebooks):
    """The entries of a leaderboard.

    Attributes:
        name: Of the leaderboard.
        after: Numbers of iterations after which errors are told.
        tolerance: Largest error that counts as reached [m].
        entries: Cases in their order; of each the beliefs, the disturbances, and the laws.
    """

    name: str
    after: tuple[int, ...]
    tolerance: float
    entries: tuple[Entry, ...]

    def __repr__(self) -> str:
        title = f"LeaderboardData {self.name!r}: {len(self.entries)} runs"
        return in_short(title, f"laws: {listed(self.laws)}")

    def to_pandas(self) -> DataFrame:
        """A data frame of pandas with a row per run and the columns of leaderboard.csv.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        from hilc_cli.leaderboards.tables import entries_table  # which is made of this

        return entries_table(self).to_pandas()

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws in their order."""
        return tuple(dict.fromkeys(entry.law for entry in self.entries))

    @property
    def disturbances(self) -> tuple[str, ...]:
        """Names of the disturbances in their order."""
        return tuple(dict.fromkeys(entry.disturbance for entry in self.entries))

    def of(self, law: str, disturbance: str) -> list[Entry]:
        """The entries of a law with a disturbance."""
        return [
            entry for entry in self.entries if entry.law == law and entry.disturbance == disturbance
        ]

    @property
    def settings(self) -> tuple[tuple[str, str], ...]:
        """Beliefs with disturbances in their order."""
        return tuple(dict.fromkeys((entry.belief, entry.disturbance) for entry in self.entries))


class FailedContestError(HilcError):
    """A run of a leaderboard could not be computed."""


def compete(contest: Contest, after: Sequence[int], tolerance: float) -> Entry:
    """Runs one law in one case.

    Where all iterations are the same, since nothing is learned and nothing disturbed, one is run
    and stands for all.

    Args:
        contest: The law and the case.
        after: Numbers of iterations after which errors are told.
        tolerance: Largest error that counts as reached [m].
    """
    prepare_machine_code()
    experiment = contest.scenario.experiment()
    law, disturbance = contest.scenario.spec.controller, contest.scenario.spec.disturbance
    same = not law.learns and not disturbance.active
    _warm_up(experiment)
    start = time.process_time()
    metrics, diverged_at = _measured(replace(experiment, iterations=0) if same else experiment)
    seconds = time.process_time() - start
    ran = len(metrics[MAX_ERROR])
    if ran == 0:
        raise DivergedError(0)

    def whole(metric: str) -> Floats:
        """Errors of all iterations: infinite where diverged, the last where all are alike."""
        last = metrics[metric][-1] if diverged_at is None else math.inf
        return np.append(metrics[metric], [last] * (experiment.iterations + 1 - ran))

    largest, path = whole(MAX_ERROR_SECOND_HALF), whole(MAX_ERROR)
    mean, wanted = whole(MEAN_ERROR_SECOND_HALF), list(after)
    return Entry(
        contest.case,
        contest.belief,
        contest.disturbance,
        contest.law,
        tuple(largest[wanted].tolist()),
        tuple(mean[wanted].tolist()),
        tuple(path[wanted].tolist()),
        first_within(largest, tolerance),
        share_within(largest, tolerance),
        settled_at(largest, tolerance),
        float(path[1:].max()) if len(path) > 1 else None,
        float(metrics[FASTEST_WHEEL].max()),
        contest.scenario.speed_limit,
        diverged_at,
        seconds / ran,
    )


def compute_entries(
    contests: Sequence[Contest],
    work: Callable[[Contest], Entry],
    workers: int,
    on_runs: Callable[[int], None] = lambda runs: None,
    go_on: Callable[[], None] = lambda: None,
) -> tuple[Entry, ...]:
    """Computes all runs, in worker processes or, if one is to do it all, in this one.

    Args:
        contests: The runs.
        work: Makes the entry of one.
        workers: How many processes.
        on_runs: Told how many runs are done, each time there are more.
        go_on: Called now and then; may raise to stop.

    Returns:
        The entries in the order of the runs; all but their times depend on nothing else.

    Raises:
        FailedContestError: A run cannot be computed.
        WorkersError: Processes cannot be started.
    """
    prepare_machine_code()
    crew: Crew[Contest, Entry] = (
        Alone(work) if workers == 1 else Processes(work, min(workers, len(contests)))
    )
    entries: dict[Contest, Entry] = {}
    try:
        for outcome in hand_out(contests, crew, go_on):
            contest = outcome.piece
            if outcome.result is None:
                where = f"law {contest.law}, case {contest.case}, belief {contest.belief}"
                where += f", disturbance {contest.disturbance}"
                raise FailedContestError(f"{where}: {outcome.reason}") from outcome.error
            entries[contest] = outcome.result
            on_runs(len(entries))
    finally:
        crew.dismiss()
    return tuple(entries[contest] for contest in contests)


_TOLD = (MAX_ERROR, MAX_ERROR_SECOND_HALF, MEAN_ERROR_SECOND_HALF, FASTEST_WHEEL)
"""The metrics of which entries tell."""


def _measured(experiment: Experiment) -> tuple[dict[str, Floats], int | None]:
    """Metrics of each iteration, and the iteration that left the finite numbers, if one did."""
    trials = MeasuredTrials(experiment, names=_TOLD)
    rows = np.array([list(metrics.values()) for _, metrics in trials]).reshape(-1, len(_TOLD))
    return dict(zip(_TOLD, rows.T, strict=True)), trials.diverged_at


_WARM: set[type[object]] = set()
"""Laws that have run in this process, so that nothing of theirs is still to be loaded or compiled,
which would count as their time."""


def _warm_up(experiment: Experiment) -> None:
    kind = type(experiment.law)
    if kind not in _WARM:
        _measured(replace(experiment, iterations=min(2, experiment.iterations)))
        _WARM.add(kind)
