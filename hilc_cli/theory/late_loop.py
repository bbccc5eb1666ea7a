"""How late wheels may be for the feedback of a law: its delay margin.

About one step of the reference, as if that step went on for ever, errors e ahead, to the left and
of the heading follow

    e(k+1) = A e(k) - B s(q) u(k),    u(k) = G_0 e(k) + G_1 e(k-1) + ...

with the answers u of the feedback, which the wheels follow late: s is the transfer function of
delay and lag, the same for both wheels, exact for sampled time. The loop is stable if no root of

    f(z) = det(z I - A + B s(z) G(z))

lies outside of the unit circle. As f has no pole there and goes as z^3 for large z, this is so if f
goes around zero three times while z goes around the circle. f is quadratic in s, whatever the delay
is, so that its three coefficients are computed once. Roots on the circle, of errors that stay as
they are, are none outside: z goes around a hair further out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.arriving import ArrivingLaw
from hilc_cli.laws.law import Task, WheelController
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot, feedforward, reference_twist
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.plain_arrays import distinct, median

Complex = NDArray[np.complex128]

_OUTSIDE = 1e-9  # of the unit circle: an error that grows by so much in a sample does not grow
_PER_DECADE = 60  # frequencies, around zero and around the turn of a sample
_NEAR = 400  # further ones around the one at which errors begin to grow
_FEW = 2  # places that are looked at where each answer takes a pass from the start
_SIZE = 1e-6  # of the error whose answer is looked at [m and rad]
_LONGEST = 400  # samples for which an answer is looked at
_GONE = 1e-6  # share of an answer that counts as none
_LASTING = 1e-2  # share of it that, left at the end, makes it one that does not end
_FINER = 1.1  # factor from a delay that is tried to the next
_SHORTEST = 0.02  # of a sample: the first delay that is tried
_ABOUT, _EXACT = 1e-4, 1e-8  # of a sample
_SLOW = (
    0.01  # of the top speed: slower steps steer nothing, and are looked at if there are no others
)


@dataclass(frozen=True, slots=True)
class DrivenRobot:
    """A robot in motion, as far as its kinematics go.

    Attributes:
        left_radius: Of the left wheel, less what slip takes of its way [m].
        right_radius: Likewise [m].
        half_track: Signed [m].
        lead: Share of a sample's turn after which its way is gone.
    """

    left_radius: float
    right_radius: float
    half_track: float
    lead: float

    @classmethod
    def of(cls, experiment: Experiment) -> DrivenRobot:
        """Returns the robot of an experiment; of one that is simulated elsewhere what is told."""
        plant, robot = experiment.plant, experiment.robot
        radius = robot.wheel_radius
        shares, lead = (1.0, 1.0), 0.0
        if isinstance(plant, ImperfectPlant):
            shares, lead = plant.drivetrain.shares(radius), 0.5 if plant.exact else 0.0
        return cls(radius * shares[0], radius * shares[1], robot.signed_half_track, lead)


@dataclass(frozen=True, slots=True, eq=False)
class LateLoop:
    """The loop about one step of the reference, with wheels that are late.

    Attributes:
        speed: Of the reference [m/s].
        yaw_rate: [rad/s].
        at: Time of the step [s].
        sample_time: d_t [s].
        states: A, shape (3, 3).
        inputs: B, shape (3, 2).
        gains: G_0, G_1, ...: answers of the left and the right wheel [rad/s] to errors ahead [m],
            to the left [m] and of the heading [rad], shape (p, 2, 3).
    """

    speed: float
    yaw_rate: float
    at: float
    sample_time: float
    states: Floats
    inputs: Floats
    gains: Floats

    @classmethod
    def about(
        cls,
        robot: DrivenRobot,
        twist: tuple[float, float],
        gains: Floats,
        sample_time: float,
        at: float = 0.0,
    ) -> LateLoop:
        """Returns the loop of a robot about a step of a speed [m/s] and a yaw rate [rad/s]."""
        return cls(*twist, at, sample_time, *_step(robot, *twist, sample_time), gains)

    def is_stable(self, delay: float, lag: float = 0.0) -> bool:
        """Returns whether no error grows with wheels that are so late; both in s."""
        late = self._samples(delay, lag)
        angles = self._closer(self._angles(), *late)
        return self._on(self._closer(angles, *late)).is_stable(*late)

    def margin(self, known: float = 0.0, lag: float = 0.0, most: float = math.inf) -> float:
        """Returns the largest delay up to which the loop is stable [s].

        Args:
            known: Delay that the feedback reckons with, from which on they are tried [s].
            lag: Of the wheels [s].
            most: Largest delay that is looked at [s].

        Returns:
            The delay; not less than what is known, and infinite if it is above the most. Zero if
            the loop is unstable with what is known.
        """
        angles = self._angles()
        curve = self._on(angles)
        stable, slow = self._samples(known, lag)
        if not curve.is_stable(stable, slow):
            return 0.0
        beyond = _SHORTEST
        while curve.is_stable(stable + beyond, slow):
            stable += beyond
            if stable * self.sample_time > most:
                return math.inf
            beyond *= _FINER
        unstable = stable + beyond
        for exact in (_ABOUT, _ABOUT, _EXACT):
            while unstable - stable > exact:
                middle = (stable + unstable) / 2
                if curve.is_stable(middle, slow):
                    stable = middle
                else:
                    unstable = middle
            # A closer look may show that the curve passes zero on the other side.
            angles = self._closer(angles, unstable, slow)
            curve, wider = self._on(angles), exact
            while stable > 0 and not curve.is_stable(stable, slow):
                stable, wider = max(stable - wider, 0.0), 2 * wider
            while curve.is_stable(unstable, slow):
                unstable, wider = unstable + wider, 2 * wider
        return stable * self.sample_time

    def _samples(self, delay: float, lag: float) -> tuple[float, float]:
        return delay / self.sample_time, lag / self.sample_time

    def _angles(self) -> Floats:
        """Returns frequencies in radians per sample, dense where f may be close to zero."""
        turn = abs(math.remainder(self.yaw_rate * self.sample_time, 2 * math.pi))
        logs = np.logspace(-11, math.log10(math.pi), round(11.5 * _PER_DECADE))
        angles = np.concatenate([logs, turn - logs, turn + logs])
        inside = angles[(angles > 0) & (angles < math.pi)]
        return distinct(np.concatenate([[0.0], inside, [math.pi]]))

    def _closer(self, angles: Floats, delay: float, lag: float) -> Floats:
        """Returns frequencies with more of them where f is nearest to zero; delay in samples."""
        where = int(self._on(angles).nearest(delay, lag))
        low, high = angles[max(where - 2, 0)], angles[min(where + 2, len(angles) - 1)]
        return distinct(np.concatenate([angles, np.linspace(low, high, _NEAR)]))

    def _on(self, angles: Floats) -> _Curve:
        """Returns f at frequencies, whatever the delay is."""
        circle = (1 + _OUTSIDE) * np.exp(1j * angles)
        answers = np.tensordot(circle[:, None] ** -np.arange(len(self.gains)), self.gains, 1)
        free = (circle - 1)[:, None, None] * np.eye(3) - (self.states - np.eye(3))
        late = self.inputs @ answers
        none, once, less = (np.linalg.det(free + share * late) for share in (0.0, 1.0, -1.0))
        return _Curve(circle, none, (once - less) / 2, (once + less) / 2 - none)


class _Curve(NamedTuple):
    """f on the upper half of the circle, as a polynomial in s; delays and lags in samples."""

    circle: Complex
    of_none: Complex
    of_one: Complex
    of_two: Complex

    def _values(self, delay: float, lag: float) -> Complex:
        late = _lateness(self.circle, delay, lag)
        values: Complex = self.of_none + (self.of_one + self.of_two * late) * late
        return values

    def is_stable(self, delay: float, lag: float) -> bool:
        values = self._values(delay, lag)
        gone_round = float(np.angle(values[1:] / values[:-1]).sum()) / math.pi
        return round(gone_round) == 3

    def nearest(self, delay: float, lag: float) -> np.intp:
        """Returns the place where it is nearest to zero, by what its parts are."""
        late = _lateness(self.circle, delay, lag)
        parts = abs(self.of_none) + abs(self.of_one * late) + abs(self.of_two * late * late)
        return np.argmin(abs(self._values(delay, lag)) / parts)


def _lateness(circle: Complex, delay: float, lag: float) -> Complex:
    """Returns what delay and lag, in samples, make of an input, as `plants.motor` has them."""
    whole, part = divmod(delay, 1.0)
    late: Complex = circle**-whole * (1 - part + part / circle)
    if lag > 0:
        kept = math.exp(-1 / lag)
        # A wheel turns by u + (w - u) lag (1 - kept) while its speed w nears u.
        behind = lag * (1 - kept)
        late = late * (1 - behind + behind * (1 - kept) / (circle - kept))
    return late


def _step(
    robot: DrivenRobot, speed: float, yaw_rate: float, sample_time: float
) -> tuple[Floats, Floats]:
    """Returns A and B of errors in the reference's frame, shapes (3, 3) and (3, 2)."""
    way, turn = speed * sample_time, yaw_rate * sample_time
    cos, sin = math.cos(robot.lead * turn), math.sin(robot.lead * turn)
    states = np.array([[1, 0, -way * sin], [0, 1, way * cos], [0, 0, 1]])
    radii = np.array([robot.left_radius, robot.right_radius]) * sample_time / 2
    ahead, turned = radii, np.array([1, -1]) * radii / robot.half_track
    aside = robot.lead * way * turned
    inputs = np.stack([cos * ahead - sin * aside, sin * ahead + cos * aside, turned])
    cos, sin = math.cos(turn), math.sin(turn)
    back = np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
    return back @ states, back @ inputs


def believed_robot(experiment: Experiment) -> tuple[Robot, Drivetrain | None]:
    """Returns the platform that the law believes in, and its wheels and motors if it knows any."""
    law = experiment.law
    if isinstance(law, ArrivingLaw):
        return law.model, law.drivetrain
    return getattr(law, "model", experiment.robot), getattr(law, "drivetrain", None)


def planned_task(experiment: Experiment) -> Task:
    """Returns what a law is to plan a pass from that needs no learning, without a limit.

    Its first input is the feedforward of the platform that the law believes in.
    """
    reference, (model, drivetrain) = experiment.reference, believed_robot(experiment)
    wheels = feedforward(reference, model)
    if drivetrain is not None:
        wheels = drivetrain.sent_for(*wheels, model.wheel_radius, reference.sample_time)
    return Task(reference, *wheels, math.inf)


def late_loops(experiment: Experiment) -> list[LateLoop] | None:
    """Returns the loops about steps of the reference that differ most: the fastest, the sharpest.

    Returns:
        None if an answer of the feedback does not end; none of them if there is no feedback.
    """
    task = planned_task(experiment)
    remembers = isinstance(experiment.law, ArrivingLaw)
    learner = experiment.law.learner(task)

    def controller() -> WheelController:
        return learner.plan().controller(task.reference)

    first = controller()
    # One that keeps what it has answered to an earlier sample is asked anew for each answer.
    return loops_of(experiment, controller if remembers else lambda: first, remembers=remembers)


def loops_of(
    experiment: Experiment, controller: Callable[[], WheelController], *, remembers: bool = False
) -> list[LateLoop] | None:
    """Returns what `late_loops` does, of any controller.

    Args:
        experiment: Its reference and robot.
        controller: Gives one that is at its start.
        remembers: Whether it has to be led through the samples before the one that is looked at.
    """
    reference, robot = experiment.reference, DrivenRobot.of(experiment)
    speeds, yaw_rates = reference_twist(reference)
    found = []
    samples = _telling_samples(speeds, yaw_rates)
    for k in samples[:_FEW] if remembers else samples:
        gains = _answers(controller, reference, k, remembers=remembers)
        if gains is None:
            return None
        if gains.any():
            twist, at = (float(speeds[k]), float(yaw_rates[k])), k * reference.sample_time
            found.append(LateLoop.about(robot, twist, gains, reference.sample_time, at))
    return found


def _telling_samples(speeds: Floats, yaw_rates: Floats) -> list[int]:
    """Returns samples of steps that differ most: fastest, median, turning most, in sharp bends."""
    speed = np.abs(speeds)
    moving = np.flatnonzero(speed > _SLOW * speed.max())
    if not len(moving):
        moving = np.flatnonzero(np.abs(yaw_rates) > 0)
    found: dict[tuple[float, float], int] = {}
    if len(moving):
        middle = median(speed[moving])
        for strain in (speed, np.abs(yaw_rates), speed * np.abs(yaw_rates), -abs(speed - middle)):
            rounded = strain[moving].round(9)
            ties = moving[rounded == rounded.max()]
            k = int(ties[len(ties) // 2])
            found.setdefault((round(float(speeds[k]), 6), round(float(yaw_rates[k]), 6)), k)
    return list(found.values())


def _answers(
    controller: Callable[[], WheelController], reference: Reference, at: int, *, remembers: bool
) -> Floats | None:
    """Returns what a controller answers to an error in one sample, in that and in later ones.

    Returns:
        Shape (p, 2, 3), as `LateLoop.about` takes it; None if the answer does not end.
    """
    last = min(at + _LONGEST, reference.samples)
    headings = reference.heading.tolist()

    def answered(error: tuple[float, float, float]) -> Floats:
        wheel_speeds, told = controller(), []
        before = range(at) if remembers else range(min(at, 1))
        for k in (*before, *range(at, last)):
            ahead, aside, turned = error if k == at else (0.0, 0.0, 0.0)
            cos, sin = math.cos(headings[k]), math.sin(headings[k])
            seen = headings[k] - turned
            wheels = wheel_speeds(
                k,
                math.cos(seen),
                math.sin(seen),
                cos * ahead - sin * aside,
                sin * ahead + cos * aside,
                turned,
            )
            if k >= at:
                told.append(wheels)
        return np.array(told)

    none = answered((0.0, 0.0, 0.0))
    errors = (_SIZE * np.eye(3)).tolist()
    gains = np.stack([(answered(tuple(each)) - none) / _SIZE for each in errors], axis=2)
    sizes = np.abs(gains).max(axis=(1, 2))
    there = np.flatnonzero(sizes > _GONE * sizes.max())
    if len(there) == 0 or not np.isfinite(sizes).all():
        return np.zeros((1, 2, 3)) if np.isfinite(sizes).all() else None
    if there[-1] == len(sizes) - 1 and len(sizes) > 1 and sizes[-1] > _LASTING * sizes.max():
        return None
    return gains[: there[-1] + 1]
