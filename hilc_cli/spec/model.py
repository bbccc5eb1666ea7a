"""The base of all models of what users write."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Strict, StringConstraints
from pydantic_core import PydanticCustomError

from hilc_cli.spec.nodes import PathKeys

NAME_PATTERN = r"^[A-Za-z0-9._-]*[A-Za-z0-9_-][A-Za-z0-9._-]*$"  # not only dots

Name = Annotated[str, StringConstraints(pattern=NAME_PATTERN, max_length=100)]
Text = Annotated[str, StringConstraints(max_length=10_000)]
Flag = Annotated[bool, Strict()]


class Model(BaseModel):
    """Frozen, and with no keys but its own."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def wrong_at(at: PathKeys, problem: str, remedy: str) -> PydanticCustomError:
    """A validation error of a model that points at one of the keys below it.

    Args:
        at: Keys from the model down to the offending value.
        problem: What is wrong.
        remedy: What is allowed.
    """
    return PydanticCustomError(
        "hilc", "{problem}; {remedy}", {"at": at, "problem": problem, "remedy": remedy}
    )
