"""What a scenario says of what is kept."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from hilc_cli.yaml_input.expressions import PLAIN
from hilc_cli.yaml_input.model import Flag, Located, Model, located, together, wrong
from hilc_cli.yaml_input.quantities import Quantity

EVERY_UP_TO = 5
AUTOMATIC = 24

RecordedIterations = Literal["auto", "all"] | Collection[int]


def recorded_iterations(choice: RecordedIterations, last: int) -> frozenset[int]:
    """The iterations whose samples are kept; the first and the last always are.

    ``auto`` keeps every one of the first few and then about two dozen at equal ratios, since
    learning changes the path most at the start.

    Args:
        choice: ``auto``, ``all``, or the iterations themselves.
        last: Number of the last iteration.
    """
    if choice == "all":
        return frozenset(range(last + 1))
    if choice == "auto":
        if last < AUTOMATIC:
            return frozenset(range(last + 1))
        ratios = np.geomspace(EVERY_UP_TO, last, AUTOMATIC - EVERY_UP_TO)
        kept = {*range(EVERY_UP_TO), *(round(ratio) for ratio in ratios.tolist())}
    else:
        kept = {int(iteration) for iteration in choice}
    return frozenset({0, last, *kept})


_ITERATION = Quantity(PLAIN, "100", least=0, whole=True)
_RECORD_SCHEMA: dict[str, object] = {
    "anyOf": [
        {"enum": ["auto", "all"]},
        {"type": "array", "items": {"type": "integer", "minimum": 0}},
    ]
}
_RECORD_REMEDY = "give auto, all, or a list of iterations such as [0, 10, 100]"


def _recorded(value: object) -> RecordedIterations:
    if value in ("auto", "all"):
        return value
    if not isinstance(value, list):
        raise wrong("is no choice of iterations", _RECORD_REMEDY)
    iterations: list[int] = []
    problems: list[Located] = []
    for index, item in enumerate(value):
        try:
            iterations.append(int(_ITERATION(item)))
        except PydanticCustomError as error:
            problems += [((index, *at), problem, remedy) for at, problem, remedy in located(error)]
    if problems:
        raise together(problems)
    return tuple(iterations)


class RecordSpec(Model):
    """What is kept beside the metrics, which are kept of every iteration."""

    iterations: Annotated[
        RecordedIterations,
        PlainValidator(_recorded),
        PlainSerializer(lambda choice: choice if isinstance(choice, str) else list(choice)),
        WithJsonSchema(_RECORD_SCHEMA),
    ] = Field(
        "auto", description="iterations whose samples are kept; the first and the last always are"
    )
    gravity_center: Flag = Field(
        False, description="write the path of the gravity centre (Eq. 7) as well"
    )
