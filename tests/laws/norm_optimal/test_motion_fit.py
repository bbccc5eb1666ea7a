"""Identification: exact without disturbance, and as sure as it says with it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Distribution, Disturbance, Triple
from hilc_cli.laws.norm_optimal.linear_quadratic import feedback_gains
from hilc_cli.laws.norm_optimal.motion_fit import NO_EVIDENCE, fit_motion
from hilc_cli.reference.sampled import Floats
from tests.laws.norm_optimal.plant import noise

SAMPLE_TIME, RADIUS, HALF_TRACK = 0.005, 0.2, 0.518
DISTANCE_GAIN = SAMPLE_TIME * RADIUS / 2
TURN_GAIN = DISTANCE_GAIN / HALF_TRACK
SAMPLES, SEEDS = 400, 200
INPUTS = np.stack([np.full(SAMPLES, 166.0), np.linspace(120.0, 164.0, SAMPLES)], axis=1)


def desired_poses() -> Floats:
    poses = np.zeros((SAMPLES + 1, 3))
    for k, (left, right) in enumerate(INPUTS):
        step, turn = DISTANCE_GAIN * (left + right), TURN_GAIN * (left - right)
        x, y, heading = poses[k]
        poses[k + 1] = x + step * math.cos(heading), y + step * math.sin(heading), heading + turn
    return poses


def many(disturbance: Disturbance, gains: Floats, seeds: int) -> tuple[Floats, Floats, Floats]:
    """Measured poses, applied wheel speeds and true poses of runs that differ by their seed."""
    desired = desired_poses()
    alpha, beta = np.zeros((seeds, SAMPLES + 1, 3)), np.zeros((seeds, SAMPLES, 3))
    for seed in range(seeds):
        own = replace(disturbance, seed=seed)
        alpha[seed] = own.of_output(1, SAMPLES + 1)
        beta[seed] = own.of_state(1, SAMPLES)
    poses = np.zeros((seeds, SAMPLES + 1, 3))
    applied = np.zeros((seeds, SAMPLES, 2))
    for k in range(SAMPLES):
        off = desired[k] - poses[:, k] - alpha[:, k]
        wheels = INPUTS[k] + off @ gains[k].T
        # Eq. 25: both wheels are scaled.
        wheels *= np.minimum(1, 180 / np.abs(wheels).max(axis=1))[:, None]
        heading = poses[:, k, 2]
        step = DISTANCE_GAIN * wheels.sum(axis=1)
        turn = TURN_GAIN * (wheels[:, 0] - wheels[:, 1])
        moved = np.stack([step * np.cos(heading), step * np.sin(heading), turn], axis=1)
        poses[:, k + 1] = poses[:, k] + moved + beta[:, k]
        applied[:, k] = wheels
    return poses + alpha, applied, poses


def regulator() -> Floats:
    weights = np.tile([1e4, 100.0], (SAMPLES + 1, 1))
    return feedback_gains(desired_poses(), DISTANCE_GAIN, TURN_GAIN, weights, 0.01)


def test_undisturbed_motion_gives_the_exact_gains() -> None:
    fit = fit_motion(desired_poses(), INPUTS)
    assert fit.distance_gain == pytest.approx(DISTANCE_GAIN, rel=1e-11)
    assert fit.turn_gain == pytest.approx(TURN_GAIN, rel=1e-11)
    assert fit.poses == pytest.approx(desired_poses(), abs=1e-9)


def test_standing_platform_tells_nothing() -> None:
    fit = fit_motion(np.tile([1.0, 2.0, 3.0], (51, 1)), np.zeros((50, 2)))
    assert (fit.distance_error, fit.turn_error) == (math.inf, math.inf)


def test_straight_run_tells_nothing_of_the_turn() -> None:
    poses = np.zeros((51, 3))
    poses[:, 0] = 0.1 * np.arange(51)
    fit = fit_motion(poses, np.full((50, 2), 10.0))
    assert fit.distance_gain == pytest.approx(0.1 / 20)
    assert fit.turn_error == math.inf


def test_noises_of_earlier_iterations_are_remembered_but_for_those_at_rest() -> None:
    disturbance = Disturbance(3, noise((1e-3, 1e-3, 1e-3)), noise((5e-3, 5e-3, 5e-3)))
    measured, applied, _ = many(disturbance, np.zeros((SAMPLES, 2, 3)), 2)
    first = fit_motion(measured[0], applied[0])
    second, both = (
        fit_motion(measured[1], applied[1], evidence) for evidence in (NO_EVIDENCE, first.evidence)
    )
    for one, other, together in zip(first.evidence, second.evidence, both.evidence, strict=True):
        assert one is not None and other is not None and together is not None
        # Deviances are logarithms of likelihoods, which multiply. Where the second fit depends on
        # that of the heading, as all but the heading's do, it does so to second order.
        assert together == pytest.approx(one + other, rel=1e-3)
    resting = fit_motion(np.tile([1.0, 2.0, 3.0], (51, 1)), np.zeros((50, 2)))
    assert resting.evidence == NO_EVIDENCE


@pytest.mark.parametrize("feedback", [False, True], ids=["open-loop", "feedback"])
@pytest.mark.parametrize(
    ("state", "output", "distribution"),
    [
        ((5e-4, 5e-4, 2e-4), (2e-3, 2e-3, 5e-3), "uniform"),
        ((1e-4, 1e-4, 1e-4), (2e-2, 2e-2, 2e-2), "truncated-normal"),
    ],
)
def test_true_values_are_within_three_standard_errors(
    state: Triple, output: Triple, distribution: Distribution, feedback: bool
) -> None:
    disturbance = Disturbance(0, noise(state, distribution), noise(output, distribution))
    gains = regulator() if feedback else np.zeros((SAMPLES, 2, 3))
    measured, applied, true = many(disturbance, gains, SEEDS)
    off = np.empty((SEEDS, 2))
    better = 0
    for seed in range(SEEDS):
        fit = fit_motion(measured[seed], applied[seed])
        half_track = fit.distance_gain / fit.turn_gain
        distance_share = fit.distance_error / fit.distance_gain
        half_track_share = math.hypot(distance_share, fit.turn_error / fit.turn_gain)
        off[seed] = (
            (fit.distance_gain / DISTANCE_GAIN - 1) / distance_share,
            (half_track / HALF_TRACK - 1) / half_track_share,
        )
        left = fit.poses - true[seed]
        better += float(np.sum(left**2)) < 0.5 * float(np.sum((measured[seed] - true[seed]) ** 2))
    assert np.all(np.mean(np.abs(off) < 3, axis=0) >= 0.95)
    # Standard errors that are not empty words: half of all within one of them would do, and their
    # mean is nowhere near one.
    assert np.all(np.std(off, axis=0) > 0.3)
    assert np.all(np.abs(np.mean(off, axis=0)) < 0.4)
    assert better == SEEDS
