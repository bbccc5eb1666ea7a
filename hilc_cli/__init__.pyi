"""The public names and where each lives; `hilc_cli/__init__.py` reads them from here."""

from hilc_cli.checks.checking import (
    Check as Check,
    check as check,
)
from hilc_cli.comparisons.comparing import (
    Comparison as Comparison,
    compare as compare,
)
from hilc_cli.drawing.looks import picture_look as picture_look
from hilc_cli.engine.experiment import Learning as Learning
from hilc_cli.errors import HilcError as HilcError
from hilc_cli.exports.exporting import export as export
from hilc_cli.html_reports.report import report as report
from hilc_cli.identification.identifying import (
    Identification as Identification,
    identify as identify,
)
from hilc_cli.labs.lab import Lab as Lab
from hilc_cli.laws.law import Plan as Plan
from hilc_cli.leaderboards.comparing import (
    LawComparison as LawComparison,
    compare_laws as compare_laws,
    plot_leaderboard as plot_leaderboard,
)
from hilc_cli.leaderboards.entries import LeaderboardData as LeaderboardData
from hilc_cli.leaderboards.folder import read_leaderboard as read_leaderboard
from hilc_cli.leaderboards.plan import (
    Leaderboard as Leaderboard,
    load_leaderboard as load_leaderboard,
)
from hilc_cli.logs.log import Log as Log
from hilc_cli.logs.options import ReadOptions as ReadOptions
from hilc_cli.logs.reading import read_log as read_log
from hilc_cli.own_robots.writing import write_own_robot as write_own_robot
from hilc_cli.paper.plan import (
    ReproductionPlan as ReproductionPlan,
    plan_reproduction as plan_reproduction,
)
from hilc_cli.paper.reproducing import (
    Reproduction as Reproduction,
    reproduce as reproduce,
)
from hilc_cli.paths.showing import (
    ShownPath as ShownPath,
    show as show,
)
from hilc_cli.results.look import Look as Look
from hilc_cli.results.trial import Trial as Trial
from hilc_cli.runs.running import (
    Run as Run,
    RunData as RunData,
    Scenario as Scenario,
    Summary as Summary,
    check_folder as check_folder,
    load_scenario as load_scenario,
    plot as plot,
    read_run as read_run,
    run as run,
)
from hilc_cli.sweeps.choices import (
    ChoiceTable as ChoiceTable,
    choices_of as choices_of,
)
from hilc_cli.sweeps.compute import Execution as Execution
from hilc_cli.sweeps.data import SweepData as SweepData
from hilc_cli.sweeps.one_case import load_case as load_case
from hilc_cli.sweeps.planning import plan_sweep as plan_sweep
from hilc_cli.sweeps.shards import (
    merge_shards as merge_shards,
    sweep_shard as sweep_shard,
)
from hilc_cli.sweeps.sweep_folder import (
    plot_sweep as plot_sweep,
    read_sweep as read_sweep,
)
from hilc_cli.sweeps.sweeping import (
    Sweep as Sweep,
    sweep as sweep,
)
from hilc_cli.version import __version__ as __version__

_HOMES: dict[str, str]
