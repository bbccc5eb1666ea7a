"""A seeded part of ``benchmarks/damaged_folders.py``: damage is one line, and no more happens."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from hilc_cli.errors import UsageError
from hilc_cli.sweeps.store import FolderStore

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "damaged_folders.py"
CASES = 12  # two of each kind of folder


def test_a_part_of_the_benchmark() -> None:
    # In a process of its own: what it forks is to be small, and no fixture is to get in between.
    command = [sys.executable, BENCHMARK, "--cases", CASES, "--first", 50_000, "--processes", 2]
    done = subprocess.run([*map(str, command)], capture_output=True, check=False, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert f"{CASES} of {CASES} cases" in done.stdout


def test_header_of_a_trillion_cases_is_refused_at_once(tmp_path: Path) -> None:
    header = {
        "kind": "hilc sweep in progress", "name": "x", "checksum": "", "first": 0, "last": 10**12,
        "shard": None, "iterations": 1, "bands": False, "axes": {"a": {"values": [1]}},
        "sample": "grid", "cases": 10**12, "seed": 0, "tolerance_m": None,
        "metric": "max_position_error_m", "minimise": None,
    }  # fmt: skip
    (tmp_path / "plan.json").write_text(json.dumps(header))
    with pytest.raises(UsageError, match=r"plan\.json: is damaged: last: should be less than"):
        FolderStore(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]
