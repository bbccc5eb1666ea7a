"""Numbers as people write them: ``pi/2``, ``14*pi/15``, ``90 deg``, ``10 m/s``.

Grammar::

    sum     = product { ("+" | "-") product }
    product = factor { ("*" | "/") factor | unit }
    factor  = { "+" | "-" } ( number | name | "(" sum ")" | unit )
    unit    = ( "deg" | "rad" | ... | "km/h" ) [ "^" digit ]

A unit stands behind a number. The first unit of a product applies to the whole product so far
(``pi/2 rad`` is half of pi radians), a later one to the factor that it follows
(``10 m / 2 s`` is 5 m/s); a unit without a number may follow ``*`` or ``/`` (``10 m/s``).

Gain matrices use the same grammar with the names ``cos`` and ``sin``: every value is therefore
carried as constant + cos * cos(heading) + sin * sin(heading), and products of two
heading-dependent values are errors.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from hilc_cli.wording import near_word

LONGEST_EXPRESSION = 120
_DEEPEST = 20
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<word>km/h(?!\w)|[^\W\d]\w*)|(?P<mark>[-+*/()^]))"
)


@dataclass(frozen=True, slots=True)
class Affine:
    """A number that depends on the heading: constant + cos * cos(heading) + sin * sin(heading)."""

    constant: float = 0.0
    cos: float = 0.0
    sin: float = 0.0


class ExpressionError(ValueError):
    """The text is no number or expression."""


class Unit(NamedTuple):
    """Powers of the quantities that a value is made of."""

    length: int = 0
    time: int = 0
    angle: int = 0

    @property
    def text(self) -> str:
        """The unit as people write it, such as ``rad/m²``; empty for none."""
        powers = (("rad", self.angle), ("m", self.length), ("s", self.time))
        above = "·".join(name + _SUPERSCRIPTS[power] for name, power in powers if power > 0)
        below = "·".join(name + _SUPERSCRIPTS[-power] for name, power in powers if power < 0)
        return f"{above or 1}/{below}" if below else above


_SUPERSCRIPTS = {1: "", 2: "²", 3: "³", 4: "⁴"}


PLAIN = Unit()

UNITS: Mapping[str, tuple[float, Unit]] = {
    "deg": (math.pi / 180, Unit(angle=1)),
    "rad": (1.0, Unit(angle=1)),
    "ms": (1e-3, Unit(time=1)),
    "s": (1.0, Unit(time=1)),
    "mm": (1e-3, Unit(length=1)),
    "cm": (1e-2, Unit(length=1)),
    "m": (1.0, Unit(length=1)),
    "rpm": (2 * math.pi / 60, Unit(angle=1, time=-1)),
    "km/h": (1e3 / 3600, Unit(length=1, time=-1)),
    "Hz": (1.0, Unit(time=-1)),
}
_HIGHEST_POWER = 4
_POWERS = [str(power) for power in range(1, _HIGHEST_POWER + 1)]


@dataclass(frozen=True, slots=True)
class Value:
    """A number, possibly affine in cos and sin of the heading, and its unit."""

    number: Affine
    unit: Unit = PLAIN

    @property
    def is_constant(self) -> bool:
        """Whether it does not depend on the heading."""
        return self.number.cos == 0 and self.number.sin == 0


def evaluate(text: str, names: Mapping[str, Affine] | None = None, *, units: bool = True) -> Value:
    """The value of an expression in SI units.

    Args:
        text: The expression.
        names: Further names beside ``pi``.
        units: Whether unit suffixes are allowed.

    Raises:
        ExpressionError: It is no expression, divides by zero, adds different units, or is not
            affine in cos and sin.
    """
    if len(text) > LONGEST_EXPRESSION:
        raise ExpressionError(f"is longer than {LONGEST_EXPRESSION} characters")
    known = {"pi": Affine(math.pi), **(names or {})}
    parser = _Parser(_tokens(text), known, UNITS if units else {})
    value = parser.sum()
    if not parser.token:
        return value
    is_word = parser.token[0] not in "0123456789.+-*/()^_"
    if units and is_word and parser.token not in (*known, *UNITS):
        raise ExpressionError(f"has the unknown unit '{parser.token}'")
    raise ExpressionError(f"has '{parser.token}' where it should end or have an operator")


def _tokens(text: str) -> list[str]:
    tokens = []
    position = 0
    text = text.rstrip()
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise ExpressionError(f"has '{text[position:].lstrip()[:1]}', which is no part of it")
        tokens.append(match.group().strip())
        position = match.end()
    return tokens


class _Parser:
    def __init__(
        self,
        tokens: list[str],
        names: Mapping[str, Affine],
        units: Mapping[str, tuple[float, Unit]],
    ) -> None:
        self.tokens = [*tokens, ""]
        self.next = 0
        self.names = names
        self.units = units
        self.depth = 0

    @property
    def token(self) -> str:
        return self.tokens[self.next]

    def take(self) -> str:
        self.next += 1
        return self.tokens[self.next - 1]

    def sum(self) -> Value:
        total = self.product()
        while self.token in ("+", "-"):
            sign = 1.0 if self.take() == "+" else -1.0
            total = _add(total, self.product(), sign)
        return total

    def product(self) -> Value:
        product = self.factor()
        operator, unit_seen = "*", False
        while True:
            if self.token in ("*", "/"):
                operator = self.take()
                is_unit = self.token in self.units
                factor = self.unit() if is_unit else self.factor()
                product = (
                    _multiply(product, factor) if operator == "*" else _divide(product, factor)
                )
                unit_seen = unit_seen or is_unit
            elif self.token in self.units and not self.follows_unit():
                unit = self.unit()
                divides = unit_seen and operator == "/"
                product = _divide(product, unit) if divides else _multiply(product, unit)
                unit_seen = True
            else:
                return product

    def factor(self) -> Value:
        sign = 1.0
        while self.token in ("+", "-"):
            sign = -sign if self.take() == "-" else sign
        value = self.primary()
        return value if sign > 0 else Value(_scaled(value.number, -1.0), value.unit)

    def primary(self) -> Value:
        token = self.take()
        if token == "(":
            self.depth += 1
            if self.depth > _DEEPEST:
                raise ExpressionError(f"has more than {_DEEPEST} nested brackets")
            inner = self.sum()
            if self.take() != ")":
                raise ExpressionError("has an opening bracket without a closing one")
            self.depth -= 1
            return inner
        if token[:1] and token[0] in "0123456789.":
            return Value(Affine(float(token)))
        if token in self.names:
            return Value(self.names[token])
        if token in self.units:
            raise ExpressionError(f"has the unit '{token}' without a number before it")
        if token and token not in "+-*/()^":
            near = near_word(token, self.names)
            hint = f"; did you mean '{near}'?" if near else ""
            raise ExpressionError(f"has the unknown name '{token}'{hint}")
        if token:
            raise ExpressionError(f"has '{token}' where a number should be")
        raise ExpressionError("ends where a number should be")

    def follows_unit(self) -> bool:
        """Whether what stands before is a unit, or its power."""
        before = self.tokens[max(self.next - 3, 0) : self.next]
        return before[-1] in self.units or (before[-2:-1] == ["^"] and before[0] in self.units)

    def unit(self) -> Value:
        factor, unit = self.units[self.take()]
        power = 1
        if self.token == "^":
            self.take()
            if self.token not in _POWERS:
                raise ExpressionError(f"has no power from 1 to {_HIGHEST_POWER} behind '^'")
            power = int(self.take())
        return Value(Affine(factor**power), Unit(*(power * each for each in unit)))


def _add(a: Value, b: Value, sign: float) -> Value:
    if a.unit != b.unit:
        raise ExpressionError("adds values of different units")
    x, y = a.number, b.number
    total = Affine(x.constant + sign * y.constant, x.cos + sign * y.cos, x.sin + sign * y.sin)
    return Value(total, a.unit)


def _multiply(a: Value, b: Value) -> Value:
    unit = Unit(*(p + q for p, q in zip(a.unit, b.unit, strict=True)))
    if b.is_constant:
        return Value(_scaled(a.number, b.number.constant), unit)
    if a.is_constant:
        return Value(_scaled(b.number, a.number.constant), unit)
    raise ExpressionError("multiplies cos and sin with each other; entries are affine in them")


def _divide(a: Value, b: Value) -> Value:
    if not b.is_constant:
        raise ExpressionError("divides by cos or sin; entries are affine in them")
    divisor = b.number.constant
    if divisor == 0:
        raise ExpressionError("divides by zero")
    number = Affine(a.number.constant / divisor, a.number.cos / divisor, a.number.sin / divisor)
    return Value(number, Unit(*(p - q for p, q in zip(a.unit, b.unit, strict=True))))


def _scaled(number: Affine, factor: float) -> Affine:
    # A factor that has overflowed leaves what is zero as it is.
    cos = number.cos * factor if number.cos else 0.0
    sin = number.sin * factor if number.sin else 0.0
    return Affine(number.constant * factor, cos, sin)
