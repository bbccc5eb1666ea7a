"""What is asked of a plant: how a platform really moves when its wheels are driven.

A plant is plain data: the platform, and whatever else makes it move as it does. It simulates one
pass at a time, and says what more it offers: a linearisation, and gains for the batch engine. What
it does not offer is not taken to be as in the paper: the experiment then runs in the loop engine,
and theory has nothing to say of it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

from hilc_cli.plants.drivetrain import LaneWheels
from hilc_cli.plants.kinematic import Linearisation, Robot
from hilc_cli.reference.sampled import Floats

Pose = tuple[float, float, float]
"""The wheel midpoint's x [m] and y [m], and the heading [rad], which is never wrapped."""

Step = Callable[[Pose, float, float], Pose]
"""The pose one sample later, from a pose and the left and right wheel speed that are sent [rad/s].

Called once for each sample in order, so that it may keep what the pose does not tell, such as how
fast the wheels turn. The pose is handed in, since disturbances move the platform between steps.
"""


class Plant(ABC):
    """A plant, best a frozen dataclass; it offers no more than its motion until it says so.

    Attributes:
        robot: The platform: wheel radius, half track, turn convention, gravity centre.
    """

    robot: Robot

    @abstractmethod
    def start(self, pose: Pose, sample_time: float) -> Step:
        """Starts a pass with the wheels at rest.

        Args:
            pose: Where the platform stands.
            sample_time: d_t [s].
        """

    def session(self) -> AbstractContextManager[Plant]:
        """Returns the plant for the passes of one run, one after the other.

        What it needs for all of them, such as a program, it ends with the context.
        """
        return nullcontext(self)

    def linearisation(
        self, headings: Floats, left: Floats, right: Floats, sample_time: float
    ) -> Linearisation | None:
        """Returns the motion to first order about some steps; None if the pose is not its state.

        Args:
            headings: Heading at the start of each step [rad], shape (n,).
            left: Speed of the left wheel [rad/s], shape (n,).
            right: Speed of the right wheel [rad/s], shape (n,).
            sample_time: d_t [s].
        """
        return None

    def lane_gains(self, sample_time: float) -> tuple[float, float] | None:
        """Returns the gains with which the batch engine may move it; None if it moves otherwise.

        Args:
            sample_time: d_t [s].

        Returns:
            Distance per sum of the wheel speeds [m s] and turn per difference [s], as `advance`
            of the kinematic platform takes what comes of them.
        """
        return None

    def lane_wheels(self, sample_time: float) -> LaneWheels | None:
        """Returns what the batch engine may put between wheel speeds and motion; None for nothing.

        A plant that offers it needs no `lane_gains`.

        Args:
            sample_time: d_t [s].
        """
        return None
