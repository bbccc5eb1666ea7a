"""What a scenario says of its robot, whichever plant that is."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, ClassVar, get_args

from pydantic import BeforeValidator, Field, WithJsonSchema

from hilc_cli.plants.kinematic import Robot, TurnConvention
from hilc_cli.plants.plant import Plant
from hilc_cli.yaml_input.model import Model
from hilc_cli.yaml_input.quantities import Coordinate, PositiveNumber, RobotLength, WheelSeparation

DEFAULT_PLANT = "kinematic"

_OTHER_NAMES = {"ros": "rep103"}


def _usual_name(value: object) -> object:
    """The name by which results call a convention."""
    return _OTHER_NAMES.get(value.lower(), value) if isinstance(value, str) else value


TurnConventionName = Annotated[
    TurnConvention,
    BeforeValidator(_usual_name),
    WithJsonSchema({"enum": ["paper", "rep103", "ros"], "type": "string"}),
]


_SEPARATION = "the distance between the left and the right wheel is wheel_separation"
OTHER_KEYS = {
    **dict.fromkeys(("wheeldiameter", "diameter"), "half of it is wheel_radius"),
    **dict.fromkeys(
        (
            "track", "trackwidth", "trackgauge", "wheeltrack", "axletrack", "axlewidth",
            "axlelength", "base", "baseline", "wheelbase", "wheelwidth", "wheeldistance",
            "wheelspacing", "wheelsdistance", "wheelseparationm", "distancebetweenwheels",
            "tread",
        ),
        _SEPARATION,
    ),
}  # fmt: skip


class RobotSpec(Model):
    """A plant by its name, with what every platform has and the plant's own parameters.

    Each plant has a model of its own, which inherits from this and adds its keys. Its field
    ``plant`` says what the scenario calls it; of hilc's own plants that has one value.
    """

    other_names = OTHER_KEYS

    exactly_one = (("half_track", "wheel_separation"),)

    only_if_given: ClassVar[tuple[str, ...]] = ("plant",)
    """Keys that a resolved scenario has only where they are not as in every robot."""

    without_effect: ClassVar[tuple[str, ...]] = ("gravity_center", "friction")
    """Keys on which the plant's motion does not depend."""

    libraries: ClassVar[tuple[str, ...]] = ()
    """Packages that compute the motion, whose versions manifests note."""

    wheel_radius: RobotLength = Field(description="R_c [m]")
    half_track: RobotLength | None = Field(
        None, description="B_c [m] as Eq. 2 uses it: half the distance between the wheels"
    )
    wheel_separation: WheelSeparation | None = Field(
        None, description="distance between the wheels [m], instead of half_track"
    )
    turn_convention: TurnConventionName = Field(
        description="paper: left wheel faster turns left; "
        "rep103 or ros: right wheel faster turns left"
    )
    gravity_center: tuple[Coordinate, Coordinate] = Field(
        (0.0, 0.0), description="D_cx, D_cy [m] in the platform's frame; only reported"
    )
    friction: PositiveNumber | None = Field(
        None,
        description="coefficient mu of the tyres, which hold a lateral acceleration of "
        "mu * 9.80665 m/s^2; used by 'hilc check' only",
    )
    plant: str = Field(DEFAULT_PLANT, description="how the robot moves")

    @classmethod
    def chosen_by(cls, data: object = None) -> tuple[str, str] | None:
        """Returns ``plant`` and the name of this plant; of one that data has, if not the usual."""
        if data is None:
            names = get_args(cls.model_fields["plant"].annotation)
            return ("plant", names[0]) if names else None
        name = plant_named(data)
        return None if name == DEFAULT_PLANT else ("plant", str(name))

    @classmethod
    def meant_by(cls, data: object) -> type[RobotSpec] | None:
        """Returns this model if data names its plant."""
        return cls if plant_named(data) in get_args(cls.model_fields["plant"].annotation) else None

    @abstractmethod
    def as_plant(self) -> Plant:
        """Returns the plant for the engines."""

    @property
    def plant_name(self) -> str:
        """What messages and manifests call the plant."""
        return self.plant

    @property
    def program(self) -> dict[str, Any] | None:
        """The program that is the plant, as manifests note it; None if it is none."""
        return None

    def imperfections(self) -> dict[str, float | str]:
        """Returns by dotted key what the plant has of which neither theory nor its path knows."""
        return {}

    def figures(self) -> dict[str, float]:
        """Returns by column what else of the robot a law may find out, see ``learning.csv``."""
        return {}

    def with_keys(self, keys: Iterable[str]) -> RobotSpec:
        """Returns the same robot, so written that values can be put at these dotted keys."""
        return self

    @property
    def mean_wheel_radius(self) -> float:
        """The radius [m] that stands for both wheels where one number is asked for."""
        return self.wheel_radius

    @property
    def wheel_acceleration(self) -> float:
        """The most that the speed of a wheel changes [rad/s^2]; infinity for no limit."""
        return math.inf

    @property
    def lead(self) -> float:
        """Share of a sample's turn after which its way is gone; half of it on an arc."""
        return 0.5

    @property
    def wheel_load(self) -> float | None:
        """Share of the weight on the wheels, where the plant slides; None where it never does."""
        return None

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine can move the plant."""
        plant = self.as_plant()
        return plant.lane_gains(1.0) is not None or plant.lane_wheels(1.0) is not None

    def resolved(self) -> dict[str, Any]:
        """Returns the parameters as plain data with every default and relation filled in."""
        data = self.model_dump(mode="json", exclude={"wheel_separation"})
        data["half_track"] = self.robot().half_track
        if self.friction is None:
            del data["friction"]
        return data

    def robot(self) -> Robot:
        """Returns the platform."""
        half_track = half_track_of(self.half_track, self.wheel_separation)
        assert half_track is not None  # exactly_one
        return Robot(self.mean_wheel_radius, half_track, self.turn_convention, self.gravity_center)


def plant_named(data: object) -> object:
    """Returns what ``plant:`` says in parameters that may not be valid."""
    plant = data.get("plant") if isinstance(data, Mapping) else None
    return DEFAULT_PLANT if plant is None else plant


def half_track_of(half_track: float | None, wheel_separation: float | None) -> float | None:
    """Returns the half track [m], whichever of the two has been given; None if neither has."""
    return half_track if wheel_separation is None else wheel_separation / 2
