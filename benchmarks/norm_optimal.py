"""What norm-optimal learning reaches on the paper's trajectories, and what it costs.

Usage: python benchmarks/norm_optimal.py [--iterations N] [--picture FILE]

Four trajectories, without and with the paper's initial errors, three beliefs of the platform, and
the paper's speed limit. Errors are of the position: over the whole path without initial error, over
its second half with one. The earliest sample is the first whose pose the platform can have at all.
"""

import argparse
import math
import time
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib as mpl
import numpy as np

import hilc_cli as hilc
from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.law import Iteration
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner, OptimalPlan
from hilc_cli.laws.norm_optimal.optimal_motion import Model
from hilc_cli.laws.norm_optimal.rectified import trajectory_inputs
from hilc_cli.plants.kinematic import Robot, euler_step, limit_wheel_speeds, step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.reach import earliest_merge

LIMIT = 180.0
SCENARIOS = {
    "circle": ("fig3-circle", "fig4-compensated"),
    "arc-and-line": ("fig3-arc-and-line", "fig5-arc-and-line"),
    "cardioid": ("fig3-cardioid", "fig5-cardioid"),
    "spiral": ("fig3-spiral", "fig5-spiral"),
}
BELIEFS = {"exact": (1.0, 1.0), "R x 0.7, B x 1.3": (0.7, 1.3), "R x 1.3, B x 0.7": (1.3, 0.7)}
_BELIEVED = Robot(1.0, 1.0)  # in the place of each experiment's
SETTINGS = {
    "default": NormOptimalLaw(_BELIEVED),
    "feedback: none": NormOptimalLaw(_BELIEVED, feedback="none"),
    "identify: false": NormOptimalLaw(_BELIEVED, identify=False),
    "identify: false, feedback: none": NormOptimalLaw(_BELIEVED, identify=False, feedback="none"),
}
NOISES = {
    "output 10 mm, 10 mrad": (0.0, 1e-2),
    "state 1 mm, 1 mrad": (1e-3, 0.0),
    "both": (1e-3, 1e-2),
}


@dataclass(frozen=True)
class Result:
    """Of one experiment.

    Attributes:
        errors: What the module's text says, of each iteration [m].
        fastest: Fastest wheel of all iterations [rad/s].
        seconds: What the law took in all iterations.
        merged: Where the rectified reference met the trajectory in the last iteration.
        poses: Of the last iteration, shape (n + 1, 3).
    """

    errors: list[float]
    fastest: float
    seconds: float
    merged: int | None
    poses: Floats


def learn(
    experiment: Experiment,
    law: NormOptimalLaw,
    shares: tuple[float, float],
    disturbance: Disturbance,
    iterations: int,
) -> Result:
    """Iteration 0 at rest, then so many learned ones."""
    reference, robot = experiment.reference, experiment.robot
    model = Robot(robot.wheel_radius * shares[0], robot.half_track * shares[1])
    learner = NormOptimalLearner(replace(law, model=model), reference, LIMIT)
    target = np.stack([reference.x, reference.y, reference.heading], axis=1)
    off = np.abs(target[0] - experiment.initial_pose).max() > 0
    first = reference.samples // 2 if off else 0
    errors, fastest, seconds = [], 0.0, 0.0
    plan: OptimalPlan | None = None
    for iteration in range(iterations + 1):
        poses, measured, applied = run(experiment, plan, disturbance, iteration)
        errors.append(float(np.hypot(*(poses - target)[first:, :2].T).max()))
        fastest = max(fastest, float(np.abs(applied).max()))
        if iteration < iterations:
            start = time.perf_counter()
            learner.learn(Iteration(*applied.T, *(target - measured).T))
            plan = learner.plan()
            seconds += time.perf_counter() - start
    return Result(errors, fastest, seconds, None if plan is None else plan.merge_sample, poses)


def run(
    experiment: Experiment, plan: OptimalPlan | None, disturbance: Disturbance, iteration: int
) -> tuple[Floats, Floats, Floats]:
    """True poses, measured poses and wheel speeds of one iteration."""
    n = experiment.reference.samples
    gains = step_gains(
        experiment.robot.wheel_radius,
        experiment.robot.signed_half_track,
        experiment.reference.sample_time,
    )
    drawn = disturbance.of_output(iteration, n + 1), disturbance.of_state(iteration, n)
    alpha = np.zeros((n + 1, 3)) if drawn[0] is None else drawn[0]
    beta = np.zeros((n, 3)) if drawn[1] is None else drawn[1]
    poses, applied = np.empty((n + 1, 3)), np.zeros((n, 2))
    poses[0] = experiment.initial_pose
    for k in range(n):
        x, y, heading = poses[k].tolist()
        if plan is not None:
            error = plan.poses[k] - poses[k] - alpha[k]
            left, right = ([plan.left[k], plan.right[k]] + plan.feedback[k] @ error).tolist()
            applied[k] = limit_wheel_speeds(left, right, LIMIT)
        left, right = applied[k].tolist()
        cos, sin = math.cos(heading), math.sin(heading)
        poses[k + 1] = euler_step(x, y, heading, cos, sin, left, right, *gains) + beta[k]
    return poses, poses + alpha, applied


def cases(law: NormOptimalLaw, iterations: int) -> list[str]:
    """A row of the table for each case."""
    rows = []
    for name, scenarios in SCENARIOS.items():
        for scenario, wrong in zip(scenarios, (False, True), strict=True):
            experiment = hilc.load_scenario(f"example:{scenario}").experiment()
            for belief, shares in BELIEFS.items():
                result = learn(experiment, law, shares, Disturbance(), iterations)
                shown = [result.errors[i] for i in (1, 2, 5, 10) if i <= iterations]
                numbers = " | ".join(f"{1000 * error:.3g}" for error in shown)
                rows.append(
                    f"| {name} | {'wrong' if wrong else 'right'} | {belief} | {numbers} "
                    f"| {result.merged} | {result.fastest:.1f} | {result.seconds:.2f} |"
                )
    return rows


def noisy(iterations: int = 100) -> list[str]:
    """A row of the table for each trajectory and noise."""
    rows = []
    for name, (_, scenario) in SCENARIOS.items():
        experiment = hilc.load_scenario(f"example:{scenario}").experiment()
        for noise, (state, output) in NOISES.items():
            disturbance = Disturbance(1, Bounded((state,) * 3), Bounded((output,) * 3))
            shares = BELIEFS["R x 0.7, B x 1.3"]
            result = learn(experiment, SETTINGS["default"], shares, disturbance, iterations)
            late = [1000 * error for error in result.errors[3:]]
            rows.append(f"| {name} | {noise} | {np.mean(late):.1f} | {max(late):.1f} |")
    return rows


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
            law = replace(SETTINGS["default"], h=h)
            result = learn(experiment, law, (1.0, 1.0), Disturbance(), 1)
            x, y, _ = result.poses[:260].T
            axis.plot(x, y, style, color={100: "#d55e00", 200: "#0072b2"}[h], label=f"h = {h}")
        target = np.stack([reference.x, reference.y, reference.heading], axis=1)
        start = np.array(experiment.initial_pose)
        robot = experiment.robot
        earliest = earliest_merge(
            target, start, robot.wheel_radius * LIMIT, robot.half_track, reference.sample_time
        )
        assert earliest is not None
        axis.plot(*target[earliest, :2], "k|", ms=14, mew=2, label="earliest that the limit allows")
        axis.plot(*start[:2], "ko", ms=6, label="start")
        axis.set(title=name, xlabel="x [m]", aspect="equal")
    axes[0].set_ylabel("y [m]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.savefig(path, dpi=100)


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--iterations", type=int, default=10)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    if arguments.picture is not None:
        draw(arguments.picture)
        return
    for name, (_, scenario) in SCENARIOS.items():
        experiment = hilc.load_scenario(f"example:{scenario}").experiment()
        reference, robot = experiment.reference, experiment.robot
        target = np.stack([reference.x, reference.y, reference.heading], axis=1)
        earliest = earliest_merge(
            target,
            np.array(experiment.initial_pose),
            robot.wheel_radius * LIMIT,
            robot.half_track,
            reference.sample_time,
        )
        gains = step_gains(robot.wheel_radius, robot.signed_half_track, reference.sample_time)
        model = Model(*gains, np.zeros((reference.samples, 3)), LIMIT)
        demand = np.abs(trajectory_inputs(target, model)).max()
        print(
            f"{name}: the trajectory asks for {demand:.1f} rad/s; the limit allows to be on it "
            f"from sample {earliest} on"
        )
    for title, law in SETTINGS.items():
        print(f"\n{title}: trajectory, start, belief, error [mm] after 1, 2, 5, 10 iterations,")
        print("merge sample, fastest wheel [rad/s], time of the law [s]")
        print("\n".join(cases(law, arguments.iterations)), flush=True)
    print(
        "\nnoise, R x 0.7 and B x 1.3, wrong start: error [mm], mean and worst of iterations 3..100"
    )
    print("\n".join(noisy()))


if __name__ == "__main__":
    main()
