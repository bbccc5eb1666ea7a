"""Numbers of a table in machine code: the cells as hilc writes them, and nothing else.

A decimal number is a product of two factors that fit two floats each: its digits, and a power of
ten. Where the product is far enough from the middle between two floats to tell the nearer one, that
is the number; else, and of any cell that is written in another way, it is not told.

Source:
    The product: Dekker, A floating-point technique for extending the available precision. Numer.
    Math. 18, 1971. The test of the rounding: Ziv, Fast evaluation of elementary mathematical
    functions with correctly rounded last bit. ACM TOMS 17, 1991.
"""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached, compiled
from hilc_cli.reference.sampled import Floats

_LARGEST_POWER = 270
"""Powers of ten up to this, and as far below 1, leave all products in the range of floats."""
_DIGITS = 10**17
"""Digits make at most ten times this number, which fits 64 bits and two floats."""
_EXACT_DIGITS, _EXACT_POWER = 2**53, 22
"""Up to these, digits and power of ten are floats: their product or quotient is rounded once."""
_UNCERTAIN = 2.0**-100
"""Share of a product by which it may be off: some units in the last place of a pair of floats."""
_SPLIT = 2.0**27 + 1
"""Cuts a float in two halves whose products are exact."""

COMMA, LINE_END = ord(","), ord("\n")
_MINUS, _PLUS, _POINT, _ZERO, _NINE = map(ord, "-+.09")
_EXPONENT, _LARGE_EXPONENT = map(ord, "eE")


@cache
def powers_of_ten() -> Floats:
    """Each power of ten as a sum of two floats, shape (2, powers), in rising order."""
    exact = [Fraction(10) ** power for power in range(-_LARGEST_POWER, _LARGEST_POWER + 1)]
    high = [float(power) for power in exact]
    low = [float(power - Fraction(rounded)) for power, rounded in zip(exact, high, strict=True)]
    return np.array([high, low])


def _number_of(digits: int, power: int, powers: Floats) -> float:
    """The float next to digits times a power of ten; not-a-number if it cannot be told.

    Args:
        digits: Below 10 * _DIGITS.
        power: Exponent of ten.
        powers: See `powers_of_ten`.
    """
    number = float(digits)
    if digits <= _EXACT_DIGITS and -_EXACT_POWER <= power <= _EXACT_POWER:
        if power < 0:
            return number / float(powers[0, _LARGEST_POWER - power])
        return number * float(powers[0, _LARGEST_POWER + power])
    if digits == 0 or abs(power) > _LARGEST_POWER:
        return math.nan
    high = float(powers[0, _LARGEST_POWER + power])
    low = float(powers[1, _LARGEST_POWER + power])
    product = number * high
    cut = _SPLIT * number
    number_high = cut - (cut - number)
    number_low = number - number_high
    cut = _SPLIT * high
    high_high = cut - (cut - high)
    high_low = high - high_high
    lost = (
        (number_high * high_high - product) + number_high * high_low + number_low * high_high
    ) + number_low * high_low
    lost += number * low + float(digits - int(number)) * high
    nearest = product + lost
    beside = lost - (nearest - product)
    uncertain = _UNCERTAIN * nearest
    if nearest + (beside + uncertain) == nearest == nearest + (beside - uncertain):
        return nearest
    return math.nan


number_of = compiled(_number_of)


def _parse_cells(
    content: NDArray[np.uint8],
    at: int,
    columns: int,
    powers: Floats,
    table: Floats,
    with_point: NDArray[np.bool_],
) -> bool:
    """Reads lines of numbers into the rows of a table.

    Args:
        content: The bytes of a file, the last of which ends a line.
        at: Where its first row begins.
        columns: Cells of a line.
        powers: See `powers_of_ten`.
        table: Gets the numbers, not-a-number of an empty cell; one for each cell of each line.
        with_point: Gets for each column whether any of its numbers has a point or an exponent.

    Returns:
        Whether all cells are plain numbers or empty, and all lines have as many cells.
    """
    size, cell = len(content), 0
    while at < size:
        column = cell % columns
        ends = LINE_END if column == columns - 1 else COMMA
        byte = content[at]
        if byte == ends:
            if columns == 1:  # an empty line
                return False
            table[cell] = math.nan
            at += 1
            cell += 1
            continue
        negative = byte == _MINUS
        if negative:
            at += 1
            byte = content[at]
        digits, power, first = np.int64(0), 0, at
        while _ZERO <= byte <= _NINE:
            if digits >= _DIGITS:
                return False
            digits = 10 * digits + (np.int64(byte) - _ZERO)
            at += 1
            byte = content[at]
        if at == first:
            return False
        if byte == _POINT:
            with_point[column] = True
            at += 1
            byte, first = content[at], at
            while _ZERO <= byte <= _NINE:
                if digits >= _DIGITS:
                    return False
                digits = 10 * digits + (np.int64(byte) - _ZERO)
                at += 1
                byte = content[at]
            if at == first:
                return False
            power = first - at
        if byte in (_EXPONENT, _LARGE_EXPONENT):
            with_point[column] = True
            at += 1
            byte = content[at]
            falls = byte == _MINUS
            if falls or byte == _PLUS:
                at += 1
                byte = content[at]
            exponent, first = np.int64(0), at
            while _ZERO <= byte <= _NINE and at < first + 4:
                exponent = 10 * exponent + (np.int64(byte) - _ZERO)
                at += 1
                byte = content[at]
            if at == first:
                return False
            power += int(-exponent if falls else exponent)
        if byte != ends:
            return False
        number = number_of(digits, power, powers)
        if number != number:
            return False
        table[cell] = -number if negative else number
        at += 1
        cell += 1
    return cell == len(table)


parse_cells = cached(_parse_cells)
