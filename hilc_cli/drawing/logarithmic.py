"""Ticks of logarithmic axes. Fixed ones in plain characters are set fast."""

from __future__ import annotations

import math

from matplotlib.axis import XAxis, YAxis
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels

Ticks = tuple[list[float], list[str], list[float]]


def ticks(bottom: float, top: float, most: int = 9) -> Ticks:
    """Ticks between two exponents.

    Args:
        bottom: Logarithm of the lower end.
        top: Logarithm of the upper end, > bottom.
        most: About so many fit.

    Returns:
        Major ticks, their labels, minor ticks.
    """
    first, last = math.ceil(bottom), math.floor(top)
    digits = range(2, 10) if last - first <= 5 else range(0)
    if last - first >= 3:
        steps = (1, 2, 5, 10, 20, 50, 100, 200)
        step = next(step for step in steps if (last - first) / step <= most)
        exponents = range(-(-first // step) * step, last + 1, step)
        major = [10.0**exponent for exponent in exponents]
        texts = [labels.power_text(exponent) for exponent in exponents]
    else:
        major = _within(bottom, top, (1, 2, 5))
        if len(major) > most:
            major = _within(bottom, top, (1, 3))
        if len(major) > most:
            major = _within(bottom, top, (1,))
        texts = [labels.tick_text(value) for value in major]
    minor = [value for value in _within(bottom, top, digits) if value not in major]
    return major, texts, minor


def _within(bottom: float, top: float, digits: tuple[int, ...] | range) -> list[float]:
    """So many times a power of ten, between two exponents."""
    exponents = range(math.floor(bottom), math.floor(top) + 1)
    values = [digit * 10.0**exponent for exponent in exponents for digit in digits]
    return [value for value in values if bottom <= math.log10(value) <= top]


def narrow_ticks(low: float, high: float, most: int = 6, least: int = 2) -> Ticks:
    """Ticks between two positive numbers that may be close together.

    Args:
        low: The lower end.
        high: The upper end, > low.
        most: About so many fit.
        least: With fewer ticks at ones, twos and fives they are spread like linear ones.

    Returns:
        Major ticks, their labels, minor ticks.
    """
    found = ticks(math.log10(low), math.log10(high), most)
    if len(found[0]) >= least:
        return found
    round_numbers = MaxNLocator(nbins=max(2, most), steps=[1, 2, 5, 10]).tick_values(low, high)
    inside = [float(value) for value in round_numbers if low <= value <= high]
    return inside, labels.PlainFormatter().format_ticks(inside), []


def set_scale(axis: XAxis | YAxis, low: float, high: float, most: int = 6, least: int = 2) -> None:
    """Makes an axis logarithmic, from one positive number to another, with its ticks."""
    if isinstance(axis, XAxis):
        axis.axes.set_xscale("log")
        axis.axes.set_xlim(low, high)
    else:
        axis.axes.set_yscale("log")
        axis.axes.set_ylim(low, high)
    major, texts, minor = narrow_ticks(low, high, most, least)
    axis.set_ticks(major, labels=texts)
    axis.set_ticks(minor, labels=[""] * len(minor), minor=True)
