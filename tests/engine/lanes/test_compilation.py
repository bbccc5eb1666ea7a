"""Whether machine code has to be compiled is known before it is."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hilc_cli.engine.lanes.batch import is_compiled, simulate_batch
from hilc_cli.runs.running import load_scenario
from tests.cli.processes import uncovered

PROGRAM = """
import sys
from hilc_cli.runs.running import load_scenario
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.engine.lanes.batch import is_compiled
experiments = [load_scenario("example:fig6a", {"iterations": 1}).experiment()]
before = [is_compiled(experiments), is_compiled(experiments)]
if sys.argv[1:]:
    simulate_batch(experiments)
print(*before, is_compiled(experiments))
"""


def answers(folder: Path, *arguments: str) -> str:
    environment = {**uncovered(dict(os.environ)), "NUMBA_CACHE_DIR": str(folder)}
    return subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()


@pytest.mark.slow
def test_code_in_the_cache_counts_as_compiled(tmp_path: Path) -> None:
    # To ask does not compile; what one process has compiled, the next one finds.
    assert answers(tmp_path, "run") == "False False True"
    assert answers(tmp_path) == "True True True"


def test_code_in_the_process_counts_as_compiled() -> None:
    experiments = [load_scenario("example:fig6a", {"iterations": 1}).experiment()]
    simulate_batch(experiments)
    assert is_compiled(experiments)
