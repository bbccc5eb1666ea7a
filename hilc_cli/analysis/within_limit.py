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
from dataclasses import replace

import numpy as np

from hilc_cli.analysis.conditions import contraction
from hilc_cli.analysis.constants import (
    Constants,
    constants,
    largest_disturbance,
    largest_initial_error,
)
from hilc_cli.analysis.headings import largest_gain_slope
from hilc_cli.analysis.matrices import desired_poses, hybrid_law
from hilc_cli.analysis.norms import pose_norm
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError


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
    law, sample_time = hybrid_law(experiment), experiment.reference.sample_time
    c = constants(experiment)  # all but what B and L1 on the reference change

    b_ud = 2 * experiment.speed_limit  # Eq. 14
    growth = 1 + c.C_B * b_ud
    h1, h3, b_1 = c.b_L1 * growth, c.h3, c.b_1  # Eq. 32
    if law.gain_heading != "reference":
        # ||(L1(a) - L1(b)) e_i(k+1)|| <= turning |a - b|, b the heading of the reference.
        slope = law.l1 * largest_gain_slope(law.matrix, c.wheels)
        turning = slope * (_largest_state_error(experiment) + c.b_alpha)
        b_1 += turning * experiment.disturbance.output.bound[2]
        if law.gain_heading == "measured":
            h3 += turning
        else:
            h1 += turning
    rho = contraction(experiment, law.l1 * sample_time, c.wheels).rho
    return replace(c, rho=rho, b_ud=b_ud, h1=h1, h2=growth, h3=h3, b_1=b_1)  # h2: Eq. 28


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
