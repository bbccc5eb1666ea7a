"""What a wrong model does to the learning of the norm-optimal law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.matrices import desired_poses

_STEPS = 60
_ENOUGH = 1e-6  # relative change of the estimate at which the search ends
_TRIED_ALONG, _TRIED_TURNING = (1 / 3, 1.5), (0.4, 2.0)
"""Where learning with feedback fell from iteration to iteration; docs/laws/norm-optimal.md."""


@dataclass(frozen=True, slots=True)
class ModelMismatch:
    """Learning from the wheel speeds alone, on a belief that stays as it is.

    Attributes:
        along: R / R_b.
        turning: R B_b / (R_b B).
        strongest: The largest eigenvalue of S D.
    """

    along: float
    turning: float
    strongest: float

    @property
    def left(self) -> float:
        """Share that an iteration leaves of a small error where errors weigh much."""
        return max(abs(1 - self.along), abs(1 - self.turning))

    @property
    def converges(self) -> bool:
        """Whether small errors fall in the end."""
        return self.strongest < 2


def model_mismatch(experiment: Experiment, law: NormOptimalLaw) -> ModelMismatch | None:
    """What the believed wheel radius and half track do to learning.

    Returns:
        None where no theory is evaluated: R and B are identified, or a feedback in the iteration
        makes up for what is wrong with them.
    """
    if law.parameters.identify or law.parameters.feedback != "none":
        return None
    along, turning = _shares(experiment, law)
    return ModelMismatch(along, turning, _strongest(experiment, law, along, turning))


def untried_findings(experiment: Experiment, law: NormOptimalLaw) -> Findings:
    """Whether feedback is asked to make up for more than it has been seen to."""
    if law.parameters.identify or law.parameters.feedback == "none":
        return Findings()
    shares = _shares(experiment, law)
    tried = (_TRIED_ALONG, _TRIED_TURNING)
    if all(low <= share <= high for share, (low, high) in zip(shares, tried, strict=True)):
        return Findings()
    return Findings(
        warnings=(
            f"with R / R_b of {shares[0]:.3g} and R B_b / (R_b B) of {shares[1]:.3g} errors may "
            "grow from iteration to iteration: learning without identification has been tried from "
            "1/3 to 1.5 of the one and 0.4 to 2 of the other; correct model, or set "
            "controller.identify: true",
        )
    )


def _shares(experiment: Experiment, law: NormOptimalLaw) -> tuple[float, float]:
    """R / R_b and R B_b / (R_b B)."""
    robot, model = experiment.robot, law.model
    along = robot.wheel_radius / model.wheel_radius
    return along, along * model.signed_half_track / robot.signed_half_track


def mismatch_findings(found: ModelMismatch) -> Findings:
    """What they mean for the experiment."""
    if found.converges:
        return Findings()
    # The track has a part in it only if turning is the worse one, beyond rounding.
    is_radius = found.along > found.turning * (1 - _ENOUGH)
    worst = "R / R_b" if is_radius else "R B_b / (R_b B)"
    return Findings(
        failures=(
            f"learning cannot converge: the correction is {found.strongest:.4g} times what would "
            f"be right, and may be 2 times at most, because {worst} is "
            f"{max(found.along, found.turning):.4g}; correct model, or set "
            "controller.identify: true or controller.feedback: lqr",
        )
    )


def _strongest(experiment: Experiment, law: NormOptimalLaw, along: float, turning: float) -> float:
    """The largest eigenvalue of S D, by powers of it: all are real and positive."""
    from hilc_cli.laws.norm_optimal.linear_quadratic import (
        LinearQuadratic,
        linearised,
    )  # the compiler starts slowly

    model, samples = law.model, experiment.reference.samples
    gains = step_gains(
        model.wheel_radius, model.signed_half_track, experiment.reference.sample_time
    )
    position, heading, wheel = law.parameters.squared_weights
    motion = linearised(desired_poses(experiment), *gains)
    pose_weights = np.tile([position, heading], (samples + 1, 1))
    input_weights, none = np.full((samples, 2), wheel), np.zeros((samples, 2))
    no_slopes = np.zeros((samples + 1, 3))
    plain = LinearQuadratic(motion, pose_weights, input_weights, no_slopes, none)

    def applied(inputs: Floats) -> Floats:
        """S D times an input, shape (n, 2)."""
        mean, half = inputs.sum(axis=1) / 2 * along, (inputs[:, 0] - inputs[:, 1]) / 2 * turning
        moved = plain.moved(np.stack([mean + half, mean - half], axis=1))
        slopes = -pose_weights[:, [0, 0, 1]] * moved
        problem = LinearQuadratic(motion, pose_weights, input_weights, slopes, none)
        return problem.solution(input_weights, none)[0]

    vector = np.random.default_rng(0).standard_normal((samples, 2))
    found = 0.0
    for _ in range(_STEPS):
        vector = applied(vector)
        before, found = found, float(np.linalg.norm(vector))
        vector /= found
        if abs(found - before) <= _ENOUGH * found:
            break
    return found
