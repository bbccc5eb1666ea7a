"""What theory knows of the norm-optimal law, and what a wrong model does to its learning.

With the believed plant P_b and the true one P = P_b D an update without limit takes u to

    u + (P_b' Q P_b + R)^-1 P_b' Q (e - P (u - u_d)),

so that what is wrong with u is multiplied by I - S D, S = (P_b' Q P_b + R)^-1 P_b' Q P_b. D
multiplies the mean of both wheels by R / R_b and half their difference by R B_b / (R_b B). All
eigenvalues of S are between 0 and 1, near 1 where errors weigh much more than the change of input.
So those of S D are positive, at most as large as the larger factor of D, and learning converges
where they are below 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, Findings, Rows, expected_rows, joined
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.laws.norm_optimal_merging import Merging, merging, merging_findings
from hilc_cli.theory.laws.norm_optimal_noise import expected_of_norm_optimal
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.noise import Remedies, WheelNoise, noise_findings, wheel_findings, wheel_rows

_MADE_UP_FOR = "feedback makes up for a wrong model"


class NormOptimalTheory(LawTheory):
    """How soon the law is on the trajectory, and what a wrong model does to its learning."""

    tells_the_way_in = True

    @property
    def law(self) -> NormOptimalLaw:
        """The law."""
        return cast("NormOptimalLaw", self.experiment.law)

    @cached_property
    def merging(self) -> Merging:
        """The way into the trajectory."""
        return merging(self.experiment, self.law)

    @cached_property
    def mismatch(self) -> ModelMismatch | None:
        """What a wrong model does, if the law can make up for it by nothing."""
        return model_mismatch(self.experiment, self.law)

    @cached_property
    def _last_iteration(self) -> tuple[ExpectedError, Outcome, WheelNoise | None]:
        leaves = 0.0 if self.mismatch is None else self.mismatch.left
        return expected_of_norm_optimal(self.experiment, self.law, leaves)

    @property
    def expected(self) -> ExpectedError:
        """How large the error of the last iteration will be."""
        return self._last_iteration[0]

    @property
    def outcome(self) -> Outcome:
        """What comes of learning."""
        return self._last_iteration[1]

    @property
    def wheels(self) -> WheelNoise | None:
        """What disturbances make of the wheel speeds."""
        return self._last_iteration[2]

    @property
    def way_in(self) -> Findings:
        """What the way into the trajectory means."""
        return merging_findings(self.merging)

    @property
    def findings(self) -> Findings:
        """What all the rest means."""
        softer = "raise controller.feedback_weights, or set 'feedback: none'"
        return joined(
            untried_findings(self.experiment, self.law),
            wheel_findings(self.wheels, softer),
            Findings()
            if self.mismatch is None
            else mismatch_findings(self.mismatch, self.expected, self.outcome),
            noise_findings(self.experiment, self.expected, _remedies(self.law)),
        )

    @property
    def rows(self) -> Rows:
        """The way in, and what learning does to errors."""
        return [*_way_in(self.merging), *self._learning()]

    @property
    def brief(self) -> Rows:
        """The way in and what learning does in short, and the error to be expected."""
        found = self.merging
        told = self._learning()
        if self.mismatch is None:
            identifies = "identifies wheel radius and half track"
            told[-1] = "Learning", identifies if self.law.identify else _MADE_UP_FOR
        if found.is_off:
            planned = _merge(found)
            text = (
                f"from {found.position_error:.4g} m, {found.heading_error:.4g} rad off: {planned}"
            )
            if found.earliest is not None and math.isfinite(found.speed_limit):
                text += f"; any law from {found.earliest} on"
            told.insert(0, ("Merges", text))
        return [*told, *expected_rows(self.expected, self.experiment), *wheel_rows(self.wheels)]

    @property
    def document(self) -> dict[str, object]:
        """What is known, as JSON."""
        found, mismatch = self.merging, self.mismatch
        document: dict[str, object] = {
            "initial_position_error_m": found.position_error,
            "initial_heading_error_rad": found.heading_error,
            "h_samples": found.h,
            "earliest_merge_sample": found.earliest,
            "merge_sample": found.planned,
            "believed_max_wheel_speed_rad_s": found.fastest_believed,
        }
        if mismatch is not None:
            document |= {
                "correction_along": mismatch.along,
                "correction_turning": mismatch.turning,
                "correction_strongest": mismatch.strongest,
                "iteration_leaves": mismatch.left,
                "converges": mismatch.converges,
            }
        return document

    def _learning(self) -> Rows:
        rows: Rows = []
        found, mismatch = self.merging, self.mismatch
        if (
            math.isfinite(found.speed_limit)
            and found.is_possible
            and not found.is_believed_possible
        ):
            rows.append(
                (
                    "Believed robot",
                    f"needs {found.fastest_believed:.4g} rad/s, above b_w: the law lags at first",
                )
            )
        if mismatch is None:
            identified = "wheel radius and half track are identified"
            why = identified if self.law.identify else f"the {_MADE_UP_FOR}"
            return [*rows, ("Theory", f"no condition is evaluated: {why}")]
        strongest = f"{mismatch.along:.4g} along the path, {mismatch.turning:.4g} in turning"
        return [
            *rows,
            ("Correction, times the right one", f"{strongest}; must be below 2"),
            ("An iteration leaves", f"{mismatch.left:.3g} of small errors that weigh much"),
        ]


def _remedies(law: NormOptimalLaw) -> Remedies:
    """Returns what can be done about disturbances."""
    if law.feedback == "none":
        return Remedies(
            start="place the robot better, or set controller.feedback: lqr",
            readings="measure better, or raise iterations",
            state="make it smaller, or set controller.feedback: lqr",
        )
    weights = "controller.feedback_weights"
    return Remedies(
        start=f"place the robot better, or lower {weights}",
        readings=f"measure better, raise {weights}, or set 'feedback: none'",
        state=f"make it smaller, or lower {weights}",
    )


def _way_in(found: Merging) -> Rows:
    off = f"{found.position_error:.4g} m, {found.heading_error:.4g} rad"
    if not found.is_off:
        return [("Initial error", f"{off}: the trajectory itself is the reference")]
    earliest = _sample(found, found.earliest, "at no sample")
    if math.isinf(found.speed_limit):
        earliest = "at once: there is no speed limit"
    planned = _merge(found)
    return [
        ("Initial error", off),
        ("Earliest merge of any law", earliest),
        ("Merge of this law", f"{planned}; h is {found.h}"),
    ]


def _merge(found: Merging) -> str:
    """Returns where the law's way in ends: within a millimetre, or else as near as counts."""
    if found.planned is not None:
        return _sample(found, found.planned, "")
    if found.way.joins is None:
        return "not before the end"
    what = "it" if found.is_possible else "what the limit leaves of it"
    return f"within {found.way.near:.2g} m of {what} from {_sample(found, found.way.joins, '')}"


def _sample(found: Merging, sample: int | None, none: str) -> str:
    return none if sample is None else f"sample {sample} ({sample * found.way.sample_time:.6g} s)"


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
    """Returns what the believed wheel radius and half track do to learning.

    Returns:
        None where no theory is evaluated: R and B are identified, or a feedback in the iteration
        makes up for what is wrong with them.
    """
    if law.identify or law.feedback != "none":
        return None
    along, turning = _shares(experiment, law)
    return ModelMismatch(along, turning, _strongest(experiment, law, along, turning))


def untried_findings(experiment: Experiment, law: NormOptimalLaw) -> Findings:
    """Tells whether feedback is asked to make up for more than it has been seen to."""
    if law.identify or law.feedback == "none":
        return Findings()
    shares = _shares(experiment, law)
    tried = (_TRIED_ALONG, _TRIED_TURNING)
    if all(low <= share <= high for share, (low, high) in zip(shares, tried, strict=True)):
        return Findings()
    return Findings.warning(
        f"with R / R_b of {shares[0]:.3g} and R B_b / (R_b B) of {shares[1]:.3g} errors may "
        "grow from iteration to iteration: learning without identification has been tried from "
        "1/3 to 1.5 of the one and 0.4 to 2 of the other; correct model, or set "
        "controller.identify: true"
    )


def _shares(experiment: Experiment, law: NormOptimalLaw) -> tuple[float, float]:
    """Returns R / R_b and R B_b / (R_b B)."""
    robot, model = experiment.robot, law.model
    along = robot.wheel_radius / model.wheel_radius
    return along, along * model.signed_half_track / robot.signed_half_track


def mismatch_findings(found: ModelMismatch, expected: ExpectedError, outcome: Outcome) -> Findings:
    """Returns what a wrong model means for the experiment, of which so much is expected."""
    if found.converges and outcome is not Outcome.DOES_NOT_LEARN:
        return Findings()
    if found.converges:
        return Findings.warning(
            f"on a model that stays wrong an iteration leaves {found.left:.3g} of the error, "
            f"which goes from {expected.first_m:.3g} m to {expected.final_m:.3g} m: correct "
            "model, set controller.identify: true or controller.feedback: lqr, or raise "
            "iterations"
        )
    # The track has a part in it only if turning is the worse one, beyond rounding.
    is_radius = found.along > found.turning * (1 - _ENOUGH)
    worst = "R / R_b" if is_radius else "R B_b / (R_b B)"
    return Findings.failure(
        f"learning cannot converge: the correction is {found.strongest:.4g} times what would "
        f"be right, and may be 2 times at most, because {worst} is "
        f"{max(found.along, found.turning):.4g}; correct model, or set "
        "controller.identify: true or controller.feedback: lqr"
    )


def _strongest(experiment: Experiment, law: NormOptimalLaw, along: float, turning: float) -> float:
    """Returns the largest eigenvalue of S D, by powers of it: all are real and positive."""
    from hilc_cli.laws.norm_optimal.linear_quadratic import (
        LinearQuadratic,
        linearised,
    )  # the compiler starts slowly

    model, samples = law.model, experiment.reference.samples
    gains = step_gains(
        model.wheel_radius, model.signed_half_track, experiment.reference.sample_time
    )
    position, heading, wheel = law.squared_weights
    motion = linearised(experiment.reference.poses, *gains)
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
