"""What one pass over a path lets one find out of a robot, before it is driven.

The reference is driven by the robot as it is believed, readings and floor as noisy as the scenario
says, or as they usually are. How wheels and motors change what a Kalman filter does not expect is
the information of a pass (Fisher), and its inverse the covariance of what is identified: the same
that norm-optimal learning and `hilc identify` compute of passes that were driven.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Rows
from hilc_cli.theory.late_loop import DrivenRobot
from hilc_cli.theory.noise import deviations

READ_POSITION, READ_HEADING = 2e-3, math.radians(0.2)
"""Standard deviations of a reading [m, rad] where the scenario has none."""
MOVED, TURNED = 5e-3, math.radians(0.5)
"""How far a robot is off after the first metre of its wheels [m, rad]: it grows with its root."""

if TYPE_CHECKING:
    from hilc_cli.laws.norm_optimal.motion_filter import Noise

TOLD = {
    "wheel radius": "%",
    "half track": "%",
    "radius by half track": "%",
    "left by right radius": "%",
    "delay and lag": "ms",
    "delay": "ms",
    "lag": "ms",
    "friction": "rad/s",
}
"""What is told of a pass, as `identification.TOLD` has it, with the unit of its standard error."""
_SCALES = {"%": 100.0, "ms": 1e3, "rad/s": 1.0}
_OF_TWO = {
    "radius by half track": ("wheel radius", "half track"),
    "delay and lag": ("delay", "lag"),
}
"""What a pass may tell of two things together: said where it does not tell both."""
_PARAMETERS = (
    "wheel radius", "left by right radius", "half track", "delay", "lag", "friction",
)  # fmt: skip
"""The parameters, as `identification.NAMES` has them, by what they are called here."""
_APART = 0.98
"""Correlation above which two things are not told apart: each alone would be five times surer."""


@dataclass(frozen=True, slots=True, eq=False)
class PassInformation:
    """What a pass would tell.

    Attributes:
        errors: Standard errors of `TOLD`: shares, s and rad/s; not-a-number for what it does not
            tell.
        alike: Pairs that it does not tell apart, by their names.
    """

    errors: Floats
    alike: tuple[tuple[str, str], ...]


class Identifiable:
    """What one pass over the path of an experiment lets one identify."""

    def __init__(self, experiment: Experiment) -> None:
        self._experiment = experiment

    @cached_property
    def noise(self) -> Noise:
        """The noise that is reckoned with, of the scenario where it has any."""
        from hilc_cli.laws.norm_optimal.motion_filter import Noise  # the compiler starts slowly

        experiment = self._experiment
        reference, source = experiment.reference, experiment.disturbance
        position, heading = READ_POSITION, READ_HEADING
        if source.output.active:
            x, y, turned = deviations(source.output)
            position = math.hypot(x, y) / math.sqrt(2) or position
            heading = turned or heading
        way = self._rolled / reference.samples  # in a sample
        ahead = left = MOVED * math.sqrt(way)
        turn = TURNED * math.sqrt(way)
        if source.state.active:
            x, y, turned = deviations(source.state)
            ahead = left = math.hypot(x, y) / math.sqrt(2) or ahead
            turn = turned or turn
        return Noise(*np.square([ahead, left, turn, position, heading]).tolist())

    @property
    def _rolled(self) -> float:
        """How far the wheels roll, their mean [m]."""
        experiment = self._experiment
        wheels = np.abs(feedforward(experiment.reference, experiment.robot))
        rolled = float(wheels.mean(axis=0).sum()) * experiment.robot.wheel_radius
        return rolled * experiment.reference.sample_time

    @cached_property
    @np.errstate(all="ignore")
    def of_a_pass(self) -> PassInformation:
        """What one pass tells."""
        # The compiler starts slowly.
        from hilc_cli.laws.norm_optimal.belief import MotorBelief
        from hilc_cli.laws.norm_optimal.identification import Identification
        from hilc_cli.laws.norm_optimal.motor import Motor, moved, steps_of
        from hilc_cli.laws.norm_optimal.passes_told import Pass

        experiment = self._experiment
        reference, robot = experiment.reference, DrivenRobot.of(experiment)
        motor = Motor(robot.left_radius, robot.right_radius, robot.half_track, 0.0, 0.0, 0.0)
        inputs = np.stack(feedforward(reference, experiment.robot), axis=1)
        steps = steps_of(motor, inputs, reference.sample_time)
        beside = np.zeros((reference.samples, 3))
        poses = moved(reference.poses[0], steps, beside, robot.lead)
        size = reference.size + 1e-3
        found = Identification(reference.sample_time, robot.lead, size)
        belief = MotorBelief.at_first(motor, found.quietest(self.noise))
        covariance = found.expected_covariance(belief, Pass(poses, inputs), 1)
        sure = MotorBelief(motor, belief.parameters, covariance, belief.noise)
        deviation = np.sqrt(np.diag(covariance))
        correlations = covariance / np.outer(deviation, deviation)
        alike = [
            (_PARAMETERS[one], _PARAMETERS[other])
            for one, other in zip(*np.triu_indices(len(_PARAMETERS), 1), strict=True)
            if abs(correlations[one, other]) > _APART
        ]
        return PassInformation(sure.told_errors, tuple(alike))

    @property
    def _sure(self) -> dict[str, bool]:
        """Whether a pass tells each of `TOLD`."""
        return dict(zip(TOLD, np.isfinite(self.of_a_pass.errors).tolist(), strict=True))

    @property
    def hidden(self) -> list[str]:
        """What a pass does not tell, not even together with something else."""
        sure = self._sure
        together = {part for whole, parts in _OF_TWO.items() if sure[whole] for part in parts}
        return [name for name in TOLD if not sure[name] and name not in {*_OF_TWO, *together}]

    @property
    def rows(self) -> Rows:
        """What one pass tells, what not, and what it hardly tells apart."""
        sure, found = self._sure, self.of_a_pass
        told = [
            f"{name} {_SCALES[unit] * error:.2g} {unit}"
            for (name, unit), error in zip(TOLD.items(), found.errors.tolist(), strict=True)
            if sure[name] and not (name in _OF_TWO and all(sure[part] for part in _OF_TWO[name]))
        ]
        alike = [" and ".join(pair) for pair in found.alike]
        return [
            ("A pass tells to", ", ".join(told) or "nothing"),
            ("  tells not", ", ".join(self.hidden) or "-"),
            ("  hardly apart", ", ".join(alike) or "-"),
        ]

    @property
    @np.errstate(all="ignore")
    def document(self) -> dict[str, object]:
        """The same as JSON, standard errors as shares, in s and in rad/s."""
        found, noise = self.of_a_pass, self.noise
        return {
            "standard_errors": {
                name: None if math.isnan(error) else error
                for name, error in zip(TOLD, found.errors.tolist(), strict=True)
            },
            "not_told": self.hidden,
            "hardly_apart": [list(pair) for pair in found.alike],
            "noise": {name: math.sqrt(variance) for name, variance in noise._asdict().items()},
        }
