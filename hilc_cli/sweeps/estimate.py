"""What the cases of a sweep will cost: time, memory and disk."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import dataclass, replace

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_many
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.compute import cases_per_chunk, samples_per_case
from hilc_cli.sweeps.plan import CANNOT_BE_MADE, Plan
from hilc_cli.sweeps.refinement import refined_cases
from hilc_cli.sweeps.search import batches

_BASE_MEMORY = 250e6  # [bytes] Python with its libraries, pictures included
_BYTES_PER_VALUE = 8
_START, _PER_CASE = 1.0, 5e-5  # [s] processes with their libraries; an experiment of its values
_PER_THOUGHT, _PER_MEMORY = 2e-3, 4e-6  # [s] for each case of a search, and each one before it
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
        choices: Of keys that do not happen, if some do and it is of all cases.
        happenings: Cases of each choice, likewise.
    """

    cases: int
    samples: int
    memory: int
    disk: int
    seconds: float
    workers: int
    choices: int | None = None
    happenings: int | None = None


def estimate(plan: Plan, workers: int, computed: int | None = None) -> Estimate:
    """What a sweep, or so many of its cases, will cost, from a short trial of its first ones."""
    cases, samples = computed or len(plan.cases), samples_per_case(plan)
    columns = len(CASE_COLUMNS) + len(plan.axes)
    rows = cases * _BYTES_PER_VALUE * len(CASE_COLUMNS)
    bands = cases * _BYTES_PER_VALUE * (plan.most_iterations + 1) if plan.bands else 0
    per_case = samples * _seconds_per_sample(plan) + _PER_CASE
    told = bool(plan.over) and cases == len(plan.cases)
    work = _of_search(plan, per_case, workers) if plan.searches else cases * per_case / workers
    return Estimate(
        cases=cases,
        samples=round(cases * samples),
        memory=round(_BASE_MEMORY + 3 * cases * _BYTES_PER_VALUE * columns),
        disk=rows + bands,
        seconds=_START + work,
        workers=workers,
        choices=plan.choices if told else None,
        happenings=plan.happenings if told else None,
    )


def _of_search(plan: Plan, per_case: float, workers: int) -> float:
    """Seconds of a search: batches wait for each other, and it takes time to think of the next."""
    choices, every = plan.choices, plan.happenings
    refined = refined_cases({key: plan.axes[key] for key in plan.chosen}, choices)
    seconds = choices * (_PER_THOUGHT + choices * _PER_MEMORY)
    sizes = [len(batch) for batch, _ in batches(choices - refined)] + [1] * refined
    for size in sizes:
        chunk = cases_per_chunk(plan, size * every, workers)
        rounds = math.ceil(math.ceil(size * every / chunk) / workers)
        seconds += rounds * chunk * per_case
    return seconds


def _seconds_per_sample(plan: Plan) -> float:
    """Seconds per sample, measured on full lanes after loading; on one case without lanes."""
    made: list[Experiment] = []
    for case in plan.cases.values(0, min(LANES, len(plan.cases))):
        with suppress(*CANNOT_BE_MADE):
            made.append(plan.experiment(case))
    if not made:
        return 0.0
    side_by_side = LANES if plan.in_lanes else 1
    made = [made[lane % len(made)] for lane in range(side_by_side)]
    steps = made[0].reference.samples
    short = max(1, min(made[0].iterations, _TRIAL_SAMPLES // steps))
    trial = [replace(experiment, iterations=short) for experiment in made]
    simulate_many(trial, plan.own_references)
    start = time.perf_counter()
    simulate_many(trial, plan.own_references)
    return (time.perf_counter() - start) / (side_by_side * steps * (short + 1))
