"""The plants that a scenario may name: hilc's own, and those that are installed beside it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

from pydantic import ConfigDict, GetJsonSchemaHandler
from pydantic_core import core_schema

from hilc_cli import plug_ins
from hilc_cli.plants.parameters import RobotSpec, plant_named
from hilc_cli.plug_ins import PlugInError
from hilc_cli.yaml_input.model import NamedModel, of_named_model

OWN = {
    "kinematic": "hilc_cli.plants.kinematic_plant:KinematicSpec",
    "mujoco": "hilc_cli.plants.mujoco_plant:MujocoSpec",
}
"""Where the parameters of each of hilc's own plants are; all else about them follows from here."""

_PROGRAM = "hilc_cli.plants.command_plant:ProgramRobotSpec"


@cache
def _at(place: str) -> type[RobotSpec]:
    module, _, cls = place.partition(":")
    return cast("type[RobotSpec]", getattr(import_module(module), cls))


def _all_own() -> list[type[RobotSpec]]:
    return [_at(place) for place in (*OWN.values(), _PROGRAM)]


class InstalledRobot(RobotSpec):
    """Stands for every plant that is not hilc's own where plants are listed."""

    model_config = ConfigDict(extra="allow")

    @classmethod
    def meant_by(cls, data: object) -> type[RobotSpec] | None:
        """Returns the model of the plant that data names, if it is not one of hilc's own."""
        try:
            model = _named(plant_named(data))
        except PlugInError:
            return None
        return None if model in _all_own() else model

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Returns the schema of any plant but hilc's own."""
        return plug_ins.schema_of_installed("plant")


def _named(plant: object) -> type[RobotSpec]:
    """Returns the model of a plant; raises PlugInError as for laws."""
    if not isinstance(plant, str) and (program := _at(_PROGRAM).meant_by({"plant": plant})):
        return program
    name = plant if isinstance(plant, str) else ""
    if name in OWN:
        return _at(OWN[name])
    model = plug_ins.find("plant", name, own=OWN).cls
    if not issubclass(model, RobotSpec):
        remedy = "name a subclass of hilc_cli.plants.parameters.RobotSpec"
        raise PlugInError("plant", name, "is no plant", remedy)
    return model


class AnyRobot(NamedModel, RobotSpec):
    """Stands for every plant."""

    @classmethod
    def choices(cls) -> Sequence[type[RobotSpec]]:
        """All plants."""
        # The last one only stands for plants, and none is made of it.
        return [*_all_own(), InstalledRobot]  # type: ignore[type-abstract]

    @classmethod
    def validated(cls, data: object) -> RobotSpec:
        """Validates parameters against the model of their plant."""
        if isinstance(data, RobotSpec):
            return data
        return of_named_model("plant", data, lambda: _named(plant_named(data)))


if TYPE_CHECKING:
    RobotSection = RobotSpec
else:
    RobotSection = AnyRobot
