"""What law feedback does along the very path, beside the engine, which drives pass by pass."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.theory.findings import joined
from hilc_cli.theory.laws.feedback import tracking_findings, tracking_loop, way_findings
from hilc_cli.theory.laws.feedback_response import TrackingResponse, tracking_response
from hilc_cli.theory.noise import seen_in, seen_warnings, wheel_findings
from tests.engine.experiments import experiment_of, law_of

DT, ROBOT = 0.05, Robot(0.03, 0.07, "rep103")
STRAIGHT, LEFT, RIGHT = (0.25, 0.0), (0.25, 1.5), (0.25, -2.5)
SPIN, STOP = (0.0, 0.8), (0.0, 0.0)
Twist = tuple[float, float]


def path(*parts: tuple[Twist, int], corner: tuple[int, float] | None = None) -> Reference:
    """Speeds and yaw rates for so many samples each, and a corner of an angle at a sample."""
    twists = np.concatenate([np.tile(twist, (samples, 1)) for twist, samples in parts])
    turns = DT * twists[:, 1]
    if corner is not None:
        turns[corner[0] - 1] += corner[1]
    heading = np.concatenate([[0.3], 0.3 + np.cumsum(turns)])
    steps = DT * twists[:, 0, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)[:-1]
    x, y = np.concatenate([[[0.0, 0.0]], np.cumsum(steps, axis=0)]).T
    return Reference("path", DT, x, y, heading)


LINE = path((STRAIGHT, 120))
ARCS = path((STRAIGHT, 80), (LEFT, 12), (STRAIGHT, 60), (RIGHT, 9), (STRAIGHT, 20))
CORNER = path((STRAIGHT, 120), corner=(50, 1.1))
SPOT = path((STRAIGHT, 40), (SPIN, 40), (STRAIGHT, 40))
STANDS = path((STRAIGHT, 40), (STOP, 20), (LEFT, 30))
WRONG = Robot(0.033, 0.062, "rep103")
NOISE = Disturbance(
    3,
    Bounded((5e-4, 3e-4, 1e-3)),
    Bounded((6e-3, 8e-3, 2e-2), "truncated-normal", (4e-3, 4e-3, 1e-2)),
    Bounded((0.02, 0.03, 0.05)),
)


def experiment(
    reference: Reference,
    believed: Robot = ROBOT,
    *,
    gains: tuple[float, float, float] = (4.0, 9.0, 6.0),
    off: tuple[float, float, float] = (0.0, 0.0, 0.0),
    limit: float = math.inf,
    disturbance: Disturbance | None = None,
) -> Experiment:
    own = float(reference.x[0]), float(reference.y[0]), float(reference.heading[0])
    made = experiment_of(
        reference,
        law_of(0.0),
        robot=ROBOT,
        initial_pose=(own[0] + off[0], own[1] + off[1], own[2] + off[2]),
        iterations=0,
        learn_in_first=True,
        speed_limit=limit,
        disturbance=disturbance or Disturbance(),
    )
    return replace(made, law=FeedbackLaw(*gains, believed))


def response_of(made: Experiment) -> TrackingResponse:
    assert isinstance(made.law, FeedbackLaw)
    return tracking_response(made, made.law)


def away(made: Experiment, trial: Trial) -> Floats:
    distance: Floats = np.hypot(made.reference.x - trial.x, made.reference.y - trial.y)
    return distance


def told(made: Experiment) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """How the findings begin: failures, and warnings."""
    assert isinstance(made.law, FeedbackLaw)
    loop, response = tracking_loop(made, made.law), response_of(made)
    found = joined(tracking_findings(loop, response), way_findings(loop, response))
    return found.failures, found.warnings


@pytest.mark.parametrize("reference", [LINE, ARCS, CORNER, SPOT, STANDS])
@pytest.mark.parametrize("believed", [ROBOT, WRONG])
@pytest.mark.parametrize("off", [(0.0, 0.0, 0.0), (-0.1, 0.2, -0.4)])
@pytest.mark.parametrize("limit", [math.inf, 12.0])
def test_undisturbed_pass_is_that_of_the_engine(
    reference: Reference, believed: Robot, off: tuple[float, float, float], limit: float
) -> None:
    made = experiment(reference, believed, off=off, limit=limit)
    (trial,) = simulate(made)
    found = response_of(made)
    assert found.expected.final_m == pytest.approx(away(made, trial).max(), rel=1e-9)
    assert found.expected.foretold_m == found.expected.final_m
    assert found.at_limit == trial.saturated_samples / reference.samples
    (own,) = simulate(experiment(reference, believed, limit=limit))
    assert found.error_m == pytest.approx(away(made, own).max(), rel=1e-9, abs=1e-12)
    left = np.hypot(trial.x - own.x, trial.y - own.y)
    assert found.way.off == pytest.approx(math.hypot(*off[:2]), abs=1e-12)
    assert found.way.left == pytest.approx(left[-1], abs=1e-12)
    late = found.way.joins_s is None
    assert late == (left[-1] > 0.01 * reference.size)
    if found.way.joins_s is not None:
        assert left[round(found.way.joins_s / DT) :].max() <= 0.01 * reference.size


@cache
def disturbed(limit: float) -> tuple[Experiment, list[Trial]]:
    """An experiment with all disturbances, and passes of seeds of its own."""
    made = experiment(ARCS, WRONG, limit=limit, disturbance=NOISE)
    return made, [
        next(simulate(replace(made, disturbance=replace(NOISE, seed=seed)))) for seed in range(80)
    ]


@pytest.mark.parametrize("limit", [math.inf, 9.5])
def test_disturbed_passes_are_those_of_other_seeds(limit: float) -> None:
    made, trials = disturbed(limit)
    found = response_of(made)
    expected, wheels = found.expected, found.wheels
    errors = [away(made, trial).max() for trial in trials]
    # 95 of 100 stay below. Of 80 that is 76, give or take 2 by chance, and as much again, since
    # what is foretold comes from a hundred passes: 67 to 80 but once in a thousand.
    assert 67 <= sum(error <= expected.foretold_m for error in errors) <= 79
    parts = expected.of_start_m, expected.of_readings_m, expected.of_state_m
    assert max(parts) <= 1.05 * (expected.foretold_m - expected.final_m)
    assert min(parts) > 0
    assert wheels is not None
    quiet = next(simulate(replace(made, disturbance=Disturbance())))
    changes = [np.diff([trial.left - quiet.left, trial.right - quiet.right]) for trial in trials]
    assert wheels.change_rad_s == pytest.approx(math.sqrt(np.square(changes).mean()), rel=0.05)
    held = np.mean([trial.saturated_samples for trial in trials]) / ARCS.samples
    assert wheels.at_limit == pytest.approx(held, rel=0.1)
    assert wheels.undisturbed == quiet.saturated_samples / ARCS.samples


def test_noise_of_the_wheels_has_the_textbook_size() -> None:
    # So slow that nothing comes of it: (B / R) v sqrt((k_y s)^2 + (k_theta s_h)^2) and the error
    # ahead's k_x s / R in each reading, twice the square from one reading to the next.
    gains, (s, s_h) = (1e-3, 0.1, 1.0), (0.02 / math.sqrt(3), 4e-3 / math.sqrt(3))
    noise = Disturbance(0, output=Bounded((0.02, 0.02, 4e-3)))
    wheels = response_of(experiment(LINE, gains=gains, disturbance=noise)).wheels
    turning = 0.07 / 0.03 * 0.25 * math.hypot(gains[1] * s, gains[2] * s_h)
    ahead = gains[0] * s / 0.03
    assert wheels is not None
    assert wheels.change_rad_s == pytest.approx(math.sqrt(2) * math.hypot(turning, ahead), rel=0.03)
    assert wheels.at_limit == 0


def test_more_than_a_twentieth_at_the_limit_is_warned_of_before_and_after() -> None:
    made = experiment(path((STRAIGHT, 600)), limit=9.0, disturbance=NOISE)
    before, after = response_of(made).wheels, seen_in(next(simulate(made)), made)
    assert before is not None and after is not None
    assert after.at_limit == pytest.approx(before.at_limit, rel=0.25)  # of one seed
    assert after.change_rad_s == pytest.approx(before.change_rad_s, rel=0.15)
    (text,) = wheel_findings(before, "do this").warnings
    share = f"noise drives the wheels to their limit in {100 * before.at_limit:.0f} % of the"
    assert text.startswith(share) and text.endswith(": do this")
    (text,) = seen_warnings(after)
    share = f"the wheels are at their limit in {100 * after.at_limit:.0f} % of the samples"
    assert text.startswith(f"in the last iteration {share}")
    assert wheel_findings(response_of(disturbed(math.inf)[0]).wheels, "").warnings == ()
    quiet = replace(made, disturbance=Disturbance())
    assert seen_in(next(simulate(quiet)), quiet) is None


def test_start_from_which_the_path_is_too_short_fails() -> None:
    # 1.5 m of path, of which an error to the side falls over a third of a metre.
    failures, _ = told(experiment(LINE, off=(-0.3, 0.8, 0.0)))
    (trial,) = simulate(experiment(LINE, off=(-0.3, 0.8, 0.0)))
    left = away(experiment(LINE), trial)[-1]
    assert failures[0].startswith("from initial_pose, 0.854 m off, the platform does not get onto")
    assert f"where {left:.3g} m are left" in failures[0]
    assert told(experiment(LINE, off=(-0.02, 0.05, 0.0))) == ((), ())


def test_heading_that_is_off_counts_as_a_start_that_is_off() -> None:
    found = response_of(experiment(LINE, off=(0.0, 0.0, 0.7)))
    assert found.is_off and found.way.off == 0
    assert found.way.joins_s is not None and found.way.joins_s > 1


@pytest.mark.parametrize(
    ("k_y", "k_theta", "begins"),
    [
        (0.5, 1.4, "controller.gains.k_y is too soft for this path: of an error to the side"),
        (9.0, 6.0, None),
        # Steps of 12.5 mm: the roots are 1 - 12.5 mm sqrt(k_y), -0.94 at the second.
        (4000.0, 2 * math.sqrt(4000.0), None),
        (24000.0, 2 * math.sqrt(24000.0), "controller.gains.k_y is too stiff: at this sample_time"),
        (60.0, 2.4, "controller.gains.k_y is too stiff: at this sample_time"),
    ],
)
def test_stiffness_is_held_against_path_and_sampling(
    k_y: float, k_theta: float, begins: str | None
) -> None:
    failures, warnings = told(experiment(LINE, gains=(4.0, k_y, k_theta)))
    assert failures == ()
    assert [text[: len(begins or "")] for text in warnings] == ([] if begins is None else [begins])


def test_share_of_a_side_error_that_a_short_path_leaves() -> None:
    # (1 + s / l) exp(-s / l) over 1.5 m, l = 1 m; sampled, (1 - 12.5 mm / l) to the 120th.
    gains = (4.0, 1.0, 2.0)
    root, n = 1 - DT * 0.25, 120
    expected = root**n + n * (1 - root) * root ** (n - 1)
    assert response_of(experiment(LINE, gains=gains)).aside_left == pytest.approx(
        expected, rel=1e-3
    )


def test_turn_in_place_is_not_steered() -> None:
    right, wrong = response_of(experiment(SPOT)), response_of(experiment(SPOT, WRONG))
    assert right.standing_s == wrong.standing_s == pytest.approx(40 * DT)
    assert right.heading_error_rad == pytest.approx(0, abs=1e-12)
    # 0.8 rad/s for 2 s, of which R B_b / (R_b B) is turned.
    turned = 0.03 * 0.062 / (0.033 * 0.07)
    assert wrong.heading_error_rad == pytest.approx(1.6 * (1 - turned), rel=1e-6)
    assert told(experiment(SPOT)) == ((), ())
    _, warnings = told(experiment(SPOT, WRONG))
    assert warnings[-1].startswith("for 2 s the reference turns in place, where its speed is 0 and")
    assert response_of(experiment(STANDS)).standing_s == pytest.approx(20 * DT)


def test_right_model_that_leaves_the_path_is_told_why() -> None:
    # Chords of 30 degrees, each driven along the tangent at its start.
    angles = math.pi / 6 * np.arange(40.0)
    circle = Reference("circle", DT, np.sin(angles), -np.cos(angles), angles)
    _, warnings = told(experiment(circle, gains=(4.0, 0.2, 1.0)))
    assert "along this path, though its model is right" in warnings[0]
    _, warnings = told(experiment(LINE, limit=8.0))  # of 0.25 / 0.03
    assert warnings[0].startswith("controller.b_w acts in 1e+02 % of the samples and leaves")


def test_open_loop_iterations_are_driven_open_loop() -> None:
    made = replace(experiment(LINE, off=(0.0, 0.1, 0.0)), learn_in_first=False)
    alone = response_of(made)  # at rest: u_0 = 0
    length = math.dist((made.reference.x[-1], made.reference.y[-1]), made.initial_pose[:2])
    assert alone.expected.final_m == pytest.approx(length, rel=1e-9)
    then = response_of(replace(made, iterations=3)).expected
    assert then.first_m == pytest.approx(length, rel=1e-9)
    assert then.final_m == pytest.approx(0.1, rel=1e-9)
