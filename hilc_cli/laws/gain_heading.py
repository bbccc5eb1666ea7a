"""The heading at which a gain matrix is taken, the "q" of Eq. 45, which the paper leaves open."""

from __future__ import annotations

import math
from typing import Literal

from hilc_cli.laws.law import Iteration, WheelController
from hilc_cli.reference.sampled import Reference

GainHeading = Literal["measured", "previous", "reference"]


def with_gain_heading(
    controller: WheelController, choice: GainHeading, previous: Iteration, reference: Reference
) -> WheelController:
    """The controller with its gain matrix taken at the chosen heading.

    Args:
        controller: Takes it at the heading that it is given.
        choice: Measured in the running iteration, measured in the previous one, or the reference's.
        previous: The previous iteration.
        reference: The trajectory.
    """
    if choice == "measured":
        return controller
    taken = (
        reference.heading if choice == "reference" else reference.heading - previous.error_heading
    )
    headings = taken.tolist()
    cosines = [math.cos(heading) for heading in headings]
    sines = [math.sin(heading) for heading in headings]

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        return controller(k, cosines[k], sines[k], error_x, error_y, error_heading)

    return wheel_speeds
