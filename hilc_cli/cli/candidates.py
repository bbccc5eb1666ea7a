"""What a shell may complete an argument or a value with."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from hilc_cli.cli.default_folders import RUNS
from hilc_cli.shipped_files import LEADERBOARDS, PREFIX, examples

_PLAIN = re.compile(r"[\w./:=+,@%~-]+")
"""What a shell takes for one word: a file may be called ``x;reboot``, by whoever has made it."""

_YAML = (".yaml", ".yml")
_WITHOUT_EFFECT = ("name", "description", "record.", "sweep", "trajectory.name")


def complete_scenario(incomplete: str) -> list[str]:
    """Example names and YAML files that a scenario argument may go on with."""
    names = [f"{PREFIX}{path.stem}" for path in examples()]
    return _begun([*names, *_files(incomplete)], incomplete)


def complete_leaderboard(incomplete: str) -> list[str]:
    """The same for a leaderboard."""
    names = [f"{PREFIX}{path.stem}" for path in examples(LEADERBOARDS)]
    return _begun([*names, *_files(incomplete)], incomplete)


def complete_key(incomplete: str) -> list[str]:
    """Keys of a scenario with their equals sign, those of all laws."""
    from hilc_cli.spec.keys import scenario_keys  # Pydantic models start slowly

    return _begun([f"{key}=" for key in scenario_keys()], incomplete)


def complete_varied_key(incomplete: str) -> list[str]:
    """The same without those that nothing depends on."""
    return [key for key in complete_key(incomplete) if not key.startswith(_WITHOUT_EFFECT)]


def complete_metric(incomplete: str) -> list[str]:
    """Metrics of an iteration."""
    from hilc_cli.results.metrics import METRIC_NAMES

    return _begun(METRIC_NAMES, incomplete)


def complete_case_metric(incomplete: str) -> list[str]:
    """Metrics of a case of a sweep."""
    from hilc_cli.results.sweep import CASE_METRICS

    return _begun(CASE_METRICS, incomplete)


def complete_results(incomplete: str) -> list[str]:
    """Folders with results below runs/; where there are none, the shell goes on with files."""
    from hilc_cli.cli.newest_results import result_folders

    return _begun(sorted(str(place) for _, place in result_folders(RUNS)), incomplete)


def _begun(names: Iterable[str], incomplete: str) -> list[str]:
    return [name for name in names if name.startswith(incomplete) and _PLAIN.fullmatch(name)]


def _files(incomplete: str) -> list[str]:
    """Folders and YAML files."""
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    if not folder.is_dir():
        return []
    return [
        f"{path}/" if path.is_dir() else str(path)
        for path in sorted(folder.iterdir())
        if path.is_dir() or path.suffix in _YAML
    ]
