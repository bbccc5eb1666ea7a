"""The convergence theory of an experiment, as printed and as it holds for the simulated system."""

from __future__ import annotations

import math
from dataclasses import asdict, replace

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.theory.linear_law import paper_law
from hilc_cli.theory.matrices import desired_poses
from hilc_cli.theory.proof.bounds import Bounds, bounds, smallest_lambda
from hilc_cli.theory.proof.conditions import contraction
from hilc_cli.theory.proof.constants import (
    ALL,
    PRINTED,
    Constants,
    Correction,
    constants,
    largest_disturbance,
    largest_initial_error,
)
from hilc_cli.theory.proof.norms import largest_gain_slope, pose_norm


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
    law, sample_time = paper_law(experiment), experiment.reference.sample_time
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


AS_PRINTED = "as printed"
WITH_SAMPLE_TIME = "as printed, with the sample time"
CORRECTED = "corrected"
WITHIN_LIMIT = "corrected, within the speed limit"


def theories(experiment: Experiment) -> dict[str, Bounds]:
    """All bounds that can be given before a run, by name.

    Returns:
        ``as printed``: every equation as it stands; no bound of the simulated system.
        ``as printed, with the sample time``: with d_k B for B, else the same.
        ``corrected``: all corrections; holds in every iteration, and has a limit only where rho < 1
        for every heading that the law may use.
        ``corrected, within the speed limit``: all corrections, with rho on the reference; only with
        a speed limit.
        Those whose constants leave the range of floating point are missing.

    Raises:
        UsageError: The law is not the hybrid law.
    """
    found = {
        AS_PRINTED: constants(experiment, PRINTED),
        WITH_SAMPLE_TIME: constants(experiment, {Correction.SAMPLE_TIME}),
        CORRECTED: constants(experiment, ALL),
    }
    if math.isfinite(experiment.speed_limit):
        found[WITHIN_LIMIT] = constants_within_limit(experiment)
    all_bounds = {name: _bounds(experiment, each) for name, each in found.items()}
    return {name: each for name, each in all_bounds.items() if each is not None}


def _bounds(experiment: Experiment, found: Constants) -> Bounds | None:
    """The bounds; None if there are no numbers for them."""
    numbers = [value for value in asdict(found).values() if not isinstance(value, str)]
    if not all(map(math.isfinite, [*numbers, smallest_lambda(found)])):
        return None
    made = bounds(experiment, found)
    return made if all(map(math.isfinite, (made.lambda_, made.A, made.B))) else None
