"""What a sweep will cost, before it runs."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.engine.batch import simulate_batch
from hilc_cli.engine.lanes import LANES
from hilc_cli.results.sweep import CASE_COLUMNS
from hilc_cli.sweeping.plan import Plan

_BASE_MEMORY = 250e6  # [bytes] Python with its libraries, pictures included
_BYTES_PER_VALUE = 8
_TRIAL_SAMPLES = 50_000


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
    """Samples of all iterations of a case, on average."""
    iterations = plan.axes.get("iterations")
    if iterations is None:
        mean = float(plan.varied.scenario.spec.iterations)
    else:
        taken = plan.cases.values(0, min(len(plan.cases), 10_000))
        mean = float(np.mean([case["iterations"] for case in taken]))
    return (mean + 1) * plan.varied.scenario.spec.trajectory.reference().samples


def estimate(plan: Plan, workers: int) -> Estimate:
    """What a sweep will cost, from a short trial of its first cases.

    Args:
        plan: The sweep.
        workers: How many compute it.
    """
    cases, samples = len(plan.cases), samples_per_case(plan)
    columns = len(CASE_COLUMNS) + len(plan.axes)
    rows = cases * _BYTES_PER_VALUE * len(CASE_COLUMNS)
    bands = cases * _BYTES_PER_VALUE * (plan.most_iterations + 1) if plan.spec.bands else 0
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
    first = min(LANES, len(plan.cases))
    values = [plan.cases.values(0, first)[case % first] for case in range(LANES)]
    made = [plan.varied.experiment(case) for case in values]
    steps = made[0].reference.samples
    short = max(1, min(made[0].iterations, _TRIAL_SAMPLES // steps))
    trial = [replace(experiment, iterations=short) for experiment in made]
    simulate_batch(trial)
    start = time.perf_counter()
    simulate_batch(trial)
    return (time.perf_counter() - start) / (LANES * steps * (short + 1))
