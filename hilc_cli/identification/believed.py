"""What a user believes of a robot: the ``model`` of a scenario, as ``--set`` gives it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Self

from pydantic import Field, ValidationError, model_validator

from hilc_cli.errors import InvalidInputError
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.plants.imperfections import MotorSpec, WheelRadii, WheelRadius
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.parameters import OTHER_KEYS, TurnConventionName, half_track_of
from hilc_cli.scenario.loading import Overrides, changes_of
from hilc_cli.yaml_input.model import Model, wrong_at
from hilc_cli.yaml_input.nodes import MapNode, Place, Source, to_data
from hilc_cli.yaml_input.problems import problems_of
from hilc_cli.yaml_input.quantities import RobotLength, WheelSeparation
from hilc_cli.yaml_input.reading import apply_override

_START_DELAY, _START_LAG = 0.05, 0.05  # [s], from where the search begins


class _ModelSpec(Model):
    """What is believed of the robot; what is left out is looked for from nothing."""

    other_names = OTHER_KEYS

    wheel_radius: WheelRadius | None = Field(None, description="R [m]")
    half_track: RobotLength | None = Field(None, description="B [m]")
    wheel_separation: WheelSeparation | None = Field(
        None, description="distance between the wheels [m], instead of half_track"
    )
    turn_convention: TurnConventionName | None = Field(
        None,
        description="paper: left wheel faster turns left; rep103 or ros: right wheel faster "
        "turns left",
    )
    motor: MotorSpec = Field(MotorSpec(), description="what motors make of their inputs")

    @model_validator(mode="after")
    def _one_track(self) -> Self:
        if self.half_track is not None and self.wheel_separation is not None:
            raise wrong_at((), "has both half_track and wheel_separation", "give one of them")
        return self


class _BeliefSpec(Model):
    """The only section that ``--set`` may say something of."""

    model: _ModelSpec = Field(_ModelSpec(), description="what is believed of the robot")


@dataclass(frozen=True, slots=True)
class Believed:
    """What is believed of a robot; None for what nothing is said of.

    Attributes:
        left_radius: R_l [m].
        right_radius: R_r [m].
        half_track: B [m], > 0.
        turns_left: Which wheel is faster where the robot turns left: ``left`` or ``right``.
        delay: [s].
        lag: [s].
    """

    left_radius: float | None = None
    right_radius: float | None = None
    half_track: float | None = None
    turns_left: str | None = None
    delay: float | None = None
    lag: float | None = None

    @property
    def signed_half_track(self) -> float | None:
        """B [m], negative where a faster right wheel turns left."""
        if self.half_track is None:
            return None
        return self.half_track if self.turns_left == "left" else -self.half_track

    @property
    def motor(self) -> Motor | None:
        """The robot, if its wheels are known."""
        track = self.signed_half_track
        if self.left_radius is None or self.right_radius is None or track is None:
            return None
        delay = _START_DELAY if self.delay is None else self.delay
        lag = _START_LAG if self.lag is None else self.lag
        return Motor(self.left_radius, self.right_radius, track, delay, lag, 0.0)

    @property
    def robot(self) -> Robot | None:
        """The platform by which a driver makes wheel speeds of twists, if its wheels are known."""
        if self.left_radius is None or self.right_radius is None or self.half_track is None:
            return None
        convention = "paper" if self.turns_left == "left" else "rep103"
        mean = (self.left_radius + self.right_radius) / 2
        return Robot(mean, self.half_track, "paper" if convention == "paper" else "rep103")


def believed_of(overrides: Overrides) -> Believed:
    """Returns what options ``--set model.KEY=VALUE`` say, or values by dotted key.

    Raises:
        InvalidInputError: One of them says something else, or nothing that a robot can be.
    """
    place = Place(Source("--set", Path(), has_lines=False))
    tree = MapNode(place)
    for keys, value in changes_of(overrides):
        tree = apply_override(tree, keys, value, lambda tree: tree)
    try:
        spec = _BeliefSpec.model_validate(to_data(tree)).model
    except ValidationError as error:
        raise InvalidInputError(problems_of(error, tree, _BeliefSpec)) from None
    radius = spec.wheel_radius
    left, right = (
        (radius.left, radius.right) if isinstance(radius, WheelRadii) else (radius, radius)
    )
    told = {"paper": "left", "rep103": "right", None: None}[spec.turn_convention]
    given = spec.motor.model_fields_set
    return Believed(
        left,
        right,
        half_track_of(spec.half_track, spec.wheel_separation),
        told,
        spec.motor.delay if "delay" in given else None,
        spec.motor.lag if "lag" in given else None,
    )
