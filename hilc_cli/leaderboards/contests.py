"""The runs of a leaderboard: how entries are made of them, and who computes them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import measure_batch
from hilc_cli.engine.lanes.kinds import Kind, member
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
from hilc_cli.workers.crews import Alone, Crew, Outcome, Processes, hand_out


class FailedContestError(HilcError):
    """A run of a leaderboard could not be computed."""


_Run = tuple[Floats, int | None]
"""The metrics of which entries tell, shape (completed iterations, metrics), and the iteration that
left the finite numbers, if one did."""

_TOLD = (MAX_ERROR, MAX_ERROR_SECOND_HALF, MEAN_ERROR_SECOND_HALF, FASTEST_WHEEL)


def compete(heat: Heat, after: Sequence[int], tolerance: float) -> list[Entry]:
    """Runs laws in cases, side by side where a heat has several.

    Args:
        heat: The laws and the cases.
        after: Numbers of iterations after which errors are told.
        tolerance: Largest error that counts as reached [m].

    Raises:
        DivergedError: A run left the finite numbers in iteration 0.
    """
    prepare_machine_code()
    experiments = [experiment_of(contest) for contest in heat.contests]
    _warm_up(experiments, heat.kind)
    start = time.process_time()
    runs = _measured(experiments, heat.kind)
    seconds = time.process_time() - start
    if any(len(metrics) == 0 for metrics, _ in runs):
        raise DivergedError(0)
    each = seconds / sum(len(metrics) for metrics, _ in runs)
    pairs = zip(heat.contests, runs, strict=True)
    return [_entry(contest, run, after, tolerance, each) for contest, run in pairs]


def _entry(
    contest: Contest, run: _Run, after: Sequence[int], tolerance: float, seconds: float
) -> Entry:
    metrics, diverged_at = run
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
    work: Callable[[Heat], list[Entry]],
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
    crew: Crew[Heat, list[Entry]] = (
        Alone(work) if workers == 1 else Processes(work, min(workers, len(pieces)))
    )
    entries: dict[Contest, Entry] = {}
    try:
        for outcome in _outcomes(pieces, crew, go_on):
            runs = outcome.piece.contests
            if outcome.result is None:
                (contest,) = runs
                where = f"law {contest.law}, case {contest.case}, belief {contest.belief}"
                where += f", disturbance {contest.disturbance}"
                raise FailedContestError(f"{where}: {outcome.reason}") from outcome.error
            entries.update(zip(runs, outcome.result, strict=True))
            on_runs(len(entries))
    finally:
        crew.dismiss()
    return tuple(entries[contest] for contest in contests)


def _outcomes(
    pieces: Sequence[Heat], crew: Crew[Heat, list[Entry]], go_on: Callable[[], None]
) -> Iterator[Outcome[Heat, list[Entry]]]:
    """What becomes of heats; one of several that fails is parted, to find out which run did."""
    parted: list[Heat] = []
    for outcome in hand_out(pieces, crew, go_on):
        runs = outcome.piece.contests
        if outcome.result is None and len(runs) > 1:
            parted += [Heat((contest,)) for contest in runs]
        else:
            yield outcome
    yield from hand_out(parted, crew, go_on)


def _measured(experiments: Sequence[Experiment], kind: Kind | None) -> list[_Run]:
    """Runs experiments in lanes, or where they have no kind one by one in the loop engine."""
    if kind is not None:
        return measure_batch([member(experiment) for experiment in experiments], kind, _TOLD)
    return [_of_trials(MeasuredTrials(each, names=_TOLD)) for each in experiments]


def _of_trials(trials: MeasuredTrials) -> _Run:
    rows = np.array([list(metrics.values()) for _, metrics in trials]).reshape(-1, len(_TOLD))
    return rows, trials.diverged_at


_WARM: set[Hashable] = set()
"""Laws and kinds that have run in this process, so that nothing of theirs is still to be loaded or
compiled, which would count as their time."""


def _warm_up(experiments: Sequence[Experiment], kind: Kind | None) -> None:
    what = type(experiments[0].law) if kind is None else kind
    if what not in _WARM:
        _measured([replace(each, iterations=min(2, each.iterations)) for each in experiments], kind)
        _WARM.add(what)
