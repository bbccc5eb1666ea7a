"""What a scenario says of its sweep: which keys are varied, and how cases are made of them.

The values of a key as people write them are ``0.1,1,10`` or a YAML list: these values;
``0.1:10:20``: 20 numbers from 0.1 to 10 in equal steps; ``0.1:10:20:log``: in equal ratios;
``0.1:10`` and ``0.1:10:log``: a range to draw from; ``1..30``: whole numbers.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BeforeValidator, Field, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic.types import StringConstraints

from hilc_cli.results.metrics import CASE_METRICS, ITERATIONS_TO_TOLERANCE
from hilc_cli.variation import (
    MOST_KEYS,
    MOST_VALUES,
    Axis,
    Choices,
    Range,
    Sampling,
    Spacing,
    Value,
)
from hilc_cli.wording import listed
from hilc_cli.yaml_input.expressions import ExpressionError, evaluate
from hilc_cli.yaml_input.model import Flag, Located, Model, wrong
from hilc_cli.yaml_input.quantities import CaseCount, PositiveLength, Seed, such_as
from hilc_cli.yaml_input.tree import LONGEST_KEY, resolve_plain

_AnyAxis = TypeVar("_AnyAxis", Choices, Range)
_WHOLE_NUMBERS = re.compile(r"\s*([-+]?[0-9]{1,20})\s*\.\.\s*([-+]?[0-9]{1,20})\s*")
_SPACINGS: dict[str, Spacing] = {"log": "log", "linear": "linear"}
_REMEDY = "give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30"


def read_axis(value: object) -> Axis:
    """The values that a text, a list or a single value stands for.

    Raises:
        PydanticCustomError: It stands for none.
    """
    if isinstance(value, Choices | Range):
        return value
    if isinstance(value, str):
        return _from_text(value)
    if isinstance(value, list | tuple):
        # Mappings are trajectories written out, which are named before they are used.
        return _choices([item if isinstance(item, Mapping) else _scalar(item) for item in value])
    return _choices([_scalar(value)])


def axis_text(axis: Axis) -> str | list[Value]:
    """An axis as it can be written in a scenario."""
    if isinstance(axis, Choices):
        return list(axis.values)
    if axis.spacing == "integer":
        return f"{int(axis.low)}..{int(axis.high)}"
    count = "" if axis.values_asked is None else f":{axis.values_asked}"
    return f"{axis.low!r}:{axis.high!r}{count}:{axis.spacing}"


def shown_axis(axis: Axis) -> str:
    """An axis as messages show it: as short as people write it."""
    if isinstance(axis, Choices):
        from hilc_cli.results.tables import value_text  # few scenarios have a sweep

        return ",".join(map(value_text, axis.values))
    if axis.written is None:
        return str(axis_text(axis))
    low, high = axis.written
    count = "" if axis.values_asked is None else f":{axis.values_asked}"
    return f"{low}:{high}{count}{'' if axis.spacing == 'linear' else ':log'}"


def _from_text(text: str) -> Axis:
    whole = _WHOLE_NUMBERS.fullmatch(text)
    if whole:
        low, high = map(int, whole.groups())
        if low > high:
            raise wrong("must rise", "give the smaller number first, such as 1..30")
        return _of_bearable_count(Range(low, high, "integer"))
    if ":" in text and "," not in text and "example:" not in text:
        return _range(text)
    inner = re.fullmatch(r"\s*\[(.*)\]\s*", text)  # as in YAML, by habit from --set
    words = [word.strip() for word in (inner[1] if inner else text).split(",")]
    return _choices([_scalar(resolve_plain(word) if word else word) for word in words])


def _range(text: str) -> Range:
    parts = [part.strip() for part in text.split(":")]
    spacing: Spacing = "linear"
    if parts[-1] in _SPACINGS:
        spacing = _SPACINGS[parts.pop()]
    if len(parts) not in (2, 3):
        raise wrong("is no range", _REMEDY)
    low, high = _number(parts[0]), _number(parts[1])
    if not math.isfinite(high - low):
        raise wrong("must be finite", _REMEDY)
    if not low < high:
        raise wrong("must rise", "give the smaller number first, such as 0.1:10:20")
    if spacing == "log" and low <= 0:
        raise wrong("has no logarithm", "start above 0, such as 0.1:10:20:log")
    if len(parts) == 2:
        return Range(low, high, spacing, written=(parts[0], parts[1]))
    if not re.fullmatch(r"[0-9]{1,18}", parts[2]) or int(parts[2]) < 2:
        raise wrong("needs 2 or more values", "give their number last, such as 0.1:10:20")
    asked = int(parts[2])
    return _of_bearable_count(Range(low, high, spacing, asked, written=(parts[0], parts[1])))


def _number(text: str) -> float:
    try:
        return float(evaluate(text).number.constant)
    except ExpressionError as error:
        problem = str(error).partition("; ")[0]
        raise wrong(f"holds '{text}', which {problem}", _REMEDY) from None


def _scalar(value: object) -> Value:
    if value is None or isinstance(value, bool | int | float | str):
        if value == "":
            raise wrong("has an empty value", _REMEDY)
        return value
    if isinstance(value, Mapping):
        remedy = "write keys with dots between them, such as controller.gains.l1"
        raise wrong("must hold values, not keys", remedy)
    raise wrong("must hold single values", _REMEDY)


def _choices(values: list[Any]) -> Choices:
    if not values:
        raise wrong("has no values", _REMEDY)
    return _of_bearable_count(Choices(tuple(values)))


def _of_bearable_count(axis: _AnyAxis) -> _AnyAxis:
    if (axis.count or 0) > MOST_VALUES:
        raise wrong(f"has {axis.count} values", f"give at most {MOST_VALUES}, or draw from a range")
    return axis


AxisSpec = Annotated[
    Axis,
    PlainValidator(read_axis),
    PlainSerializer(axis_text, return_type=Any),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "string", "description": "0.1,1,10 or 0.1:10:20[:log] or 1..30"},
                {"type": "array", "minItems": 1},
                {"type": "number"},
            ]
        }
    ),
]

Key = Annotated[str, StringConstraints(pattern=r"^[^.\s=]+(\.[^.\s=]+)*$", max_length=LONGEST_KEY)]

Robust = Literal["worst", "q95", "mean"]
"""By which figure of its cases a choice is judged."""


def _keys_of(value: object) -> object:
    """Keys one by one, of a text too that has them with commas between."""
    if isinstance(value, str):
        return tuple(filter(None, map(str.strip, value.split(","))))
    return tuple(value) if isinstance(value, list) else value


Keys = Annotated[
    tuple[Annotated[str, StringConstraints(max_length=LONGEST_KEY)], ...],
    BeforeValidator(_keys_of),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}),
]


class SweepSpec(Model):
    """Many runs of one scenario."""

    vary: dict[Key, AxisSpec] = Field(
        {}, max_length=MOST_KEYS, description="values by dotted key, such as controller.gains.l1"
    )
    sample: Sampling = Field(
        "grid", description="grid: every combination; random, sobol: points drawn from the ranges"
    )
    minimise: Literal[CASE_METRICS] | None = Field(  # type: ignore[valid-type]
        None, description="search the ranges for the case in which this metric is smallest"
    )
    cases: CaseCount | None = Field(None, description="number of points to draw, or to search")
    seed: Seed = Field(0, description="of the drawing, or of the search")
    over: Keys | None = Field(
        None, description="varied keys that are not chosen but happen: each choice meets them all"
    )
    robust: Robust | None = Field(
        None, description="the figure of its cases by which a choice is ranked: worst if left out"
    )
    happenings: CaseCount | None = Field(
        None, description="number of happenings to draw from the ranges of 'over'"
    )
    tolerance: Annotated[float, such_as(PositiveLength, "0.05 or 5 cm")] | None = Field(
        None, description="maximum error [m] for iterations_to_tolerance"
    )
    bands: Flag = Field(False, description="write quantiles of the error over the cases")
    metric: Literal[CASE_METRICS] = Field(  # type: ignore[valid-type]
        "max_position_error_m", description="what pictures show and the best case is best in"
    )


class CompleteSweepSpec(SweepSpec):
    """A sweep as it is to run: what one part of it needs of another is there.

    What a scenario leaves out may still be given on the command line. What is minimised is what
    the cases are ranked by.
    """

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """What does not fit together, whatever else is wrong."""
        given = {key: value for key, value in data.items() if value is not None}
        searches, sample = "minimise" in given, given.get("sample") or "grid"
        is_grid = not searches and sample == "grid"
        vary = given.get("vary")
        ranges = vary if isinstance(vary, dict) else {}
        over = _keys_of(given.get("over", ()))
        over = over if isinstance(over, tuple) else ()
        drawn = "happenings" in given
        ranked = given.get("metric", given.get("minimise"))
        found: list[tuple[bool, tuple[str, ...], str, str]] = [
            (is_grid and "cases" in given, ("cases",), "has no meaning for a grid",
             "remove it, or set 'sample: random' or 'sample: sobol'"),
            *((is_grid and key not in over and _has_no_count(value), ("vary", str(key)),
               "is a range without a number of values",
               "add it, such as 0.1:10:20, or draw from the range with 'sample'")
              for key, value in ranges.items()),
            *((key in over and not drawn and _has_no_count(value), ("vary", str(key)),
               "happens, and is a range without a number of values",
               "add it, such as 0.1:10:20, or draw from the range with 'happenings: 20'")
              for key, value in ranges.items()),
            (not searches and sample in ("random", "sobol") and "cases" not in given,
             ("sample",), "needs the number of cases to draw",
             "give it too, such as 'cases: 1000' or --cases 1000"),
            (searches and "cases" not in given, ("minimise",), "needs the number of cases to try",
             "give it too, such as 'cases: 200' or --cases 200"),
            (searches and "sample" in given, ("sample",), "has no meaning for a search",
             "remove it, or 'minimise'"),
            (searches and ranked != given["minimise"], ("metric",), "has no meaning for a search",
             "remove it: cases are ranked by what is minimised"),
            *((given.get(key) == ITERATIONS_TO_TOLERANCE and "tolerance" not in given,
               (key,), "needs a tolerance",
               "give it too, such as 'tolerance: 5 cm' or --tolerance '5 cm'")
              for key in ("metric", "minimise")),
            *_misfits_of_choice(given, over, ranges),
        ]  # fmt: skip
        told = [(at, problem, remedy) for is_wrong, at, problem, remedy in found if is_wrong]
        return [*super().misfits(data), *told]


def _misfits_of_choice(
    given: Mapping[str, Any], over: tuple[Any, ...], vary: Mapping[str, Any]
) -> list[tuple[bool, tuple[str, ...], str, str]]:
    """What may be wrong with the keys that happen: whether it is, where, what, and the remedy."""
    unknown = [key for key in over if key not in vary]
    twice = [key for number, key in enumerate(over) if key in over[:number]]
    others = listed([key for key in vary if key not in over])
    remedy = "give it values with 'vary', or name"
    remedy += f" some of the varied keys: {others}" if others else " varied keys"
    all_happen = bool(over) and not unknown and not others
    return [
        ("over" in given and not over, ("over",), "names no key",
         "name varied keys, such as disturbance.seed"),
        *((True, ("over",), f"names {key!s}, which is not varied", remedy) for key in unknown),
        *((True, ("over",), f"names {key!s} more than once", "name it once") for key in twice),
        (all_happen, ("over",), "names all varied keys, which leaves nothing to choose",
         "leave out a key that is to be chosen, or 'over'"),
        *((key in given and "over" not in given, (key,), "needs the keys that happen",
           "name them too, such as 'over: [disturbance.seed]' or --over disturbance.seed")
          for key in ("robust", "happenings")),
    ]  # fmt: skip


def _has_no_count(value: object) -> bool:
    try:
        axis = read_axis(value)
    except ValueError:
        return False
    return not isinstance(axis, Choices) and axis.count is None
