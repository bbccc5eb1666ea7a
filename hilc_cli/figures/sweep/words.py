"""What pictures of sweeps call keys, values and metrics, with their units."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import takewhile

from hilc_cli.figures import labels
from hilc_cli.results.sweep import ITERATIONS_TO_TOLERANCE, PEAK, SweepData
from hilc_cli.variation.axes import Value

LONGEST_KEY = 60
LONGEST_NAME = 32
LONGEST_WORD = 24

_UNITS_BY_LAST_NAME = {
    "b_w": "rad/s",
    "duration": "s",
    "gravity_center": "m",
    "h": "samples",
    "half_track": "m",
    "heading": "rad",
    "length": "m",
    "radius": "m",
    "sample_time": "s",
    "speed": "m/s",
    "wheel_radius": "m",
    "wheel_separation": "m",
    "x": "m",
    "y": "m",
}
_UNITS_BY_PLACE = {
    "bound": ("m", "m", "rad"),
    "standard_deviation": ("m", "m", "rad"),
    "center": ("m", "m"),
    "gravity_center": ("m", "m"),
    "to": ("m", "m"),
}

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


def unit_of(key: str) -> str:
    """The unit of a varied key; empty if it has none or none is known."""
    *above, last = key.split(".")
    if last.isdigit() and above:
        places = _UNITS_BY_PLACE.get(above[-1], ())
        return places[int(last)] if int(last) < len(places) else ""
    # The sweep of an arc is an angle; what is below the key 'sweep' is not.
    if last == "sweep" and len(above) > 1:
        return "rad"
    return _UNITS_BY_LAST_NAME.get(last, "")


def key_label(key: str, longest: int = LONGEST_KEY) -> str:
    """A key with its unit, as an axis names it; very long keys keep both ends."""
    return with_unit(labels.shortened(key, longest), unit_of(key))


def with_unit(text: str, unit: str) -> str:
    """A text with a unit behind it, if there is one."""
    return f"{text} [{unit}]" if unit else text


def key_label_in_lines(key: str, longest: int) -> str:
    """A key with its unit in at most two lines of so many characters, broken at a dot."""
    label = key_label(key, 2 * longest - 10)
    if len(label) <= longest:
        return label
    breaks = [place + 1 for place, letter in enumerate(label) if letter == "."]
    fitting = [b for b in breaks if b <= longest and len(label) - b <= longest]
    place = min(fitting, key=lambda b: abs(2 * b - len(label)), default=longest)
    return f"{label[:place]}\n{label[place:]}"


def short_names(keys: Sequence[str]) -> dict[str, str]:
    """Of each key the last part, or as many as tell it apart from the others."""
    names: dict[str, str] = {}
    for key in keys:
        parts = key.split(".")
        endings = (".".join(parts[-count:]) for count in range(1, len(parts) + 1))
        others = [f".{other}" for other in keys if other != key]
        name = next(
            (e for e in endings if not any(other.endswith(f".{e}") for other in others)), key
        )
        names[key] = labels.shortened(name, LONGEST_NAME)
    return names


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
