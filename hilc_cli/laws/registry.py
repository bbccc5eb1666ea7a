"""The laws that a scenario may name: hilc's own, and those that are installed beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

from pydantic import ConfigDict, GetJsonSchemaHandler
from pydantic_core import core_schema

from hilc_cli import plug_ins
from hilc_cli.laws.parameters import DEFAULT_LAW, Controller, law_named
from hilc_cli.plug_ins import PlugInError
from hilc_cli.yaml_input.model import NamedModel, of_named_model

OWN = {
    "hybrid": "hilc_cli.laws.hybrid:HybridController",
    "pid": "hilc_cli.laws.pid:PidController",
    "norm-optimal": "hilc_cli.laws.norm_optimal.law:NormOptimalController",
    "feedback": "hilc_cli.laws.feedback:FeedbackController",
}
"""Where the parameters of each of hilc's own laws are; all else about laws follows from here."""


@cache
def _own(name: str) -> type[Controller]:
    module, _, cls = OWN[name].partition(":")
    return cast("type[Controller]", getattr(import_module(module), cls))


def controllers() -> dict[str, type[Controller]]:
    """The parameters of all of hilc's own laws, by name."""
    return {name: _own(name) for name in OWN}


class InstalledController(Controller):
    """Stands for every law that is not hilc's own where laws are listed, as in the JSON Schema."""

    model_config = ConfigDict(extra="allow")

    @classmethod
    def meant_by(cls, data: object) -> type[Controller] | None:
        """Returns the model of the law that data names, if it is not one of hilc's own."""
        model = controller_model(data)
        return None if model in controllers().values() else model

    @classmethod
    def chosen_by(cls, data: object = None) -> None:
        """Returns nothing: which law it is depends on what is installed."""

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Returns the schema of any law but hilc's own."""
        return plug_ins.schema_of_installed("law")


def controller_model(data: object) -> type[Controller] | None:
    """Returns the model of the law that parameters name; None if there is no such law."""
    if not isinstance(data, Mapping):
        return _own(DEFAULT_LAW)
    try:
        return _named(law_named(data))
    except PlugInError:
        return None


def _named(law: object) -> type[Controller]:
    """The model of a law; raises PlugInError where there is none that may be imported."""
    name = law if isinstance(law, str) else ""
    if name in OWN:
        return _own(name)
    model = plug_ins.find("law", name, own=OWN).cls
    if not (issubclass(model, Controller) and {"law", "b_w"} <= model.model_fields.keys()):
        remedy = "name a subclass of hilc_cli.laws.parameters.Controller with a field b_w"
        raise PlugInError("law", name, "is no law", remedy)
    return model


class AnyController(NamedModel, Controller):
    """Stands for every law."""

    @classmethod
    def choices(cls) -> Sequence[type[Controller]]:
        """All laws."""
        # The last one only stands for laws, and none is made of it.
        return [*controllers().values(), InstalledController]  # type: ignore[type-abstract]

    @classmethod
    def validated(cls, data: object) -> Controller:
        """Validates parameters against the model of their law."""
        if isinstance(data, Controller):
            return data
        if not isinstance(data, Mapping):
            return _own(DEFAULT_LAW).model_validate(data)
        return of_named_model("law", data, lambda: _named(law_named(data)))


if TYPE_CHECKING:
    ControllerSpec = Controller
else:
    ControllerSpec = AnyController
