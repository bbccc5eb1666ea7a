"""Many experiments, metrics only: in lanes where the batch engine knows the law, else in turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import NEVER, BatchResult, simulate_batch
from hilc_cli.engine.lanes.packs import knows
from hilc_cli.engine.loop import MeasuredTrials
from hilc_cli.results.metrics import MAX_ERROR, METRICS


def simulate_many(experiments: Sequence[Experiment]) -> BatchResult:
    """Runs experiments of any laws.

    The result of an experiment does not depend on which others are run with it.

    Args:
        experiments: At least one.
    """
    cases = len(experiments)
    most = max(experiment.iterations for experiment in experiments)
    result = BatchResult(
        np.full((cases, len(METRICS)), np.nan),
        np.full((cases, most + 1), np.nan),
        np.full(cases, NEVER, dtype=np.int64),
    )
    in_lanes = [number for number, each in enumerate(experiments) if knows(each)]
    if in_lanes:
        batch = simulate_batch([experiments[number] for number in in_lanes])
        result.final[in_lanes] = batch.final
        result.errors[in_lanes, : batch.errors.shape[1]] = batch.errors
        result.diverged_at[in_lanes] = batch.diverged_at
    for number in sorted(set(range(cases)) - set(in_lanes)):
        _one(experiments[number], result, number)
    return result


def _one(experiment: Experiment, result: BatchResult, number: int) -> None:
    """Runs one in the loop engine and notes it like the batch engine."""
    trials = MeasuredTrials(experiment)
    for trial, metrics in trials:
        result.errors[number, trial.iteration] = metrics[MAX_ERROR]
        result.final[number] = list(metrics.values())
    if trials.diverged_at is not None:
        result.diverged_at[number] = trials.diverged_at
