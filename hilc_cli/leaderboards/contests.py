"""The runs of a leaderboard: how entries are made of them, and who computes them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import measure_batch
from hilc_cli.engine.lanes.kinds import member
from hilc_cli.engine.loop import MeasuredTrials, prepare_machine_code
from hilc_cli.errors import DivergedError, HilcError
from hilc_cli.leaderboards.entries import Entry
from hilc_cli.leaderboards.heats import Heat, experiment_of, heats
from hilc_cli.leaderboards.plan import Contest
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import (
    FASTEST_WHEEL,
    MAX_ERROR,
    MAX_ERROR_SECOND_HALF,
    MEAN_ERROR_SECOND_HALF,
    first_within,
    settled_at,
    share_within,
)
from hilc_cli.workers.crews import Alone, Crew, Processes, hand_out


class FailedContestError(HilcError):
    """A run of a leaderboard could not be computed."""


_Measured = tuple[Floats, int | None]
"""The metrics of which entries tell, shape (completed iterations, metrics), and the iteration that
left the finite numbers, if one did."""

_TOLD = (MAX_ERROR, MAX_ERROR_SECOND_HALF, MEAN_ERROR_SECOND_HALF, FASTEST_WHEEL)

_TIMED = 2
"""The last iteration that the loop engine runs, too, of runs in lanes: to tell what it takes."""


def compete(contest: Contest, after: Sequence[int], tolerance: float) -> Entry:
    """Runs one law in one case, in the loop engine.

    Args:
        contest: The law and the case.
        after: Numbers of iterations after which errors are told.
        tolerance: Largest error that counts as reached [m].

    Raises:
        DivergedError: It left the finite numbers in iteration 0.
    """
    prepare_machine_code()
    measured, seconds = _by_loop(experiment_of(contest))
    if not len(measured[0]):
        raise DivergedError(0)
    return _entry(contest, measured, after, tolerance, seconds)


def run_heat(heat: Heat, after: Sequence[int], tolerance: float) -> list[Entry | str]:
    """Runs laws in cases, side by side where a heat has a kind.

    Args:
        heat: The laws and the cases.
        after: As for `compete`.
        tolerance: Likewise.

    Returns:
        The entry of each run; of one side by side with others that left the finite numbers in
        iteration 0, what there is to say of it.

    Raises:
        DivergedError: A run that is alone did.
    """
    if heat.kind is None:
        return [compete(contest, after, tolerance) for contest in heat.contests]
    prepare_machine_code()
    experiments = [experiment_of(contest) for contest in heat.contests]
    in_lanes = measure_batch([member(each) for each in experiments], heat.kind, _TOLD)
    found: list[Entry | str] = []
    for contest, experiment, measured in zip(heat.contests, experiments, in_lanes, strict=True):
        short = replace(experiment, iterations=min(experiment.iterations, _TIMED))
        if len(measured[0]):
            found.append(_entry(contest, measured, after, tolerance, _by_loop(short)[1]))
        else:
            found.append(f"{DivergedError.__name__}: {DivergedError(0)}")
    return found


def _by_loop(experiment: Experiment) -> tuple[_Measured, float]:
    """Runs one in the loop engine; also returns the processor time of an iteration [s]."""
    law = type(experiment.law)
    if law not in _WARM:
        _measured(replace(experiment, iterations=min(2, experiment.iterations)))
        _WARM.add(law)
    start = time.process_time()
    measured = _measured(experiment)
    seconds = time.process_time() - start
    return measured, seconds / max(len(measured[0]), 1)


_WARM: set[type[object]] = set()
"""Laws that have run in this process, so that nothing of theirs is still to be loaded or compiled,
which would count as their time."""


def _measured(experiment: Experiment) -> _Measured:
    trials = MeasuredTrials(experiment, names=_TOLD)
    rows = np.array([list(metrics.values()) for _, metrics in trials]).reshape(-1, len(_TOLD))
    return rows, trials.diverged_at


def _entry(
    contest: Contest, measured: _Measured, after: Sequence[int], tolerance: float, seconds: float
) -> Entry:
    metrics, diverged_at = measured
    missing = contest.scenario.spec.iterations + 1 - len(metrics)
    # Iterations that are missing are like the one that is not, or have diverged.
    rest = metrics[-1] if diverged_at is None else np.full(len(_TOLD), math.inf)
    path, largest, mean, _ = np.concatenate([metrics, np.tile(rest, (missing, 1))]).T
    wanted = list(after)
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
        float(metrics[:, _TOLD.index(FASTEST_WHEEL)].max()),
        contest.scenario.speed_limit,
        diverged_at,
        seconds,
    )


def compute_entries(
    contests: Sequence[Contest],
    work: Callable[[Heat], list[Entry | str]],
    workers: int,
    on_runs: Callable[[int], None] = lambda runs: None,
    go_on: Callable[[], None] = lambda: None,
) -> tuple[Entry, ...]:
    """Computes all runs, in worker processes or, if one is to do it all, in this one.

    Args:
        contests: The runs.
        work: Makes the entries of a heat.
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
    pieces = heats(contests)
    crew: Crew[Heat, list[Entry | str]] = (
        Alone(work) if workers == 1 else Processes(work, min(workers, len(pieces)))
    )
    entries: dict[Contest, Entry] = {}
    try:
        for outcome in hand_out(pieces, crew, go_on):
            runs = outcome.piece.contests
            if outcome.result is None:
                raise _failed(runs, outcome.reason) from outcome.error
            for contest, entry in zip(runs, outcome.result, strict=True):
                if isinstance(entry, str):
                    raise _failed([contest], entry)
                entries[contest] = entry
            on_runs(len(entries))
    finally:
        crew.dismiss()
    return tuple(entries[contest] for contest in contests)


def _failed(runs: Sequence[Contest], reason: str) -> FailedContestError:
    first, others = runs[0], len(runs) - 1
    where = f"law {first.law}, case {first.case}, belief {first.belief}"
    where += f", disturbance {first.disturbance}"
    if others:
        where += f", or one of {others} that are run with it"
    return FailedContestError(f"{where}: {reason}")
