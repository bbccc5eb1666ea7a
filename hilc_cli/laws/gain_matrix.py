"""The 2x3 matrix from pose errors to corrections of the two wheel speeds, and plans made by it.

Every gain of the paper is a scalar times one such matrix, whose entries are affine in the cosine
and the sine of the heading: Eqs. 45, 56 and 57.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from hilc_cli.plants.kinematic import Number, Robot
from hilc_cli.wording import near_word
from hilc_cli.yaml_input.expressions import Affine, ExpressionError, evaluate
from hilc_cli.yaml_input.model import Located, located, together, wrong, wrong_at

Coefficients = tuple[
    float, float, float, float, float, float, float, float, float,
    float, float, float, float, float, float, float, float, float,
]  # fmt: skip


@dataclass(frozen=True)
class GainMatrix:
    """Rows: left and right wheel. Columns: errors in x [m], y [m] and heading [rad].

    Attributes:
        left: The three entries of the row of the left wheel.
        right: The three entries of the row of the right wheel.
    """

    left: tuple[Affine, Affine, Affine]
    right: tuple[Affine, Affine, Affine]

    @cached_property
    def coefficients(self) -> Coefficients:
        """The 18 coefficients, row by row, as `wheel_correction` takes them."""
        a, b, c = self.left
        d, e, f = self.right
        return (
            a.constant, a.cos, a.sin, b.constant, b.cos, b.sin, c.constant, c.cos, c.sin,
            d.constant, d.cos, d.sin, e.constant, e.cos, e.sin, f.constant, f.cos, f.sin,
        )  # fmt: skip

    @classmethod
    def of(cls, coefficients: Coefficients) -> GainMatrix:
        """The matrix of 18 coefficients."""
        a, b, c, d, e, f = (Affine(*coefficients[first : first + 3]) for first in range(0, 18, 3))
        return cls((a, b, c), (d, e, f))

    @cached_property
    def is_kinematic(self) -> bool:
        """Whether it has the form of Eq. 45, with any wheel radius and half track."""
        coefficients = self.coefficients
        along, turning = coefficients[1], coefficients[6]
        return coefficients == (
            0, along, 0, 0, 0, along, turning, 0, 0,
            0, along, 0, 0, 0, along, -turning, 0, 0,
        )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class GainsAlong:
    """The gain matrix at each sample of a reference.

    Attributes:
        matrices: The different ones.
        numbers: Which of them it is at each sample, shape (n,).
    """

    matrices: tuple[GainMatrix, ...]
    numbers: NDArray[np.intp]

    @classmethod
    def same(cls, matrix: GainMatrix, samples: int) -> GainsAlong:
        """One matrix at all samples."""
        return cls((matrix,), np.zeros(samples, dtype=np.intp))

    @property
    def coefficients(self) -> Sequence[Coefficients]:
        """`GainMatrix.coefficients` at each sample."""
        different = [matrix.coefficients for matrix in self.matrices]
        return [different[number] for number in self.numbers.tolist()]

    def parts(self) -> Iterator[tuple[GainMatrix, NDArray[np.bool_] | slice]]:
        """Each matrix, and at which samples it is: all of them, or a mask of shape (n,)."""
        if len(self.matrices) == 1:
            yield self.matrices[0], slice(None)
            return
        for number, matrix in enumerate(self.matrices):
            yield matrix, self.numbers == number


def inverse_kinematics_gain(wheel_radius: float, signed_half_track: float) -> GainMatrix:
    """The gain matrix that inverts the kinematics along the heading.

    Args:
        wheel_radius: R_rs [m].
        signed_half_track: B_rs [m], negative in the convention of REP-103.

    Source:
        Qiao et al. 2021, Eq. 45.
    """
    along_x = Affine(cos=1 / wheel_radius)
    along_y = Affine(sin=1 / wheel_radius)
    turning = signed_half_track / wheel_radius
    return GainMatrix(
        left=(along_x, along_y, Affine(turning)),
        right=(along_x, along_y, Affine(-turning)),
    )


def model_gain(model: Robot) -> GainMatrix:
    """Eq. 45 with the wheel radius and half track that the controller believes in."""
    return inverse_kinematics_gain(model.wheel_radius, model.signed_half_track)


def unit_gain(model: Robot) -> GainMatrix:
    """Eq. 56: Eq. 45 with R = B = 1; of the model it knows the turn convention only."""
    return inverse_kinematics_gain(1.0, 1.0 if model.turn_convention == "paper" else -1.0)


def wheel_correction(
    coefficients: Coefficients,
    cos_heading: Number,
    sin_heading: Number,
    error_x: Number,
    error_y: Number,
    error_heading: Number,
) -> tuple[Number, Number]:
    """The gain matrix times a pose error: corrections of the left and right wheel [rad/s].

    Args:
        coefficients: `GainMatrix.coefficients`.
        cos_heading: Cosine of the heading at which the matrix is taken.
        sin_heading: Sine of that heading.
        error_x: Error [m], already weighted by the scalar gains.
        error_y: Error [m], likewise.
        error_heading: Error [rad], likewise.

    Source:
        Qiao et al. 2021, the products L(k) e of Eqs. 17 and 21 with Eqs. 45, 56 and 57.
    """
    (
        lx, lx_cos, lx_sin, ly, ly_cos, ly_sin, lh, lh_cos, lh_sin,
        rx, rx_cos, rx_sin, ry, ry_cos, ry_sin, rh, rh_cos, rh_sin,
    ) = coefficients  # fmt: skip
    left = (
        (lx + lx_cos * cos_heading + lx_sin * sin_heading) * error_x
        + (ly + ly_cos * cos_heading + ly_sin * sin_heading) * error_y
        + (lh + lh_cos * cos_heading + lh_sin * sin_heading) * error_heading
    )
    right = (
        (rx + rx_cos * cos_heading + rx_sin * sin_heading) * error_x
        + (ry + ry_cos * cos_heading + ry_sin * sin_heading) * error_y
        + (rh + rh_cos * cos_heading + rh_sin * sin_heading) * error_heading
    )
    return left, right


Entry = int | float | str
Rows = tuple[tuple[Entry, Entry, Entry], tuple[Entry, Entry, Entry]]
Named = Literal["model", "unit"]

_NAMED = {"model": model_gain, "unit": unit_gain}
_REMEDY = "give model, unit, or two rows of three numbers or expressions in cos, sin, R and B"
_ENTRY_REMEDY = "give a number or an expression in cos, sin, R and B"
# Any values serve to check the form of an expression; these two make no division by zero likely.
_PLACEHOLDER = Robot(0.7391, 1.2853)


def _validate(value: object) -> Named | Rows:
    if isinstance(value, str):
        if value not in _NAMED:
            near = near_word(value, _NAMED)
            raise wrong("is no gain matrix", f"did you mean '{near}'?" if near else _REMEDY)
        return value  # type: ignore[return-value]
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise wrong("must be model, unit or two rows", _REMEDY)
    rows = []
    for index, row in enumerate(value):
        if not isinstance(row, list | tuple) or len(row) != 3:
            raise wrong_at((index,), "must be a row of three entries", _REMEDY)
        rows.append(tuple(row))
    matrix: Rows = (rows[0], rows[1])
    gain_matrix(matrix, _PLACEHOLDER)
    return matrix


@lru_cache(maxsize=64)
def _named_matrix(choice: Named, model: Robot) -> GainMatrix:
    """One of those that have a name, of which the cases of a sweep have few."""
    return _NAMED[choice](model)


def gain_matrix(choice: Named | Rows, model: Robot) -> GainMatrix:
    """The gain matrix with the controller's wheel radius and half track in it.

    A matrix written out is taken as it is written: first row left wheel, second row right wheel,
    in either turn convention.

    Raises:
        PydanticCustomError: An entry is no expression affine in cos and sin, or not finite.
    """
    if isinstance(choice, str):
        return _named_matrix(choice, model)
    names = {
        "cos": Affine(cos=1.0),
        "sin": Affine(sin=1.0),
        "R": Affine(model.wheel_radius),
        "B": Affine(model.half_track),
    }
    problems: list[Located] = []
    entries: list[Affine] = []
    for row, expressions in enumerate(choice):
        for column, expression in enumerate(expressions):
            try:
                entries.append(_entry(expression, names, (row, column)))
            except PydanticCustomError as error:
                problems += located(error)
    if problems:
        raise together(problems)
    a, b, c, d, e, f = entries
    return GainMatrix((a, b, c), (d, e, f))


def matrix_misfits(choice: Named | Rows | None, model: Robot | None) -> list[Located]:
    """Entries that the controller's R and B make infinite; either may be unknown."""
    if choice is None or model is None:
        return []
    try:
        gain_matrix(choice, model)
    except PydanticCustomError as error:
        return [(("gain_matrix", *at), problem, remedy) for at, problem, remedy in located(error)]
    return []


def _entry(entry: object, names: Mapping[str, Affine], at: tuple[int, int]) -> Affine:
    if isinstance(entry, bool) or not isinstance(entry, int | float | str):
        raise wrong_at(at, "must be a number or an expression", _ENTRY_REMEDY)
    if isinstance(entry, str):
        try:
            number = evaluate(entry, names, units=False).number
        except ExpressionError as error:
            problem, _, remedy = str(error).partition("; ")
            raise wrong_at(at, problem, remedy or _ENTRY_REMEDY) from None
    else:
        number = Affine(float(entry))
    if not all(map(math.isfinite, (number.constant, number.cos, number.sin))):
        raise wrong_at(at, "must be finite", _ENTRY_REMEDY)
    return number


def _lists_of(count: int, items: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "minItems": count, "maxItems": count, "items": items}


_EXPRESSION = {"anyOf": [{"type": "number"}, {"type": "string"}]}
GainMatrixChoice = Annotated[
    Named | Rows,
    PlainValidator(_validate),
    PlainSerializer(lambda choice: choice if isinstance(choice, str) else list(map(list, choice))),
    WithJsonSchema({"anyOf": [{"enum": list(_NAMED)}, _lists_of(2, _lists_of(3, _EXPRESSION))]}),
    Field(description="model: Eq. 45; unit: Eq. 56; or 2x3 entries affine in cos and sin"),
]


GainHeading = Literal["measured", "previous", "reference"]


class LaneParameters(NamedTuple):
    """What a law may offer to be run in lanes by the batch engine: Eq. 17 or Eq. 21.

    Attributes:
        gains: l1, l2, l3 >= 0 of the errors e_i(k+1), e_{i+1}(k) and e_{i+1}(k-1).
        matrix: The 2x3 gain matrix, without its lateral gain.
        gain_heading: Heading at which the matrix is taken.
        compensation: Length of the compensation of Eq. 21 in samples; None for Eq. 17.
        derivative: tau [s], see `HybridLaw`.
        lateral: kappa [rad/m], see `HybridLaw`.
    """

    gains: tuple[float, float, float]
    matrix: GainMatrix
    gain_heading: GainHeading
    compensation: int | None
    derivative: float
    lateral: float
