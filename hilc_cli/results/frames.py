"""Tables of results as data frames of pandas: the columns of the CSV files, numbers as they are.

Nothing here loads pandas before a data frame is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.errors import needed
from hilc_cli.names import named
from hilc_cli.results.metrics import METRICS
from hilc_cli.results.tables import (
    GRAVITY_CENTER_HEADER,
    INPUT_HEADER,
    ITERATIONS_HEADER,
    PLAN_HEADER,
    SAMPLES_HEADER,
)

if TYPE_CHECKING:
    from pandas import DataFrame

    from hilc_cli.laws.law import Plan
    from hilc_cli.reference.sampled import Floats
    from hilc_cli.results.run import RunData

Columns = Mapping[str, NDArray[Any] | Sequence[object]]
"""A table by its columns, all of one length."""

Tables = Mapping[str, Callable[[], Columns]]
"""What makes each table of a result, by the name of its CSV file without the ending."""


def frame(tables: Tables, name: str) -> DataFrame:
    """One of several tables as a data frame.

    Args:
        tables: Those that there are.
        name: Which.

    Raises:
        UnknownNameError: There is no such table; names those that there are.
        MissingPackageError: pandas is not installed.
    """
    make = named("table", tables)[name]  # what is misspelt is told whether there is pandas or not
    found: DataFrame = needed("to_pandas()", "pandas", "notebooks").DataFrame(dict(make()))
    return found


def whole_where_known(column: Floats) -> NDArray[Any]:
    """A column of counts as whole numbers; as it is if one of them is missing."""
    return column.astype(np.int64) if np.isfinite(column).all() else column


def run_tables(run: RunData) -> Tables:
    """The tables of a run that there are, as in its folder."""
    tables: dict[str, Callable[[], Columns]] = {
        "iterations": lambda: _iterations(run),
        "samples": lambda: _samples(run),
        "input": lambda: _input(run),
        "gravity-center": lambda: _gravity_center(run),
    }
    plan = run.plan
    if plan is not None:
        tables["plan"] = lambda: _plan(run, plan)
    if run.learning.names:
        learning = run.learning
        tables["learning"] = lambda: {
            "iteration": np.arange(len(learning)),
            **{name: learning[name] for name in learning.names},
        }
    return tables


def _named(header: Sequence[str], columns: Sequence[NDArray[Any]]) -> Columns:
    return dict(zip(header, columns, strict=True))


def _iterations(run: RunData) -> Columns:
    metrics = run.metrics
    columns = [
        whole_where_known(metrics[name]) if metric.whole else metrics[name]
        for name, metric in METRICS.items()
    ]
    return _named(ITERATIONS_HEADER, [np.arange(len(metrics)), *columns])


def _samples(run: RunData) -> Columns:
    reference, trials = run.reference, list(run.trials.values())
    count = len(reference.times)
    asked = (reference.x, reference.y, reference.heading)
    moved = [(trial.x, trial.y, trial.heading) for trial in trials]
    desired = [np.tile(values, len(trials)) for values in asked]
    driven = [np.concatenate(poses) for poses in zip(*moved, strict=True)]
    columns = [
        np.repeat([trial.iteration for trial in trials], count),
        np.tile(np.arange(count), len(trials)),
        np.tile(reference.times, len(trials)),
        *desired,
        *driven,
        *(wanted - found for wanted, found in zip(desired, driven, strict=True)),
        # No wheel speeds belong to the last sample.
        np.concatenate([np.append(trial.left, np.nan) for trial in trials]),
        np.concatenate([np.append(trial.right, np.nan) for trial in trials]),
    ]
    return _named(SAMPLES_HEADER, columns)


def _input(run: RunData) -> Columns:
    left, right = run.learned_input
    samples = np.arange(len(left))
    return _named(INPUT_HEADER, [samples, samples * run.reference.sample_time, left, right])


def _plan(run: RunData, plan: Plan) -> Columns:
    plan = plan.shortest
    samples = np.arange(len(plan.poses)) - plan.lead_in
    wheels = [np.append(speeds, np.nan) for speeds in (plan.left, plan.right)]
    times = samples * run.reference.sample_time
    return _named(PLAN_HEADER, [samples, times, *wheels, *plan.poses.T])


def _gravity_center(run: RunData) -> Columns:
    count = len(run.reference.times)
    paths = [run.gravity_center_path(number) for number in run.trials]
    columns = [
        np.repeat(list(run.trials), count),
        np.tile(np.arange(count), len(paths)),
        np.tile(run.reference.times, len(paths)),
        *(np.concatenate(values) for values in zip(*paths, strict=True)),
    ]
    return _named(GRAVITY_CENTER_HEADER, columns)
