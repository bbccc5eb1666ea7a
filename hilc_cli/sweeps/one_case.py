"""A case of a sweep as a scenario of its own: the best one as a file, any one to be run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.results.folder import SCENARIO
from hilc_cli.results.reading import damaged
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.changes import TRAJECTORY
from hilc_cli.sweeps.choices import best_case, choices_of
from hilc_cli.sweeps.data import BEST, SweepData
from hilc_cli.sweeps.sweep_folder import read_sweep
from hilc_cli.variation import Value
from hilc_cli.wording import listed
from hilc_cli.yaml_input.nodes import MapNode, Place, Source, from_data, to_data
from hilc_cli.yaml_input.reading import Inputs, apply_override
from hilc_cli.yaml_input.tree import parse_yaml, to_yaml

_LONGEST_NAME = 100


def load_case(
    folder: str | Path, case: int | None, overrides: Sequence[str] = (), *, trust: bool = False
) -> Scenario:
    """The scenario of a case in the folder of a sweep, for `run`.

    It is read like any other scenario: whoever has made the folder, no code comes with it.

    Args:
        folder: Of the sweep.
        case: Its number; None for the best one.
        overrides: Texts ``KEY=VALUE`` as on the command line, put in after its values.
        trust: As for `load_scenario`.

    Raises:
        UsageError: It is no such folder, or has no such case.
        HilcError: As for `load_scenario`.
    """
    if case is not None and (isinstance(case, bool) or not isinstance(case, int)):
        raise UsageError(f"a case must be a whole number, or None for the best one, got {case!r}")
    data = read_sweep(folder)
    number = best_case(data) if case is None else case
    if number is None:
        none = f"no choice has a value of {data.robust}" if data.over else "no case has a value of"
        raise UsageError(f"{folder}: {none} {data.metric}, so there is no best one")
    if not 0 <= number < len(data):
        raise UsageError(
            f"--case {number}: {folder} has no such case; give a number from 0 to {len(data) - 1}"
        )
    file = Path(folder) / SCENARIO
    ending = f"-case-{number}" if case is not None else "-best"
    changes: list[tuple[str, object]] = [("sweep", None), ("name", _named(data.name, ending))]
    values: dict[str, Any] = data.case(number)
    if TRAJECTORY in values:
        values[TRAJECTORY] = _trajectory(to_data(Inputs().tree(file)), values[TRAJECTORY], file)
    in_order = sorted(values.items(), key=lambda item: item[0] != TRAJECTORY)
    return load_scenario(file, [*changes, *in_order, *overrides], trust=trust)


def best_yaml(sweep: SweepData, resolved: Mapping[str, Any]) -> str | None:
    """The scenario of the best case as a file, if any case has the metric.

    Args:
        sweep: The results.
        resolved: Its scenario with the section ``sweep``, as `Plan.resolved` gives it.
    """
    case = best_case(sweep)
    if case is None:
        return None
    title = _title_of_choice(sweep, case) if sweep.over else _title(sweep, case)
    return f"{title}{to_yaml(_with_values(resolved, sweep.case(case), sweep.name))}"


def read_resolved(text: str, file: Path) -> dict[str, Any]:
    """The scenario of a sweep from what `Plan.resolved_yaml` has written.

    Args:
        text: What stands in the file.
        file: Which.

    Raises:
        InvalidInputError: It is no YAML.
    """
    found = to_data(parse_yaml(text.encode(), Source(str(file), file.parent)))
    return found if isinstance(found, dict) else {}


def _with_values(
    resolved: Mapping[str, Any], values: Mapping[str, Value], name: str
) -> dict[str, Any]:
    """The scenario without its sweep, with the values of a case in their places."""
    place = Place(Source(BEST, Path(), has_lines=False))
    data = {key: part for key, part in resolved.items() if key != "sweep"}
    data["name"] = _named(name, "-best")
    if TRAJECTORY in values:
        data[TRAJECTORY] = _trajectory(resolved, values[TRAJECTORY], Path(SCENARIO))
    tree = from_data(data, place)
    assert isinstance(tree, MapNode)  # of a mapping
    for key, value in values.items():
        if key != TRAJECTORY:
            keys = tuple(key.split("."))
            tree = apply_override(tree, keys, from_data(value, place), lambda same: same)
    found = to_data(tree)
    assert isinstance(found, dict)  # of a mapping
    return found


def _trajectory(resolved: Any, name: Value, file: Path) -> Any:
    """The trajectory of a name among those that are varied.

    Raises:
        UsageError: The file, which may come from anybody, has no such trajectory.
    """
    try:
        paths = resolved["sweep"]["vary"][TRAJECTORY]
        return next(path for path in paths if path["name"] == name)
    except (TypeError, KeyError, StopIteration):
        raise damaged(file, "it lacks a trajectory of the cases") from None


def _named(name: str, ending: str) -> str:
    return name[: _LONGEST_NAME - len(ending)] + ending


def _title(sweep: SweepData, case: int) -> str:
    """What a case is the best of, as comments."""
    metric = float(sweep.columns[sweep.metric][case])
    what = "sweep" if sweep.as_it_is is None else "search"
    title = f"# Case {case} of a {what} with hilc sweep, the best of {len(sweep)}: "
    title += f"{sweep.metric} {metric!r}\n"
    return title + _no_better(sweep, metric)


def _title_of_choice(sweep: SweepData, case: int) -> str:
    """The same of a choice, and what has happened in the case that stands for it."""
    table = choices_of(sweep)
    choice = int(table.choice_of[case])
    figure = float(table.figures[table.robust][choice])
    what = "sweep" if sweep.as_it_is is None else "search"
    title = (
        f"# Choice {choice} of a {what} with hilc sweep, the best of {len(table)}: {table.robust} "
    )
    title += f"{sweep.metric} {figure!r} over {listed(sweep.over)}\n"
    own = "its worst case" if case == table.worst_case[choice] else "the case nearest to that"
    title += f"# These are as in case {case}, {own}: {sweep.metric} "
    title += f"{float(sweep.columns[sweep.metric][case])!r}\n"
    return title + _no_better(sweep, figure)


def _no_better(sweep: SweepData, metric: float) -> str:
    as_it_is = sweep.as_it_is
    if as_it_is is None or not metric >= as_it_is.metric:
        return ""
    return f"# No better than the scenario as it is, which has {as_it_is.metric!r}.\n"
