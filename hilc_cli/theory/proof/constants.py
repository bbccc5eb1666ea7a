"""The conditions of the paper's theorems, and the constants of their proof: Eqs. 12 to 32.

With all corrections they satisfy, in every iteration and at every sample of an experiment, with
disturbances, initial errors and a speed limit or without, whatever its headings do,

    ||du_{i+1}(k)|| <= rho ||du_i(k)|| + h1 ||dq_i(k)|| + h3 ||dq_{i+1}(k)||
                       + b_L3 ||dq_{i+1}(k-1)|| + b_1                                (Eq. 32)
    ||dq_i(k+1)||   <= h2 ||dq_i(k)|| + b_B ||du_i(k)|| + b_beta                      (Eq. 28)

with du = u_d - u and dq = q_d - q. The print has these with b_L2 for h3.

Where L1 acts on e_i(k+1) + tau (e_i(k+1) - e_i(k)) / d_k, Eq. 26 put into that gives

    dq_i(k) + (1 + tau / d_k) [d_k (B_d - B_i) u_d(k) + d_k B_i du_i(k) - beta(k)]

for dq_i(k+1): the error before the step counts once, whatever tau is, and the step 1 + tau / d_k
times. So Eq. 32 stays, with rho = max ||I - (tau + d_k) L1 B||, which has a limit below 1 for small
sample times: max ||I - tau L1 B||. L2 and L3 have none of tau, and none in that limit.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Literal

import numpy as np

from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.plants.kinematic import control_matrices, limit_wheel_speeds
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.linear_law import linear_law, paper_law
from hilc_cli.theory.matrices import Desired, desired_motion
from hilc_cli.theory.proof.norms import (
    WheelNorm,
    control_slope,
    gain_norm,
    input_norm,
    largest_contraction,
    largest_control,
    largest_gain,
    largest_gain_slope,
    pose_norm,
    wheel_map_norm,
)


@dataclass(frozen=True, slots=True)
class Conditions:
    """The numbers rho that both theorems want below 1, printed and for the simulated system.

    The print has B of Eq. 9, the plant of Eq. 8 moves by d_k B in a sample. The proof of Theorem 1,
    Eq. 30, needs the condition of Theorem 2: L2 and L3 do not learn. With a derivative both have a
    limit for small sample times, max ||I - tau L1 B||, which takes the place of what is printed.

    Attributes:
        theorem: Which of the two speaks of this experiment's law: 1 of Eq. 17, 2 of Eq. 21.
        theorem_1_printed: max ||I - (L1 + L2 + L3) B||, Eq. 19; with a derivative the limit.
        theorem_1_simulated: max ||I - ((L1 + L2 + L3) d_k + L1 tau) B||.
        theorem_2_printed: max ||I - L1 B||, Eq. 23; with a derivative the limit.
        theorem_2_simulated: max ||I - L1 (d_k + tau) B||.
        derivative: tau [s], 0 in the paper.
        starts_on_reference: Whether y_i(0) = y_d(0), as both theorems want, in every iteration.
    """

    theorem: Literal[1, 2]
    theorem_1_printed: float
    theorem_1_simulated: float
    theorem_2_printed: float
    theorem_2_simulated: float
    derivative: float
    starts_on_reference: bool


def conditions(experiment: Experiment) -> Conditions:
    """Returns the conditions of Theorems 1 and 2.

    B is that of the true robot, L that of the law, which knows the model; both at the heading of
    the reference.

    Raises:
        UsageError: The law is not the hybrid law.

    Source:
        Qiao et al. 2021, Eqs. 19 and 23.
    """
    law, reference = paper_law(experiment), experiment.reference
    all_gains, learned = law.l1 + law.l2 + law.l3, law.l1 * law.derivative
    sample_time, is_printed = reference.sample_time, law.derivative == 0
    start = (reference.x[0], reference.y[0], reference.heading[0])
    disturbance = experiment.disturbance
    return Conditions(
        theorem=2 if law.compensation else 1,
        theorem_1_printed=contraction(experiment, all_gains if is_printed else learned),
        theorem_1_simulated=contraction(experiment, all_gains * sample_time + learned),
        theorem_2_printed=contraction(experiment, law.l1 if is_printed else learned),
        theorem_2_simulated=contraction(experiment, law.l1 * sample_time + learned),
        derivative=law.derivative,
        starts_on_reference=experiment.initial_pose == start
        and not disturbance.initial_pose.active
        and not disturbance.output.active,
    )


def contraction(experiment: Experiment, gain: float, wheels: WheelNorm = "euclidean") -> float:
    """Returns max_k ||I - gain L(q_d(k)) B(q_d(k))|| along the reference.

    Args:
        experiment: The experiment.
        gain: Scalar before the product, with the sample time or without, and with tau.
        wheels: Norm of wheel speeds.
    """
    control = control_matrices(experiment.robot, experiment.reference.heading[:-1])  # Eq. 9
    product = linear_law(experiment).gains @ control
    return float(wheel_map_norm(np.eye(2) - gain * product, wheels).max())


class Correction(StrEnum):
    """One change that turns the printed bounds into bounds of the system that is simulated."""

    SAMPLE_TIME = "sample-time"
    LEARNING_GAIN = "learning-gain"
    HEADINGS = "headings"
    STATE_DISTURBANCE = "state-disturbance"
    REACHABILITY = "reachability"
    COMPENSATION = "compensation"
    SPEED_LIMIT = "speed-limit"
    OUTPUT_SIGN = "output-sign"


EXPLANATIONS: Mapping[Correction, str] = {
    Correction.SAMPLE_TIME: (
        "Eqs. 12, 19 and 23 have B, and Eq. 26 loses the sample time from its second line on; the "
        "plant of Eq. 8 moves by d_k B, so that b_B and rho need d_k B"
    ),
    Correction.LEARNING_GAIN: (
        "Eq. 34 puts rho of Eq. 19, ||I - (L1 + L2 + L3) B||, for ||I - L1 B||, which Eq. 32 has "
        "and Eq. 23 bounds; L2 and L3 do not learn"
    ),
    Correction.HEADINGS: (
        "L is taken at the heading that the law uses, B at the one of the iteration before: "
        "||I - L1 B|| must hold for both headings, not on the reference alone"
    ),
    Correction.STATE_DISTURBANCE: (
        "Eq. 30 leaves beta out of e_i(k+1), so that b_L1 b_beta is missing in b_1 of Eq. 32"
    ),
    Correction.REACHABILITY: (
        "Eq. 26 takes q_d(k+1) = q_d(k) + d_k B u_d(k); the Euler plant does not reach the samples "
        "of an arc exactly, and what is missing counts as a disturbance of the state"
    ),
    Correction.COMPENSATION: (
        "Eq. 21 adds exp(-k d_k) theta(k) L1 e_i(0), at most 2 b_L1 (b_q0 + b_alpha) / (d_k h), "
        "which no bound contains; b_1 needs it"
    ),
    Correction.SPEED_LIMIT: (
        "Eq. 25 is not in the proof: scaling both wheels may take the input further from u_d in "
        "the Euclidean norm, by a factor of up to sqrt 2, though not in the sum of the wheels' "
        "absolute values; and u_d itself may exceed the limit"
    ),
    Correction.OUTPUT_SIGN: ("Eqs. 42 and 43 subtract b_alpha; the triangle inequality adds it"),
}

OF_THE_DERIVATIVE = (
    "L1 acts on e_i(k+1) + tau (e_i(k+1) - e_i(k)) / d_k: rho is ||I - (tau + d_k) L1 B||, h1 is "
    "b_L1 (1 + (1 + tau / d_k) C_B b_ud); in b_1 b_L1 b_beta counts 1 + tau / d_k times, "
    "b_L1 b_alpha 1 + 2 tau / d_k times, and the compensation tau times"
)
"""What a derivative changes in the constants."""

PRINTED: frozenset[Correction] = frozenset()
ALL: frozenset[Correction] = frozenset(Correction)


@dataclass(frozen=True, slots=True)
class Constants:
    """What the bounds are made of. Units mix metres and radians, as the paper's norms do.

    Attributes:
        wheels: The norm of wheel speeds that they are made for.
        samples: n.
        rho: Of Eq. 19 or 23.
        b_B: Largest norm of the control matrix, Eq. 12.
        C_B: Lipschitz constant of d_k B, Eq. 16.
        b_ud: Largest norm of u_d [rad/s], Eq. 14.
        b_L1: Largest norm of L1, Eq. 18.
        b_L2: Of L2; 0 with Eq. 21.
        b_L3: Of L3; 0 with Eq. 21.
        b_q0: Largest norm of the initial error, Eq. 15.
        b_alpha: Largest norm of the output's disturbance, Eq. 13.
        b_beta: Largest norm of the state's disturbance, Eq. 13.
        b_s: What u_d exceeds the speed limit by [rad/s]; 0 where the limit is not considered.
        h1: Eq. 32.
        h2: Eq. 28.
        h3: What ||dq_{i+1}(k)|| is weighted with; b_L2 in the paper.
        b_1: Eq. 32.
        output_offset: What the output error adds to the state error: -b_alpha in the print.
    """

    wheels: WheelNorm
    samples: int
    rho: float
    b_B: float
    C_B: float
    b_ud: float
    b_L1: float
    b_L2: float
    b_L3: float
    b_q0: float
    b_alpha: float
    b_beta: float
    b_s: float
    h1: float
    h2: float
    h3: float
    b_1: float
    output_offset: float


def constants(
    experiment: Experiment,
    corrections: Collection[Correction] = ALL,
    *,
    heading_mismatch: float | None = None,
) -> Constants:
    """Returns the constants of an experiment.

    A lateral gain, which the paper has not, is in L1, L2 and L3. Its sign is that of the
    reference's direction of travel, so that they depend on the sample as well as on the pose; the
    proofs ask for bounds at every sample, which are the largest over the directions that occur.

    Args:
        experiment: The experiment.
        corrections: What of the print is corrected: none of it as printed, all of it for bounds
            that hold whatever the headings do.
        heading_mismatch: With the correction of the headings, the largest angle [rad] between the
            heading at which L is taken and that at which B stands; the constants then hold as long
            as it does. By default what is sure before a run: the bound of the measured heading's
            disturbance if L is taken at the previous iteration's heading, else any angle.

    Raises:
        UsageError: The law is not the hybrid law, or it has a derivative, of which nothing is
            printed, and not all is corrected.

    Source:
        Qiao et al. 2021, Eqs. 12 to 18, 28 and 32.
    """
    law, robot, reference = paper_law(experiment), experiment.robot, experiment.reference
    sample_time, disturbance = reference.sample_time, experiment.disturbance
    rate = law.derivative / sample_time
    if rate and set(corrections) != ALL:
        raise UsageError("with a derivative, which the paper has not, all must be corrected")
    limited = Correction.SPEED_LIMIT in corrections and math.isfinite(experiment.speed_limit)
    wheels: WheelNorm = "sum" if limited else "euclidean"
    desired = desired_motion(experiment)
    linear = linear_law(experiment)
    (l2, l3), matrices = linear.feedback, linear.along.matrices

    scale = sample_time if Correction.SAMPLE_TIME in corrections else 1.0
    C_B = sample_time * control_slope(robot, wheels)  # Eq. 16
    b_ud = float(input_norm(desired.inputs, wheels).max())  # Eq. 14
    learning = law.l1 if Correction.LEARNING_GAIN in corrections else law.l1 + l2 + l3
    if Correction.HEADINGS in corrections:
        angle = _sure_mismatch(experiment) if heading_mismatch is None else heading_mismatch
        gain = max(largest_gain(matrix, wheels) for matrix in matrices)
        strength = learning * scale + law.l1 * law.derivative
        rho = max(
            largest_contraction(strength, matrix, robot, wheels, angle) for matrix in matrices
        )
    else:
        gain = float(gain_norm(linear.gains, wheels).max())
        rho = contraction(experiment, learning * scale, wheels)  # Eq. 19 or 23
    b_L1, b_L2, b_L3 = law.l1 * gain, l2 * gain, l3 * gain  # Eq. 18
    mismatch = desired.mismatch if Correction.REACHABILITY in corrections else np.zeros(3)
    b_beta = largest_disturbance(disturbance.state, mismatch)  # Eq. 13
    b_alpha = largest_disturbance(disturbance.output)
    b_q0 = largest_initial_error(experiment)
    b_s = largest_excess(experiment, desired, wheels) if limited else 0.0

    b_1 = (b_L1 + b_L2 + b_L3) * b_alpha + b_s + 2 * rate * b_L1 * b_alpha  # Eq. 32
    if Correction.STATE_DISTURBANCE in corrections:
        b_1 += (1 + rate) * b_L1 * b_beta
    if Correction.COMPENSATION in corrections and law.compensation:
        b_1 += float(law.compensations(reference)[0]) * b_L1 * (b_q0 + b_alpha)
    return Constants(
        wheels=wheels,
        samples=reference.samples,
        rho=rho,
        b_B=scale * largest_control(robot, wheels),  # Eq. 12
        C_B=C_B,
        b_ud=b_ud,
        b_L1=b_L1,
        b_L2=b_L2,
        b_L3=b_L3,
        b_q0=b_q0,
        b_alpha=b_alpha,
        b_beta=b_beta,
        b_s=b_s,
        h1=b_L1 * (1 + (1 + rate) * C_B * b_ud),  # Eq. 32
        h2=1 + C_B * b_ud,  # Eq. 28
        h3=b_L2,
        b_1=b_1,
        output_offset=b_alpha if Correction.OUTPUT_SIGN in corrections else -b_alpha,  # Eq. 43
    )


def constants_within_limit(experiment: Experiment) -> Constants:
    """Returns the constants of an experiment with a speed limit, all corrections made.

    They satisfy the two inequalities of `constants`; b_ud is the bound of u_i, as Eq. 14 has it.

    Raises:
        UsageError: There is no speed limit, or the law is not the hybrid law.

    Source:
        Qiao et al. 2021, Eqs. 12 to 18, 28 and 32, with Eq. 26 split the other way.
    """
    if math.isinf(experiment.speed_limit):
        raise UsageError("without a speed limit nothing bounds the inputs, as Eq. 14 demands")
    law, sample_time = paper_law(experiment), experiment.reference.sample_time
    c = constants(experiment)  # all but what B and L1 on the reference change

    b_ud, rate = 2 * experiment.speed_limit, law.derivative / sample_time  # Eq. 14
    growth = 1 + c.C_B * b_ud
    h1, h3, b_1 = c.b_L1 * (1 + (1 + rate) * c.C_B * b_ud), c.h3, c.b_1  # Eq. 32
    if law.gain_heading != "reference":
        # ||(L1(a) - L1(b)) w|| <= turning |a - b|, b the reference's heading, w what L1 acts on.
        matrices = linear_law(experiment).along.matrices
        slope = law.l1 * max(largest_gain_slope(matrix, c.wheels) for matrix in matrices)
        largest = _largest_state_error(experiment) + c.b_alpha
        turning = slope * (largest + rate * (_largest_change(experiment) + 2 * c.b_alpha))
        b_1 += turning * experiment.disturbance.output.bound[2]
        if law.gain_heading == "measured":
            h3 += turning
        else:
            h1 += turning
    rho = contraction(experiment, law.l1 * sample_time + law.l1 * law.derivative, c.wheels)
    return replace(c, rho=rho, b_ud=b_ud, h1=h1, h2=growth, h3=h3, b_1=b_1)  # h2: Eq. 28


def _largest_state_error(experiment: Experiment) -> float:
    """Returns what the state error cannot exceed, however the wheels turn within their limit."""
    desired = experiment.reference.poses
    step = _largest_step(experiment)
    travelled = pose_norm(desired - desired[0]) + step * np.arange(len(desired))
    return largest_initial_error(experiment) + float(travelled.max())


def _largest_change(experiment: Experiment) -> float:
    """Returns what the state error cannot change by more in a sample, likewise."""
    desired = pose_norm(np.diff(experiment.reference.poses, axis=0))
    return float(desired.max()) + _largest_step(experiment)


def _largest_step(experiment: Experiment) -> float:
    """Returns what the platform cannot exceed in a sample within its speed limit."""
    robot = experiment.robot
    # A convex function of both wheels, largest with both at the limit: straight ahead or turning.
    step = experiment.reference.sample_time * robot.wheel_radius * experiment.speed_limit
    step *= max(1.0, 1 / robot.half_track)
    return step + largest_disturbance(experiment.disturbance.state)


def largest_disturbance(source: Bounded, beside: Floats | float = 0.0) -> float:
    """Returns the largest norm that a bounded disturbance can have together with given offsets.

    Args:
        source: The disturbance.
        beside: Offsets [m, m, rad], shape (..., 3); the largest over all of them counts.
    """
    return float(np.max(pose_norm(np.abs(beside) + np.array(source.bound))))


def largest_initial_error(experiment: Experiment) -> float:
    """B_q0: the largest norm of q_d(0) - q_i(0) over the disturbance of the initial pose."""
    error = experiment.reference.poses[0] - experiment.initial_pose
    return largest_disturbance(experiment.disturbance.initial_pose, error)  # Eq. 15


def largest_excess(experiment: Experiment, desired: Desired, wheels: WheelNorm) -> float:
    """Returns b_s: the largest norm of what the speed limit takes from u_d [rad/s]."""
    return float(
        input_norm(desired.inputs - limited_inputs(experiment, desired.inputs), wheels).max()
    )


def limited_inputs(experiment: Experiment, inputs: Floats) -> Floats:
    """Returns wheel speeds as the speed limit lets them pass, shape (n, 2)."""
    bound = experiment.speed_limit
    return np.array([limit_wheel_speeds(left, right, bound) for left, right in inputs.tolist()])


def _sure_mismatch(experiment: Experiment) -> float:
    """Returns what can be said before a run of the angle between the headings of L and B [rad]."""
    # L1 at the measured heading of iteration i meets B at the true one of iteration i.
    if paper_law(experiment).gain_heading == "previous":
        return experiment.disturbance.output.bound[2]
    return math.pi
