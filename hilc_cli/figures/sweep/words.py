"""What pictures of sweeps call values and metrics, with their units."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import takewhile

from hilc_cli.figures import labels
from hilc_cli.figures.sweep.key_names import with_unit
from hilc_cli.results.sweep import ITERATIONS_TO_TOLERANCE, PEAK, SweepData
from hilc_cli.variation.axes import Value

LONGEST_WORD = 24

# Each with what it is measured in, and when.
_METRICS = {
    "max_position_error_m": ("maximum position error", "m", "after the last iteration"),
    "mean_position_error_m": ("mean position error", "m", "after the last iteration"),
    "rms_position_error_m": ("RMS position error", "m", "after the last iteration"),
    "final_position_error_m": ("position error at the end", "m", "of the last iteration"),
    "max_abs_error_x_m": ("maximum error in x", "m", "after the last iteration"),
    "max_abs_error_y_m": ("maximum error in y", "m", "after the last iteration"),
    "max_abs_error_heading_rad": ("maximum heading error", "rad", "after the last iteration"),
    "max_wheel_speed_rad_s": ("maximum wheel speed", "rad/s", "in the last iteration"),
    "saturated_samples": ("samples at the speed limit", "", "in the last iteration"),
    "input_change_rms_rad_s": ("RMS input change", "rad/s", "in the last iteration"),
    "max_position_error_second_half_m": (
        "maximum position error of the second half",
        "m",
        "after the last iteration",
    ),
    "mean_position_error_second_half_m": (
        "mean position error of the second half",
        "m",
        "after the last iteration",
    ),
    PEAK: ("largest position error", "m", "of all iterations"),
}


def value_text(value: Value, digits: int = 4, longest: int = LONGEST_WORD) -> str:
    """A value as the scenario would have it, numbers rounded and long words shortened."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, str):
        return labels.shortened(value, longest)
    if isinstance(value, int) and abs(value) < 10**7:
        return labels.number_text(value)
    return labels.number_text(float(value), digits)


def shortened_words(words: Sequence[str], longest: int) -> list[str]:
    """Words of at most so many letters; what they have in common goes first."""
    if max(map(len, words)) <= longest:
        return list(words)
    if len(words) > 1:
        first = _alike(words)
        while first and words[0][first - 1].isdigit():
            first -= 1  # numbers stay whole
        last = _alike([word[:first:-1] for word in words])
        words = [
            ("…" if first > 1 else word[:first])
            + word[first : len(word) - last]
            + ("…" if last > 1 else word[len(word) - last :])
            for word in words
        ]
    return [labels.shortened(word, longest) for word in words]


def _alike(words: Sequence[str]) -> int:
    """How many letters all words have in common from the first on."""
    alike = takewhile(lambda letters: len(set(letters)) == 1, zip(*words, strict=False))
    return len(list(alike))


def metric_name(data: SweepData) -> str:
    """The metric in words, without a unit."""
    if data.metric == ITERATIONS_TO_TOLERANCE:
        bound = "the tolerance" if data.tolerance is None else _with_metres(data.tolerance)
        return f"iterations until the error stays below {bound}"
    name, _, when = _METRICS.get(data.metric, (data.metric, "", ""))
    return f"{name} {when}".strip()


def metric_unit(data: SweepData) -> str:
    """The unit of the metric; empty if it is a count."""
    return _METRICS.get(data.metric, ("", "", ""))[1]


def metric_label(data: SweepData, height: float, prefix: str = "") -> str:
    """The metric with its unit, as an axis of so many inches names it."""
    text = with_unit(prefix + metric_name(data), metric_unit(data))
    return textwrap.fill(text[0].upper() + text[1:], max(20, int(height / 0.068)))


def metric_text(data: SweepData, value: float) -> str:
    """A value of the metric with its unit."""
    if data.metric == ITERATIONS_TO_TOLERANCE:
        return f"{labels.number_text(value)} iterations"
    return f"{labels.number_text(value, 4)} {metric_unit(data)}".rstrip()


def _with_metres(length: float) -> str:
    return f"{labels.number_text(length, 4)} m"
