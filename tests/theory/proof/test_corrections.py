"""Each gap of the printed proof by the smallest experiment that falls through it.

A platform with R = B = 1, for which L B = I, learns the wheel speeds of very few samples. Without
the one correction a bound is violated, all others made or none; with all of them all bounds hold.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import GainHeading, model_gain
from hilc_cli.plants.kinematic import Robot, limit_wheel_speeds
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.proof.bounds import Bounds, bounds, smallest_lambda
from hilc_cli.theory.proof.constants import ALL, EXPLANATIONS, Constants, Correction, constants
from hilc_cli.theory.proof.measured import Comparison, compare
from tests.engine.experiments import experiment_of, law_of
from tests.reference.paths import Pose
from tests.theory.experiments import euler_reference

UNIT = Robot(1.0, 1.0)
DT = 0.1
STRAIGHT = euler_reference(UNIT, np.full((1, 2), 3.0), DT, 0.0)  # one sample at 3 m/s
BEND = Reference("bend", DT, np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.array([0.0, 0.5]))


def unit_experiment(
    l1: float,
    l2: float = 0.0,
    *,
    reference: Reference = STRAIGHT,
    initial: tuple[float, float] = (0.0, 0.0),
    start: Pose = (0.0, 0.0, 0.0),
    heading: GainHeading = "previous",
    compensation: bool = False,
    speed_limit: float = math.inf,
    disturbance: Disturbance | None = None,
    iterations: int = 10,
) -> Experiment:
    """Gains are given times the sample time: l1 = 1 learns everything at once."""
    law = law_of(
        l1 / DT,
        l2 / DT,
        matrix=model_gain(UNIT),
        gain_heading=heading,
        compensation=compensation,
        h=1,
    )
    inputs: tuple[Floats, Floats] = (np.array(initial[:1]), np.array(initial[1:]))
    return experiment_of(
        reference,
        law,
        initial_pose=start,
        robot=UNIT,
        initial_input=inputs,
        iterations=iterations,
        speed_limit=speed_limit,
        disturbance=disturbance,
    )


@dataclass(frozen=True)
class Gap:
    """An experiment that violates a bound without one correction.

    Attributes:
        experiment: The experiment.
        part: The quantity whose bound is violated: input or output.
        lambda_: A lambda for which it is; None for the one that is chosen.
    """

    experiment: Experiment
    part: str
    lambda_: float | None = None


REPEATED = Bounded((0.0, 0.0, 0.1), repeat=True)
# u_d = (10, 9) at the limit; the first input lies aside of it along (-1, 1). Overshoot by 0.9
# leads over the limit, and scaling back moves the slower wheel twice as far as it should.
AT_LIMIT = unit_experiment(
    1.9,
    reference=euler_reference(UNIT, np.array([[10.0, 9.0]]), DT, 0.0),
    initial=(9.9, 9.1),
    speed_limit=10.0,
)
GAPS = {
    # One iteration corrects the tenth part of the error, not all of it.
    Correction.SAMPLE_TIME: Gap(unit_experiment(DT), "input"),
    # Without l1 the first sample is never learned, whatever l2 says of the sum.
    Correction.LEARNING_GAIN: Gap(unit_experiment(0.0, 1.0), "input"),
    # At a right angle to the reference nothing is learned along it.
    Correction.HEADINGS: Gap(
        unit_experiment(
            1.0, start=(0.0, 0.0, math.pi / 2), heading="reference", initial=(1e4, 1e4)
        ),
        "input",
    ),
    # l1 = 1 learns the disturbance at once, and more of it than any state error of large lambda.
    Correction.STATE_DISTURBANCE: Gap(
        unit_experiment(1.0, disturbance=Disturbance(1, state=REPEATED)), "input", 100.0
    ),
    # The step along the tangent, as long as the chord, is learned away from: u_d is no fixed point.
    Correction.REACHABILITY: Gap(
        unit_experiment(1.0, reference=BEND, initial=(14.0, 14.0)), "input", 100.0
    ),
    # Weight 2 / (d h) = 20 of the initial error, beside 1 of e_i(k+1).
    Correction.COMPENSATION: Gap(
        unit_experiment(1.0, start=(0.5, 0.0, 0.0), compensation=True), "input"
    ),
    Correction.SPEED_LIMIT: Gap(AT_LIMIT, "input", 1000.0),
    Correction.OUTPUT_SIGN: Gap(
        unit_experiment(1.0, disturbance=Disturbance(2, output=REPEATED)), "output", 100.0
    ),
}


def compared(experiment: Experiment, constants: Constants, lambda_: float | None) -> Comparison:
    theory: Bounds = bounds(experiment, constants, lambda_)
    return compare(experiment, {"": theory}, simulate(experiment))[""]


@pytest.mark.parametrize("correction", Correction)
def test_without_one_correction_a_bound_is_violated(correction: Correction) -> None:
    gap = GAPS[correction]
    printed = {Correction.SAMPLE_TIME} - {correction}  # what the print is at best
    for kept in (ALL - {correction}, printed):
        found = compared(gap.experiment, constants(gap.experiment, kept), gap.lambda_)
        part = found.parts[gap.part]
        assert len(part.violated) > 0
        assert part.limit_violated(5)


@pytest.mark.parametrize("correction", Correction)
def test_with_all_corrections_every_bound_holds(correction: Correction) -> None:
    gap = GAPS[correction]
    found = compared(gap.experiment, constants(gap.experiment), gap.lambda_)
    for part in found.parts.values():
        assert len(part.violated) == 0
        assert not part.limit_violated(5)


def test_every_correction_is_explained() -> None:
    assert set(EXPLANATIONS) == set(Correction) == set(GAPS)


def test_state_disturbance_is_learned_in_full() -> None:
    # u_1 = u_0 + L1 (q_d - q_0) = u_d - L1 beta with l1 d = 1: b_L1 b_beta, not 0, in b_1.
    gap = GAPS[Correction.STATE_DISTURBANCE]
    beta = gap.experiment.disturbance.of_state(0, 1)
    assert beta is not None
    _, second, *_ = simulate(gap.experiment)
    expected = 3.0 - np.array([1.0, -1.0]) * beta[0, 2] / DT
    np.testing.assert_allclose([second.left[0], second.right[0]], expected, rtol=1e-12)


def test_printed_output_bound_is_below_zero() -> None:
    # Eq. 43 subtracts b_alpha from a state bound that a large lambda makes as small as one likes.
    gap = GAPS[Correction.OUTPUT_SIGN]
    printed = compared(
        gap.experiment, constants(gap.experiment, {Correction.SAMPLE_TIME}), gap.lambda_
    )
    assert printed.output.limit == -math.inf
    assert printed.output.measured.min() > -2.0


def test_limit_takes_the_input_further_from_what_is_desired() -> None:
    # (10, 9) is wanted. Learning alone would give (10, 9) + 0.9 (0.1, -0.1).
    _, second, *_ = simulate(AT_LIMIT)
    assert second.left[0] == 10.0
    assert second.right[0] == pytest.approx(8.91 * 10 / 10.09, rel=1e-12)
    before, after = math.hypot(0.1, 0.1), 9 - float(second.right[0])
    assert after > 1.19 * before  # although |1 - l1 d| = 0.9
    assert after < 0.2  # the sum of both wheels' distances does not grow


def test_scaling_to_the_limit_brings_inputs_no_further_apart_in_the_sum() -> None:
    draw = np.random.default_rng(5)
    first = draw.uniform(-3, 3, (20_000, 2))
    second = first + draw.normal(0, 1, first.shape) * 10 ** draw.uniform(-3, 1, (20_000, 1))
    limited = [
        np.array([limit_wheel_speeds(left, right, 1.0) for left, right in inputs.tolist()])
        for inputs in (first, second)
    ]
    before, after = np.abs(first - second), np.abs(limited[0] - limited[1])
    assert (after.sum(axis=1) <= before.sum(axis=1) * (1 + 1e-12)).all()
    assert (np.hypot(*after.T) <= math.sqrt(2) * np.hypot(*before.T)).all()
    left, right = limit_wheel_speeds(1.001, 0.999, 1.0)
    stretched = math.hypot(1 - left, 1 - right) / math.hypot(0.001, 0.001)
    assert stretched == pytest.approx(math.sqrt(2) / 1.001, rel=1e-12)


def test_lambda_of_the_print_may_be_too_small() -> None:
    # Eq. 35: above max(1, h2, b_B (b_L2 + b_L3)), but below h2 + b_B (b_L2 + b_L3).
    line = euler_reference(UNIT, np.full((100, 2), 3.0), DT, 0.0)
    experiment = experiment_of(line, law_of(5.0, 10.0, matrix=model_gain(UNIT)), robot=UNIT)
    c = constants(experiment, {Correction.SAMPLE_TIME})
    lambda_ = (max(1, c.h2, c.b_B * c.b_L2) + smallest_lambda(c)) / 2
    denominator = 1 - c.b_B * c.b_L2 * (1 - (c.h2 / lambda_) ** 100) / (lambda_ - c.h2)
    assert denominator < -0.9
    with pytest.raises(UsageError, match="lambda must be above"):
        bounds(experiment, c, lambda_)
