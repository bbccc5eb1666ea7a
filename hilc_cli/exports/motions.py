"""What is exported: poses over time, and the wheel speeds that were sent meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.run import RunData


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Poses, and what was sent until the next one.

    Attributes:
        name: What its files are called.
        times: [s], shape (n + 1,); those of a plan may begin below 0.
        poses: x [m], y [m] and heading [rad], shape (n + 1, 3).
        left: Speed of the left wheel [rad/s], shape (n,); None where nothing is sent.
        right: Of the right wheel, likewise.
    """

    name: str
    times: Floats
    poses: Floats
    left: Floats | None = None
    right: Floats | None = None

    @property
    def speeds(self) -> Floats | None:
        """Wheel speeds from each time on [rad/s], shape (n + 1, 2): at last they stand."""
        if self.left is None or self.right is None:
            return None
        return np.vstack([np.stack([self.left, self.right], axis=1), np.zeros(2)])

    def twists(self, robot: Robot) -> Floats | None:
        """Speeds [m/s] and yaw rates [rad/s] as a robot's driver is told, shape (n + 1, 2).

        Args:
            robot: What the driver is configured with: it turns them back into wheel speeds.
        """
        speeds = self.speeds
        if speeds is None:
            return None
        left, right = speeds.T
        radius, half_track = robot.wheel_radius, robot.signed_half_track
        yaw_rate = radius * (left - right) / (2 * half_track)
        return np.stack([radius * (left + right) / 2, yaw_rate], axis=1)


def motion_of_reference(reference: Reference) -> Motion:
    """Returns the trajectory itself."""
    return Motion("reference", reference.times, reference.poses)


def motion_of_trial(run: RunData, iteration: int) -> Motion:
    """Returns a recorded iteration.

    Raises:
        UnknownNameError: It was not recorded.
    """
    trial = run.trials[iteration]
    poses = np.stack([trial.x, trial.y, trial.heading], axis=1)
    name = f"iteration-{iteration:03d}"
    return Motion(name, run.reference.times, poses, trial.left, trial.right)


def motion_of_plan(run: RunData) -> Motion | None:
    """Returns what is to be sent next, from its first row on; None if the run has no plan."""
    plan = run.plan
    if plan is None:
        return None
    times = plan.times(run.reference.sample_time)
    return Motion("plan", times, plan.poses, plan.left, plan.right)


def rows_of(motion: Motion) -> Iterator[tuple[float, tuple[float, float, float]]]:
    """Yields time and pose of each sample."""
    poses = motion.poses.tolist()
    yield from ((t, (x, y, h)) for t, (x, y, h) in zip(motion.times.tolist(), poses, strict=True))
