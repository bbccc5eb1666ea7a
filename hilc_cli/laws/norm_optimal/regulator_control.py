"""The regulator at work: what it tells the wheels, of numbers that are known beforehand."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from hilc_cli.laws.law import NumericController, WheelController
from hilc_cli.reference.sampled import Floats


def on_arrival(
    x: float,
    y: float,
    heading: float,
    way_x: float,
    way_y: float,
    cos_there: float,
    sin_there: float,
) -> tuple[float, float, float]:
    """What an error will be where its correction arrives: ahead [m], aside [m], heading [rad].

    Args:
        x: Error now [m].
        y: Likewise.
        heading: Likewise [rad].
        way_x: From here to there [m].
        way_y: Likewise.
        cos_there: Cosine of the plan's heading there.
        sin_there: Its sine.
    """
    # A heading that is off turns the way until then.
    x, y = x - heading * way_y, y + heading * way_x
    return cos_there * x + sin_there * y, cos_there * y - sin_there * x, heading


@dataclass(frozen=True, slots=True, eq=False)
class RegulatorControl(NumericController):
    """The feedback about a plan.

    Attributes:
        rows: Of each sample, shape (n, 10): left and right wheel speed of the plan [rad/s]; how far
            it is off the reference in x, y and heading; the way in x and y [m] until a correction
            arrives, cosine and sine of the heading there; what a sideways error steers [rad/(m s)].
        late: By samples since, how much of a correction is yet to arrive [s].
        rates: How fast an error ahead and one sideways shall fall [1/s].
        radii: Of the left and the right wheel [m].
        half_track: Signed [m].
    """

    rows: Floats
    late: Floats
    rates: tuple[float, float]
    radii: tuple[float, float]
    half_track: float

    def controller(self) -> WheelController:
        """Returns the controller for one pass."""
        (ahead_rate, aside_rate), (left_radius, right_radius) = self.rates, self.radii
        rows, shares, half_track = self.rows.tolist(), self.late.tolist(), self.half_track
        sent: deque[tuple[float, float]] = deque(maxlen=max(len(shares), 1))

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            if k == 0:
                sent.clear()
            left, right, dx, dy, dh, way_x, way_y, cos_there, sin_there, steer = rows[k]
            ahead, aside, heading = on_arrival(
                *(error_x + dx, error_y + dy, error_heading + dh),
                *(way_x, way_y, cos_there, sin_there),
            )
            for share, (faster, turning) in zip(shares, sent, strict=False):
                ahead -= share * faster
                heading -= share * turning
            faster = ahead_rate * ahead
            turning = aside_rate * heading + steer * aside
            sent.appendleft((faster, turning))
            wheel = half_track * turning
            return left + (faster + wheel) / left_radius, right + (faster - wheel) / right_radius

        return wheel_speeds
