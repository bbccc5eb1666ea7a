"""What a search leaves beside its cases: the scenario of the best one, and how it began."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

from hilc_cli.results.search import AsItIs
from hilc_cli.results.sweep import SweepData
from hilc_cli.spec.dump import to_yaml
from hilc_cli.spec.putting import parts
from hilc_cli.spec.varied import TRAJECTORY
from hilc_cli.sweeping.plan import Plan
from hilc_cli.sweeping.sampler import SAMPLER
from hilc_cli.variation.axes import Value

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
    return {"as_it_is": AsItIs(values, metric), "best_yaml": _best_yaml(plan, data, metric)}


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
