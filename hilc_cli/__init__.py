"""Iterative learning control for differential-drive robots.

The Python interface in short::

    import hilc_cli as hilc

    scenario = hilc.load_scenario("scenarios/fig3-circle.yaml", overrides={"iterations": 20})
    result = hilc.run(scenario)
    print(result.metrics["max_position_error_m"])
    result.write("runs/circle")

    plan = hilc.plan_sweep(scenario, {"controller.gains.l1": "0.1:10:40:log"})
    print(hilc.sweep(plan).columns["max_position_error_m"])

    hilc.reproduce(hilc.plan_reproduction(["fig3"])).write("runs/fig3-of-the-paper")
"""

from typing import TYPE_CHECKING, Any

from hilc_cli.version import __version__

if TYPE_CHECKING:
    from hilc_cli.api import (
        Check,
        Comparison,
        Execution,
        LawComparison,
        Leaderboard,
        LeaderboardData,
        Reproduction,
        ReproductionPlan,
        Run,
        RunData,
        Scenario,
        Summary,
        Sweep,
        SweepData,
        check,
        check_folder,
        compare,
        compare_laws,
        load_leaderboard,
        load_scenario,
        merge_shards,
        plan_reproduction,
        plan_sweep,
        plot,
        plot_leaderboard,
        plot_sweep,
        read_leaderboard,
        read_run,
        read_sweep,
        reproduce,
        run,
        sweep,
        sweep_shard,
    )
    from hilc_cli.errors import HilcError

__all__ = [
    "Check",
    "Comparison",
    "Execution",
    "HilcError",
    "LawComparison",
    "Leaderboard",
    "LeaderboardData",
    "Reproduction",
    "ReproductionPlan",
    "Run",
    "RunData",
    "Scenario",
    "Summary",
    "Sweep",
    "SweepData",
    "__version__",
    "check",
    "check_folder",
    "compare",
    "compare_laws",
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
    "run",
    "sweep",
    "sweep_shard",
]


def __getattr__(name: str) -> Any:
    """Loads the interface when it is first used: ``hilc --help`` needs none of it."""
    if name == "HilcError":  # which who catches it needs before any other
        from hilc_cli.errors import HilcError

        return HilcError
    if name in __all__:
        from hilc_cli import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted(__all__)
