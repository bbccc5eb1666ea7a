"""What an engine runs: reference, plant, law, disturbance. It knows nothing of files."""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.disturbance.streams import Disturbance, Triple
from hilc_cli.laws.law import Law
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.plant import Plant
from hilc_cli.reference.sampled import Floats, Reference


@dataclass(frozen=True, slots=True, eq=False)
class Experiment:
    """One learning experiment, every number resolved.

    Attributes:
        reference: The trajectory y_d, n + 1 samples.
        plant: The platform as it really moves; what the controller believes is in the law.
        law: The learning law.
        initial_pose: Pose at which each iteration starts [m, m, rad], before its disturbance.
        initial_left: u_0 of the left wheel [rad/s], shape (n,).
        initial_right: u_0 of the right wheel [rad/s], shape (n,).
        learn_in_first: Whether iteration 0 already runs the law, from u_0 and no error, instead
            of applying u_0 as it is.
        iterations: Number of learning updates N; iterations 0..N are run.
        speed_limit: b_w [rad/s]; infinity for none.
        disturbance: Disturbances of state, output and initial pose.
    """

    reference: Reference
    plant: Plant
    law: Law
    initial_pose: Triple
    initial_left: Floats
    initial_right: Floats
    learn_in_first: bool
    iterations: int
    speed_limit: float
    disturbance: Disturbance

    @property
    def robot(self) -> Robot:
        """The true platform."""
        return self.plant.robot
