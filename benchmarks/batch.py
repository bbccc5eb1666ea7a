"""Time a sample of the engines beside a scalar C program that does the same.

Usage: python benchmarks/batch.py [REPEATS]

All on one core, in one go; the last column is what carries over to other machines. Needs the extra
``batch`` and a C compiler.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import hilc_cli as hilc
from hilc_cli.engine.batch import simulate_batch
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes import LANES
from hilc_cli.laws.hybrid import HybridLaw

GAINS = (0.1, 0.25, 0.25)
SOURCE = Path(__file__).with_name("scalar.c")


def scalar_c(repeats: int) -> tuple[float, float]:
    """Nanoseconds a sample, and the maximum error of the last iteration."""
    with tempfile.TemporaryDirectory() as folder:
        program = str(Path(folder) / "scalar")
        build = ["cc", "-O3", "-march=native", str(SOURCE), "-o", program, "-lm"]
        subprocess.run(build, check=True)
        words = subprocess.run(
            [program, *map(str, GAINS), str(repeats)], check=True, capture_output=True, text=True
        ).stdout.split()
    return float(words[0]), float(words[1])


def nanoseconds(action: Callable[[], object], samples: int, repeats: int) -> float:
    action()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times) / samples * 1e9


def varied(experiment: Experiment, cases: int) -> list[Experiment]:
    law = experiment.law
    assert isinstance(law, HybridLaw)
    return [replace(experiment, law=replace(law, l1=law.l1 + 0.01 * i)) for i in range(cases)]


def main() -> None:
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    scenario = hilc.load_scenario("example:fig8a")
    compensated = hilc.load_scenario("example:fig4-compensated")
    noise = {"disturbance.state.bound": [1e-4] * 3, "disturbance.output.bound": [1e-3] * 3}
    noisy = hilc.load_scenario("example:fig8a", noise)
    samples = (scenario.spec.iterations + 1) * scenario.spec.trajectory.reference().samples
    packs = 2 * LANES

    base, last = scalar_c(repeats)
    found = hilc.run(scenario).metrics["max_position_error_m"][-1]
    print(f"maximum error of the last iteration: C {last:.12f} m, loop engine {found:.12f} m\n")
    rows = {
        "scalar C, cc -O3 -march=native": base,
        "loop engine": nanoseconds(lambda: hilc.run(scenario), samples, 2),
    }
    for name, which in {
        "batch engine, Eq. 17": scenario,
        "batch engine, Eq. 21": compensated,
        "batch engine, Eq. 17, all disturbances": noisy,
    }.items():
        cases = varied(which.experiment(), packs)
        few = 1 if which is noisy else repeats
        rows[name] = nanoseconds(lambda c=cases: simulate_batch(c), samples * packs, few)  # type: ignore[misc]
    print(f"{'':42}{'ns a sample':>12}{'times faster than C':>22}")
    for name, time_a_sample in rows.items():
        print(f"{name:42}{time_a_sample:12.2f}{base / time_a_sample:22.2f}")


if __name__ == "__main__":
    main()
