"""What somebody meant whose number is written as other programs, or people, write it."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from functools import partial

from hilc_cli.spec.expressions import UNITS, ExpressionError, Unit, evaluate

_SIGNS = str.maketrans({
    "\N{MINUS SIGN}": "-", "\N{EN DASH}": "-", "\N{EM DASH}": "-", "\N{HYPHEN}": "-",
    "\N{NON-BREAKING HYPHEN}": "-", "\N{MULTIPLICATION SIGN}": "*", "\N{MIDDLE DOT}": "*",
    "\N{DIVISION SIGN}": "/", "\N{DIVISION SLASH}": "/", "\N{DEGREE SIGN}": " deg",
    "\N{MASCULINE ORDINAL INDICATOR}": " deg", "\N{SUPERSCRIPT TWO}": "^2",
    "\N{SUPERSCRIPT THREE}": "^3", "\N{MICRO SIGN}": "u", "\N{GREEK SMALL LETTER MU}": "u",
    **dict.fromkeys("\N{LEFT DOUBLE QUOTATION MARK}\N{RIGHT DOUBLE QUOTATION MARK}"
                    "\N{LEFT SINGLE QUOTATION MARK}\N{RIGHT SINGLE QUOTATION MARK}"
                    "\N{DOUBLE LOW-9 QUOTATION MARK}\"'", " "),
    **dict.fromkeys("\N{ZERO WIDTH SPACE}\N{ZERO WIDTH NON-JOINER}\N{WORD JOINER}"
                    "\N{ZERO WIDTH NO-BREAK SPACE}", " "),
})  # fmt: skip


def _names(unit: str, *names: str) -> dict[str, str]:
    return dict.fromkeys(names, unit)


_OTHER_UNITS: Mapping[str, str] = {
    **_names("m", "meter", "meters", "metre", "metres"),
    **_names("cm", "centimeter", "centimeters", "centimetre", "centimetres"),
    **_names("mm", "millimeter", "millimeters", "millimetre", "millimetres"),
    **_names("s", "sec", "secs", "second", "seconds"),
    **_names("ms", "msec", "msecs", "millisec", "millisecond", "milliseconds"),
    **_names("deg", "degs", "degree", "degrees"),
    **_names("rad", "rads", "radian", "radians"),
    **_names("Hz", "hertz"),
    **_names("m/s", "mps"),
    **_names("km/h", "kmh", "kph", "kmph"),
    **_names("mm/s", "mmps"),
    **_names("cm/s", "cmps"),
    **_names("deg/s", "dps", "degps"),
    **_names("rad/s", "radps"),
    **_names("rpm", "rev/min"),
    **_names("*60 rpm", "rps"),
    **_names("*60 s", "min", "mins", "minute", "minutes"),
    **_names("*1e-6 s", "us", "usec", "microsecond", "microseconds"),
    **_names("*1e-6 m", "um", "micron", "microns", "micrometer", "micrometers"),
    **_names("*0.1 m", "dm"),
    **_names("*25.4 mm", "in", "inch", "inches"),
    **_names("*0.3048 m", "ft", "foot", "feet"),
    **_names("*0.9144 m", "yd", "yard", "yards"),
    **_names("*0.44704 m/s", "mph"),
    **_names("*1000 Hz", "khz"),
    **_names("*360 deg", "turn", "turns", "rev", "revs", "revolution", "revolutions"),
    **_names("*2*pi", "tau"),
    **_names("pi", "\N{GREEK SMALL LETTER PI}"),
    **_names("km", "km", "kilometer", "kilometers", "kilometre", "kilometres"),
    **_names("h", "h", "hr", "hrs", "hour", "hours"),
}
"""By names in lower case; ``*`` in front goes on from the number before."""
_ALONE: Mapping[str, str] = {"km": "*1000 m", "h": "*3600 s"}
"""Units that are known only as parts of km/h."""
_SAME_IN_CAPITALS = {name.lower(): name for name in UNITS}
_MAY_BE_THOUSANDS = re.compile(r"[1-9],[0-9]{3}(?![0-9])")
_WORD = re.compile(r"(?P<before>[0-9.)]?)(?P<gap>\s*)(?P<word>[^\W\d_]+)(?P<power>[23]?)(?!\w)")


def corrected(text: str, fits: Unit) -> str | None:
    """The text as an expression with the right unit; None if it is unlike any.

    Args:
        text: What is no expression.
        fits: The unit that it must have, if it has one.
    """
    if _MAY_BE_THOUSANDS.search(text):
        return None
    for candidate in _candidates(" ".join(text.translate(_SIGNS).split())):
        if candidate != text and _has_unit(candidate, fits):
            return candidate
    return None


def _candidates(text: str) -> Iterator[str]:
    text = re.sub(r"(?<=[0-9]),(?=[0-9])", ".", unicodedata.normalize("NFKC", text))
    nothing: Mapping[str, str] = {}
    for alone in (nothing, _ALONE):
        words = _WORD.sub(partial(_word, alone=alone), text).strip()
        yield re.sub(r"km\s*/\s*h\b", "km/h", words)


def _word(found: re.Match[str], alone: Mapping[str, str]) -> str:
    before, gap, word, power = found.group("before", "gap", "word", "power")
    known = word if word in UNITS else _SAME_IN_CAPITALS.get(word.lower(), word)
    unit = _OTHER_UNITS.get(known.lower(), known)
    unit = alone.get(unit, unit)
    power = f"^{power}" if power and unit in UNITS else power
    if unit.startswith("*"):
        return f"{before}{unit if before else unit[1:]}{power}"
    if unit == "pi" and before:
        return f"{before}*pi{power}"
    if before and not gap and unit not in ("e", "E"):
        gap = " "
    return f"{before}{gap}{unit}{power}"


def _has_unit(text: str, fits: Unit) -> bool:
    try:
        found = evaluate(text).unit
    except ExpressionError:
        return False
    return found in (Unit(), fits)
