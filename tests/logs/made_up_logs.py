"""Robots that are simulated here, in small steps of their own, and the logs that they leave."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilc_cli.logs.planned import PlannedPass
from hilc_cli.reference.sampled import Floats, Reference

STEP = 1e-3  # [s]


@dataclass(frozen=True)
class MadeUpRobot:
    """A robot in REP-103 and its camera."""

    left_radius: float = 0.1
    right_radius: float = 0.1
    half_track: float = 0.25
    delay: float = 0.0
    lag: float = 0.05
    rate: float = 30.0  # of the camera [Hz]
    position_noise: float = 2e-3
    heading_noise: float = 2e-3

    def drive(
        self,
        sample_time: float,
        wheels: Floats,
        *,
        start: Sequence[float] = (0.0, 0.0, 0.0),
        clock: float = 1000.0,
        before: float = 2.0,
        after: float = 1.0,
        seed: int = 0,
    ) -> Floats:
        """Drives wheel speeds, shape (n, 2), sent from `clock` on: times and poses, (m, 4)."""
        random = np.random.default_rng(seed)
        end = len(wheels) * sample_time + after
        pictures = np.arange(-before + random.uniform(0, 1 / self.rate), end, 1 / self.rate)
        times = np.arange(-before, end + STEP, STEP)
        late = np.floor((times - self.delay) / sample_time + 1e-9).astype(int)
        inside = (late >= 0) & (late < len(wheels))
        told = np.where(inside[:, None], wheels[late.clip(0, len(wheels) - 1)], 0.0)
        follow = -math.expm1(-STEP / self.lag) if self.lag else 1.0
        speed, pose = np.zeros(2), np.array(start, dtype=float)
        poses = np.empty((len(times), 3))
        radii = np.array([self.left_radius, self.right_radius])
        for k, wanted in enumerate(told):
            poses[k] = pose
            before_step, speed = speed, speed + follow * (wanted - speed)
            left, right = radii * (before_step + speed) / 2 * STEP
            turn = (right - left) / (2 * self.half_track)
            middle = pose[2] + turn / 2
            ahead = (left + right) / 2
            pose = pose + np.array([ahead * math.cos(middle), ahead * math.sin(middle), turn])
        seen = np.stack([np.interp(pictures, times, column) for column in poses.T], axis=1)
        noise = np.array([self.position_noise, self.position_noise, self.heading_noise])
        seen += random.normal(size=seen.shape) * noise
        return np.column_stack([pictures + clock, seen])


def winding_plan(
    sample_time: float = 0.02, duration: float = 8.0, speed: float = 0.5
) -> PlannedPass:
    """A plan from rest to rest over an S, for the robot with the usual numbers."""
    t = np.arange(round(duration / sample_time)) * sample_time
    ahead = speed * np.minimum(1, np.minimum(t, duration - t))
    yaw_rate = 0.8 * np.sin(4 * np.pi * t / duration) * ahead / speed
    wheels = np.stack([ahead - 0.25 * yaw_rate, ahead + 0.25 * yaw_rate], axis=1) / 0.1
    robot = MadeUpRobot(lag=0.0, rate=1 / sample_time, position_noise=0.0, heading_noise=0.0)
    seen = robot.drive(sample_time, wheels, clock=0.0, before=1.0, after=1.0)
    at = np.arange(len(t) + 1) * sample_time
    x, y, heading = (np.interp(at, seen[:, 0], column) for column in seen[:, 1:].T)
    reference = Reference("winding", sample_time, x, y, heading)
    return PlannedPass.from_samples(reference, wheels[:, 0], wheels[:, 1])


def write_csv(path: Path, poses: Floats, commands: Floats | None = None) -> Path:
    """Writes rows of poses, and of commands (time, left, right) between them."""
    rows = [(row[0], ",".join(map(repr, row)) + ",,") for row in poses.tolist()]
    if commands is not None:
        rows += [(t, f"{t!r},,,,{left!r},{right!r}") for t, left, right in commands.tolist()]
    header = "t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s"
    path.write_text("\n".join([header, *(text for _, text in sorted(rows))]) + "\n")
    return path
