"""What a scenario says of a robot that another program simulates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from hilc_cli import plug_ins
from hilc_cli.plants.parameters import RobotSpec, plant_named
from hilc_cli.plants.program import ProgramPlant
from hilc_cli.yaml_input.model import Model, Text, wrong_at
from hilc_cli.yaml_input.quantities import PositiveTime, such_as

PROGRAM = "{command: [...]}"
"""What messages call a plant that is a program."""


class ProgramSpec(Model):
    """A program in any language, run only with the user's word."""

    command: tuple[Text, ...] = Field(
        min_length=1, description="the program and its arguments, such as [./my-simulator, -v]"
    )
    folder: Text | None = Field(
        None, description="its working folder; default: that of the file which names it"
    )
    timeout: Annotated[float, such_as(PositiveTime, "60 or 60 s")] = Field(
        60.0, description="how long it may take for an answer [s]"
    )

    @model_validator(mode="after")
    def _is_trusted(self) -> Self:
        if not self.command[0]:
            raise wrong_at(("command", 0), "is no program", "give its path or name")
        if any("\0" in word for word in (*self.command, self.working_folder)):
            raise wrong_at(("command",), "has a character of code 0", "leave that out")
        if not plug_ins.may_run(self.command, self.working_folder):
            problem = "is a program, which is run only with --trust"
            raise wrong_at(("command",), problem, "give --trust if you know where it comes from")
        return self

    @property
    def working_folder(self) -> str:
        """The folder in which it is run."""
        return self.folder or "."


def is_program(plant: object) -> bool:
    """Returns whether what stands behind ``plant:`` is meant for a program."""
    return isinstance(plant, Mapping | ProgramSpec)


class ProgramRobotSpec(RobotSpec):
    """A robot whose motion a program tells, whatever it makes of the wheel speeds."""

    plant: ProgramSpec  # type: ignore[assignment]  # in the place of a name

    @classmethod
    def chosen_by(cls, data: object = None) -> tuple[str, str] | None:
        """Returns ``plant`` and what messages call a program."""
        return ("plant", PROGRAM)

    @classmethod
    def meant_by(cls, data: object) -> type[RobotSpec] | None:
        """Returns this model if data names a program."""
        return cls if is_program(plant_named(data)) else None

    @property
    def plant_name(self) -> str:
        """The program as the scenario names it."""
        return self.plant.command[0]

    @property
    def program(self) -> dict[str, Any]:
        """The program as manifests note it."""
        return {"command": list(self.plant.command), "folder": self.plant.working_folder}

    def as_plant(self) -> ProgramPlant:
        """Returns the plant for the engines.

        Raises:
            PlantError: There is no such program.
        """
        program = self.plant
        plant = ProgramPlant(self.robot(), program.command, program.working_folder, program.timeout)
        plant.executable()
        return plant
