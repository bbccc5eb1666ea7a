"""How much work the cases of a sweep are, and how many of them make a chunk."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.errors import HilcError
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.varied import TRAJECTORY
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
    """What a case takes on one core, roughly."""
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
