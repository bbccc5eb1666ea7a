"""What norm-optimal learning does on robots as they are, of which it is told nothing.

    python benchmarks/robots.py [--passes 60] [--seeds 5] [--told] [--coverage SEEDS]

The robots move on an integrator of their own, which shares no code with hilc: a tenth of a sample
a step, exact arcs, commands that arrive when their delay is over. The believed wheel radius is 10 %
too small, the half track 10 % too large. The table has the largest error of the second half of the
path [mm], in the worst of the passes from 10 on and of all seeds, with feedback in the pass and
replayed. "Beyond feedback" counts the passes from 2 on in which it is worse than the law feedback,
which does not learn, would be in the same pass. With --told the model has the machine's own
numbers. --coverage has how often what three
passes identify is within three standard errors, or a misfit is told.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.laws.feedback import FeedbackController
from hilc_cli.laws.law import Figures
from hilc_cli.laws.norm_optimal.law import MISFITS, NormOptimalController
from hilc_cli.laws.parameters import Setting
from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.motor import Motor
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.scenario import DisturbanceSpec

Floats = NDArray[np.float64]
Answer = Callable[[int, Floats], tuple[float, float]]

UNLEARNED = FeedbackController(law="feedback", b_w=25.0)
RADIUS, HALF_TRACK, LIMIT = 0.1, 0.2, 25.0  # [m], [m], [rad/s]
STEPS = 10  # of the integrator in a sample


def _integrate(
    state: Floats,
    sent: Floats,
    k: int,
    sample_time: float,
    numbers: tuple[float, ...],
    grip: Floats,
    side_slip: float,
) -> None:
    """Moves a robot through one sample, a tenth of it a step.

    Args:
        state: Pose and wheel speeds, shape (5,); changed.
        sent: Commands so far [rad/s], shape (n, 2).
        k: The sample.
        sample_time: [s].
        numbers: Radii [m], delay [samples], lag [s], dead zone [rad/s], acceleration [rad/s^2].
        grip: Share of its way that each wheel keeps.
        side_slip: See `Machine`.
    """
    left, right, delay, lag, dead_zone, acceleration = numbers
    step = sample_time / STEPS
    kept = math.exp(-step / lag) if lag > 0 else 0.0
    for part in range(STEPS):
        # The command whose time has come in the middle of this step.
        arrived = math.floor((k * STEPS + part + 0.5) / STEPS - delay)
        ways = np.empty(2)
        for wheel in range(2):
            command = sent[arrived, wheel] if arrived >= 0 else 0.0
            command = math.copysign(max(abs(command) - dead_zone, 0.0), command)
            before = state[3 + wheel]
            after = command + (before - command) * kept
            angle = command * step + (before - command) * lag * (1 - kept)
            if abs(after - before) > acceleration * step:
                after = before + math.copysign(acceleration * step, after - before)
                angle = step * (before + after) / 2
            state[3 + wheel] = after
            ways[wheel] = angle * (left if wheel == 0 else right) * grip[wheel]
        turn = (ways[1] - ways[0]) / (2 * HALF_TRACK)
        chord = 2 * math.sin(turn / 2) / turn if turn != 0 else 1.0  # over the arc
        ahead = (ways[0] + ways[1]) / 2 * chord
        aside = (
            -side_slip * (ways[0] + ways[1]) / 2 * turn / step
        )  # outwards, to the right of a left turn
        cos, sin = math.cos(state[2] + turn / 2), math.sin(state[2] + turn / 2)
        state[0] += ahead * cos - aside * sin
        state[1] += ahead * sin + aside * cos
        state[2] += turn


integrate: Any = njit(_integrate)


@dataclass(frozen=True)
class Machine:
    """A robot; turning follows REP-103."""

    radii: tuple[float, float] = (RADIUS, RADIUS)  # [m]
    delay: float = 0.0  # [samples]
    lag: float = 0.0  # [s]
    dead_zone: float = 0.0  # [rad/s]
    acceleration: float = math.inf  # of a wheel [rad/s^2]
    slip: float = 0.0  # share
    side_slip: float = 0.0  # sideways speed outwards over speed times yaw rate [s]
    random_slip: float = 0.0  # standard deviation of the share, by sample and wheel
    quantum: tuple[float, float] = (0.0, 0.0)  # of the readings [m, rad]
    noise: float = 0.0  # standard deviation of the readings [m and rad]

    @property
    def is_random(self) -> bool:
        """Whether another seed makes another run."""
        return self.random_slip > 0 or self.noise > 0

    def drive(
        self, start: Floats, samples: int, sample_time: float, answer: Answer, seed: int
    ) -> tuple[Floats, Floats, Floats]:
        """Drives one pass.

        Returns:
            True poses and measured ones, shape (n + 1, 3), and the wheel speeds sent, (n, 2).
        """
        random = np.random.default_rng(seed)
        # Pose, wheel speeds, and the robot in numbers.
        state = np.array([*start.tolist(), 0.0, 0.0])
        numbers = (*self.radii, self.delay, self.lag, self.dead_zone, self.acceleration)
        true, measured = np.empty((samples + 1, 3)), np.empty((samples + 1, 3))
        sent = np.zeros((samples, 2))
        for k in range(samples + 1):
            true[k] = state[:3]
            measured[k] = self._reading(true[k], random)
            if k == samples:
                break
            sent[k] = np.clip(answer(k, measured[k]), -LIMIT, LIMIT)
            grip = np.full(2, 1 - self.slip)
            if self.random_slip > 0:
                grip += self.random_slip * random.normal(size=2)
            integrate(state, sent, k, sample_time, numbers, grip, self.side_slip)
        return true, measured, sent

    def _reading(self, pose: Floats, random: np.random.Generator) -> Floats:
        read = pose.copy()
        if self.quantum[0] > 0:
            quanta = np.array([self.quantum[0], self.quantum[0], self.quantum[1]])
            read = np.round(pose / quanta) * quanta
        if self.noise > 0:
            read += self.noise * random.normal(size=3)
        return read


MACHINES = {
    "as believed but for R and B": Machine(),
    "radii 2 % apart": Machine(radii=(0.101, 0.099)),
    "slip 5 % along": Machine(slip=0.05),
    "dead zone 1 rad/s": Machine(dead_zone=1.0),
    "pose quantised to 5 mm, 0.5 deg": Machine(quantum=(5e-3, math.radians(0.5))),
    "random slip 5 %": Machine(random_slip=0.05),
    "lag 50 ms": Machine(lag=0.05),
    "lag 150 ms": Machine(lag=0.15),
    "delay of 2 samples": Machine(delay=2),
    "delay of 5 samples": Machine(delay=5),
    "side slip of 20 ms": Machine(side_slip=0.02),
    "acceleration of 20 rad/s^2": Machine(acceleration=20.0),
    "2 % apart, lag, delay, slip, 2 mm noise": Machine(
        radii=(0.101, 0.099), lag=0.05, delay=2, slip=0.03, noise=2e-3
    ),
}


def ramp(time: Floats, duration: float, rise: float) -> Floats:
    """From 0 to 1 and back, with speed and acceleration 0 at both ends."""

    def up(share: Floats) -> Floats:
        share = share.clip(0, 1)
        return share**3 * (10 - 15 * share + 6 * share**2)

    return up(time / rise) * up((duration - time) / rise)


def path(
    name: str,
    curvature: Callable[[Floats], Floats],
    speed: float,
    duration: float,
    rise: float,
    sample_time: float,
) -> Reference:
    """A path from rest to rest, from its curvature [1/m] over the distance [m]."""
    finer = 50
    count = round(duration / sample_time) * finer + 1
    times = np.arange(count, dtype=np.float64) * (sample_time / finer)

    def integral(values: Floats, steps: Floats) -> Floats:
        return np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2 * steps)])

    distance = integral(speed * ramp(times, duration, rise), np.diff(times))
    steps = np.diff(distance)
    heading = integral(curvature(distance), steps)
    x, y = integral(np.cos(heading), steps), integral(np.sin(heading), steps)
    x, y, heading = (each[::finer].copy() for each in (x, y, heading))
    return Reference(name, sample_time, x, y, heading)


def chicane() -> Reference:
    """Bends of 0.4, 0.3, 0.3 and 0.4 m at 1 m/s, every 10 ms."""
    bends = ((0.7, 0.9, 2.5), (1.8, 1.0, -1 / 0.3), (2.9, 1.0, 1 / 0.3), (4.0, 0.9, -2.5))

    def curvature(distance: Floats) -> Floats:
        shares = [((distance - at) / (length / 2)).clip(-1, 1) for at, length, _ in bends]
        parts = zip(bends, shares, strict=True)
        return sum((bend * np.cos(math.pi * z / 2) ** 2 for (_, _, bend), z in parts), 0 * distance)

    return path("chicane", curvature, 1.0, 6.0, 1.0, 0.01)


def lap() -> Reference:
    """A lap of 6.25 m at 0.5 m/s, every 20 ms."""
    length = 0.5 * 12.5
    return path(
        "lap",
        lambda s: 2 * math.pi / length + 0.8 * np.sin(6 * math.pi * s / length),
        0.5, 14.0, 1.5, 0.02,
    )  # fmt: skip


def eight() -> Reference:
    """A figure of eight of 8.4 m at 0.3 m/s, every 50 ms."""
    return path("eight", lambda s: 2.2 * np.sin(2 * math.pi * s / 8.4), 0.3, 30.0, 2.0, 0.05)


PATHS = {"chicane": chicane, "lap": lap, "eight": eight}


def errors(
    machine: Machine,
    reference: Reference,
    controller: NormOptimalController | FeedbackController,
    passes: int,
    seed: int,
    *,
    told: bool = False,
) -> tuple[Floats, float, Figures]:
    """Largest error of the second half of each pass [mm], seconds of learning a pass, and figures.

    The figures are those of the last pass.
    """
    believed, drivetrain = Robot(0.9 * RADIUS, 1.1 * HALF_TRACK, "rep103"), None
    if told:
        believed = Robot(sum(machine.radii) / 2, HALF_TRACK, "rep103")
        motor = Motor(
            machine.delay * reference.sample_time, machine.lag, dead_zone=machine.dead_zone
        )
        drivetrain = Drivetrain(*machine.radii, motor, Slip(machine.slip))
    still = np.zeros(reference.samples)
    none = (0.0, 0.0, 0.0)
    setting = Setting(reference, believed, none, none, lead=0.5, drivetrain=drivetrain)
    learning = Learning(
        Experiment(
            reference=reference,
            plant=KinematicPlant(believed),  # not used: nothing is simulated here
            law=controller.law_on(setting),
            initial_pose=tuple(reference.poses[0].tolist()),
            initial_left=still,
            initial_right=still,
            learn_in_first=True,
            iterations=passes,
            speed_limit=LIMIT,
            disturbance=DisturbanceSpec().disturbance(),
        )
    )
    found, spent = [], 0.0
    half, poses = reference.samples // 2, reference.poses
    for number in range(passes + 1):
        began = time.perf_counter()
        control = learning.unlimited_plan().controller(reference)
        spent += time.perf_counter() - began

        def answer(k: int, measured: Floats) -> tuple[float, float]:
            error = poses[k] - measured
            heading = float(measured[2])
            return control(k, math.cos(heading), math.sin(heading), *error.tolist())  # noqa: B023

        true, measured, sent = machine.drive(
            reference.poses[0],
            reference.samples,
            reference.sample_time,
            answer,
            1000 * seed + number,
        )
        away = np.hypot(*(true - reference.poses)[half:, :2].T)
        found.append(1e3 * float(away.max()))
        began = time.perf_counter()
        figures = learning.learn(Trial(number, *measured.T.copy(), *sent.T.copy()))
        spent += time.perf_counter() - began
    return np.array(found), spent / (passes + 1), figures


def coverage(machine: Machine, reference: Reference, seeds: int) -> str:
    """How often figures are within three standard errors, and how often a misfit is told.

    With noise of 1 mm and 1 mrad, without which nothing would differ from seed to seed.
    """
    noisy = replace(machine, noise=max(machine.noise, 1e-3))
    radius = sum(machine.radii) / 2 * (1 - machine.slip)  # of wheels that go as far
    late = machine.delay * reference.sample_time + machine.lag
    true = {
        "wheel_radius{}_m": radius,
        "half_track{}_m": HALF_TRACK,
        "left_per_right_radius{}": machine.radii[0] / machine.radii[1],
        "delay_and_lag{}_s": late,
        "friction{}_rad_s": machine.dead_zone,
    }
    controller = NormOptimalController(law="norm-optimal", b_w=LIMIT)
    within, misfits = [], 0
    for seed in range(seeds):
        _, _, figures = errors(noisy, reference, controller, 2, seed)
        away = [
            (figures[f"model_{name.format('')}"] - value)
            / figures[f"model_{name.format('_standard_error')}"]
            for name, value in true.items()
        ]
        within.append([not abs(each) > 3 for each in away])
        misfits += any(figures[name] > 1 for name in MISFITS)
    shares = " | ".join(f"{share:.0%}" for share in np.mean(within, axis=0))
    return f"{shares} | {misfits / seeds:.0%}"


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--passes", type=int, default=60)
    options.add_argument("--seeds", type=int, default=5)
    options.add_argument("--paths", nargs="+", choices=list(PATHS), default=list(PATHS))
    options.add_argument("--machines", nargs="+", choices=list(MACHINES), default=list(MACHINES))
    options.add_argument("--told", action="store_true")
    options.add_argument("--coverage", type=int, metavar="SEEDS")
    given = options.parse_args()
    if given.coverage is not None:
        print("| path, robot | R | B | radii | delay and lag | friction | misfit told |")
        print("|---|---:|---:|---:|---:|---:|---:|")
        for name in given.paths:
            for what in given.machines:
                row = coverage(MACHINES[what], PATHS[name](), given.coverage)
                print(f"| {name}, {what} | {row} |", flush=True)
        return
    for name in given.paths:
        reference = PATHS[name]()
        print(f"\n{name}: {PATHS[name].__doc__}\n")
        print(
            "| robot | pass 2 | worst from 10 on | replayed, pass 2 | replayed, worst "
            "| beyond feedback | s a pass |"
        )
        print("|---|---:|---:|---:|---:|---:|---:|")
        for what in given.machines:
            machine, cells, spent = MACHINES[what], [], 0.0
            for feedback in ("regulator", "none"):
                controller = NormOptimalController(law="norm-optimal", feedback=feedback, b_w=LIMIT)
                runs = [
                    errors(machine, reference, controller, given.passes, seed, told=given.told)
                    for seed in range(given.seeds if machine.is_random else 1)
                ]
                all_runs = np.array([run for run, _, _ in runs])
                if feedback == "regulator":
                    unlearned = [
                        errors(machine, reference, UNLEARNED, given.passes, seed)[0]
                        for seed in range(len(runs))
                    ]
                    beyond = int((all_runs > unlearned)[:, 2:].sum())
                spent = max(spent, *(seconds for _, seconds, _ in runs))
                cells += [
                    f"{all_runs[:, 2].max():.2f}",
                    f"{all_runs[:, min(10, given.passes) :].max():.2f}",
                ]
            print(f"| {what} | {' | '.join(cells)} | {beyond} | {spent:.2f} |", flush=True)


if __name__ == "__main__":
    main()
