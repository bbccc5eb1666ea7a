"""Constants that rest on the speed limit: with them the condition on the reference is enough.

Eq. 14 bounds u_i, but the proof uses it for u_d alone. Where the speed limit keeps u_i within it,
Eq. 26 can be split the other way, (B_d - B_i) u_i + B_d (u_d - u_i), so that B stands on the
reference. L1 is moved there too: what it differs by is at most its slope times the heading error,
and the error that it multiplies cannot exceed what the wheels can drive away in the time there is.
Then rho is that of the reference, and a rho < 1 gives bounds for all iterations and their limit,
whatever the headings do. The price is a very large lambda.
"""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.analysis.conditions import contraction
from hilc_cli.analysis.constants import (
    Constants,
    feedback_gains,
    largest_disturbance,
    largest_excess,
    largest_initial_error,
)
from hilc_cli.analysis.headings import (
    control_slope,
    largest_control,
    largest_gain,
    largest_gain_slope,
)
from hilc_cli.analysis.matrices import desired_motion, desired_poses, hybrid_law
from hilc_cli.analysis.norms import WheelNorm, pose_norm
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.compensation import compensation_gain


def constants_within_limit(experiment: Experiment) -> Constants:
    """The constants of an experiment with a speed limit, all corrections made.

    They satisfy the two inequalities of `constants`; b_ud is the bound of u_i, as Eq. 14 has it.

    Raises:
        UsageError: There is no speed limit, or the law is not the hybrid law.

    Source:
        Qiao et al. 2021, Eqs. 12 to 18, 28 and 32, with Eq. 26 split the other way.
    """
    if math.isinf(experiment.speed_limit):
        raise UsageError("without a speed limit nothing bounds the inputs, as Eq. 14 demands")
    law, robot, reference = hybrid_law(experiment), experiment.robot, experiment.reference
    sample_time, disturbance = reference.sample_time, experiment.disturbance
    wheels: WheelNorm = "sum"
    desired = desired_motion(experiment)
    l2, l3 = feedback_gains(experiment)

    C_B = sample_time * control_slope(robot, wheels)  # Eq. 16
    b_ud = 2 * experiment.speed_limit  # Eq. 14
    gain = largest_gain(law.matrix, wheels)
    b_L1, b_L2, b_L3 = law.l1 * gain, l2 * gain, l3 * gain  # Eq. 18
    b_alpha = largest_disturbance(disturbance.output)  # Eq. 13
    b_beta = largest_disturbance(disturbance.state, desired.mismatch)
    b_q0 = largest_initial_error(experiment)
    b_s = largest_excess(experiment, desired, wheels)

    h1, h2, h3 = b_L1 * (1 + C_B * b_ud), 1 + C_B * b_ud, b_L2  # Eqs. 28 and 32
    b_1 = b_L1 * (b_alpha + b_beta) + (b_L2 + b_L3) * b_alpha + b_s
    if law.compensation:
        b_1 += compensation_gain(0, law.h, sample_time) * b_L1 * (b_q0 + b_alpha)  # Eq. 21
    if law.gain_heading != "reference":
        # ||(L1(a) - L1(b)) e_i(k+1)|| <= turning |a - b|, b the heading of the reference.
        slope = law.l1 * largest_gain_slope(law.matrix, wheels)
        turning = slope * (_largest_state_error(experiment) + b_alpha)
        b_1 += turning * disturbance.output.bound[2]
        if law.gain_heading == "measured":
            h3 += turning
        else:
            h1 += turning
    return Constants(
        wheels=wheels,
        samples=reference.samples,
        rho=contraction(experiment, law.l1 * sample_time, wheels).rho,
        b_B=sample_time * largest_control(robot, wheels),  # Eq. 12
        C_B=C_B,
        b_ud=b_ud,
        b_L1=b_L1,
        b_L2=b_L2,
        b_L3=b_L3,
        b_q0=b_q0,
        b_alpha=b_alpha,
        b_beta=b_beta,
        b_s=b_s,
        h1=h1,
        h2=h2,
        h3=h3,
        b_1=b_1,
        output_offset=b_alpha,
    )


def _largest_state_error(experiment: Experiment) -> float:
    """What the state error cannot exceed, however the wheels turn within their limit."""
    reference, robot = experiment.reference, experiment.robot
    # A convex function of both wheels, largest with both at the limit: straight ahead or turning.
    step = reference.sample_time * robot.wheel_radius * experiment.speed_limit
    step *= max(1.0, 1 / robot.half_track)
    step += largest_disturbance(experiment.disturbance.state)
    desired = desired_poses(experiment)
    travelled = pose_norm(desired - desired[0]) + step * np.arange(len(desired))
    return largest_initial_error(experiment) + float(travelled.max())
