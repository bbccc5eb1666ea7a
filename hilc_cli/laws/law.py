"""What an engine asks of a learning law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from hilc_cli.reference.sampled import Reference

WheelController = Callable[[int, float, float, float, float, float], tuple[float, float]]
"""Wheel speeds at one sample of the running iteration, before the speed limit.

Called once for each sample k = 0, 1, ... in order, with k, the cosine and sine of the measured
heading, and the measured error in x [m], y [m] and heading [rad]; returns left and right [rad/s].
"""


@dataclass(frozen=True, slots=True)
class PreviousIteration:
    """What a law learns from: plain lists, since the loop engine reads them one by one.

    Attributes:
        left: Speed of the left wheel that the plant got [rad/s], n numbers.
        right: Speed of the right wheel that the plant got [rad/s], n numbers.
        error_x: Measured error [m], n + 1 numbers.
        error_y: Measured error [m], n + 1 numbers.
        error_heading: Measured error [rad], n + 1 numbers.
    """

    left: list[float]
    right: list[float]
    error_x: list[float]
    error_y: list[float]
    error_heading: list[float]


class Law(Protocol):
    """A learning law with its parameters."""

    def controller(self, previous: PreviousIteration, reference: Reference) -> WheelController:
        """The controller of the next iteration, learned from the previous one."""
