"""The base of all models of what users write."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Self, TypeVar, get_args, get_origin

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    Strict,
    StringConstraints,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError, core_schema

from hilc_cli.names import LONGEST_NAME, NAME_PATTERN
from hilc_cli.plug_ins import PlugInError
from hilc_cli.yaml_input.nodes import Node, PathKeys, nearest, to_data

Name = Annotated[str, StringConstraints(pattern=NAME_PATTERN, max_length=LONGEST_NAME)]
Text = Annotated[str, StringConstraints(max_length=10_000)]
Flag = Annotated[bool, Strict()]


Located = tuple[PathKeys, str, str]
"""Keys down to the offending value, what is wrong, and what is allowed."""


class Model(BaseModel):
    """Frozen, and with no keys but its own; a key with nothing behind it has its default."""

    # Built when something is first validated by it: most commands need few of all the models.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    exactly_one: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Groups of keys of which each must have exactly one."""

    other_names: ClassVar[Mapping[str, str]] = {}
    """What to write for keys that other programs have, by their letters in lower case alone."""

    looked_at: ClassVar[tuple[str, ...]] = ()
    """Keys whose valid values `misfits` looks at: they are validated before the others, once."""

    def __setstate__(self, state: dict[Any, Any]) -> None:
        """Takes the values that another process has sent, where nothing may have been validated."""
        super().__setstate__(state)
        # Pydantic before 2.14 cannot write out what is within another model and is not built yet.
        type(self).model_rebuild()

    @classmethod
    def chosen_by(cls, data: object = None) -> tuple[str, str] | None:
        """Returns the key, and its value, by which this model is chosen where there are several.

        Args:
            data: What is to be of this model, if there is something.
        """
        return None

    @classmethod
    def meant_by(cls, data: object) -> type[Model] | None:
        """Returns the model of data, which may not be valid, if it is this one or in its place."""
        return cls

    @classmethod
    def choices(cls) -> Sequence[type[Model]]:
        """The models of which what stands here may be, where this one is named."""
        return (cls,)

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """What does not fit together in data that may not be valid yet."""
        return [
            ((), f"needs exactly one of {listed(group)}", "give one of them")
            for group in cls.exactly_one
            if cls._is_wrong(group, data)
        ]

    @classmethod
    def _is_wrong(cls, group: Sequence[str], data: dict[str, Any]) -> bool:
        given = sum(data.get(key) is not None for key in group)
        # One that is missing beside an unknown key is misspelt: telling that is enough.
        return given > 1 or (given == 0 and data.keys() <= cls.model_fields.keys())

    @model_validator(mode="wrap")
    @classmethod
    def _fits_together(cls, data: object, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Tells of misfits together with wrong values, not only after those are mended."""
        if not isinstance(data, dict):
            return handler(data)
        for key in cls.looked_at:
            field = cls.model_fields[key]
            kind: Any = field.annotation
            if field.metadata:  # such as the validator that finds the model of a plant
                kind = Annotated[kind, *field.metadata]
            part = valid(kind, data.get(key))
            if part is not None:
                data = {**data, key: part}
        misfits = cls.misfits(data)
        if not misfits:
            return handler(data)
        found = [InitErrorDetails(type=together(misfits), input=data)]
        try:
            handler(data)
        except ValidationError as error:
            found = [*map(_details, error.errors(include_url=False)), *found]
        raise ValidationError.from_exception_data(cls.__name__, found)

    @model_validator(mode="before")
    @classmethod
    def _nothing_is_the_default(cls, data: object) -> object:
        if not isinstance(data, dict):
            return data
        optional = {name for name, field in cls.model_fields.items() if not field.is_required()}
        return {
            key: value for key, value in data.items() if value is not None or key not in optional
        }


class NamedModel(Model):
    """Stands for several models, of which a key of the data names one, such as that of a law.

    Each of them is loaded when it is named, all of them where they are listed.
    """

    @classmethod
    def validated(cls, data: object) -> Model:
        """Validates data against the model that it names, and against no other.

        So what is wrong with it is told by the keys of that model, as if there were no others.
        """
        raise NotImplementedError

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: object, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Returns the schema of whatever `validated` takes."""
        return core_schema.no_info_plain_validator_function(cls.validated)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Returns the schema of any of the models."""
        parts: list[Any] = [TypeAdapter(model).core_schema for model in cls.choices()]
        return handler(core_schema.union_schema(parts))


@lru_cache(maxsize=256)
def _adapter(kind: Any) -> TypeAdapter[Any]:
    """What validates values of a type, which takes longer to make than to use."""
    return TypeAdapter(kind)


def valid(kind: Any, value: Any) -> Any:
    """The value of a part that is there and valid by itself; None otherwise."""
    if value is None:
        return None
    try:
        return _adapter(kind).validate_python(value)
    except ValidationError:
        return None


_Named = TypeVar("_Named", bound=BaseModel)


def of_named_model(key: str, data: Any, named: Callable[[], type[_Named]]) -> _Named:
    """Validates data against the model that one of its keys names, and against no other.

    It is found by a function that raises PlugInError if there is none.

    Raises:
        ValidationError: There is no such model, or the data does not fit it.
    """
    try:
        model = named()
    except PlugInError as error:
        kind = wrong(error.problem, error.remedy)
        found = InitErrorDetails(type=kind, loc=(key,), input=data[key])
        raise ValidationError.from_exception_data(key, [found]) from None
    return model.model_validate(data)


def listed(words: Sequence[str]) -> str:
    """Words as a sentence lists them: a, b and c."""
    return f"{', '.join(words[:-1])} and {words[-1]}"


def _details(details: ErrorDetails) -> InitErrorDetails:
    """What Pydantic says of an error in the form in which it takes one."""
    context = details.get("ctx", {})
    kind: str | PydanticCustomError = details["type"]
    if kind == "hilc":
        kind = PydanticCustomError("hilc", "{text}", context)
    return InitErrorDetails(type=kind, loc=details["loc"], input=details["input"], ctx=context)


def wrong(problem: str, remedy: str) -> PydanticCustomError:
    """A validation error: what is wrong, and what is allowed."""
    return wrong_at((), problem, remedy)


def wrong_at(at: PathKeys, problem: str, remedy: str) -> PydanticCustomError:
    """A validation error of a model, with the keys from it down to the offending value."""
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


@dataclass(frozen=True, slots=True)
class Step:
    """A mapping on the way to a key.

    Attributes:
        keys: Its own path.
        model: What it is validated against; None if that is not known.
        choices: The models that could stand there; `model` is one of them, or in the place of one.
        data: What stands there.
    """

    keys: PathKeys
    model: type[Model] | None
    choices: tuple[type[Model], ...]
    data: object = None

    @property
    def fields(self) -> Mapping[str, FieldInfo]:
        """The keys that it may have."""
        return {} if self.model is None else self.model.model_fields

    @property
    def choice(self) -> tuple[str, str] | None:
        """The key, and its value, by which the model has been chosen among several."""
        return None if self.model is None else self.model.chosen_by(self.data)

    def choices_with(self, keys: PathKeys) -> list[tuple[str, str]]:
        """The other choices that would make a key known, by the keys from the root down to it."""
        below = [key for key in keys[len(self.keys) :] if isinstance(key, str)]
        found = (model.chosen_by() for model in self.choices if _has(model, below))
        return [choice for choice in found if choice is not None and choice != self.choice]


def steps_to(tree: Node, keys: PathKeys, model: type[Model]) -> list[Step]:
    """The mappings on the way to a path, the one that stands there last.

    The root need not be valid; the model is what it is validated against.
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
            models = tuple(models_in(annotation))
            found.append(Step(here, model_in(annotation, part), models, part))
    return found


def model_in(annotation: object, data: object = None) -> type[Model] | None:
    """The model within an optional or a list of it; of several the one that data is meant for."""
    models = models_in(annotation)
    meant = (found for model in models if (found := model.meant_by(data)) is not None)
    return next(meant, models[0] if models else None)


def models_in(annotation: object) -> list[type[Model]]:
    """All models within an annotation, such as those of an optional one or a union."""
    if isinstance(annotation, type) and issubclass(annotation, Model):
        return list(annotation.choices())
    return [model for part in get_args(annotation) for model in models_in(part)]


def _has(model: type[Model], keys: Sequence[str]) -> bool:
    """Whether a model has the last of some keys, each below the one before."""
    first, *below = keys
    field = model.model_fields.get(first)
    if field is None or not below:
        return field is not None
    return any(_has(part, below) for part in models_in(field.annotation))
