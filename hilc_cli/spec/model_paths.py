"""The models that the values on the way to a key are validated against."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import get_args, get_origin

from pydantic.fields import FieldInfo

from hilc_cli.spec.model import Model
from hilc_cli.spec.nodes import Node, PathKeys, nearest, to_data


@dataclass(frozen=True, slots=True)
class Step:
    """A mapping on the way to a key.

    Attributes:
        keys: Its own path.
        model: What it is validated against; None if that is not known.
        choices: The models that could stand there; `model` is one of them.
    """

    keys: PathKeys
    model: type[Model] | None
    choices: tuple[type[Model], ...]

    @property
    def fields(self) -> Mapping[str, FieldInfo]:
        """The keys that it may have."""
        return {} if self.model is None else self.model.model_fields

    @property
    def choice(self) -> tuple[str, str] | None:
        """The key, and its value, by which the model has been chosen among several."""
        return None if self.model is None else self.model.chosen_by()

    def choices_with(self, keys: PathKeys) -> list[tuple[str, str]]:
        """The other choices that would make a key a known one.

        Args:
            keys: From the root, through this mapping, to the key.
        """
        below = [key for key in keys[len(self.keys) :] if isinstance(key, str)]
        found = (model.chosen_by() for model in self.choices if _has(model, below))
        return [choice for choice in found if choice is not None and choice != self.choice]


def steps_to(tree: Node, keys: PathKeys, model: type[Model]) -> list[Step]:
    """The mappings on the way to a path, the one that stands there last.

    Args:
        tree: The root, which need not be valid.
        keys: The path.
        model: What the root is validated against.
    """
    found = [Step((), model, (model,))]
    named: object = None  # what the names in a mapping of names stand for
    for depth, key in enumerate(keys, 1):
        if not isinstance(key, str):
            continue
        field = found[-1].fields.get(key)
        annotation = named or (None if field is None else field.annotation)
        named = get_args(annotation)[1] if get_origin(annotation) is dict else None
        here = keys[:depth]
        if annotation is None or named:
            found.append(Step(here, None, ()))
        else:
            part = to_data(nearest(tree, here)[0])
            found.append(Step(here, model_in(annotation, part), tuple(models_in(annotation))))
    return found


def model_in(annotation: object, data: object = None) -> type[Model] | None:
    """The model within an optional or a list of it; of several the one that data is meant for."""
    models = models_in(annotation)
    return next((model for model in models if model.is_meant(data)), models[0] if models else None)


def models_in(annotation: object) -> list[type[Model]]:
    """All models within an annotation, such as those of an optional one or a union."""
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return [annotation]
    return [model for part in get_args(annotation) for model in models_in(part)]


def _has(model: type[Model], keys: Sequence[str]) -> bool:
    """Whether a model has the last of some keys, each below the one before."""
    first, *below = keys
    field = model.model_fields.get(first)
    if field is None or not below:
        return field is not None
    return any(_has(part, below) for part in models_in(field.annotation))
