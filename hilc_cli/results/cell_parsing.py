"""Numbers of a table in machine code: the cells as hilc writes them, and nothing else.

Digits are read eight at a time. A decimal number is a product of two factors that fit two floats
each: its digits, and a power of ten. Where the product is far enough from the middle between two
floats to tell the nearer one, that is the number; else, and of any cell that is written in another
way, it is not told.

Source:
    Eight digits: Lemire, Number parsing at a gigabyte per second. Software: Practice and Experience
    51, 2021, section 5. The test of the rounding: Ziv, Fast evaluation of elementary mathematical
    functions with correctly rounded last bit. ACM TOMS 17, 1991.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached, inner
from hilc_cli.numba_loading import intrinsic, types
from hilc_cli.reference.sampled import Floats

LINE_END = ord("\n")
ROOM = 8
"""Bytes behind the last line that are read with it."""

_LARGEST_POWER = 270
"""Powers of ten up to this, and as far below 1, leave all products in the range of floats."""
_MOST_DIGITS = 18
"""Numbers of so many digits fit 64 bits and two floats."""
_TENS = np.array([10**power for power in range(_MOST_DIGITS + 1)], np.uint64)
_EXACT_DIGITS, _EXACT_POWER = 2**53, 22
"""Up to these, digits and power of ten are floats: their product is rounded once."""
_UNCERTAIN = 2.0**-100
"""Share of a product by which it may be off: some units in the last place of a pair of floats."""

# Numba makes floats of a sum of numbers with and without sign, so all of these have none.
_0, _1, _3, _4, _8, _9 = map(np.uint64, (0, 1, 3, 4, 8, 9))
_BYTES = tuple(map(np.uint64, range(0, 64, 8)))
"""How far a word is shifted by so many bytes."""
_MOST = np.uint64(_MOST_DIGITS)
_COMMA, _LINE_END, _MINUS, _PLUS, _POINT, _ZERO = map(np.uint64, (ord(","), LINE_END, *b"-+.0"))
_EXPONENT, _LARGE_EXPONENT = map(np.uint64, b"eE")

# Words of eight bytes.
_EACH = np.uint64(0x0101010101010101)
_HIGHEST = np.uint64(0x8080808080808080)
_ZEROS = _ZERO * _EACH
_BELOW_HIGHEST = np.uint64(0x80 - ord("9") - 1) * _EACH
"""Added to bytes it sets the highest bit of those that are above the digit 9."""
_EVERY_FOURTH = np.uint64(0x000000FF000000FF)
_FIRST_AND_THIRD = np.uint64(100 + (1_000_000 << 32))
_SECOND_AND_FOURTH = np.uint64(1 + (10_000 << 32))
"""What pairs of digits count, in the upper half of a product with them."""


@cache
def powers_of_ten() -> Floats:
    """Each power of ten as a sum of two floats, shape (2, powers), in rising order."""
    exact = [Fraction(10) ** power for power in range(-_LARGEST_POWER, _LARGEST_POWER + 1)]
    high = [float(power) for power in exact]
    low = [float(power - Fraction(rounded)) for power, rounded in zip(exact, high, strict=True)]
    return np.array([high, low])


def _product_and_sum(typing_context: Any, one: Any, other: Any, added: Any) -> Any:
    """A product of two floats and another one, rounded once as a whole."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fma(*arguments)

    return types.float64(one, other, added), generate


product_and_sum: Any = intrinsic(_product_and_sum)


def _zeros_before(typing_context: Any, word: Any) -> Any:
    """How many bits of a word are zero before its lowest that is not; 64 if all are."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(*arguments, context.get_constant(types.boolean, False))

    return types.uint64(word), generate


zeros_before: Any = intrinsic(_zeros_before)


def _number_of(digits: int, power: int, powers: Floats) -> float:
    """The float next to digits times a power of ten; not-a-number if it cannot be told.

    Args:
        digits: Below ten to the power of _MOST_DIGITS, or it is not told.
        power: Exponent of ten.
        powers: See `powers_of_ten`.
    """
    if digits >= 10**_MOST_DIGITS or abs(power) > _LARGEST_POWER:
        return math.nan
    number, high = float(digits), float(powers[0, _LARGEST_POWER + power])
    product = number * high
    if 0 <= power <= _EXACT_POWER and digits <= _EXACT_DIGITS:
        return product
    low = float(powers[1, _LARGEST_POWER + power])
    lost: float = product_and_sum(number, high, -product)
    lost += number * low + float(digits - np.int64(number)) * high
    nearest = product + lost
    beside = lost - (nearest - product)
    uncertain = _UNCERTAIN * nearest
    if nearest + (beside + uncertain) == nearest == nearest + (beside - uncertain):
        return nearest
    return math.nan


def _word_at(content: NDArray[np.uint8], at: np.uint64) -> np.uint64:
    """Eight bytes as one number, the first of them its lowest; the compiler loads them at once."""
    word = np.uint64(content[at])
    for place in range(1, 8):
        word |= np.uint64(content[at + np.uint64(place)]) << _BYTES[place]
    return word


def _leading_digits(word: np.uint64) -> np.uint64:
    """How many bytes of a word are digits, from the first on."""
    bits: np.uint64 = zeros_before(((word + _BELOW_HIGHEST) | (word - _ZEROS)) & _HIGHEST)
    return bits >> _3


def _value_of(word: np.uint64, count: np.uint64) -> np.uint64:
    """The number that the first digits of a word make.

    They are put behind zeros, and taken together in pairs, and then all four pairs.
    """
    half = _4 * (_8 - count)  # no word can be shifted by all of its bits at once
    digits = (word - _ZEROS) << half << half
    pairs = digits * np.uint64(10) + (digits >> _8)
    odd, even = pairs & _EVERY_FOURTH, (pairs >> _BYTES[2]) & _EVERY_FOURTH
    return (odd * _FIRST_AND_THIRD + even * _SECOND_AND_FOURTH) >> _BYTES[4]


word_at = inner(_word_at)
leading_digits = inner(_leading_digits)
value_of = inner(_value_of)


def _append_digits(
    content: NDArray[np.uint8], at: np.uint64, digits: np.uint64
) -> tuple[np.uint64, np.uint64]:
    """Appends the digits that stand somewhere to others.

    Returns:
        All of them as a number, and where they end. More than _MOST_DIGITS are not read, and make
        the smallest number of more.
    """
    more = True
    while more:
        word = word_at(content, at)
        count = leading_digits(word)
        if count == _8:
            if digits >= _TENS[_MOST - _8]:
                return _TENS[_MOST], at
            digits = digits * _TENS[_8] + value_of(word, _8)
            at += _8
            # Whether there is none, some or another eight is not asked: nobody could foresee it.
            word = word_at(content, at)
            count = leading_digits(word)
        if digits >= _TENS[_MOST - count]:
            return _TENS[_MOST], at
        digits = digits * _TENS[count] + value_of(word, count)
        at += count
        more = bool(np.uint64(content[at]) - _ZERO <= _9)
    return digits, at


append_digits = inner(_append_digits)


def _first_digits(content: NDArray[np.uint8], at: np.uint64) -> tuple[np.uint64, np.uint64]:
    """The same of the digits that a number begins with: mostly one, for which no word is read."""
    digits, second = np.uint64(content[at]) - _ZERO, np.uint64(content[at + _1]) - _ZERO
    if digits <= _9 < second:
        at += _1
    else:
        digits, at = append_digits(content, at, _0)
    return digits, at


number_of = inner(_number_of)
first_digits = inner(_first_digits)


def _parse_lines(
    content: NDArray[np.uint8],
    size: int,
    powers: Floats,
    table: Floats,
    row: int,
    with_point: NDArray[np.bool_],
    with_gap: NDArray[np.bool_],
) -> int:
    """Reads lines of numbers into the columns of a table.

    Args:
        content: Whole lines, and behind them room for ROOM more bytes.
        size: Bytes of the lines.
        powers: See `powers_of_ten`.
        table: Gets the numbers, not-a-number of an empty cell, shape (columns, rows).
        row: Of the first line; there must be room for all.
        with_point: Gets for each column whether any of its numbers has a point or an exponent.
        with_gap: Gets for each column whether any of its cells is empty.

    Returns:
        The row after the last; -1 unless all cells are plain numbers or empty, and all lines have
        as many cells as the table has columns.
    """
    at, after, column, columns = _0, np.uint64(size), 0, len(table)
    while at < after:
        end = _LINE_END if column == columns - 1 else _COMMA
        byte = np.uint64(content[at])
        if byte == end:
            if columns == 1:  # an empty line
                return -1
            table[column, row] = math.nan
            with_gap[column] = True
        else:
            negative = byte == _MINUS
            if negative:
                at += _1
            first, power = at, np.int64(0)
            digits, at = first_digits(content, first)
            if at == first:
                return -1
            byte = np.uint64(content[at])
            if byte == _POINT:
                with_point[column] = True
                first = at + _1
                digits, at = append_digits(content, first, digits)
                if at == first:
                    return -1
                power = np.int64(first) - np.int64(at)
                byte = np.uint64(content[at])
            if byte in (_EXPONENT, _LARGE_EXPONENT):
                with_point[column] = True
                at += _1
                byte = np.uint64(content[at])
                falls = byte == _MINUS
                if falls or byte == _PLUS:
                    at += _1
                first = at
                exponent, at = append_digits(content, first, _0)
                if at == first or at > first + _4:
                    return -1
                power += -np.int64(exponent) if falls else np.int64(exponent)
                byte = np.uint64(content[at])
            if byte != end:
                return -1
            number = number_of(np.int64(digits), power, powers)
            if number != number:
                return -1
            table[column, row] = -number if negative else number
        at += _1
        column += 1
        if column == columns:
            column, row = 0, row + 1
    return row if column == 0 else -1


parse_lines = cached(_parse_lines)
