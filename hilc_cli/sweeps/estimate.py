"""How much work the cases of a sweep are: how many make a chunk, and what all will cost."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.engine.many import simulate_many
from hilc_cli.errors import HilcError
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.sampler import batches
from hilc_cli.sweeps.varied import CANNOT_BE_MADE, TRAJECTORY
from hilc_cli.variation.cases import Cases

# Orders of magnitude, on one core of a machine of 2023 [s]; docs/performance.md has measured ones.
_PER_SAMPLE = 4e-9
_PER_DISTURBED_SAMPLE = 2e-8
_PER_LOOPED_SAMPLE = 1.5e-6
_PER_CASE = 1e-4

_CHUNK = 1.0  # [s]
_MOST_CASES = 4096
_TRIAL_CASES = 1000


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


def seconds_per_case(plan: Plan) -> float:
    """Seconds that a case takes on one core, roughly."""
    disturbance = plan.varied.scenario.spec.disturbance
    disturbed = any(source.bounded().active for source in (disturbance.state, disturbance.output))
    varied = any(key.startswith(("disturbance.state", "disturbance.output")) for key in plan.axes)
    per_sample = _PER_DISTURBED_SAMPLE if disturbed or varied else _PER_SAMPLE
    if not plan.in_lanes:
        per_sample = _PER_LOOPED_SAMPLE
    return _PER_CASE + per_sample * samples_per_case(plan)


def cases_per_chunk(plan: Plan, cases: int, workers: int) -> int:
    """How many cases make about a second of work, and keep all workers busy to the end.

    Args:
        plan: The sweep.
        cases: How many there are to compute.
        workers: How many compute them.

    Returns:
        A multiple of the number of lanes, so that none is empty, if cases run in lanes.
    """
    fair = cases / (4 * workers)
    pack = LANES if plan.in_lanes else 1
    packs = min(_CHUNK / seconds_per_case(plan), fair, _MOST_CASES) / pack
    return max(1, int(packs)) * pack


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
    """

    cases: int
    samples: int
    memory: int
    disk: int
    seconds: float
    workers: int


def estimate(plan: Plan, workers: int, computed: int | None = None) -> Estimate:
    """What a sweep will cost, from a short trial of its first cases.

    Args:
        plan: The sweep.
        workers: How many compute it.
        computed: How many of its cases they compute; by default all.
    """
    cases, samples = computed or len(plan.cases), samples_per_case(plan)
    columns = len(CASE_COLUMNS) + len(plan.axes)
    rows = cases * _BYTES_PER_VALUE * len(CASE_COLUMNS)
    bands = cases * _BYTES_PER_VALUE * (plan.most_iterations + 1) if plan.bands else 0
    per_case = samples * _seconds_per_sample(plan) + _PER_CASE
    work = _of_search(plan, per_case, workers) if plan.searches else cases * per_case / workers
    return Estimate(
        cases=cases,
        samples=round(cases * samples),
        memory=round(_BASE_MEMORY + 3 * cases * _BYTES_PER_VALUE * columns),
        disk=rows + bands,
        seconds=_START + work,
        workers=workers,
    )


def _of_search(plan: Plan, per_case: float, workers: int) -> float:
    """Seconds of a search: batches wait for each other, and it takes time to think of the next."""
    cases = len(plan.cases)
    seconds = cases * (_PER_THOUGHT + cases * _PER_MEMORY)
    for batch, _ in batches(cases):
        size = cases_per_chunk(plan, len(batch), workers)
        rounds = math.ceil(math.ceil(len(batch) / size) / workers)
        seconds += rounds * size * per_case
    return seconds


def _seconds_per_sample(plan: Plan) -> float:
    """Seconds per sample, measured on full lanes after loading; on one case without lanes."""
    made: list[Experiment] = []
    for case in plan.cases.values(0, min(LANES, len(plan.cases))):
        with suppress(*CANNOT_BE_MADE):
            made.append(plan.varied.experiment(case))
    if not made:
        return 0.0
    side_by_side = LANES if plan.in_lanes else 1
    made = [made[lane % len(made)] for lane in range(side_by_side)]
    steps = made[0].reference.samples
    short = max(1, min(made[0].iterations, _TRIAL_SAMPLES // steps))
    trial = [replace(experiment, iterations=short) for experiment in made]
    simulate_many(trial)
    start = time.perf_counter()
    simulate_many(trial)
    return (time.perf_counter() - start) / (side_by_side * steps * (short + 1))
