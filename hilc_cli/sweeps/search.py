"""A search for the case in which a metric is smallest: each batch follows from those before it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np

from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, ITERATIONS_TO_TOLERANCE, MAX_ERROR
from hilc_cli.sweeps.chunks import Chunk, Store, run_chunk
from hilc_cli.sweeps.compute import Execution, compile_for, compute_chunks, crew_for
from hilc_cli.sweeps.data import OwnValues, SweepData
from hilc_cli.sweeps.estimate import cases_per_chunk
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.sampler import SAMPLER, Sampler, Values, batches
from hilc_cli.sweeps.varied import TRAJECTORY, Varied, parts
from hilc_cli.variation.axes import Value
from hilc_cli.variation.cases import ListedCases
from hilc_cli.yaml_input.tree import to_yaml

_COLUMNS = list(CASE_COLUMNS)


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a search has tried.

    Attributes:
        cases: All its cases.
        as_it_is: The metric of the scenario with its own values, not-a-number if it has none.
    """

    cases: ListedCases
    as_it_is: float


def search(plan: Plan, store: Store, how: Execution) -> Found:
    """Computes the cases of a search, of which a store may have some.

    A batch follows from the results of the batches before it, not from who computed them, so that
    a search that goes on after a stop thinks of the same cases again and finds them in the store.

    Raises:
        UsageError: The package for that is not installed.
        HilcError: As for `compute`.
    """
    sampler = Sampler(plan.cases)
    compile_for(plan, how.on_compile)
    listed: list[Values] = []
    crew = crew_for(plan, LANES, how)
    try:
        for cases, drawn in batches(len(plan.cases)):
            how.go_on()
            values = sampler.ask(len(cases), drawn)
            batch = Chunk(cases.first, cases.last, values)
            store.forget_others(batch)
            compute_chunks(plan, store, crew, _missing(plan, store, batch, crew.workers), how)
            sampler.tell(costs(plan, store.rows()[batch.first : batch.last]))
            listed += values
    finally:
        crew.dismiss()
    return Found(ListedCases(plan.axes, listed), _as_it_is(plan))


def costs(plan: Plan, rows: Floats) -> Floats:
    """How good cases are, the smaller the better.

    Where the metric counts iterations to a tolerance, a case that never reaches it is worse than
    any that does, and among those of its kind as good as its last maximum error is small. One
    that diverged or failed is worse than all others.

    Args:
        plan: The search.
        rows: Of the cases, in the order of CASE_COLUMNS.

    Returns:
        Shape (cases,), infinite for the worst; only the order counts.
    """
    found = _metric(plan, rows)
    if plan.spec.metric == ITERATIONS_TO_TOLERANCE:
        error = rows[:, _COLUMNS.index(MAX_ERROR)]
        never = plan.most_iterations + 1 + error / (1 + error)
        finished = rows[:, _COLUMNS.index(DIVERGED)] == 0
        found = np.where(np.isnan(found) & finished, never, found)
    return np.where(np.isfinite(found), found, np.inf)


def _metric(plan: Plan, rows: Floats) -> Floats:
    """What is minimised, not-a-number for cases that diverged, failed or have no such number."""
    finished = rows[:, _COLUMNS.index(DIVERGED)] == 0
    return np.where(finished, rows[:, _COLUMNS.index(plan.spec.metric)], np.nan)


def _missing(plan: Plan, store: Store, batch: Chunk, workers: int) -> list[Chunk]:
    """What is missing of a batch, in chunks that keep workers busy."""
    size = cases_per_chunk(plan, len(batch), workers)
    pieces = []
    for gap in store.missing():
        last = min(gap.last, batch.last)
        for first in range(max(gap.first, batch.first), last, size):
            pieces.append(batch.part(first, min(first + size, last)))
    return pieces


def _as_it_is(plan: Plan) -> float:
    """The metric of the scenario with its own values."""
    own = Plan(Varied(plan.varied.scenario, {}), plan.spec)
    return float(_metric(plan, run_chunk(own, Chunk(0, 1, ((),))).rows)[0])


_SUFFIX, _LONGEST_NAME = "-best", 100


def beside_cases(plan: Plan, data: SweepData, metric: float) -> dict[str, Any]:
    """The fields that a `Sweep` has of a search only.

    Args:
        plan: The search.
        data: Its cases.
        metric: What it minimises, of the scenario as it is.
    """
    own = plan.varied.scenario.resolved()
    values = {key: value_of(own, key) for key in plan.axes}
    return {"as_it_is": OwnValues(values, metric), "best_yaml": _best_yaml(plan, data, metric)}


def how_searched(plan: Plan) -> dict[str, Any]:
    """What the manifest tells of how a search was done."""
    return {
        "minimise": plan.spec.minimise,
        "seed": plan.spec.seed,
        "sampler": SAMPLER,
        "optuna": version("optuna"),
    }


def _best_yaml(plan: Plan, data: SweepData, as_it_is: float) -> str | None:
    """The scenario of the best case as a file, if any case has the metric."""
    best = next(iter(data.ranked()), None)
    if best is None:
        return None
    scenario = plan.varied.case(data.case(best)).resolved()
    scenario["name"] = plan.name[: _LONGEST_NAME - len(_SUFFIX)] + _SUFFIX
    metric = float(data.columns[data.metric][best])
    title = f"# Case {best} of a search with hilc sweep, the best of {len(data)}: "
    title += f"{data.metric} {metric!r}\n"
    if metric >= as_it_is:
        title += f"# No better than the scenario as it is, which has {as_it_is!r}.\n"
    return f"{title}{to_yaml(scenario)}"


def value_of(resolved: Mapping[str, Any], key: str) -> Value:
    """What a resolved scenario has at a dotted key; None for what is no single value.

    Args:
        resolved: The scenario; of the names that a platform's width goes by it has one.
        key: The key, with whichever of them.
    """
    if key == TRAJECTORY:
        return str(resolved[TRAJECTORY]["name"])
    platform, _, field = key.partition(".")
    if field == "wheel_separation":
        return 2 * float(resolved[platform]["half_track"])
    found: Any = resolved
    for part in parts(key):
        is_there = part in found if isinstance(found, Mapping) else _is_place(part, found)
        if not is_there:
            return None
        found = found[part]
    return found if isinstance(found, bool | int | float | str) else None


def _is_place(part: str | int, data: Any) -> bool:
    return isinstance(data, list) and isinstance(part, int) and part < len(data)
