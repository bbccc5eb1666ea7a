"""The public names and where each lives; `hilc_cli/__init__.py` reads them from here."""

from hilc_cli.checks.checking import (
    Check as Check,
)
from hilc_cli.checks.checking import (
    check as check,
)
from hilc_cli.comparisons.comparing import (
    Comparison as Comparison,
)
from hilc_cli.comparisons.comparing import (
    compare as compare,
)
from hilc_cli.engine.learning import Learning as Learning
from hilc_cli.errors import HilcError as HilcError
from hilc_cli.laws.law import Plan as Plan
from hilc_cli.leaderboards.comparing import (
    LawComparison as LawComparison,
)
from hilc_cli.leaderboards.comparing import (
    Leaderboard as Leaderboard,
)
from hilc_cli.leaderboards.comparing import (
    compare_laws as compare_laws,
)
from hilc_cli.leaderboards.comparing import (
    load_leaderboard as load_leaderboard,
)
from hilc_cli.leaderboards.comparing import (
    plot_leaderboard as plot_leaderboard,
)
from hilc_cli.leaderboards.comparing import (
    read_leaderboard as read_leaderboard,
)
from hilc_cli.leaderboards.contests import LeaderboardData as LeaderboardData
from hilc_cli.paper.plan import (
    ReproductionPlan as ReproductionPlan,
)
from hilc_cli.paper.plan import (
    plan_reproduction as plan_reproduction,
)
from hilc_cli.paper.reproducing import (
    Reproduction as Reproduction,
)
from hilc_cli.paper.reproducing import (
    reproduce as reproduce,
)
from hilc_cli.results.trial import Trial as Trial
from hilc_cli.runs.running import (
    Run as Run,
)
from hilc_cli.runs.running import (
    RunData as RunData,
)
from hilc_cli.runs.running import (
    Scenario as Scenario,
)
from hilc_cli.runs.running import (
    Summary as Summary,
)
from hilc_cli.runs.running import (
    check_folder as check_folder,
)
from hilc_cli.runs.running import (
    load_scenario as load_scenario,
)
from hilc_cli.runs.running import (
    plot as plot,
)
from hilc_cli.runs.running import (
    read_run as read_run,
)
from hilc_cli.runs.running import (
    run as run,
)
from hilc_cli.sweeps.compute import Execution as Execution
from hilc_cli.sweeps.data import SweepData as SweepData
from hilc_cli.sweeps.folders import (
    plot_sweep as plot_sweep,
)
from hilc_cli.sweeps.folders import (
    read_sweep as read_sweep,
)
from hilc_cli.sweeps.sweeping import Sweep as Sweep
from hilc_cli.sweeps.sweeping import (
    merge_shards as merge_shards,
)
from hilc_cli.sweeps.sweeping import (
    plan_sweep as plan_sweep,
)
from hilc_cli.sweeps.sweeping import (
    sweep as sweep,
)
from hilc_cli.sweeps.sweeping import (
    sweep_shard as sweep_shard,
)
from hilc_cli.version import __version__ as __version__
