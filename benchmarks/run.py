"""What a run costs, beside a bare Python script that draws the same pictures.

Usage: python benchmarks/run.py [REPEATS]

Everything is measured in one go on one machine, each figure as the smallest of a few repeats; the
ratios carry over to other machines better than the seconds do.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import hilc_cli as hilc

SCENARIO = "example:fig3-circle"
BARE = Path(__file__).with_name("bare_drawing.py")


def smallest(action: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def command(*arguments: str, cwd: str) -> Callable[[], object]:
    def call() -> None:
        subprocess.run(arguments, cwd=cwd, check=True, stdout=subprocess.DEVNULL)

    return call


def peak_memory(*arguments: str, cwd: str) -> float:
    """Largest resident memory of one command [MB], measured in a child of its own."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        subprocess.run(arguments, cwd=cwd, check=True, stdout=subprocess.DEVNULL)
        kilobytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        os.write(writer, str(kilobytes).encode())
        os._exit(0)
    os.waitpid(child, 0)
    os.close(writer)
    with os.fdopen(reader) as pipe:
        return int(pipe.read()) / 1024


def save_arrays(run: hilc.Run, path: Path) -> None:
    trials = run.trials.values()
    np.savez(
        path,
        x=[trial.x for trial in trials],
        y=[trial.y for trial in trials],
        reference_x=run.reference.x,
        reference_y=run.reference.y,
        left=run.last.left,
        right=run.last.right,
        errors=[run.metrics[f"{kind}_position_error_m"] for kind in ("max", "mean", "rms")],
    )


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    scenario = hilc.load_scenario(SCENARIO)
    run = hilc.run(scenario)
    samples = len(run.metrics) * run.reference.samples
    python = sys.executable
    with tempfile.TemporaryDirectory() as folder:
        save_arrays(run, Path(folder) / "run.npz")
        hilc_run = [python, "-m", "hilc_cli", "run", SCENARIO, "-q"]
        bare = [python, str(BARE), "run.npz", "."]
        command(*hilc_run, cwd=folder)()  # font cache and bytecode
        command(*bare, cwd=folder)()
        rows = {
            "bare python -c pass": smallest(command(python, "-c", "pass", cwd=folder), repeats),
            "hilc --help": smallest(
                command(python, "-m", "hilc_cli", "--help", cwd=folder), repeats
            ),
            "simulation, 100 iterations x 2000 samples": smallest(
                lambda: hilc.run(scenario), repeats
            ),
            "bare script that draws the same": smallest(command(*bare, cwd=folder), repeats),
            "hilc run --no-plots": smallest(command(*hilc_run, "--no-plots", cwd=folder), repeats),
            "hilc run": smallest(command(*hilc_run, cwd=folder), repeats),
        }
        memory = {
            "bare script that draws the same": peak_memory(*bare, cwd=folder),
            "hilc run": peak_memory(*hilc_run, cwd=folder),
        }
    base = rows["bare script that draws the same"]
    print(f"{'':45}{'seconds':>9}{'ratio to bare script':>23}{'peak MB':>10}")
    for name, seconds in rows.items():
        megabytes = f"{memory[name]:10.0f}" if name in memory else ""
        print(f"{name:45}{seconds:9.3f}{seconds / base:23.2f}{megabytes}")
    simulation = rows["simulation, 100 iterations x 2000 samples"]
    print(f"\nsimulation: {simulation / samples * 1e6:.2f} microseconds a sample")


if __name__ == "__main__":
    main()
