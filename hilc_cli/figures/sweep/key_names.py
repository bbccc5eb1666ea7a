"""What pictures of sweeps call keys, with their units."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

from hilc_cli.figures import labels

LONGEST_KEY = 60
LONGEST_NAME = 32

_UNITS_BY_LAST_NAME = {
    "b_w": "rad/s",
    "cutoff": "Hz",
    "duration": "s",
    "gravity_center": "m",
    "h": "samples",
    "half_track": "m",
    "heading": "rad",
    "input_change": "rad/s",
    "k_theta": "rad/m",
    "k_x": "1/s",
    "k_y": "rad/m²",
    "kd": "s",
    "ki": "1/s",
    "lateral": "rad/m",
    "length": "m",
    "memory": "iterations",
    "position": "m",
    "radius": "m",
    "sample_time": "s",
    "speed": "m/s",
    "switch_tolerance": "m and rad",
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


def key_labels_in_lines(keys: Sequence[str], longest: int) -> dict[str, str]:
    """Keys side by side, each with its unit in at most two lines of so many characters.

    Where a key is too long, what all of them begin with is left out, and then what else it needs
    not to be told from the others.
    """
    found = {key: _in_lines(key, unit_of(key), longest) for key in keys}
    if None not in found.values():
        return {key: str(label) for key, label in found.items()}
    parts = [key.split(".")[:-1] for key in keys]
    alike = len(list(takewhile(lambda names: len(set(names)) == 1, zip(*parts, strict=False))))
    return {key: _shortened_in_lines(key, keys, alike, longest) for key in keys}


def _shortened_in_lines(key: str, keys: Sequence[str], left_out: int, longest: int) -> str:
    """A key without so many leading parts, or as many more as it takes."""
    others = [f".{other}" for other in keys if other != key]
    parts = key.split(".")
    endings = [".".join(parts[count:]) for count in range(left_out, len(parts))]
    own = [e for e in endings if not any(o.endswith(f".{e}") for o in others)] or endings[:1]
    unit = unit_of(key)
    lines = (_in_lines(name, unit, longest) for name in own)
    label = next((label for label in lines if label is not None), None)
    if label is None:  # no good place for a break
        label = with_unit(labels.shortened(own[-1], 2 * longest - 12), unit)
        label = f"{label[:longest]}\n{label[longest:]}"
    return label


def _in_lines(name: str, unit: str, longest: int) -> str | None:
    """A name with its unit in at most two lines, broken at a dot or before the unit."""
    label = with_unit(name, unit)
    if len(label) <= longest:
        return label
    breaks = [place + 1 for place, letter in enumerate(name) if letter == "."]
    breaks += [len(name) + 1] if unit else []
    fitting = [
        b for b in breaks if len(label[:b].rstrip()) <= longest and len(label) - b <= longest
    ]
    if not fitting:
        return None
    place = min(fitting, key=lambda b: abs(2 * b - len(label)))
    return f"{label[:place].rstrip()}\n{label[place:]}"


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
