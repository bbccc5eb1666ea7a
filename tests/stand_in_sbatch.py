"""Plays SLURM's ``sbatch`` for the recipes of docs/clusters.md: each task is run at once, in turn.

Knows what the recipes use: ``--array`` on the command line or in the script, ``--parsable``,
``--dependency=afterok:JOB``. Jobs are kept as a file each, with the exit codes of their tasks.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path


def numbers(array: str) -> list[int]:
    """The tasks of an array such as ``1-3,7``."""
    found: list[int] = []
    for part in array.split(","):
        first, _, last = part.partition("-")
        found += range(int(first), int(last or first) + 1)
    return found


def main(arguments: list[str]) -> int:
    *given, script = arguments
    text = Path(script).read_text(encoding="utf-8")
    words = [*re.findall(r"^#SBATCH (\S+)$", text, re.MULTILINE), *given]
    options = dict(word.removeprefix("--").partition("=")[::2] for word in words)
    if "dependency" in options:
        before = Path(f"job-{options['dependency'].removeprefix('afterok:')}")
        if set(before.read_text().split()) != {"0"}:
            return 0  # it waits for ever
    job = len(list(Path().glob("job-*"))) + 1
    tasks = numbers(options["array"]) if "array" in options else []
    codes = []
    # The last task is the first to be run: SLURM promises no order.
    for task in reversed(tasks or [0]):
        variables = {"SLURM_JOB_ID": str(job), "SLURM_CPUS_PER_TASK": options.get("cpus-per-task")}
        if tasks:
            variables |= {
                "SLURM_ARRAY_TASK_ID": str(task),
                "SLURM_ARRAY_TASK_COUNT": str(len(tasks)),
            }
        known = {name: value for name, value in variables.items() if value is not None}
        log = options["output"].replace("%x", options["job-name"]).replace("%a", str(task))
        with Path(log).open("wb") as output:
            done = subprocess.run(
                ["bash", script],  # as the first line of the script says
                env={**os.environ, **known},
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        codes.append(done.returncode)
    Path(f"job-{job}").write_text(" ".join(map(str, codes)), encoding="utf-8")
    print(job if "parsable" in options else f"Submitted batch job {job}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
