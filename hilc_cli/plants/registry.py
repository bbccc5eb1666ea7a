"""The plants that a scenario may name: hilc's own, and those that are installed beside it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    ConfigDict,
    GetJsonSchemaHandler,
    SerializeAsAny,
    WrapValidator,
)
from pydantic_core import core_schema

from hilc_cli import plug_ins
from hilc_cli.plants.command_plant import ProgramRobotSpec, is_program
from hilc_cli.plants.kinematic_plant import KinematicSpec
from hilc_cli.plants.mujoco_plant import MujocoSpec
from hilc_cli.plants.parameters import RobotSpec, plant_named
from hilc_cli.plug_ins import PlugInError
from hilc_cli.yaml_input.model import of_named_model

OWN: Mapping[str, type[RobotSpec]] = {"kinematic": KinematicSpec, "mujoco": MujocoSpec}
"""The parameters of each of hilc's own plants; all else about plants follows from here."""

_OWN = (*OWN.values(), ProgramRobotSpec)


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
        return None if model in _OWN else model

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Returns the schema of any plant but hilc's own."""
        return plug_ins.schema_of_installed("plant")


def _named(plant: object) -> type[RobotSpec]:
    """Returns the model of a plant; raises PlugInError as for laws."""
    if is_program(plant):
        return ProgramRobotSpec
    name = plant if isinstance(plant, str) else ""
    if name in OWN:
        return OWN[name]
    model = plug_ins.find("plant", name, own=OWN).cls
    if not issubclass(model, RobotSpec):
        remedy = "name a subclass of hilc_cli.plants.parameters.RobotSpec"
        raise PlugInError("plant", name, "is no plant", remedy)
    return model


def _of_its_plant(data: object, handler: object) -> RobotSpec:
    """Validates parameters against the model of their plant alone."""
    if isinstance(data, RobotSpec):
        return data
    return of_named_model("plant", data, lambda: _named(plant_named(data)))


if TYPE_CHECKING:
    RobotSection = RobotSpec
else:
    RobotSection = Annotated[
        reduce(or_, (*_OWN, InstalledRobot)),
        WrapValidator(_of_its_plant),
        SerializeAsAny(),
    ]
