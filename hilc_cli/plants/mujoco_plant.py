"""What a scenario says of a robot that MuJoCo simulates."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from hilc_cli.errors import PlantError
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.parameters import half_track_of
from hilc_cli.plants.rigid_body import GRAVITY, Body, RigidBodyPlant, mujoco_library
from hilc_cli.plants.wheeled import WheeledSpec
from hilc_cli.yaml_input.expressions import PLAIN
from hilc_cli.yaml_input.model import Model, wrong_at
from hilc_cli.yaml_input.quantities import Coordinate, PositiveNumber, Quantity, RobotLength

Mass = Annotated[
    float, Quantity(PLAIN, "12, in kg", above=0, smallest=1e-3, most=1e6, told_in="kg")
]
Torque = Annotated[
    float, Quantity(PLAIN, "6, in N m", above=0, smallest=1e-6, most=1e6, told_in="N m")
]
VelocityGain = Annotated[
    float, Quantity(PLAIN, "3, in N m s/rad", above=0, smallest=1e-9, most=1e9, told_in="N m s/rad")
]

_DENSITY = 500.0  # [kg/m^3] of the box around a robot; those of laboratories have 300 to 700
_ACCELERATION = 0.3 * GRAVITY  # [m/s^2] that both motors give the robot
_RESPONSE = 20e-3  # [s] within which its speed follows
_OFF_AXLE = 0.2  # of the way from the axle to the caster


class BodySpec(Model):
    """A robot's body; what is left out follows from half track B and wheel radius R."""

    other_names: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("weight", "masskg"), "it is mass"),
        **dict.fromkeys(("torque", "maxtorque", "forcerange", "stalltorque"), "it is torque_limit"),
        **dict.fromkeys(("kv", "gain", "servo", "stiffness"), "it is velocity_gain"),
        "inertia": "it follows from mass and size",
        "friction": "it is a key of 'robot'",
    }

    mass: Mass | None = Field(
        None, description="of the whole robot [kg]; default: 500 kg for each m^3 of its size"
    )
    size: tuple[RobotLength, RobotLength, RobotLength] | None = Field(
        None,
        description="length, width and height [m] of the box over which the mass is spread; "
        "default: [2 B, 2 B, 2 R]",
    )
    caster: tuple[Coordinate, Coordinate] | None = Field(
        None,
        description="where a caster without friction touches the floor, ahead and to the left of "
        "the wheel midpoint [m]; default: B behind it, or B ahead if the gravity centre is ahead",
    )
    torque_limit: Torque | None = Field(
        None, description="the most that each motor gives [N m]; default: 0.15 R times the weight"
    )
    velocity_gain: VelocityGain | None = Field(
        None,
        description="what each motor gives for a wheel that is too slow [N m s/rad]; "
        "default: mass R^2 / 40 ms, with which speeds follow within 20 ms",
    )


class MujocoSpec(WheeledSpec):
    """A rigid body with two driven wheels and a caster."""

    only_if_given: ClassVar[tuple[str, ...]] = ("motor",)
    without_effect: ClassVar[tuple[str, ...]] = ()
    libraries: ClassVar[tuple[str, ...]] = ("mujoco",)

    plant: Literal["mujoco"]
    gravity_center: tuple[Coordinate, Coordinate] | None = Field(  # type: ignore[assignment]
        None,
        description="D_cx, D_cy [m] in the platform's frame, between axle and caster; "
        "default: a fifth of the way to the caster",
    )
    friction: PositiveNumber = Field(0.8, description="coefficient mu between tyres and floor")
    body: BodySpec = Field(BodySpec(), description="the rigid body")

    @model_validator(mode="after")
    def _stands(self) -> Self:
        if self._unstable is not None:
            raise wrong_at(*self._unstable)
        return self

    @property
    def _unstable(self) -> tuple[tuple[str, ...], str, str] | None:
        """The key by which it does not stand on its three points, why, and what to do."""
        platform, (caster_x, caster_y) = self.robot(), self._caster
        if caster_x == 0:
            at = ("body", "caster", "0")
            return at, "must not be 0, beside the wheels", "give a place ahead or behind"
        center_x, center_y = platform.gravity_center
        on_caster = center_x / caster_x  # share of the weight
        if not 0 < on_caster < 1:
            meant = f"[{_OFF_AXLE * caster_x:g}, {_OFF_AXLE * caster_y:g}]"
            problem = f"must be between the axle and the caster, which is {caster_x:g} m ahead"
            return ("gravity_center",), problem, f"leave it out, which makes it {meant}"
        if abs(center_y - on_caster * caster_y) >= (1 - on_caster) * platform.half_track:
            return ("gravity_center",), "lets the robot tip over a wheel", "bring it to the middle"
        return None

    def as_plant(self) -> RigidBodyPlant:
        """Returns the plant for the engines.

        Raises:
            MissingPackageError: MuJoCo is not installed.
            PlantError: The robot does not stand.
        """
        mujoco_library()
        if self._unstable is not None:  # by values of a sweep that do not fit together
            at, problem, remedy = self._unstable
            raise PlantError(self.plant, f"robot.{'.'.join(at)} {problem}; {remedy}")
        return RigidBodyPlant(self.robot(), *self.wheel_radii, self.motor.motor(), self.as_body())

    def as_body(self) -> Body:
        """Returns the body with every default filled in."""
        body, platform = self.body, self.robot()
        radius, half_track = platform.wheel_radius, platform.half_track
        size = body.size or (2 * half_track, 2 * half_track, 2 * radius)
        mass = _DENSITY * math.prod(size) if body.mass is None else body.mass
        torque_limit, velocity_gain = body.torque_limit, body.velocity_gain
        if torque_limit is None:
            torque_limit = mass * _ACCELERATION * radius / 2
        if velocity_gain is None:
            velocity_gain = mass * radius**2 / (2 * _RESPONSE)
        return Body(mass, size, self._caster, torque_limit, velocity_gain, self.friction)

    @property
    def _caster(self) -> tuple[float, float]:
        if self.body.caster is not None:
            return self.body.caster
        half_track = half_track_of(self.half_track, self.wheel_separation)
        assert half_track is not None  # exactly_one
        is_ahead = self.gravity_center is not None and self.gravity_center[0] > 0
        return (half_track if is_ahead else -half_track, 0.0)

    @property
    def wheel_load(self) -> float:
        """Share of the weight on the wheels; the caster bears the rest."""
        return 1 - self.robot().gravity_center[0] / self._caster[0]

    def robot(self) -> Robot:
        """Returns the platform."""
        platform = super().robot()
        if self.gravity_center is not None:
            return platform
        x, y = self._caster
        return replace(platform, gravity_center=(_OFF_AXLE * x, _OFF_AXLE * y))

    def resolved(self) -> dict[str, Any]:
        """Returns the parameters as plain data with every default and relation filled in."""
        body = self.as_body()
        return super().resolved() | {
            "gravity_center": list(self.robot().gravity_center),
            "body": {
                "mass": body.mass,
                "size": list(body.size),
                "caster": list(body.caster),
                "torque_limit": body.torque_limit,
                "velocity_gain": body.velocity_gain,
            },
        }
