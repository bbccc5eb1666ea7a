"""What a sweep will cost, before it runs."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.engine.batch import simulate_batch
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes import LANES
from hilc_cli.errors import HilcError
from hilc_cli.results.sweep import CASE_COLUMNS
from hilc_cli.spec.varied import CANNOT_BE_MADE, TRAJECTORY
from hilc_cli.sweeping.plan import Plan
from hilc_cli.variation.cases import Cases

_BASE_MEMORY = 250e6  # [bytes] Python with its libraries, pictures included
_BYTES_PER_VALUE = 8
_TRIAL_SAMPLES = 50_000
_TRIAL_CASES = 1000


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a sweep will cost.

    Attributes:
        cases: Number of cases.
        samples: Number of samples of all iterations of all cases.
        memory: Of the process that collects the results [bytes].
        disk: Of the results while they are computed [bytes].
        seconds: With this number of workers.
        workers: Number of workers.
    """

    cases: int
    samples: float
    memory: float
    disk: float
    seconds: float
    workers: int


def samples_per_case(plan: Plan) -> float:
    """Samples of all iterations of a case, on average; of many cases estimated from some."""
    keys = [key for key in plan.axes if key == "iterations" or key.split(".")[0] == TRAJECTORY]
    cases = plan.cases
    if cases.sampling == "grid":
        # The other keys only repeat the combinations of these.
        cases = Cases({key: plan.axes[key] for key in keys})
    counts = []
    for case in cases.values(0, min(len(cases), _TRIAL_CASES)) if keys else [{}]:
        with suppress(HilcError):
            spec = plan.varied.case({key: case[key] for key in keys}).spec
            counts.append((spec.iterations + 1) * spec.trajectory.reference().samples)
    return float(np.mean(counts)) if counts else 0.0


def estimate(plan: Plan, workers: int) -> Estimate:
    """What a sweep will cost, from a short trial of its first cases.

    Args:
        plan: The sweep.
        workers: How many compute it.
    """
    cases, samples = len(plan.cases), samples_per_case(plan)
    columns = len(CASE_COLUMNS) + len(plan.axes)
    rows = cases * _BYTES_PER_VALUE * len(CASE_COLUMNS)
    bands = cases * _BYTES_PER_VALUE * (plan.most_iterations + 1) if plan.bands else 0
    return Estimate(
        cases=cases,
        samples=cases * samples,
        memory=_BASE_MEMORY + 3 * cases * _BYTES_PER_VALUE * columns,
        disk=rows + bands,
        seconds=cases * samples * _seconds_per_sample(plan) / workers,
        workers=workers,
    )


def _seconds_per_sample(plan: Plan) -> float:
    """Measured on full lanes, after the code has been loaded."""
    made: list[Experiment] = []
    for case in plan.cases.values(0, min(LANES, len(plan.cases))):
        with suppress(*CANNOT_BE_MADE):
            made.append(plan.varied.experiment(case))
    if not made:
        return 0.0
    made = [made[lane % len(made)] for lane in range(LANES)]
    steps = made[0].reference.samples
    short = max(1, min(made[0].iterations, _TRIAL_SAMPLES // steps))
    trial = [replace(experiment, iterations=short) for experiment in made]
    simulate_batch(trial)
    start = time.perf_counter()
    simulate_batch(trial)
    return (time.perf_counter() - start) / (LANES * steps * (short + 1))
