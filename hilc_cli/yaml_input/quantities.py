"""Field types for Pydantic models: numbers with a unit, bounds and an expression behind them."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import PydanticCustomError, core_schema

from hilc_cli.yaml_input.expressions import PLAIN, UNITS, ExpressionError, Unit, evaluate
from hilc_cli.yaml_input.model import wrong
from hilc_cli.yaml_input.tree import LONGEST_NUMBER

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
    **_names("*9.80665 m/s^2", "g", "gee"),
    **_names("*360 deg", "turn", "turns", "rev", "revs", "revolution", "revolutions"),
    **_names("*2*pi", "tau"),
    **_names("pi", "\N{GREEK SMALL LETTER PI}"),
    **_names("km", "km", "kilometer", "kilometers", "kilometre", "kilometres"),
    **_names("h", "h", "hr", "hrs", "hour", "hours"),
}
"""Units by their names in lower case; ``*`` in front goes on from the number before."""
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


def _is_in(text: str, unit: Unit) -> bool:
    """Whether a text is an expression in a unit that is one."""
    return unit != PLAIN and _has_unit(text, unit) and evaluate(text).unit == unit


def _has_unit(text: str, fits: Unit) -> bool:
    try:
        found = evaluate(text).unit
    except ExpressionError:
        return False
    return found in (Unit(), fits)


MOST_CASES = 100_000_000
_LARGEST = 1e9  # keeps squares and products far from overflow; nothing real is larger
_SMALLEST = 1e-30  # keeps quotients far from overflow; nothing real is smaller, but for 0
_FAR = 1e6
"""Bounds from here on only keep out what nobody means: they are told to whoever passes them."""


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float field that may be written as an expression.

    Attributes:
        unit: The unit that the value must have, if it is written with one.
        example: What to write, for error messages and editors.
        above: Exclusive lower bound.
        least: Inclusive lower bound.
        most: Inclusive upper bound.
        smallest: What is nearer to 0 and not 0 is nothing real.
        whole: Only whole numbers, as int.
        told_in: What it is told in, where its unit does not say that, such as ``samples``.
    """

    unit: Unit
    example: str
    above: float | None = None
    least: float | None = None
    most: float | None = None
    smallest: float | None = None
    whole: bool = False
    told_in: str = ""

    def __call__(self, value: object) -> float:
        """The number in SI units.

        Raises:
            PydanticCustomError: It is no number, has another unit, or exceeds a bound.
        """
        number = self._bounded(self._number(value))
        if not self.whole:
            return number
        if number != round(number):
            raise wrong("must be a whole number", self.remedy)
        return round(number)

    @property
    def remedy(self) -> str:
        """What is allowed, as a sentence; ends that only nonsense passes are left out."""
        far = self.most is not None and (self.most >= _FAR or self.smallest is not None)
        return self._allowed(self.above, None if far else self.most)

    @property
    def _whole_remedy(self) -> str:
        """What is allowed, with both ends."""
        if self.smallest is None:
            return self._allowed(self.above, self.most)
        or_nothing = "" if self.above is not None else "0, or "
        ends = f"{or_nothing}a number from {_shown(self.smallest)}"
        ends += "" if self.most is None else f" to {_shown(self.most)}"
        return f"give {ends}, such as {self.example}"

    def _allowed(self, above: float | None, most: float | None) -> str:
        kind = "a whole number" if self.whole else "a number"
        bound = ""
        if above is not None:
            bound = f" above {_shown(above)}"
            bound += "" if most is None else f" and up to {_shown(most)}"
        elif self.least is not None and (self.least > -_FAR or most is not None):
            bound = f" from {_shown(self.least)}"
            bound += " up" if most is None else f" to {_shown(most)}"
        return f"give {kind}{bound}, such as {self.example}"

    def _number(self, value: object) -> float:
        if self.whole and isinstance(value, int) and not isinstance(value, bool):
            return value  # as it is: a float does not hold every seed
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise wrong("must be a number", self.remedy)
        if isinstance(value, str):
            if len(value) > LONGEST_NUMBER and value.lstrip("+-").isdigit():
                raise wrong(f"has {len(value)} digits", self.remedy)
            try:
                result = evaluate(value)
            except ExpressionError as error:
                raise self._no_expression(value, error) from None
            if result.unit not in (PLAIN, self.unit):
                problem = "must have no unit" if self.unit == PLAIN else "has the wrong unit"
                candidates = (f"{value}/s".replace("/s/s", "/s^2"), f"1/({value})")
                near = next((each for each in candidates if _is_in(each, self.unit)), None)
                raise wrong(problem, f"did you mean '{near}'?" if near else self.remedy)
            number = result.number.constant
        else:
            try:
                number = float(value)
            except OverflowError:
                number = math.inf
        if not math.isfinite(number):
            raise wrong("must be finite", self.remedy)
        return number

    def _no_expression(self, text: str, error: ExpressionError) -> PydanticCustomError:
        problem, _, remedy = str(error).partition("; ")
        if "has ','" in problem and re.search(r"[0-9],[0-9]", text):
            problem = "has a decimal comma"
        meant = corrected(text, self.unit)
        if meant is not None:
            return wrong(problem, f"did you mean '{meant}'?")
        if "unknown unit" in problem and self.unit in _NAMES:
            return wrong(problem, f"give it in {_NAMES[self.unit]}")
        return wrong(problem, remedy or self.remedy)

    def _bounded(self, number: float) -> float:
        if self.above is not None and not number > self.above:
            raise wrong(f"must be above {_shown(self.above)}", self.remedy)
        if self.least is not None and not number >= self.least:
            raise wrong(f"must be at least {_shown(self.least)}", self.remedy)
        if self.most is not None and not number <= self.most:
            raise wrong(f"must be at most {_shown(self.most)}", self._whole_remedy)
        if self.smallest is not None and 0 < abs(number) < self.smallest:
            raise wrong(f"must be at least {_shown(self.smallest)}", self._whole_remedy)
        return number

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Pydantic's hook: this object validates the field."""
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Pydantic's hook: a number within the bounds, or an expression."""
        number: dict[str, object] = {"type": "integer" if self.whole else "number"}
        nothing: list[dict[str, object]] = []
        if self.smallest is not None:
            number["minimum"] = self.smallest
            nothing = [] if self.above is not None else [{"const": 0}]
        elif self.above is not None:
            number["exclusiveMinimum"] = self.above
        elif self.least is not None:
            number["minimum"] = self.least
        if self.most is not None:
            number["maximum"] = self.most
        return {
            "anyOf": [
                number,
                *nothing,
                {"type": "string", "description": f"an expression, such as {self.example}"},
            ]
        }


def such_as(kind: Any, example: str, told_in: str = "") -> Quantity:
    """A kind of quantity for a key to which another example fits.

    Args:
        kind: The annotated type, such as `PositiveLength`.
        example: What to write.
        told_in: As in `Quantity`; as the kind has it by default.
    """
    (quantity,) = kind.__metadata__
    assert isinstance(quantity, Quantity)
    return replace(quantity, example=example, told_in=told_in or quantity.told_in)


def quantities_in(annotation: Any) -> list[Quantity]:
    """The quantities that values of a kind hold: one of a number, one for each of a tuple."""
    own = [part for part in getattr(annotation, "__metadata__", ()) if isinstance(part, Quantity)]
    return own or [each for part in get_args(annotation) for each in quantities_in(part)]


def _shown(bound: float) -> str:
    return str(bound) if isinstance(bound, int) else f"{bound:g}"


_LENGTH, _TIME, _ANGLE = Unit(length=1), Unit(time=1), Unit(angle=1)
_SPEED, _WHEEL_SPEED = Unit(length=1, time=-1), Unit(angle=1, time=-1)
_NAMES = {
    _LENGTH: "mm, cm or m",
    _TIME: "ms or s",
    _ANGLE: "deg or rad",
    _SPEED: "m/s or km/h",
    _WHEEL_SPEED: "rad/s, deg/s or rpm",
    Unit(length=-1): "1/m",
    Unit(length=1, time=-2): "m/s^2",
    Unit(angle=1, time=-2): "rad/s^2",
}

Coordinate = Annotated[float, Quantity(_LENGTH, "1.5 or 20 cm", least=-1e8, most=1e8)]
RobotLength = Annotated[float, Quantity(_LENGTH, "0.2 or 20 cm", above=0, smallest=1e-5, most=1e3)]
WheelSeparation = Annotated[  # twice a half track
    float, Quantity(_LENGTH, "0.4 or 40 cm", above=0, smallest=2e-5, most=2e3)
]
PositiveLength = Annotated[
    float, Quantity(_LENGTH, "0.2 or 20 cm", above=0, smallest=1e-12, most=1e8)
]
LengthBound = Annotated[
    float, Quantity(_LENGTH, "0.001 or 1 mm", least=0, smallest=_SMALLEST, most=1e8)
]
Angle = Annotated[float, Quantity(_ANGLE, "pi/2 or 90 deg", least=-1e6, most=1e6)]
PositiveAngle = Annotated[
    float, Quantity(_ANGLE, "pi or 180 deg", above=0, smallest=1e-12, most=1e6)
]
AngleBound = Annotated[
    float, Quantity(_ANGLE, "0.001 or 0.1 deg", least=0, smallest=_SMALLEST, most=1e6)
]
Curvature = Annotated[
    float, Quantity(Unit(length=-1), "0.2, 0.2/m or 1/(5 m)", least=-_LARGEST, most=_LARGEST)
]
TurnAngle = Annotated[float, Quantity(_ANGLE, "pi/2 or -90 deg", least=-1e6, most=1e6)]
PositiveTime = Annotated[
    float, Quantity(_TIME, "0.5 or 500 ms", above=0, smallest=1e-9, most=_LARGEST)
]
SampleTime = Annotated[float, Quantity(_TIME, "0.001 or 1 ms", above=0, smallest=1e-6, most=1e4)]
PositiveSpeed = Annotated[float, Quantity(_SPEED, "2 or 2 m/s", above=0, smallest=1e-9, most=1e6)]
PositiveAcceleration = Annotated[
    float,
    Quantity(Unit(length=1, time=-2), "0.5 or 0.5 m/s^2", above=0, smallest=1e-9, most=_LARGEST),
]
PositiveRate = Annotated[
    float, Quantity(_WHEEL_SPEED, "1.5 or 90 deg/s", above=0, smallest=1e-9, most=1e6)
]
PositiveWheelSpeed = Annotated[
    float, Quantity(_WHEEL_SPEED, "180 or 1700 rpm", above=0, smallest=1e-9, most=_LARGEST)
]
WheelSpeedLoss = Annotated[
    float, Quantity(_WHEEL_SPEED, "0.2 or 2 rpm", least=0, smallest=_SMALLEST, most=_LARGEST)
]
WheelAcceleration = Annotated[
    float,
    Quantity(Unit(angle=1, time=-2), "30 or 30 rad/s^2", above=0, smallest=1e-9, most=_LARGEST),
]
PositiveNumber = Annotated[float, Quantity(PLAIN, "0.8", above=0, smallest=1e-6, most=1e6)]
Gain = Annotated[float, Quantity(PLAIN, "0.5", least=0, smallest=_SMALLEST, most=1e12)]
GainPerSecond = Annotated[
    float, Quantity(Unit(time=-1), "0.5", least=0, smallest=_SMALLEST, most=1e12)
]
CurvatureGain = Annotated[
    float,
    Quantity(
        Unit(angle=1, length=-2), "8 or 8 rad/m/m", least=0, smallest=_SMALLEST, most=_LARGEST
    ),
]
Duration = Annotated[
    float, Quantity(_TIME, "0.5 or 500 ms", least=0, smallest=_SMALLEST, most=_LARGEST)
]
Frequency = Annotated[
    float,
    Quantity(Unit(time=-1), "20 or 20 Hz", above=0, smallest=1e-9, most=_LARGEST, told_in="Hz"),
]
Share = Annotated[float, Quantity(PLAIN, "0.1", least=0, most=1)]
SlipShare = Annotated[float, Quantity(PLAIN, "0.03", least=0, most=0.99)]
LateralGain = Annotated[
    float,
    Quantity(
        Unit(angle=1, length=-1), "0.3 or 0.3 rad/m", least=0, smallest=_SMALLEST, most=_LARGEST
    ),
]
Tolerance = Annotated[
    float, Quantity(PLAIN, "1e-9, in m and rad", least=0, most=_LARGEST, told_in="m and rad")
]
Iterations = Annotated[int, Quantity(PLAIN, "100", least=0, most=10_000_000, whole=True)]
Samples = Annotated[
    int, Quantity(PLAIN, "200", least=1, most=1_000_000, whole=True, told_in="samples")
]
CaseCount = Annotated[int, Quantity(PLAIN, "1000", least=1, most=MOST_CASES, whole=True)]
Seed = Annotated[int, Quantity(PLAIN, "0", least=0, most=2**64 - 1, whole=True)]
