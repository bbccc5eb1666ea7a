"""Experiments of the tests: the paper's platform and situations, and how to put one together."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from hilc_cli.disturbance.streams import Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, model_gain, unit_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.yaml_input.expressions import Affine
from tests.reference.paths import PAPER_STARTS, Pose

PLATFORM = Robot(0.200, 0.518)  # Eq. 44
LIMIT = 180.0  # [rad/s]
UP = math.pi / 2
MatrixName = Literal["model", "unit", "contradicting"]


def matrix_of(name: MatrixName, model: Robot) -> GainMatrix:
    """Eq. 45, Eq. 56 or Eq. 57."""
    if name == "model":
        return model_gain(model)
    if name == "unit":
        return unit_gain(model)
    turning = model.signed_half_track / model.wheel_radius
    return GainMatrix(
        left=(Affine(0.5), Affine(0.2), Affine(turning)),
        right=(Affine(cos=1.0), Affine(sin=1.0), Affine(-turning)),
    )


@dataclass(frozen=True)
class Situation:
    """A row of the table of experiments."""

    trajectory: str = "circle"
    start: Pose | None = None
    l1: float = 0.0
    l2: float = 0.0
    l3: float = 0.0
    matrix: MatrixName = "model"
    compensation: bool = False
    speed_limit: float = LIMIT

    @property
    def initial_pose(self) -> Pose:
        """The given start, or that of the trajectory."""
        return PAPER_STARTS[self.trajectory] if self.start is None else self.start


SITUATIONS: dict[str, Situation] = {
    **{f"1-{name}": Situation(name, l1=1.0) for name in PAPER_STARTS},
    "2": Situation(start=(9.0, 0.0, UP), l1=0.5, l2=0.25, l3=0.25),
    "3-circle": Situation(start=(9.0, 0.0, UP), l1=0.5, compensation=True),
    "3-arc-and-line": Situation("arc-and-line", (4.0, 0.0, UP), l1=0.5, compensation=True),
    "3-cardioid": Situation("cardioid", (2.0, 0.0, 14 * math.pi / 15), l1=0.5, compensation=True),
    "3-spiral": Situation("spiral", (2.5, 0.0, 31 * math.pi / 30), l1=0.5, compensation=True),
    "4a": Situation(l1=0.1),
    "4b": Situation(l1=1.0),
    "4c": Situation(l1=10.0),
    "5a": Situation(l1=0.1, l2=0.5),
    "5b": Situation(l1=0.1, l2=1.0),
    "5c": Situation(l1=0.1, l2=10.0),
    "6a": Situation(l1=0.1, l2=1.0, l3=0.1),
    "6b": Situation(l1=0.1, l2=1.0, l3=1.0),
    "6c": Situation(l1=0.1, l2=1.0, l3=20.0),
    "7": Situation(l1=0.1, l2=0.25, l3=0.25, speed_limit=math.inf),
    "8": Situation(l1=0.1, l2=0.25, l3=0.25),
    "9": Situation(l1=1.0, l2=0.25, l3=0.25, speed_limit=math.inf),
    "10": Situation(l1=0.5, l2=0.25, l3=0.25),
    "11": Situation(l1=0.1, l2=0.25, l3=0.25),
    "12": Situation(l1=1.0, l2=0.5, l3=0.5, matrix="unit"),
    "13": Situation(l1=0.1, l2=0.25, l3=0.25, matrix="contradicting"),
}


def law_of(
    l1: float,
    l2: float = 0.0,
    l3: float = 0.0,
    *,
    matrix: GainMatrix | None = None,
    gain_heading: GainHeading = "measured",
    compensation: bool = False,
    h: int = 200,
    derivative: float = 0.0,
) -> HybridLaw:
    """A law; its matrix is Eq. 45 with the platform's parameters if none is given."""
    gain = model_gain(PLATFORM) if matrix is None else matrix
    return HybridLaw(l1, l2, l3, gain, gain_heading, compensation, h, derivative)


def experiment_of(
    reference: Reference,
    law: HybridLaw,
    *,
    initial_pose: Pose | None = None,
    robot: Robot = PLATFORM,
    initial_input: tuple[Floats, Floats] | None = None,
    learn_in_first: bool = False,
    iterations: int = 5,
    speed_limit: float = math.inf,
    disturbance: Disturbance | None = None,
) -> Experiment:
    """An experiment; it starts on the reference, at rest, undisturbed, if nothing else is said."""
    start = (float(reference.x[0]), float(reference.y[0]), float(reference.heading[0]))
    rest = np.zeros(reference.samples)
    left, right = (rest, rest) if initial_input is None else initial_input
    return Experiment(
        reference=reference,
        plant=KinematicPlant(robot),
        law=law,
        initial_pose=start if initial_pose is None else initial_pose,
        initial_left=left,
        initial_right=right,
        learn_in_first=learn_in_first,
        iterations=iterations,
        speed_limit=speed_limit,
        disturbance=Disturbance() if disturbance is None else disturbance,
    )
