"""The Python interface: load a scenario, run it or sweep it, keep the results.

The commands call this and nothing else. Each name is loaded when it is first used: a run needs no
compiler, and a sweep no loop engine.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hilc_cli.api.checking import Check, check
    from hilc_cli.api.comparing import Comparison, compare
    from hilc_cli.api.comparing_laws import (
        LawComparison,
        Leaderboard,
        check_leaderboard_output,
        compare_laws,
        load_leaderboard,
    )
    from hilc_cli.api.leaderboard_folders import (
        is_leaderboard,
        plot_leaderboard,
        read_leaderboard,
    )
    from hilc_cli.api.reproducing import Reproduction, check_reproduction, reproduce
    from hilc_cli.api.running import (
        Run,
        RunData,
        RunSource,
        Scenario,
        ScenarioSource,
        Summary,
        as_runs,
        check_folder,
        forewarnings,
        load_scenario,
        plot,
        read_run,
        run,
    )
    from hilc_cli.api.sweep_folders import (
        check_sweep_output,
        discard_work,
        is_complete,
        is_resumable,
        is_sweep,
        plot_sweep,
        read_sweep,
        work_folder,
    )
    from hilc_cli.api.sweep_results import Sweep
    from hilc_cli.api.sweeping import merge_shards, plan_sweep, sweep, sweep_shard
    from hilc_cli.paper.plan import ReproductionPlan, plan_reproduction
    from hilc_cli.results.leaderboard import LeaderboardData
    from hilc_cli.results.parquet import require_parquet
    from hilc_cli.results.sweep import SweepData
    from hilc_cli.results.sweep_summary import SweepSummary, summarise_sweep
    from hilc_cli.sweeping.chunks import Failure
    from hilc_cli.sweeping.compute import Execution, compile_for
    from hilc_cli.sweeping.crew import available_cores
    from hilc_cli.sweeping.estimate import Estimate, estimate
    from hilc_cli.sweeping.plan import Plan
    from hilc_cli.sweeping.shards import check_shardable, shard_cases

__all__ = [
    "Check",
    "Comparison",
    "Estimate",
    "Execution",
    "Failure",
    "LawComparison",
    "Leaderboard",
    "LeaderboardData",
    "Plan",
    "Reproduction",
    "ReproductionPlan",
    "Run",
    "RunData",
    "RunSource",
    "Scenario",
    "ScenarioSource",
    "Summary",
    "Sweep",
    "SweepData",
    "SweepSummary",
    "as_runs",
    "available_cores",
    "check",
    "check_folder",
    "check_leaderboard_output",
    "check_reproduction",
    "check_shardable",
    "check_sweep_output",
    "compare",
    "compare_laws",
    "compile_for",
    "discard_work",
    "estimate",
    "forewarnings",
    "is_complete",
    "is_leaderboard",
    "is_resumable",
    "is_sweep",
    "load_leaderboard",
    "load_scenario",
    "merge_shards",
    "plan_reproduction",
    "plan_sweep",
    "plot",
    "plot_leaderboard",
    "plot_sweep",
    "read_leaderboard",
    "read_run",
    "read_sweep",
    "reproduce",
    "require_parquet",
    "run",
    "shard_cases",
    "summarise_sweep",
    "sweep",
    "sweep_shard",
    "work_folder",
]

_HOMES = {
    "hilc_cli.api.reproducing": (
        "Reproduction",
        "check_reproduction",
        "reproduce",
    ),
    "hilc_cli.api.checking": (
        "Check",
        "check",
    ),
    "hilc_cli.api.comparing": (
        "Comparison",
        "compare",
    ),
    "hilc_cli.api.comparing_laws": (
        "LawComparison",
        "Leaderboard",
        "check_leaderboard_output",
        "compare_laws",
        "load_leaderboard",
    ),
    "hilc_cli.api.leaderboard_folders": (
        "is_leaderboard",
        "plot_leaderboard",
        "read_leaderboard",
    ),
    "hilc_cli.api.running": (
        "Run",
        "RunData",
        "RunSource",
        "Scenario",
        "ScenarioSource",
        "Summary",
        "as_runs",
        "check_folder",
        "forewarnings",
        "load_scenario",
        "plot",
        "read_run",
        "run",
    ),
    "hilc_cli.api.sweep_folders": (
        "check_sweep_output",
        "discard_work",
        "is_complete",
        "is_resumable",
        "is_sweep",
        "plot_sweep",
        "read_sweep",
        "work_folder",
    ),
    "hilc_cli.api.sweep_results": ("Sweep",),
    "hilc_cli.api.sweeping": (
        "merge_shards",
        "plan_sweep",
        "sweep",
        "sweep_shard",
    ),
    "hilc_cli.paper.plan": (
        "ReproductionPlan",
        "plan_reproduction",
    ),
    "hilc_cli.results.leaderboard": ("LeaderboardData",),
    "hilc_cli.results.parquet": ("require_parquet",),
    "hilc_cli.results.sweep": ("SweepData",),
    "hilc_cli.results.sweep_summary": (
        "SweepSummary",
        "summarise_sweep",
    ),
    "hilc_cli.sweeping.chunks": ("Failure",),
    "hilc_cli.sweeping.compute": (
        "Execution",
        "compile_for",
    ),
    "hilc_cli.sweeping.crew": ("available_cores",),
    "hilc_cli.sweeping.estimate": (
        "Estimate",
        "estimate",
    ),
    "hilc_cli.sweeping.plan": ("Plan",),
    "hilc_cli.sweeping.shards": (
        "check_shardable",
        "shard_cases",
    ),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Loads what is asked for."""
    if name in _HOME_OF:
        return getattr(import_module(_HOME_OF[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted(__all__)
