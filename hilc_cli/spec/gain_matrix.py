"""What a scenario says of the gain matrix: a name, or two rows of three expressions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import PlainSerializer, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from hilc_cli.errors import near_word
from hilc_cli.laws.gain_matrix import Affine, GainMatrix, model_gain, unit_gain
from hilc_cli.robot import Robot
from hilc_cli.spec.expressions import ExpressionError, evaluate
from hilc_cli.spec.model import Located, located, together, wrong, wrong_at

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


def gain_matrix(choice: Named | Rows, model: Robot) -> GainMatrix:
    """The gain matrix with the controller's wheel radius and half track in it.

    A matrix written out is taken as it is written: first row left wheel, second row right wheel,
    in either turn convention.

    Args:
        choice: What the scenario says.
        model: The platform as the controller believes it to be.

    Raises:
        PydanticCustomError: An entry is no expression affine in cos and sin, or not finite.
    """
    if isinstance(choice, str):
        return _NAMED[choice](model)
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


_EXPRESSION = {"anyOf": [{"type": "number"}, {"type": "string"}]}
GainMatrixChoice = Annotated[
    Named | Rows,
    PlainValidator(_validate),
    PlainSerializer(lambda choice: choice if isinstance(choice, str) else list(map(list, choice))),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": list(_NAMED)},
                {
                    "type": "array",
                    "minItems": 2,
                    "maxItems": 2,
                    "items": {
                        "type": "array",
                        "minItems": 3,
                        "maxItems": 3,
                        "items": _EXPRESSION,
                    },
                },
            ]
        }
    ),
]
