"""The base of all models of what users write."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Strict, StringConstraints, model_validator
from pydantic_core import PydanticCustomError

from hilc_cli.spec.nodes import PathKeys

NAME_PATTERN = r"^[A-Za-z0-9._-]*[A-Za-z0-9_-][A-Za-z0-9._-]*$"  # not only dots

Name = Annotated[str, StringConstraints(pattern=NAME_PATTERN, max_length=100)]
Text = Annotated[str, StringConstraints(max_length=10_000)]
Flag = Annotated[bool, Strict()]


Located = tuple[PathKeys, str, str]
"""Keys down to the offending value, what is wrong, and what is allowed."""


class Model(BaseModel):
    """Frozen, and with no keys but its own; a key with nothing behind it has its default."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _nothing_is_the_default(cls, data: object) -> object:
        if not isinstance(data, dict):
            return data
        optional = {name for name, field in cls.model_fields.items() if not field.is_required()}
        return {
            key: value for key, value in data.items() if value is not None or key not in optional
        }


def wrong(problem: str, remedy: str) -> PydanticCustomError:
    """A validation error: what is wrong, and what is allowed."""
    return wrong_at((), problem, remedy)


def wrong_at(at: PathKeys, problem: str, remedy: str) -> PydanticCustomError:
    """A validation error of a model that points at one of the keys below it.

    Args:
        at: Keys from the model down to the offending value.
        problem: What is wrong.
        remedy: What is allowed.
    """
    return together([(at, problem, remedy)])


def together(problems: Sequence[Located]) -> PydanticCustomError:
    """Several problems of one value as one validation error.

    Args:
        problems: Of each the keys from the value down, what is wrong, and what is allowed.
    """
    text = "; ".join(problem for _, problem, _ in problems)
    return PydanticCustomError("hilc", "{text}", {"text": text, "problems": list(problems)})


def located(error: PydanticCustomError) -> list[Located]:
    """The problems of an error made by `wrong`, `wrong_at` or `together`."""
    problems: list[Located] = (error.context or {})["problems"]
    return problems
