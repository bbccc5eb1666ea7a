"""What norm-optimal learning reaches on the paper's trajectories, and what it costs.

Usage: python benchmarks/norm_optimal.py [--iterations N] [--seeds N] [--picture FILE]
       python benchmarks/norm_optimal.py --cost [--beside FOLDER] [--iterations N] [--samples N ...]

Four trajectories, without and with the paper's initial errors, three beliefs of the platform, and
the paper's speed limit. Errors are of the position: over the whole path without initial error, over
its second half with one. The earliest sample is the first whose pose the platform can have at all.

With --cost: processor time for each sample and pass, simulation included, of trajectories that are
sampled more and more finely, and of a plan alone; with --beside in turn from these sources and from
those in another folder, such as those of an older commit.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.reach import earliest_merge

LIMIT = 180.0
SCENARIOS = {
    "circle": ("fig3-circle", "fig4-compensated"),
    "arc-and-line": ("fig3-arc-and-line", "fig5-arc-and-line"),
    "cardioid": ("fig3-cardioid", "fig5-cardioid"),
    "spiral": ("fig3-spiral", "fig5-spiral"),
}
BELIEFS = {"exact": (1.0, 1.0), "R x 0.7, B x 1.3": (0.7, 1.3), "R x 1.3, B x 0.7": (1.3, 0.7)}
NOISES = {
    "output 10 mm, 10 mrad": {"output": {"bound": ["10 mm", "10 mm", 0.01]}},
    "state 1 mm, 1 mrad": {"state": {"bound": ["1 mm", "1 mm", 1e-3]}},
    "both": {
        "output": {"bound": ["10 mm", "10 mm", 0.01]},
        "state": {"bound": ["1 mm", "1 mm", 1e-3]},
    },
}


def learned(scenario: str, belief: str, iterations: int, **changes: Any) -> hilc.Run:
    """Iteration 0 at rest, then so many learned ones."""
    robot = hilc.load_scenario(f"example:{scenario}").experiment().robot
    radius, half_track = BELIEFS[belief]
    controller = {"law": "norm-optimal", "b_w": LIMIT, **changes.pop("controller", {})}
    given: Mapping[str, Any] = {
        "model": {
            "wheel_radius": radius * robot.wheel_radius,
            "half_track": half_track * robot.half_track,
        },
        "controller": controller,
        "initial_input": "zero",
        "initial_trial": "open-loop",
        "iterations": iterations,
        "record.iterations": [],
        **changes,
    }
    return hilc.run(hilc.load_scenario(f"example:{scenario}", given))


def earliest(experiment: Experiment) -> int | None:
    """The first sample whose pose the platform can have."""
    robot, reference = experiment.robot, experiment.reference
    start = np.array(experiment.initial_pose)
    reach = robot.wheel_radius * LIMIT
    return earliest_merge(reference.poses, start, reach, robot.half_track, reference.sample_time)


def cases(iterations: int, **changes: Any) -> None:
    """Prints a row of the table for each case."""
    for name, scenarios in SCENARIOS.items():
        for scenario, start in zip(scenarios, ("right", "wrong"), strict=True):
            for belief in BELIEFS:
                run = learned(scenario, belief, iterations, **changes)
                errors = 1000 * np.array(run.telling_errors_m)
                shown = [f"{errors[i]:.3g}" for i in (1, 2, 5, 10) if i <= iterations]
                merge, fastest = (
                    run.learning.last()["merge_time_s"],
                    max(run.metrics["max_wheel_speed_rad_s"]),
                )
                print(
                    f"| {name} | {start} | {belief} | {' | '.join(shown)} | {merge:g} "
                    f"| {fastest:.1f} | {run.timings['simulation']:.1f} |",
                    flush=True,
                )


def noisy(iterations: int, seeds: int) -> None:
    """Prints what noise leaves, and how often R and B are within three standard errors."""
    for name, (_, scenario) in SCENARIOS.items():
        for noise, disturbance in NOISES.items():
            left, off = [], []
            for seed in range(seeds):
                given = {"seed": seed, **disturbance}
                run = learned(scenario, "R x 0.7, B x 1.3", iterations, disturbance=given)
                left += (1000 * np.array(run.telling_errors_m)[3:]).tolist()
                told, robot = run.learning.last(), run.robot
                assert robot is not None
                off.append(
                    [
                        (told[f"model_{key}_m"] / true - 1)
                        * true
                        / told[f"model_{key}_standard_error_m"]
                        for key, true in (
                            ("wheel_radius", robot.wheel_radius),
                            ("half_track", robot.half_track),
                        )
                    ]
                )
            within = (np.abs(off) < 3).mean(axis=0)
            print(
                f"| {name} | {noise} | {np.mean(left):.1f} | {max(left):.1f} "
                f"| {within[0]:.0%}, {within[1]:.0%} |",
                flush=True,
            )


def draw(path: Path) -> None:
    """The way from the paper's initial errors into the trajectories."""
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    widths = {"width_ratios": [0.5, 1, 1, 1]}
    figure, axes = plt.subplots(1, 4, figsize=(11, 3.6), layout="constrained", gridspec_kw=widths)
    for axis, (name, (_, scenario)) in zip(axes, SCENARIOS.items(), strict=True):
        experiment = hilc.load_scenario(f"example:{scenario}").experiment()
        reference = experiment.reference
        axis.plot(reference.x[:260], reference.y[:260], color="0.6", lw=4, label="trajectory")
        for h, style in ((100, "--"), (200, "-")):
            run = learned(scenario, "exact", 3, controller={"h": h})
            x, y = run.last.x[:260], run.last.y[:260]
            axis.plot(x, y, style, color={100: "#d55e00", 200: "#0072b2"}[h], label=f"h = {h}")
        sample = earliest(experiment)
        assert sample is not None
        there = reference.poses[sample, :2]
        axis.plot(*there, "k|", ms=14, mew=2, label="earliest that the limit allows")
        axis.plot(*experiment.initial_pose[:2], "ko", ms=6, label="start")
        axis.set(title=name, xlabel="x [m]", aspect="equal")
    axes[0].set_ylabel("y [m]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.savefig(path, dpi=100)


COSTS: dict[str, tuple[str, dict[str, Any]]] = {
    "circle": ("fig3-circle", {}),
    "circle, both noises": ("fig3-circle", {"disturbance": {"seed": 1, **NOISES["both"]}}),
    "circle from the wrong start": ("fig4-compensated", {}),
    "circle, too fast for the wheels": ("fig3-circle", {"controller.b_w": 8.0}),
    "lap of a small robot, noises": ("small-robot", {}),
}
TIMED = """\
import json, sys, time
from hilc_cli.surroundings import settle
settle()
import hilc_cli as hilc
from hilc_cli.engine.loop import simulate
from hilc_cli.theory.laws.norm_optimal_noise import planned_motion
scenario, given, samples, iterations = json.loads(sys.argv[1])
given = {"controller.law": "norm-optimal", **given, "iterations": iterations}
if scenario.startswith("fig"):
    limit = given.pop("controller.b_w", 180)
    given["controller"] = {"law": given.pop("controller.law"), "b_w": limit}

def experiment(samples):
    reference = hilc.load_scenario(f"example:{scenario}", given).experiment().reference
    if samples is not None:
        given["controller"]["h"] = max(1, samples // 10)
        given["trajectory.sample_time"] = reference.samples * reference.sample_time / samples
    return hilc.load_scenario(f"example:{scenario}", given).experiment()

short = experiment(None if samples is None else 1_200)  # with 60, no limit would be in the way
planned_motion(short, short.law)  # loads all of its machine code
for _ in simulate(short):
    pass
measured = experiment(samples)
start = time.process_time()
planned_motion(measured, measured.law)
planned = time.process_time()
for _ in simulate(measured):
    pass
run, n = time.process_time() - planned, measured.reference.samples
print(json.dumps([1e6 * run / n / iterations, 1e6 * (planned - start) / n]))
"""
"""Prints microseconds for each sample and pass, and for each sample of the plan that
`hilc check` makes."""


def costs(folders: Sequence[Path], samples: Sequence[int], iterations: int) -> None:
    """Prints a row for each case and number of samples, of the fastest of three."""
    for name, (scenario, given) in COSTS.items():
        for n in samples if scenario.startswith("fig") else [None]:
            asked = json.dumps([scenario, given, n, iterations])
            found = [[(1e9, 1e9)] for _ in folders]
            for _ in range(3):
                for folder, times in zip(folders, found, strict=True):
                    code = f"import sys; sys.path.insert(0, {str(folder.resolve())!r})\n{TIMED}"
                    told = subprocess.run(
                        [sys.executable, "-c", code, asked],
                        check=True,
                        capture_output=True,
                        cwd=folder,
                    )
                    times.append(tuple(json.loads(told.stdout)))
            runs = [f"{min(run for run, _ in times):.1f}" for times in found]
            plans = [f"{min(plan for _, plan in times):.2f}" for times in found]
            print(f"| {name} | {n or ''} | {' | '.join(runs)} | {' | '.join(plans)} |", flush=True)


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--iterations", type=int, default=10)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--cost", action="store_true")
    parser.add_argument("--beside", type=Path)
    parser.add_argument("--samples", type=int, nargs="+", default=[1_200, 12_000, 120_000])
    given = parser.parse_args()
    if given.cost:
        here = Path(__file__).parents[1]
        folders = [here] if given.beside is None else [given.beside, here]
        print("case, samples, microseconds for each sample and pass, and for each sample of a plan")
        costs(folders, given.samples, given.iterations)
        return
    if given.picture is not None:
        draw(given.picture)
        return
    for name, (_, scenario) in SCENARIOS.items():
        found = earliest(hilc.load_scenario(f"example:{scenario}").experiment())
        print(f"{name}: the limit allows to be on it from sample {found} on")
    print("\ntrajectory, start, belief, error [mm] after 1, 2, 5, 10 iterations,")
    print("merge [s], fastest wheel [rad/s], time of the run [s]")
    cases(given.iterations)
    print(
        "\nnoise, R x 0.7 and B x 1.3, wrong start: error [mm], mean and worst of iterations from"
    )
    print("3 on; how often R and B are within three standard errors")
    noisy(given.iterations, given.seeds)


if __name__ == "__main__":
    main()
