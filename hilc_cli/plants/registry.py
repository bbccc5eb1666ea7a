"""The plants that a scenario may name: hilc's own, and those that are installed beside it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    ConfigDict,
    GetJsonSchemaHandler,
    SerializeAsAny,
    ValidationError,
    WrapValidator,
)
from pydantic_core import InitErrorDetails, core_schema

from hilc_cli import plug_ins
from hilc_cli.plants.kinematic_plant import KinematicSpec
from hilc_cli.plants.parameters import RobotSpec, plant_named
from hilc_cli.plug_ins import PlugInError
from hilc_cli.yaml_input.model import wrong

OWN: Mapping[str, type[RobotSpec]] = {"kinematic": KinematicSpec}


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
        return None if model in OWN.values() else model

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Returns the schema of any plant but hilc's own, whose keys are not known before it is."""
        names = [plug_ins.REFERENCE, *map(re.escape, plug_ins.installed("plant"))]
        plant = {"type": "string", "pattern": f"^({'|'.join(names)})$"}
        return {
            "type": "object",
            "title": "a plant that is installed beside hilc",
            "required": ["plant"],
            "properties": {"plant": plant},
            "additionalProperties": True,
        }


def package_of(plant: str) -> dict[str, dict[str, str | None]]:
    """Returns package and version of a plant that is not hilc's own, by its name, for manifests."""
    if plant in OWN:
        return {}
    found = plug_ins.find("plant", plant)
    return {plant: {"package": found.distribution, "version": found.version}}


def _named(plant: object) -> type[RobotSpec]:
    """Returns the model of a plant.

    Raises:
        PlugInError: There is no such plant, or it must not or cannot be imported.
    """
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
    try:
        model = _named(plant_named(data))
    except PlugInError as error:
        assert isinstance(data, Mapping)  # anything else is of the usual plant
        kind = wrong(error.problem, error.remedy)
        found = InitErrorDetails(type=kind, loc=("plant",), input=data["plant"])
        raise ValidationError.from_exception_data("robot", [found]) from None
    return model.model_validate(data)


if TYPE_CHECKING:
    RobotSection = RobotSpec
else:
    RobotSection = Annotated[
        SerializeAsAny[KinematicSpec | InstalledRobot], WrapValidator(_of_its_plant)
    ]
