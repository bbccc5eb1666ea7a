"""What is told of a run that its author probably did not mean: all warnings, from one place.

`forewarnings` are known before anything is simulated, `what_happened` shows in the results. A `Run`
keeps both, its manifest too; the summary, the terminal and ``--json`` take them from there.
"""

from __future__ import annotations

from hilc_cli.engine.experiment import Experiment
from hilc_cli.results.run import RunData
from hilc_cli.scenario.loading import ScenarioSource, as_scenario
from hilc_cli.theory.feasibility.feasibility import beyond_wheels
from hilc_cli.theory.noise.wheels import seen_in, seen_warnings


def forewarnings(scenario: ScenarioSource) -> list[str]:
    """What is legal but probably not meant, and what no law can do, to be told before a run."""
    scenario = as_scenario(scenario)
    return [*scenario.warnings(), *beyond_wheels(scenario.feasibility())]


def what_happened(run: RunData, experiment: Experiment) -> list[str]:
    """What only a simulation shows, to be told after a run.

    Args:
        run: The results, with at least one completed iteration.
        experiment: What was simulated.
    """
    return seen_warnings(seen_in(run.last, experiment))
