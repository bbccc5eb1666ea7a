"""What a scenario says of what is kept."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from hilc_cli.results.recording import RecordedIterations
from hilc_cli.spec.expressions import PLAIN
from hilc_cli.spec.model import Flag, Located, Model, located, together, wrong
from hilc_cli.spec.quantities import Quantity

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
