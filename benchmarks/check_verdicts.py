"""How often `hilc check` is wrong: its verdicts on random scenarios, held against simulation.

    python benchmarks/check_verdicts.py [--seeds FIRST:COUNT ...] [--processes N] [--out FOLDER]

Each seed is a scenario: laws, starts right and wrong, all disturbances, beliefs from right to far
off, paths with and without corners, limits from none to too tight, 50 to 400 samples, 1 to 40
iterations. Nothing of a scenario depends on what was said of another.

Definitions, written down before the first run of this file:

- Nothing wrong: no failure and no warning. Cannot work: a failure (exit code 3 of `hilc check`).
  With warnings: anything else.
- The final error is the largest position error of the last iteration of the simulation; of one
  that left the finite numbers it is infinite.
- Called fine and is not: nothing wrong, and the final error is above twice `Check.expected.
  foretold_m`, the error with the stated effect of the disturbances that the check had foretold.
  Where a check foretells nothing, any final error is above it.
- Learned: the final error is below half of the smaller one of two that need no learning, that of
  iteration 0, and that of the believed feedforward on the same robot, from the same start, within
  the same limit. (A robot that stands still in iteration 0 has not learned when it moves.)
- Called impossible and is not: cannot work, and it learned. The count that holds the final error
  against iteration 0 alone is printed as well.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import hilc_cli as hilc
from hilc_cli.errors import HilcError

SEEDS = ((10_000, 300), (20_000, 300))
"""First seed and number: the first range is the one that was looked at while the check was
written, the second one confirms."""
FINE, WARNED, IMPOSSIBLE = "nothing wrong", "works with warnings", "cannot work"
TWICE, HALF = 2.0, 0.5
Data = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """One scenario and what came of it.

    Attributes:
        seed: Of the scenario.
        law: Its law.
        verdict: FINE, WARNED or IMPOSSIBLE.
        foretold: The error that was foretold [m]; None if none was.
        first: Error of iteration 0 [m].
        unlearned: Error of the believed feedforward [m].
        final: Of the last iteration [m]; infinite if the simulation left the finite numbers.
        said: The first failure or warning.
        seconds: What the check took of the processor.
    """

    seed: int
    law: str
    verdict: str
    foretold: float | None
    first: float
    unlearned: float
    final: float
    said: str
    seconds: float

    @property
    def learned(self) -> bool:
        """Whether learning, or the law's feedback, made much of the error go away."""
        return self.final < HALF * min(self.first, self.unlearned)

    @property
    def is_not_fine(self) -> bool:
        """Whether it was called fine and is not."""
        return self.verdict == FINE and not self.final <= TWICE * (self.foretold or 0.0)

    @property
    def is_not_impossible(self) -> bool:
        """Whether it was called impossible and is not."""
        return self.verdict == IMPOSSIBLE and self.learned


def scenario_of(seed: int) -> Data:
    """The scenario of a seed, as a scenario file has it."""
    return _Draw(seed).scenario()


class _Draw:
    """The random choices of one scenario."""

    def __init__(self, seed: int) -> None:
        self.seed, self.random = seed, np.random.default_rng(seed)

    def chance(self, probability: float) -> bool:
        return bool(self.random.random() < probability)

    def between(self, low: float, high: float) -> float:
        return float(self.random.uniform(low, high))

    def scale(self, low: float, high: float) -> float:
        """Between two positive numbers, uniform in the logarithm."""
        return float(math.exp(self.random.uniform(math.log(low), math.log(high))))

    def one_of(self, *choices: Any) -> Any:
        return choices[int(self.random.integers(len(choices)))]

    def scenario(self) -> Data:
        # Some are as one would write them who knows the platform; else few would be fine.
        self.is_sound = self.chance(0.55)
        self.speed, self.sample_time = self.scale(0.1, 1.0), self.one_of(0.01, 0.02, 0.05, 0.1)
        if self.is_sound:
            self.speed, self.sample_time = self.scale(0.1, 0.5), self.one_of(0.05, 0.1)
        self.samples = int(self.scale(100 if self.is_sound else 50, 400))
        self.length = self.speed * self.sample_time * self.samples
        radius = self.scale(0.03, 0.3)
        robot = {
            "wheel_radius": radius,
            "wheel_separation": radius * self.scale(3, 8),
            "turn_convention": self.one_of("paper", "rep103"),
        }
        trajectory, sharpness = self.trajectory()
        # What the wheels need, corners left out.
        needed = self.speed * (1 + sharpness * robot["wheel_separation"] / 2) / radius
        data: Data = {
            "name": f"seed-{self.seed}",
            "trajectory": trajectory,
            "robot": robot,
            "model": self.model(robot),
            "iterations": int(self.scale(15 if self.is_sound else 5, 40)),
            "initial_input": "feedforward" if self.is_sound or self.chance(0.6) else "zero",
            "controller": self.controller(),
        }
        limit = self.limit(needed)
        data["controller"]["b_w"] = limit
        if self.chance(0.1) and not self.is_sound:
            data["initial_trial"] = "feedback"
        pose = self.start()
        if pose is not None:
            data["initial_pose"] = pose
        noise = self.noise()
        if noise is not None:
            data["disturbance"] = noise
        if data["controller"]["law"] == "feedback":  # what has no effect on it is warned of
            del data["initial_input"]
            data.pop("initial_trial", None)
            if noise is None:
                data["iterations"] = 0
        return data

    def trajectory(self) -> tuple[Data, float]:
        """A trajectory, and the largest curvature in it [1/m]."""
        turn, other = ("left", "right") if self.chance(0.5) else ("right", "left")
        total, speed = self.length, self.speed

        def timed(kind: str, share: float, **keys: Any) -> Data:
            samples = max(1, round(self.samples * share))
            return {kind: {**keys, "duration": f"{samples} * {self.sample_time} s"}}

        def line(share: float) -> Data:
            samples = max(1, round(self.samples * share))
            return timed("line", share, length=samples * self.sample_time * speed)

        def arc(share: float, sweep: float, way: str) -> Data:
            samples = max(1, round(self.samples * share))
            radius = samples * self.sample_time * speed / sweep
            return timed("arc", share, radius=radius, turn=way, sweep=sweep)

        kinds = "line", "circle", "arc", "u-turn", "s", "zigzag", "corners"
        kind = self.one_of(*kinds[: 6 if self.is_sound else 7])
        sweep = self.between(0.4, 1.8) * math.pi
        self.heading = self.between(-3, 3)
        data: Data = {"name": kind, "sample_time": self.sample_time}
        data["start"] = {"x": 0, "y": 0, "heading": self.heading}
        curvature = 0.0
        if kind == "line":
            segments = [line(1)]
        elif kind == "circle":
            segments, curvature = [arc(1, 2 * math.pi, turn)], 2 * math.pi / total
        elif kind == "arc":
            segments, curvature = [line(0.3), arc(0.7, sweep, turn)], sweep / (0.7 * total)
        elif kind == "u-turn":
            segments = [line(0.35), arc(0.3, math.pi, turn), line(0.35)]
            curvature = math.pi / (0.3 * total)
        elif kind == "s":
            segments = [arc(0.5, 0.8 * sweep, turn), arc(0.5, 0.8 * sweep, other)]
            curvature = 0.8 * sweep / (0.5 * total)
        elif kind == "zigzag":
            count = int(self.random.integers(2, 5))
            turns = [self.scale(0.1, 1.5) for _ in range(count)]
            segments = []
            for angle in turns:
                way = self.one_of("left", "right")
                segments += [line(0.6 / count), arc(0.4 / count, angle, way)]
            curvature = max(turns) / (0.4 / count * total)
        else:
            count, heading = int(self.random.integers(2, 5)), self.heading
            x = y = 0.0
            segments = []
            for _ in range(count):
                samples = max(8, round(self.samples / count))
                step = samples * self.sample_time * speed
                x, y = x + step * math.cos(heading), y + step * math.sin(heading)
                segments.append(timed("line", samples / self.samples, to=[x, y]))
                heading += self.one_of(-1, 1) * self.scale(0.02, 1.5)
            data["corners"] = "allow"
        data["segments"] = segments
        return data, curvature

    def model(self, robot: Data) -> Data:
        chosen = self.random.random()
        if chosen < 0.35:
            return {}
        far = 1.15 if chosen < 0.85 or self.is_sound else 2.5
        return {
            key: robot[key] * self.scale(1 / far, far)
            for key in ("wheel_radius", "wheel_separation")
        }

    def limit(self, needed: float) -> float | None:
        chosen = self.random.random()
        if chosen < 0.25:
            return None
        if chosen < 0.65 or self.is_sound:
            return needed * self.scale(1.5, 4)
        return needed * (self.between(1.02, 1.4) if chosen < 0.8 else self.between(0.2, 0.98))

    def start(self) -> Data | None:
        if self.chance(0.8 if self.is_sound else 0.6):
            return None
        off = self.length * self.scale(0.003, 0.03 if self.is_sound else 0.3)
        way = self.between(-math.pi, math.pi)
        anyhow = self.chance(0.2) and not self.is_sound
        turned = self.between(-3, 3) if anyhow else self.between(-0.3, 0.3)
        return {
            "x": off * math.cos(way),
            "y": off * math.sin(way),
            "heading": self.heading + turned,
        }

    def noise(self) -> Data | None:
        if self.chance(0.35):
            return None
        size = self.length * (self.scale(0.01, 1) if self.is_sound else 1)
        levels = {
            "initial_pose": (0.03 * size, 0.1 * size / self.length),
            "output": (0.01 * size, 0.05 * size / self.length),
            "state": (
                0.003 * size / math.sqrt(self.samples),
                0.03 * size / self.length / math.sqrt(self.samples),
            ),
        }
        found: Data = {"seed": self.seed}
        for name, most in levels.items():
            metres, radians = (each * self.scale(0.01, 1) for each in most)
            if self.chance(0.5):
                found[name] = {
                    "bound": [metres, metres, radians],
                    "distribution": self.one_of("uniform", "truncated-normal"),
                    "repeat": self.chance(0.3),
                }
        return found

    def controller(self) -> Data:
        law = self.one_of("hybrid", "hybrid", "pid", "pid", "norm-optimal", "feedback")
        build = {
            "hybrid": self.hybrid,
            "pid": self.pid,
            "norm-optimal": self.norm_optimal,
            "feedback": self.feedback,
        }
        return {"law": law, **build[law]()}

    def share(self) -> float:
        """What an iteration corrects of the error of a sample; above 2 it cannot converge."""
        if self.is_sound:
            return self.scale(0.2, 1.0)
        return self.scale(0.02, 1.0) if self.chance(0.75) else self.scale(1.0, 6.0)

    def hybrid(self) -> Data:
        l1 = self.share() / self.sample_time
        if self.is_sound:  # errors of the position add up along the path, and so do corrections
            l1 = self.scale(0.5, 5) / (self.samples * self.sample_time)
        gains = {"l1": l1}
        if self.chance(0.5):
            gains["l2"] = l1 * self.scale(0.1, 0.9 if self.is_sound else 3)
        if self.chance(0.2) and not self.is_sound:
            gains["l3"] = l1 * self.scale(0.05, 0.5)
        if self.chance(0.25):
            gains["lateral"] = self.scale(0.05, 2)
        if self.chance(0.05) and not self.is_sound:
            gains["l1"] = 0.0
        found: Data = {"gains": gains, "compensation": self.one_of("auto", "on", "off")}
        if self.is_sound:
            found["compensation"] = "off"
        if self.chance(0.5):
            found["h"] = max(1, int(self.samples * self.between(0.1, 0.4)))
        else:
            found["h"] = max(1, min(40, self.samples // 3))
        if self.chance(0.1) and not self.is_sound:
            found["gain_matrix"] = "unit"
        return found

    def pid(self) -> Data:
        share = self.share()
        of_change = self.between(0, 1) if self.chance(0.7) else 1.0
        gains = {"kd": share * of_change, "kp": share * (1 - of_change) / self.sample_time}
        if self.chance(0.2):
            gains["ki"] = self.scale(0.01, 1) * share / self.sample_time**2 / self.samples
        found: Data = {"gains": gains}
        if self.chance(0.2) and not self.is_sound:
            found["forgetting"] = self.scale(0.001, 0.3)
        if self.chance(0.25):
            found["cutoff"] = self.scale(0.02, 0.4) / self.sample_time
        if self.chance(0.3):
            found["rectifying"] = "on"
            found["h"] = max(1, int(self.samples * self.between(0.05, 0.4)))
        return found

    def norm_optimal(self) -> Data:
        found: Data = {"feedback": self.one_of("regulator", "none")}
        if self.chance(0.5):
            found["h"] = max(1, int(self.samples * self.between(0.05, 0.6)))
        return found

    def feedback(self) -> Data:
        if self.chance(0.4):
            return {}
        ahead = self.scale(0.5, 40) / (self.samples * self.sample_time)
        aside = (self.scale(1, 30) / self.length) ** 2
        heading = 2 * self.scale(0.3, 1.5) * math.sqrt(aside)
        return {"gains": {"k_x": ahead, "k_y": aside, "k_theta": heading}}


def judged(seed: int) -> Case:
    """Checks and simulates the scenario of a seed."""
    data = scenario_of(seed)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenario.yaml"
        file.write_text(json.dumps(data), encoding="utf-8")
        scenario = hilc.load_scenario(file)
        plain = hilc.load_scenario(
            file,
            overrides=[
                "iterations=0",
                "initial_input=feedforward",
                "initial_trial=open-loop",
                "disturbance={}",
            ],
        )
    clock = time.process_time()
    found = hilc.check(scenario)
    seconds = time.process_time() - clock
    first, final = _errors(scenario)
    unlearned = _errors(plain)[1]
    said = [*found.failures, *found.warnings]
    verdict = IMPOSSIBLE if found.failures else WARNED if found.warnings else FINE
    return Case(
        seed,
        data["controller"]["law"],
        verdict,
        None if found.expected is None else found.expected.foretold_m,
        first,
        unlearned,
        final,
        said[0] if said else "",
        seconds,
    )


def _errors(scenario: hilc.Scenario) -> tuple[float, float]:
    """The largest position errors of the first iteration and of the last."""
    try:
        done = hilc.run(scenario)
    except HilcError:
        return math.inf, math.inf
    errors = done.metrics["max_position_error_m"]
    return float(errors[0]), math.inf if done.diverged_at is not None else float(errors[-1])


def judge(seeds: Iterable[int], processes: int) -> list[Case]:
    """Checks and simulates many scenarios."""
    if processes == 1:
        return [judged(seed) for seed in seeds]
    with ProcessPoolExecutor(processes) as pool:
        return list(pool.map(judged, seeds, chunksize=4))


def table(cases: Sequence[Case]) -> str:
    """What came of the scenarios, in a few lines."""
    laws = sorted({case.law for case in cases})
    lines = [f"{'':22}{'all':>6}" + "".join(f"{law:>14}" for law in laws)]
    for verdict in (FINE, WARNED, IMPOSSIBLE):
        counts = Counter(case.law for case in cases if case.verdict == verdict)
        row = "".join(f"{counts[law]:14d}" for law in laws)
        lines.append(f"{verdict:22}{sum(counts.values()):6d}{row}")
    fine = [case for case in cases if case.verdict == FINE]
    impossible = [case for case in cases if case.verdict == IMPOSSIBLE]
    other = sum(case.final < HALF * case.first for case in impossible)
    lines += [
        _share("called fine and is not", sum(case.is_not_fine for case in cases), len(fine)),
        _share(
            "called impossible and is not",
            sum(case.is_not_impossible for case in cases),
            len(impossible),
        ),
        _share("  against iteration 0 alone", other, len(impossible)),
        f"a check took {np.median([case.seconds for case in cases]):.2f} s, "
        f"the slowest {max(case.seconds for case in cases):.2f} s",
    ]
    for case in cases:
        if case.is_not_fine or case.is_not_impossible:
            lines.append(
                f"  seed {case.seed}, {case.law}, {case.verdict}: foretold {case.foretold} m, "
                f"iteration 0 {case.first:.4g} m, feedforward {case.unlearned:.4g} m, last "
                f"{case.final:.4g} m {case.said}"
            )
    return "\n".join(lines)


def _share(name: str, part: int, whole: int) -> str:
    return f"{name:30}{part:4d} of {whole:4d}: {100 * part / max(whole, 1):.1f} %"


def main() -> None:
    """Prints the tables; writes the misjudged scenarios."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seeds", nargs="*", help="FIRST:COUNT", metavar="RANGE")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, help="folder for the scenarios that were misjudged")
    given = parser.parse_args()
    ranges = [tuple(map(int, text.split(":"))) for text in given.seeds or []] or SEEDS
    for first, count in ranges:
        clock = time.perf_counter()
        cases = judge(range(first, first + count), given.processes)
        print(f"seeds {first} to {first + count - 1}, {time.perf_counter() - clock:.0f} s")
        print(table(cases), flush=True)
        for case in cases:
            if given.out is not None and (case.is_not_fine or case.is_not_impossible):
                given.out.mkdir(parents=True, exist_ok=True)
                text = json.dumps(scenario_of(case.seed), indent=1)
                (given.out / f"seed-{case.seed}.yaml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
