"""Validation errors of Pydantic as problems that point into the user's files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from hilc_cli.errors import Problem, suggestion
from hilc_cli.spec.nodes import MapNode, Node, PathKeys, describe, nearest

# What is wrong and what is allowed, by Pydantic's name of the error.
_MESSAGES: Mapping[str, tuple[str, str]] = {
    "string_type": ("must be text", "put it in quotes"),
    "string_pattern_mismatch": (
        "has characters that are not allowed",
        "use letters, digits, '.', '_' and '-'",
    ),
    "string_too_long": ("is too long", "shorten it"),
    "bool_type": ("must be true or false", "give true or false"),
    "model_type": ("must be a mapping of keys and values", "write its keys below it"),
    "model_attributes_type": ("must be a mapping of keys and values", "write its keys below it"),
    "list_type": ("must be a list", "write [..., ...] or lines that start with '- '"),
    "tuple_type": ("must be a list", "write [..., ...]"),
    "too_short": ("has too few entries", "add some"),
    "too_long": ("has too many entries", "remove some"),
}


def problems_of(error: ValidationError, tree: Node, model: type[BaseModel]) -> list[Problem]:
    """Each validation error as a problem at the place of the offending value.

    Args:
        error: What Pydantic found.
        tree: The tree that was validated.
        model: The model that it was validated against.
    """
    return [_problem(dict(details), tree, model) for details in error.errors(include_url=False)]


def _problem(details: dict[str, Any], tree: Node, model: type[BaseModel]) -> Problem:
    context: dict[str, Any] = details.get("ctx", {})
    keys: PathKeys = (*details["loc"], *context.get("at", ()))
    node, place, found = nearest(tree, keys)
    path = ".".join(map(str, keys))
    kind = details["type"]
    if kind == "missing":
        return Problem(str(place), path, f"is missing; {_how_to_give(keys, model)}")
    if kind == "extra_forbidden":
        known = _fields(_model_at(model, keys[:-1]))
        if isinstance(node, MapNode):
            place = node.key_places.get(str(keys[-1]), place)
        return Problem(str(place), path, f"is an unknown key; {suggestion(str(keys[-1]), known)}")
    if kind == "literal_error":
        problem = "is not one of the choices"
        remedy = "give " + str(context["expected"]).replace("'", "")
    elif kind == "hilc":
        problem, remedy = context["problem"], context["remedy"]
    else:
        problem, remedy = _MESSAGES.get(kind, (str(details["msg"]), "correct it"))
    shown = f", got {describe(node)}" if found and _tells(node, kind) else ""
    return Problem(str(place), path, f"{problem}{shown}; {remedy}")


def _tells(node: Node, kind: str) -> bool:
    """Whether showing the value helps: not where a whole mapping is said to be inconsistent."""
    return not (isinstance(node, MapNode) and kind == "hilc")


def _how_to_give(keys: PathKeys, model: type[BaseModel]) -> str:
    if isinstance(keys[-1], int):
        return "the list has too few entries"
    description = _fields(_model_at(model, keys[:-1]))[keys[-1]].description
    return f"give it ({description})" if description else "give it"


def _fields(model: type[BaseModel] | None) -> Mapping[str, FieldInfo]:
    return {} if model is None else model.model_fields


def _model_at(model: type[BaseModel] | None, keys: PathKeys) -> type[BaseModel] | None:
    """The model that the mapping at a path is validated against."""
    for key in keys:
        if isinstance(key, str):
            field = _fields(model).get(key)
            model = None if field is None else _model_in(field.annotation)
    return model


def _model_in(annotation: object) -> type[BaseModel] | None:
    """The model within an optional or a list of it."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_model_in, get_args(annotation))), None)
