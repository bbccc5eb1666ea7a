"""Identification: exact without disturbance, as sure as it says with it, and what it leaves."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Distribution, Disturbance, Triple
from hilc_cli.laws.norm_optimal.identification import MeasuredMotion, fit_motion
from hilc_cli.laws.norm_optimal.linear_quadratic import feedback_gains
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
    return moved_by(disturbance, 1, np.broadcast_to(INPUTS, (seeds, SAMPLES, 2)), gains)


def moved_by(
    disturbance: Disturbance, iteration: int, inputs: Floats, gains: Floats
) -> tuple[Floats, Floats, Floats]:
    """Likewise, each run with its own inputs, shape (seeds, n, 2)."""
    desired, seeds = desired_poses(), len(inputs)
    alpha, beta = np.zeros((seeds, SAMPLES + 1, 3)), np.zeros((seeds, SAMPLES, 3))
    for seed in range(seeds):
        own = replace(disturbance, seed=seed)
        for drawn, noises in (
            (own.of_output(iteration, SAMPLES + 1), alpha),
            (own.of_state(iteration, SAMPLES), beta),
        ):
            if drawn is not None:
                noises[seed] = drawn
    poses = np.zeros((seeds, SAMPLES + 1, 3))
    applied = np.zeros((seeds, SAMPLES, 2))
    for k in range(SAMPLES):
        off = desired[k] - poses[:, k] - alpha[:, k]
        wheels = inputs[:, k] + off @ gains[k].T
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


@pytest.mark.parametrize(
    ("state", "output"),
    [((1e-4, 1e-4, 1e-4), (1e-3, 1e-3, 0.2)), ((0, 0, 1e-3), (0, 0, 0)), ((0, 0, 0), (0, 0, 0.05))],
    ids=["readings", "drift-alone", "readings-alone"],
)
def test_uncertain_heading_makes_the_distance_less_sure(state: Triple, output: Triple) -> None:
    measured, applied, _ = many(Disturbance(0, noise(state), noise(output)), regulator(), 60)
    off = []
    for poses, wheels in zip(measured, applied, strict=True):
        fit = fit_motion(poses, wheels)
        off.append((fit.distance_gain - DISTANCE_GAIN) / fit.distance_error)
    assert np.mean(np.abs(off) < 3) >= 0.95


def learned_from(measured: Floats, applied: Floats) -> Floats:
    """Wheel speeds that would have led along the desired motion, shape (seeds, n, 2)."""
    headings = measured[:, :-1, 2]
    steps = np.diff(measured, axis=1)
    moved = np.cos(headings) * steps[..., 0] + np.sin(headings) * steps[..., 1]
    wanted, turns = DISTANCE_GAIN * INPUTS.sum(axis=1), TURN_GAIN * (INPUTS[:, 0] - INPUTS[:, 1])
    mean = (wanted - moved) / (2 * DISTANCE_GAIN)
    half = (turns - steps[..., 2]) / (2 * TURN_GAIN)
    inputs: Floats = applied + np.stack([mean + half, mean - half], axis=2)
    return inputs


@pytest.mark.parametrize("fresh", [0.0, 5e-3], ids=["all-repeated", "part-repeated"])
def test_learned_input_does_not_bias_the_gains(fresh: float) -> None:
    # An input that cancels a repeated disturbance depends on it: taken alone, its iteration tells
    # gains that are too small, in each run and in all with the same sign.
    repeated = replace(noise((4e-2, 4e-2, 1e-2)), repeat=True)
    disturbance = Disturbance(0, repeated, noise((fresh, fresh, fresh)))
    first = np.broadcast_to(0.9 * INPUTS, (60, SAMPLES, 2))
    measured, applied, _ = moved_by(disturbance, 1, first, np.zeros((SAMPLES, 2, 3)))
    inputs = learned_from(measured, applied)
    again, followed, _ = moved_by(disturbance, 2, inputs, np.zeros((SAMPLES, 2, 3)))
    alone: list[tuple[float, float]] = []
    off: list[tuple[float, float]] = []
    for seed in range(60):
        earlier = fit_motion(measured[seed], applied[seed]).kept
        for fits, before in ((alone, None), (off, earlier)):
            fit = fit_motion(again[seed], followed[seed], before)
            fits.append(
                (
                    (fit.distance_gain - DISTANCE_GAIN) / fit.distance_error,
                    (fit.turn_gain - TURN_GAIN) / fit.turn_error,
                )
            )
    assert np.all(np.mean(alone, axis=0) < -1.5)
    assert np.all(np.mean(np.abs(off) < 3, axis=0) >= 0.95)
    assert np.all(np.abs(np.mean(off, axis=0)) < 0.5)


def test_iterations_at_rest_are_not_kept() -> None:
    rest = fit_motion(np.tile([1.0, 2.0, 3.0], (51, 1)), np.zeros((50, 2)))
    assert rest.kept is None
    moved = fit_motion(desired_poses(), INPUTS)
    assert moved.kept is not None
    assert moved.kept.iterations == 1
    still = fit_motion(np.tile(desired_poses()[0], (SAMPLES + 1, 1)), 0 * INPUTS, moved.kept)
    assert still.kept is moved.kept


def test_undisturbed_iterations_stay_exact() -> None:
    kept = None
    for _ in range(3):
        fit = fit_motion(desired_poses(), INPUTS, kept)
        kept = fit.kept
        assert fit.distance_error < 1e-9 * DISTANCE_GAIN or math.isinf(fit.distance_error)
        assert fit.poses == pytest.approx(desired_poses(), abs=1e-9)
        if math.isfinite(fit.distance_error):
            assert fit.distance_gain == pytest.approx(DISTANCE_GAIN, rel=1e-11)


def driven(applied: float, slip: float, heading: float = 0.3) -> MeasuredMotion:
    """Three steps straight ahead with gain 0.1 a wheel, and as much slip."""
    steps = 2 * 0.1 * applied + slip
    distance = np.arange(4) * steps
    poses = np.stack(
        [distance * np.cos(heading), distance * np.sin(heading), np.full(4, heading)], axis=1
    )
    return MeasuredMotion.of(poses, np.full((3, 2), applied))


def test_motion_is_seen_from_the_platform() -> None:
    poses = np.array([[0, 0, np.pi / 2], [-2, 3, 1.0], [-2, 3, 1.0]])
    motion = MeasuredMotion.of(poses, np.ones((2, 2)))
    assert motion.moved[0] == pytest.approx([3, 2, 1 - np.pi / 2])
    assert motion.drift(0.5, 0.25)[0] == pytest.approx([3 - 1.0, 2, 1 - np.pi / 2])


def test_average_is_over_all_iterations_up_to_the_memory() -> None:
    motion = driven(10, 0.1).and_then(driven(20, 0.2), 3).and_then(driven(30, 0.6), 3)
    assert motion.drift(0.1, 0.1)[:, 0] == pytest.approx(0.3)
    # From here on the last one has a third.
    assert motion.and_then(driven(30, 0.9), 3).drift(0.1, 0.1)[:, 0] == pytest.approx(0.5)


def test_average_follows_new_gains() -> None:
    motion = driven(10, 0.0).and_then(driven(30, 0.0), 2)
    # A gain of 0.08 leaves 0.02 a wheel unexplained at the mean of 20 rad/s.
    assert motion.drift(0.08, 0.1)[:, 0] == pytest.approx(2 * 0.02 * 20)


def test_memory_of_one_is_the_last_iteration() -> None:
    motion = driven(10, 0.1).and_then(driven(20, 0.2), 1)
    assert motion.drift(0.1, 0.1)[:, 0] == pytest.approx(0.2)


def test_iteration_at_rest_tells_the_start_only() -> None:
    rest = MeasuredMotion.of(np.tile([1.0, 2.0, 3.0], (4, 1)), np.zeros((3, 2)))
    moving = driven(10, 0.1)
    for motion in (rest.and_then(moving, 4), moving.and_then(rest, 4)):
        assert motion.drift(0.1, 0.1) == pytest.approx(moving.drift(0.1, 0.1))
        assert motion.start == pytest.approx([0.5, 1.0, 1.65])
