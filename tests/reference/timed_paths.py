"""Paths by closed forms, and what a speed profile along them is held against."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import toppra
import toppra.algorithm
import toppra.constraint
from scipy.integrate import cumulative_simpson
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from hilc_cli.reference.limits import Limits, Wheels
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.speed_limits import Stretch
from hilc_cli.reference.timing import SpeedProfile

RADIUS, HALF_TRACK = 0.05, 0.2
WHEELS = Wheels(RADIUS, HALF_TRACK)
DT = 0.001


def pieces(*each: tuple[float, float, float]) -> Stretch:
    """A stretch of pieces: length, curvature at the start and at the end."""
    table = np.array(each)
    return Stretch(np.append(0.0, np.cumsum(table[:, 0])), table[:, 1:])


@dataclass(frozen=True)
class Path:
    """A smooth path by closed forms, to be measured by."""

    length: float
    heading: Callable[[Floats], Floats]
    curvature: Callable[[Floats], Floats]
    change: Callable[[Floats], Floats]  # of the curvature [1/m^2]
    stretch: Stretch

    def rates(self, s: Floats) -> Floats:
        """What each wheel turns by for a metre, shape (n, 2)."""
        turning = HALF_TRACK * self.curvature(s)
        return np.stack([1 + turning, 1 - turning], axis=-1) / RADIUS

    def wheels(self, s: Floats) -> Floats:
        """How far each wheel has turned, shape (n, 2)."""
        turned = HALF_TRACK * self.heading(s)
        return np.stack([s + turned, s - turned], axis=-1) / RADIUS


def smooth(
    length: float,
    heading: Callable[[Floats], Floats],
    curvature: Callable[[Floats], Floats],
    change: Callable[[Floats], Floats],
    borders: Floats | None = None,
) -> Path:
    ends = np.array([0.0, length]) if borders is None else borders
    return Path(length, heading, curvature, change, Stretch.curved(curvature, ends))


def wave(mean: float, height: float, number: float, length: float = 10.0) -> Path:
    """A path whose curvature is a sine."""
    return smooth(
        length,
        lambda s: mean * s - height / number * np.cos(number * s),
        lambda s: mean + height * np.sin(number * s),
        lambda s: height * number * np.cos(number * s),
    )


def piecewise(*each: tuple[float, float, float]) -> Path:
    """A path of lines, arcs and clothoids."""
    stretch = pieces(*each)
    ends, (start, end) = stretch.positions, stretch.curvatures.T
    lengths = np.diff(ends)
    before = np.append(0.0, np.cumsum(lengths * (start + end) / 2))
    change = (end - start) / lengths

    def piece(s: Floats) -> tuple[Any, Floats]:
        number = np.clip(np.searchsorted(ends, s, "right") - 1, 0, len(lengths) - 1)
        return number, s - ends[number]

    def heading(s: Floats) -> Floats:
        i, passed = piece(s)
        return np.asarray(before[i] + passed * (start[i] + change[i] * passed / 2))

    def curvature(s: Floats) -> Floats:
        i, passed = piece(s)
        return np.asarray(start[i] + change[i] * passed)

    def rate(s: Floats) -> Floats:
        return np.asarray(change[piece(s)[0]])

    return Path(stretch.length, heading, curvature, rate, stretch)


def wandering(seed: int, scale: float) -> Path:
    """A path whose curvature is a spline through random values."""
    values = np.random.default_rng(seed).normal(size=12) * scale
    knots = np.linspace(0.0, 8.0, 12)
    spline = CubicSpline(knots, values)
    return smooth(8.0, spline.antiderivative(), spline, spline.derivative(), knots)


def through_points(seed: int) -> Path:
    """A cubic spline through random points of the plane."""
    points = np.cumsum(np.random.default_rng(seed).normal(size=(8, 2)), axis=0)
    knots = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    curve = CubicSpline(knots, points)
    t = np.unique(np.concatenate([np.linspace(a, b, 2001) for a, b in pairwise(knots)]))
    s = cumulative_simpson(np.hypot(*curve(t, 1).T), x=t, initial=0.0)
    (dx, dy), (ddx, ddy) = curve(t, 1).T, curve(t, 2).T
    speed, bend = np.hypot(dx, dy), dx * ddy - dy * ddx
    heading, curvature = np.unwrap(np.arctan2(dy, dx)), bend / speed**3
    # The third derivative jumps at knots, and is constant from each to the next.
    dddx, dddy = curve(t, 3).T
    slope = (dx * dddy - dy * dddx) / speed**4 - 3 * bend * (dx * ddx + dy * ddy) / speed**6
    return smooth(
        float(s[-1]),
        CubicHermiteSpline(s, heading, curvature),
        CubicHermiteSpline(s, curvature, slope),
        lambda where: np.interp(where, s, slope),
        s[::2000],
    )


PATHS = {
    "line": piecewise((3.0, 0, 0)),
    "circle": piecewise((5.0, 2.5, 2.5)),
    "clothoid": piecewise((4.0, -3.0, 8.0)),
    "rounded corners": piecewise((1, 0, 0), (0.5, 0, 2), (0.3, 2, 2), (0.5, 2, 0), (1, 0, 0)),
    "gentle wave": wave(0.0, 1.0, 2.0),
    "wave over a standing wheel": wave(0.0, 8.0, 3.0),
    "about a standing wheel": wave(5.0, 5.0, 3.0),
    "wandering": wandering(1, 3.0),
    "wandering far": wandering(2, 10.0),
    "through points": through_points(3),
    "through other points": through_points(5),
}


def time_by_toppra(path: Path, limits: Limits, jumps: bool = False) -> float:
    """The time from rest to rest that TOPP-RA takes, with the arc length as a third joint."""

    class Wheeled(toppra.interpolator.AbstractGeometricPath):  # type: ignore[misc]
        dof = 3
        path_interval = np.array([0.0, path.length])

        def __call__(self, s: Any, order: int = 0) -> Floats:
            where = np.asarray(s, dtype=float)
            turning = HALF_TRACK * path.change(where) / RADIUS
            zero = np.zeros_like(where)
            if order == 0:
                return np.concatenate([path.wheels(where), where[..., None]], axis=-1)
            if order == 1:
                return np.concatenate([path.rates(where), zero[..., None] + 1], axis=-1)
            return np.stack([turning, -turning, zero], axis=-1)

    def fastest(s: float) -> Floats:
        curvature = max(abs(float(path.curvature(np.array(s)))), 1e-9)
        along = min(limits.speed, math.sqrt(limits.lateral_acceleration / curvature))
        most = np.array([limits.wheel_speed, limits.wheel_speed, along])
        return np.stack([-most, most], axis=1)

    wheel = 1e6 if jumps else limits.wheel_acceleration
    accelerations = np.array([wheel, wheel, limits.acceleration])
    constraints = [
        toppra.constraint.JointVelocityConstraintVarying(fastest),
        toppra.constraint.JointAccelerationConstraint(
            np.stack([-accelerations, accelerations], axis=1)
        ),
    ]
    ends = path.stretch.positions
    parts = np.interp(np.arange(0, len(ends) - 0.95, 0.1), np.arange(len(ends)), ends)
    grid = np.union1d(np.linspace(0.0, path.length, 2001), parts)
    instance = toppra.algorithm.TOPPRA(constraints, Wheeled(), grid, solver_wrapper="seidel")
    _, speeds, _ = instance.compute_parameterization(0.0, 0.0)
    return float(np.sum(2 * np.diff(grid) / (speeds[:-1] + speeds[1:])))


def excess(
    path: Path,
    limits: Limits,
    found: SpeedProfile,
    sample_time: float = DT,
    wheels: Wheels = WHEELS,
    ends: tuple[bool, bool] | Literal["lap"] = (True, True),
) -> dict[str, float]:
    """How much of each limit the samples use, by differences of where robot and wheels are.

    Differences of rounded positions are let off what rounding makes of them.
    """
    s, heading = found.positions, path.heading(found.positions)
    used: dict[str, float] = {}
    turned = abs(wheels.half_track) * heading
    ways = {
        "": (s, limits.speed, limits.acceleration),
        "wheel_l": ((s + turned) / wheels.radius, limits.wheel_speed, limits.wheel_acceleration),
        "wheel_r": ((s - turned) / wheels.radius, limits.wheel_speed, limits.wheel_acceleration),
    }
    size = s[-1] + np.abs(turned).max()
    for name, (way, speed, acceleration) in ways.items():
        speeds = np.diff(way) / sample_time
        rounding = 4e-16 * size / (wheels.radius if name else 1.0) / sample_time
        around = np.append(speeds, speeds[0])
        if ends != "lap":  # at rest or not
            around = np.concatenate([[0.0] * ends[0], speeds, [0.0] * ends[1]])
        changes = np.abs(np.diff(around)) / sample_time
        used[f"{name} speed"] = (np.abs(speeds).max() - 2 * rounding) / speed
        used[f"{name} acceleration"] = (
            np.max(changes, initial=0.0) - 4 * rounding / sample_time
        ) / acceleration
    used["speed at samples"] = found.speeds.max() / limits.speed
    lateral = np.abs(path.curvature(s)) * found.speeds**2
    used["lateral acceleration"] = lateral.max() / limits.lateral_acceleration
    return used
