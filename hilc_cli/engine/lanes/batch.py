"""The batch engine: many experiments at once, metrics only.

One per vector lane where the law is known here, else in turn by the loop engine.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import is_at_hand
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.iterations import run_iterations
from hilc_cli.engine.lanes.kinds import Kind, Member, kinds_of, member, offers_of
from hilc_cli.engine.lanes.lanes import LANES, SUM_ROWS
from hilc_cli.engine.lanes.packs import NEVER as NEVER, Pack
from hilc_cli.engine.loop import MeasuredTrials
from hilc_cli.laws.pid import PidLaw
from hilc_cli.numba_loading import DISABLED, typeof
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import MAX_ERROR, METRICS, Sums, metrics_of_sums

Integers = NDArray[np.int64]
_NO_END = 2**62
"""A number of iterations that nobody runs."""


@dataclass(frozen=True, slots=True, eq=False)
class BatchResult:
    """What is kept of each experiment of a batch.

    Attributes:
        final: Metrics of the last completed iteration, shape (cases, metrics), in the order of
            `METRICS`; not-a-number if not even iteration 0 stayed within the finite numbers.
        errors: Largest position error [m] of each iteration, shape (cases, iterations + 1);
            not-a-number where an experiment has no such iteration.
        diverged_at: The iteration that left the finite numbers, shape (cases,); NEVER if none.
    """

    final: Floats
    errors: Floats
    diverged_at: Integers


def simulate_batch(experiments: Sequence[Experiment], own_references: bool = False) -> BatchResult:
    """Runs experiments side by side.

    Experiments that share their reference, law and kinds of disturbance share vector lanes;
    gains, matrices, limits, robots, poses, bounds, seeds and iterations are each experiment's own.
    The result of an experiment does not depend on which others are run with it.

    Args:
        experiments: At least one, each with a law and a plant that this engine knows.
        own_references: Whether lanes have references of their own, see `simulate_many`.

    Raises:
        UsageError: An experiment has a law or a plant that this engine does not know.
    """
    return _simulate([member(experiment) for experiment in experiments], own_references)


def simulate_many(experiments: Sequence[Experiment], own_references: bool = False) -> BatchResult:
    """Runs experiments of any laws, at least one.

    The result of an experiment does not depend on which others are run with it.

    Args:
        experiments: What to run.
        own_references: Whether lanes have references of their own, so that experiments on many
            trajectories share them. That takes longer for those that share their trajectory, and
            changes last digits: whoever compares results decides it for all of them.
    """
    offers = [None] * len(experiments) if DISABLED else list(offers_of(experiments))
    in_lanes = [number for number, offer in enumerate(offers) if offer is not None]
    members = [offer for offer in offers if offer is not None]
    if len(members) == len(experiments):
        return _simulate(members, own_references)
    cases = len(experiments)
    most = max(experiment.iterations for experiment in experiments)
    result = BatchResult(
        np.full((cases, len(METRICS)), np.nan),
        np.full((cases, most + 1), np.nan),
        np.full(cases, NEVER, dtype=np.int64),
    )
    if members:
        batch = _simulate(members, own_references)
        result.final[in_lanes] = batch.final
        result.errors[in_lanes, : batch.errors.shape[1]] = batch.errors
        result.diverged_at[in_lanes] = batch.diverged_at
    for number, offer in enumerate(offers):
        if offer is None:
            _one(experiments[number], result, number)
    return result


def _simulate(members: Sequence[Member], own_references: bool) -> BatchResult:
    """Runs experiments that are all known here."""
    cases = len(members)
    most = max(each.experiment.iterations for each in members)
    final = np.empty((cases, len(METRICS)))
    errors = np.empty((cases, most + 1))
    diverged_at = np.empty(cases, dtype=np.int64)
    for kind, alike in groups(members, own_references):
        references = [members[number].experiment.reference for number in alike]
        pack = Pack(references[-1], kind)
        sums = np.empty((SUM_ROWS, len(alike)))
        noted = np.empty((most + 1, LANES))
        for first in range(0, len(alike), LANES):
            numbers = alike[first : first + LANES]
            used = len(numbers)
            _run(pack, [members[number] for number in numbers], noted)
            sums[:, first : first + used] = pack.sums.reshape(-1, LANES)[:, :used]
            errors[numbers] = noted[:, :used].T
            diverged_at[numbers] = pack.diverged_at[:used]
        samples = np.array([reference.samples for reference in references])
        final[alike] = metrics_of_sums(Sums(samples, *sums))
    return BatchResult(final, errors, diverged_at)


def measure_batch(
    members: Sequence[Member], kind: Kind, names: Sequence[str]
) -> list[tuple[Floats, int | None]]:
    """Metrics of each iteration, not of the last one alone.

    Args:
        members: The experiments; of one reference, unless the kind has lanes with their own.
        kind: What all of them can be run as, see `joined`.
        names: Which metrics.

    Returns:
        Of each experiment its metrics, shape (completed iterations, names), and the iteration that
        left the finite numbers; None if none did.
    """
    longest = max((each.experiment.reference for each in members), key=lambda each: each.samples)
    pack, found = Pack(longest, kind), []
    for first in range(0, len(members), LANES):
        some = members[first : first + LANES]
        pack.fill(some)
        table = _each_iteration(pack, some, names)
        for each, rows, diverged_at in zip(some, table, pack.diverged_at.tolist(), strict=False):
            ends = each.experiment.iterations + 1 if diverged_at == NEVER else diverged_at
            found.append((rows[:ends], None if diverged_at == NEVER else diverged_at))
    return found


def _each_iteration(pack: Pack, members: Sequence[Member], names: Sequence[str]) -> Floats:
    """The metrics of lanes, shape (members, iterations + 1, names), of no meaning behind ends."""
    lasts = pack.last.copy()
    iterations = int(lasts.max()) + 1
    values = arguments(pack, np.empty((iterations, LANES)))
    samples = np.array([each.experiment.reference.samples for each in members])
    sums = pack.sums.reshape(-1, LANES)[:, : len(members)]
    table = np.empty((len(members), iterations, len(names)))
    for iteration in range(iterations):
        goes_on = (lasts >= iteration) & (pack.diverged_at == NEVER)
        if not goes_on.any():
            break
        # What metrics are made of is noted of a lane's last iteration: this is its last for now.
        pack.last[:] = np.where(goes_on, iteration, NEVER)
        pack.plan(iteration)
        run_iterations(*values, iteration, iteration + 1)
        noted = Sums(samples, *sums)
        with np.errstate(invalid="ignore", over="ignore"):  # of lanes that have diverged
            for number, name in enumerate(names):
                table[:, iteration, number] = METRICS[name].of_sums(noted)
    return table


def _one(experiment: Experiment, result: BatchResult, number: int) -> None:
    """Runs one in the loop engine and notes it like the batch engine."""
    trials = MeasuredTrials(experiment)
    for trial, metrics in trials:
        result.errors[number, trial.iteration] = metrics[MAX_ERROR]
        result.final[number] = list(metrics.values())
    if trials.diverged_at is not None:
        result.diverged_at[number] = trials.diverged_at


def groups(
    members: Sequence[Member], own_references: bool = False
) -> Iterator[tuple[Kind, list[int]]]:
    """Numbers of the experiments that can share lanes, and their kind; the shortest first."""
    found: dict[tuple[float, Kind], list[int]] = {}
    for number, kind in enumerate(kinds_of(members, own_references)):
        reference = members[number].experiment.reference
        shared = reference.sample_time if own_references else id(reference)
        found.setdefault((shared, kind), []).append(number)
    for (_, kind), alike in found.items():
        yield kind, sorted(alike, key=lambda number: members[number].experiment.reference.samples)


def _run(pack: Pack, members: Sequence[Member], errors: Floats) -> None:
    """Runs all iterations; lanes that have diverged are run again up to where they did."""
    pack.fill(members)
    errors[:] = np.nan
    _run_passes(pack, errors)
    gone = pack.diverged_at != NEVER
    if gone.any():
        sums, diverged_at = pack.sums.reshape(-1, LANES).copy(), pack.diverged_at.copy()
        pack.restart(members)
        pack.last[:] = np.where(gone, diverged_at - 1, NEVER)
        _run_passes(pack, errors)
        again = pack.sums.reshape(-1, LANES)
        again[:, ~gone] = sums[:, ~gone]
        pack.diverged_at[:] = diverged_at


def _run_passes(pack: Pack, errors: Floats) -> None:
    """Runs iterations as long as any lane goes on; where passes are planned, one at a time."""
    values = arguments(pack, errors)
    if not pack.kind.planned:
        run_iterations(*values, 0, _NO_END)
        return
    goes_on, iteration = True, 0
    while goes_on:
        pack.plan(iteration)
        goes_on = run_iterations(*values, iteration, iteration + 1)
        iteration += 1


def arguments(pack: Pack, errors: Floats) -> tuple[Any, ...]:
    """The arguments of `run_iterations` but for which to run.

    None stands for what the machine code is to be without.
    """
    kind, heading = pack.kind, pack.kind.gain_heading
    return (
        pack.lanes,
        pack.words,
        pack.noise,
        pack.history,
        errors.ravel(),
        pack.sums,
        pack.last,
        pack.diverged_at,
        *pack.reached,
        pack.tracks,
        pack.decay,
        pack.directions,
        kind.derivative or None,
        kind.full_matrix or None,
        (kind.disturbed and heading == "measured") or None,
        (heading == "reference") or None,
        (heading == "previous") or None,
        pack.planned,
        (kind.law is PidLaw and not kind.planned) or None,
        kind.rectifying or None,
        pack.twists,
        pack.late,
        pack.late_alike,
        kind.wheels or 0,
        kind.disturbed or None,
        kind.drawn or None,
        kind.learn_in_first,
        kind.state,
        kind.output,
        kind.pose,
    )


def is_compiled(experiments: Sequence[Experiment], own_references: bool = False) -> bool:
    """Whether `simulate_batch` could run these experiments without compiling anything.

    Compiling takes seconds and is done once for each law and kind of disturbance; the code is kept
    in the ``__pycache__`` beside the engine, or in the user's cache folder where that cannot be
    written; the environment variable ``NUMBA_CACHE_DIR`` names another one.

    Raises:
        UsageError: An experiment has a law or a plant that the batch engine does not know.
    """
    signatures = set()
    members = [member(experiment) for experiment in experiments]
    for kind, alike in groups(members, own_references):
        pack = Pack(members[alike[0]].experiment.reference, kind)
        values = *arguments(pack, np.empty((1, LANES))), 0, _NO_END
        signatures.add(tuple(map(typeof, values)))
    return all(is_at_hand(run_iterations, signature) for signature in signatures)
