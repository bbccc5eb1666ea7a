"""A robot as a rigid body on wheels that are driven by motors with a torque limit, in MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

from hilc_cli.errors import PlantError, needed
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.plant import Plant, Pose, Step
from hilc_cli.reference.sampled import Floats
from hilc_cli.surroundings import hidden

GRAVITY = 9.80665  # [m/s^2]
WHEEL_SHARE = 0.05
"""Share of the robot's mass that each wheel has, an even disc."""

_LONGEST_STEP = 1e-3  # [s]
_STEPS = 10  # in a sample, at least
_CONTACT_TIME = 4e-3  # [s]: by it floor and wheels give way, hundredths of a millimetre
_SETTLING = 2.0  # [s]
_FASTEST = 1e9  # [rad/s]: a motor that is told more has long reached its torque limit
_UPRIGHT = 0.5  # of the platform's vertical axis


@dataclass(frozen=True, slots=True)
class Body:
    """What a robot weighs, where it touches the floor, and what its motors can do.

    Attributes:
        mass: Of the whole robot [kg].
        size: Length, width and height [m] of the box over which the mass is spread evenly; its
            middle is at the robot's gravity centre, as high as the axle.
        caster: Where a caster without friction touches the floor, ahead of the wheel midpoint and
            to its left [m].
        torque_limit: The most that each motor gives [N m].
        velocity_gain: What each motor gives for a wheel that is too slow [N m s/rad].
        friction: Coefficient mu between the tyres and the floor.
    """

    mass: float
    size: tuple[float, float, float]
    caster: tuple[float, float]
    torque_limit: float
    velocity_gain: float
    friction: float


@dataclass(frozen=True)
class RigidBodyPlant(Plant):
    """A rigid body with two driven wheels and a caster on an even floor without end.

    Its state is the pose, that of the body and its wheels as they move, and the inputs under way;
    each pass begins at rest on the wheels. The floor is the same everywhere, so each sample is
    computed as if the robot stood at the origin: where it stands changes nothing, not even by
    rounding.

    Attributes:
        robot: The platform; its wheel radius is not used here, its gravity centre is.
        left_radius: Of the left wheel [m].
        right_radius: Of the right wheel [m].
        motor: What becomes of an input before the motors are told it.
        body: The body.
    """

    robot: Robot
    left_radius: float
    right_radius: float
    motor: Motor
    body: Body

    def start(self, pose: Pose, sample_time: float) -> Step:
        """Starts a pass with the robot at rest on its wheels and no input under way."""
        steps = max(_STEPS, math.ceil(sample_time / _LONGEST_STEP))
        duration = sample_time / steps
        mujoco, settled = mujoco_library(), _settled(self, duration)
        model, data = settled.model, mujoco.MjData(settled.model)
        data.qpos[:], data.qacc_warmstart[:] = settled.positions, settled.accelerations
        told, speeds = data.ctrl, data.qvel
        left_wheel, right_wheel = self.motor.wheel(duration), self.motor.wheel(duration)

        def step(pose: Pose, left: float, right: float) -> Pose:
            if not (math.isfinite(left) and math.isfinite(right)):
                return math.nan, math.nan, math.nan  # what no motor can be told
            turn = 0.0
            with _silence(mujoco):
                for _ in range(steps):
                    told[0] = _bounded(left_wheel(left) / duration)
                    told[1] = _bounded(right_wheel(right) / duration)
                    mujoco.mj_step(model, data)
                    turn += speeds[_YAW] * duration
            ahead, aside, turned = _brought_back(data)
            turned += math.tau * round((turn - turned) / math.tau)
            x, y, heading = pose
            cos, sin = math.cos(heading), math.sin(heading)
            return (
                x + (ahead * cos - aside * sin),
                y + (ahead * sin + aside * cos),
                heading + turned,
            )

        return step

    def document(self, duration: float) -> str:
        """Returns the robot in MuJoCo's own language (MJCF).

        Wheels are balls that touch the floor in a point each, below their middle, so that they
        turn on the spot without resistance.

        Args:
            duration: Of a physics step [s].
        """
        robot, body = self.robot, self.body
        axle = robot.wheel_radius  # height of the axle [m]
        wheel_mass = WHEEL_SHARE * body.mass
        platform_mass = body.mass - 2 * wheel_mass
        share = body.mass / platform_mass  # the wheels' own gravity centre is the origin
        center_x, center_y = (share * offset for offset in robot.gravity_center)
        length, width, height = (side**2 * platform_mass / 12 for side in body.size)
        (caster_x, caster_y), ball = body.caster, axle / 3
        # In the paper's convention the faster left wheel turns left: it is on the right side.
        sides = (("left", -robot.signed_half_track), ("right", robot.signed_half_track))
        radii = (self.left_radius, self.right_radius)
        wheels = "".join(
            f"""
      <body pos="0 {side!r} 0">
        <joint name="{name}" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="{wheel_mass!r}"
          diaginertia="{spin / 2!r} {spin!r} {spin / 2!r}"/>
        <geom type="sphere" size="{radius!r}" condim="3" friction="{body.friction!r} 0 0"/>
      </body>"""
            for (name, side), radius in zip(sides, radii, strict=True)
            for spin in (wheel_mass * radius**2 / 2,)
        )
        motors = "".join(
            f'<velocity joint="{name}" kv="{body.velocity_gain!r}" '
            f'forcerange="{-body.torque_limit!r} {body.torque_limit!r}"/>'
            for name, _ in sides
        )
        return f"""
<mujoco>
  <option timestep="{duration!r}" gravity="0 0 {-GRAVITY}" integrator="implicitfast"
    cone="elliptic" impratio="10"><flag autoreset="disable"/></option>
  <default><geom solref="{max(_CONTACT_TIME, 2 * duration)!r} 1" friction="0 0 0"/></default>
  <worldbody>
    <geom type="plane" size="1 1 1" condim="1"/>
    <body pos="0 0 {axle!r}">
      <freejoint/>
      <inertial pos="{center_x!r} {center_y!r} 0" mass="{platform_mass!r}"
        diaginertia="{width + height!r} {length + height!r} {length + width!r}"/>
      <geom type="sphere" size="{ball!r}" pos="{caster_x!r} {caster_y!r} {ball - axle!r}"
        condim="1"/>{wheels}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>"""


def mujoco_library() -> Any:
    """Returns MuJoCo, which starts slowly, and is loaded without anything that draws.

    Raises:
        MissingPackageError: It is not installed.
    """
    with hidden("", {"MUJOCO_GL": "disable"}):
        return needed("plant mujoco", "mujoco", "mujoco")


class _Settled(NamedTuple):
    """A robot at rest on its wheels, at the origin.

    Attributes:
        model: The model as MuJoCo has compiled it.
        positions: Of all joints.
        accelerations: With which the search for contact forces begins.
    """

    model: Any
    positions: Floats
    accelerations: Floats


@lru_cache(maxsize=8)
def _settled(plant: RigidBodyPlant, duration: float) -> _Settled:
    """Returns a plant at rest for physics steps of a duration [s]; the same for every pass."""
    mujoco = mujoco_library()
    try:
        model = mujoco.MjModel.from_xml_string(plant.document(duration))
    except ValueError as error:
        raise PlantError("mujoco", f"MuJoCo cannot make it: {error}; check robot.body") from None
    data = mujoco.MjData(model)
    with _silence(mujoco):
        mujoco.mj_step(model, data, math.ceil(_SETTLING / duration))
    _brought_back(data)
    data.qpos[_JOINTS:] = 0
    return _Settled(model, data.qpos.copy(), data.qacc_warmstart.copy())


# Places in MuJoCo's positions (x, y, z, quaternion, wheels) and velocities (of x, y, z in the
# world, and about the body's own axes, wheels).
_QUATERNION = slice(3, 7)
_JOINTS = 7
_YAW = 5


def _brought_back(data: Any) -> tuple[float, float, float]:
    """Moves the robot to the origin, with heading 0, as it moves.

    Returns:
        Where it has been: ahead [m], to the left [m], and the heading [rad] from -pi to pi; not a
        number if it has left the finite numbers.

    Raises:
        PlantError: It has tipped over.
    """
    ahead, aside = data.qpos[:2].tolist()
    w, i, j, k = data.qpos[_QUATERNION].tolist()
    if not math.isfinite(ahead + aside + w + i + j + k):
        return math.nan, math.nan, math.nan
    if 1 - 2 * (i * i + j * j) < _UPRIGHT:
        raise PlantError(
            "mujoco",
            "the robot has tipped over; lower robot.body.torque_limit, or move gravity_center "
            "towards the caster",
        )
    turned = math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))
    half, cos, sin = turned / 2, math.cos(turned), math.sin(turned)
    c, s = math.cos(half), math.sin(half)
    data.qpos[:2] = 0
    data.qpos[_QUATERNION] = c * w + s * k, c * i + s * j, c * j - s * i, c * k - s * w
    for motion in (data.qvel, data.qacc_warmstart):
        x, y = motion[:2].tolist()
        motion[:2] = cos * x + sin * y, cos * y - sin * x
    return ahead, aside, turned


def _bounded(speed: float) -> float:
    return min(max(speed, -_FASTEST), _FASTEST)


@contextmanager
def _silence(mujoco: Any) -> Iterator[None]:
    """Keeps MuJoCo from writing its warnings to a file in the working folder.

    What they say shows in numbers that are not finite.
    """
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda warning: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
