"""The law as a whole: it tracks, whatever it believes and wherever it starts, within the limit."""

from __future__ import annotations

import math
import secrets
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Disturbance
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw, figures_told
from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import PLATFORM
from tests.laws.norm_optimal.plant import Learned, Workplace, learned_from, noise
from tests.reference.paths import PAPER_STARTS, Pose, paper_reference

LIMIT = 180.0
WRONG_STARTS: dict[str, Pose] = {
    "circle": (9.0, 0.0, math.pi / 2),
    "arc-and-line": (4.0, 0.0, math.pi / 2),
    "cardioid": (2.0, 0.0, 14 * math.pi / 15),
    "spiral": (2.5, 0.0, 31 * math.pi / 30),
}
BELIEFS = {
    "exact": PLATFORM,
    "small": Robot(0.7 * PLATFORM.wheel_radius, 1.3 * PLATFORM.half_track),
    "large": Robot(1.3 * PLATFORM.wheel_radius, 0.7 * PLATFORM.half_track),
}


def assert_within_limit(done: list[Learned], limit: float = LIMIT) -> None:
    assert max(np.abs(learned.applied).max() for learned in done) <= limit


@pytest.mark.parametrize("name", PAPER_STARTS)
@pytest.mark.parametrize(
    ("belief", "wrong_start"),
    [  # each belief from the start of the path, and one from elsewhere
        *((belief, False) for belief in BELIEFS),
        ("small", True),
        *(pytest.param(belief, True, marks=pytest.mark.slow) for belief in ("exact", "large")),
    ],
)
def test_paper_cases_track_from_the_second_iteration_on(
    name: str, belief: str, wrong_start: bool
) -> None:
    start = (WRONG_STARTS if wrong_start else PAPER_STARTS)[name]
    workplace = Workplace(paper_reference(name), start, NormOptimalLaw(BELIEFS[belief]))
    done = workplace.learn(3)
    assert_within_limit(done)
    first = workplace.reference.samples // 2 if wrong_start else 0
    for learned in done[2:]:
        assert workplace.position_error(learned)[first:].max() <= 2e-4
        assert learned.plan is not None
        assert learned.belief is not None
        assert learned.belief.robot.wheel_radius == pytest.approx(0.2, rel=1e-6)
        assert learned.belief.robot.half_track == pytest.approx(0.518, rel=1e-6)
        assert learned.plan.merge_sample is not None
        assert (learned.plan.merge_sample <= 205) if wrong_start else not learned.plan.merge_sample


def rounded(seconds: float) -> Reference:
    """An S with straight ends that is in no other test; its wheels need 84 % of the limit."""
    plans: list[SegmentPlan] = [
        LinePlan(length=4.0, duration=0.2 * seconds),
        ArcPlan(1.9, "right", radius=3.0, duration=0.3 * seconds),
        ArcPlan(2.6, "left", radius=2.2, duration=0.3 * seconds),
        LinePlan(length=5.0, duration=0.2 * seconds),
    ]
    return build_reference("s", (1.0, -2.0, 0.4), plans, 0.005)


@pytest.mark.parametrize("feedback", ["lqr", "none"])
def test_own_trajectory_is_tracked_with_and_without_feedback(feedback: str) -> None:
    kind: Literal["lqr", "none"] = "lqr" if feedback == "lqr" else "none"
    law = NormOptimalLaw(BELIEFS["large"], feedback=kind, h=40)
    workplace = Workplace(rounded(1.0), (1.3, -2.4, -0.2), law)
    done = workplace.learn(3)
    assert_within_limit(done)
    assert workplace.position_error(done[-1])[100:].max() < 1e-3
    assert done[-1].plan is not None
    assert np.any(done[-1].plan.feedback) == (feedback == "lqr")


def test_wrong_belief_that_stays_is_learned_around() -> None:
    for belief in ("small", "large"):
        law = NormOptimalLaw(BELIEFS[belief], identify=False, h=40)
        workplace = Workplace(rounded(1.2), (1.0, -2.0, 0.4), law)
        done = workplace.learn(8)
        assert done[-1].belief is not None
        assert done[-1].belief.robot == BELIEFS[belief]
        errors = [workplace.position_error(learned).max() for learned in done[1:]]
        assert errors[-1] < 5e-3
        assert errors[-1] < errors[0] / 10


def random_trajectory(random: np.random.Generator) -> Reference:
    """Smooth, at most 85 % of the paper's platform's limit; sums of a few waves."""
    n, sample_time = 300, 0.005
    turns = np.linspace(0, 2 * math.pi, n + 1)

    def waves(count: int) -> Floats:
        numbers = np.arange(1, count + 1)[:, None]
        phases = random.uniform(0, 2 * math.pi, (count, 1))
        sizes = random.normal(0, 1, (count, 1)) / numbers
        total = (sizes * np.sin(numbers * turns + phases)).sum(axis=0)
        scaled: Floats = total / np.abs(total).max()
        return scaled

    speed = 1.5 + 0.5 * waves(3)
    yaw_rate = waves(4) * random.uniform(1.0, 6.0)
    top = 0.85 * LIMIT * PLATFORM.wheel_radius
    speed *= random.uniform(0.3, 1.0) * (top - PLATFORM.half_track * 6.0) / 2
    heading = random.uniform(-3, 3) + np.concatenate([[0], np.cumsum(yaw_rate[:-1] * sample_time)])
    middle = (heading[1:] + heading[:-1]) / 2
    x, y = (
        np.concatenate([[0], np.cumsum(speed[:-1] * sample_time * wave(middle))])
        for wave in (np.cos, np.sin)
    )
    return Reference("random", sample_time, x, y, heading)


def test_random_trajectory_from_a_random_start() -> None:
    seed = secrets.randbits(32)
    print(f"seed {seed}")
    random = np.random.default_rng(seed)
    reference = random_trajectory(random)
    offset = random.uniform([-0.5, -0.5, -1.0], [0.5, 0.5, 1.0])
    x, y, heading = (reference.poses[0] + offset).tolist()
    shares = random.uniform(0.7, 1.3, 2)
    model = Robot(PLATFORM.wheel_radius * shares[0], PLATFORM.half_track * shares[1])
    workplace = Workplace(reference, (x, y, heading), NormOptimalLaw(model, h=60))
    done = workplace.learn(3)
    assert_within_limit(done)
    assert workplace.position_error(done[-1])[150:].max() < 5e-3


@pytest.mark.parametrize("identify", [False, True])
def test_noise_does_not_add_up_over_a_hundred_iterations(identify: bool) -> None:
    disturbance = Disturbance(
        7, noise((1e-3, 1e-3, 1e-3)), noise((5e-3, 5e-3, 5e-3), "truncated-normal")
    )
    law = NormOptimalLaw(BELIEFS["large"], identify=identify, h=20)
    reference = build_reference(
        "arc", (0.0, 0.0, 0.0), [ArcPlan(2.0, "left", radius=3.0, duration=1.0)], 0.01
    )
    workplace = Workplace(reference, (0.0, 0.0, 0.0), law, disturbance=disturbance)
    done = workplace.learn(100)
    assert_within_limit(done)
    errors = np.array([workplace.position_error(learned).max() for learned in done])
    # No worse at the end than soon after the start: about the noise of a few steps.
    assert errors[50:].mean() < 1.2 * errors[5:50].mean()
    assert errors[5:].max() < 0.03


@pytest.mark.slow
def test_all_iterations_together_are_as_sure_as_they_say() -> None:
    # Noises that few samples can hardly tell apart: if each iteration judged them by itself, those
    # that judge too well of themselves would count most, and the mean be 1.5 standard errors off.
    reference = build_reference(
        "bend",
        (0.0, 0.0, 0.0),
        [ArcPlan(2.0, "left", radius=3.0, duration=0.7), LinePlan(length=2.0, duration=0.3)],
        0.01,
    )
    seeds, iterations = 40, 12
    off = np.empty((seeds, 2))
    for seed in range(seeds):
        noises = noise((1e-3, 1e-3, 1e-3)), noise((5e-3, 5e-3, 5e-3), "truncated-normal")
        disturbance = Disturbance(seed, *noises)
        law = NormOptimalLaw(BELIEFS["small"], h=20)
        workplace = Workplace(reference, (0.0, 0.0, 0.0), law, disturbance=disturbance)
        learner = NormOptimalLearner(law, reference, LIMIT)
        done = workplace.run(0, None)
        for iteration in range(1, iterations + 1):
            alpha = disturbance.of_output(iteration - 1, reference.samples + 1)
            assert alpha is not None
            learned_from(learner, reference, done.poses + alpha, done.applied)
            done = workplace.run(iteration, learner.plan())
        belief = learner.belief
        off[seed] = (
            (belief.robot.wheel_radius - PLATFORM.wheel_radius) / belief.wheel_radius_error,
            (belief.robot.half_track - PLATFORM.half_track) / belief.half_track_error,
        )
    assert np.all(np.mean(np.abs(off) < 3, axis=0) >= 0.95)
    # Known to 0.11 from 40 seeds.
    spread = np.sqrt(np.mean(off**2, axis=0))
    assert np.all((spread > 0.7) & (spread < 1.3))


def test_without_identification_nothing_is_identified() -> None:
    reference = rounded(1.0)
    law = NormOptimalLaw(BELIEFS["small"], identify=False)
    learner = NormOptimalLearner(law, reference, LIMIT)
    applied = np.full((reference.samples, 2), 10.0)
    told = learned_from(learner, reference, reference.poses, applied)
    assert tuple(told) == figures_told(identify=False)
    assert learner.belief.robot == BELIEFS["small"]
    assert learner.belief.wheel_radius_error == math.inf


def test_noise_at_the_start_does_not_cut_corners() -> None:
    # Readings up to 20 mm off in x and y look like an initial error; the corner comes before h.
    reference = build_reference(
        "corner",
        (0.0, 0.0, 0.0),
        [LinePlan(length=2.0, duration=0.5), LinePlan(to=(2.0, 4.0), duration=1.0)],
        0.005,
        corners=True,
    )
    exact = Workplace(reference, (0.0, 0.0, 0.0), NormOptimalLaw(PLATFORM, h=200))
    noisy = replace(exact, disturbance=Disturbance(1, output=noise((0.02, 0.02, 0.02))))
    least = exact.position_error(exact.learn(2)[-1]).max()
    errors = [exact.position_error(learned).max() for learned in noisy.learn(10)[1:]]
    assert least < 0.02
    assert max(errors) < least + 0.02 * math.sqrt(2)


def test_repeated_disturbance_leaves_the_identified_platform_right() -> None:
    # Steps of 3 to 5 cm; what is learned against a disturbance of 1 cm depends on all of it.
    repeated = replace(noise((1e-2, 1e-2, 5e-3)), repeat=True)
    workplace = Workplace(
        rounded(1.0),
        (1.0, -2.0, 0.4),
        NormOptimalLaw(BELIEFS["large"]),
        disturbance=Disturbance(3, repeated),
    )
    done = workplace.learn(5)
    for learned in done[2:]:
        told, belief = learned.told, learned.belief
        assert belief is not None
        for name, true in (
            ("wheel_radius", PLATFORM.wheel_radius),
            ("half_track", PLATFORM.half_track),
        ):
            assert abs(told[f"{name}_m"] - true) < 3 * told[f"{name}_standard_error_m"]
        if learned is not done[2]:  # from the difference between the first two that moved on
            assert belief.robot.wheel_radius == pytest.approx(PLATFORM.wheel_radius, rel=1e-3)
            assert belief.robot.half_track == pytest.approx(PLATFORM.half_track, rel=1e-3)


def test_platform_at_rest_changes_no_belief() -> None:
    reference = rounded(1.0)
    learner = NormOptimalLearner(NormOptimalLaw(BELIEFS["small"]), reference, LIMIT)
    n, small = reference.samples, BELIEFS["small"].wheel_radius
    told = learned_from(
        learner, reference, np.tile(reference.poses[0], (n + 1, 1)), np.zeros((n, 2))
    )
    assert learner.belief.robot.wheel_radius == pytest.approx(small, rel=1e-12)
    assert math.isnan(told["wheel_radius_m"])
    assert math.isnan(told["wheel_radius_standard_error_m"])


def test_first_plan_needs_no_measurement() -> None:
    reference = rounded(1.0)
    law = NormOptimalLaw(PLATFORM)
    plan = NormOptimalLearner(law, reference, LIMIT).plan()
    workplace = Workplace(reference, (1.0, -2.0, 0.4), law)
    assert workplace.position_error(workplace.run(0, plan)).max() < 1e-3
    assert plan.merge_sample == 0


def test_trajectory_beyond_the_limit_is_followed_as_well_as_it_goes() -> None:
    workplace = Workplace(
        rounded(1.0), (1.0, -2.0, 0.4), NormOptimalLaw(BELIEFS["large"]), speed_limit=120.0
    )
    done = workplace.learn(3)
    assert_within_limit(done, 120.0)
    assert done[-1].plan is not None
    assert done[-1].plan.merge_sample is None
    errors = [float(np.mean(workplace.position_error(learned) ** 2)) for learned in done]
    assert errors[3] == pytest.approx(errors[2], rel=1e-2)
    assert errors[3] <= errors[1] * (1 + 1e-9)


@pytest.mark.parametrize("speed_limit", [math.inf, 1e3])
def test_limit_that_is_never_reached_changes_nothing(speed_limit: float) -> None:
    reference = rounded(1.0)
    plans = [
        NormOptimalLearner(NormOptimalLaw(PLATFORM, h=40), reference, limit).plan(
            reference.poses[0] + [0.2, 0.1, 0.3]
        )
        for limit in (speed_limit, 500.0)
    ]
    assert plans[0].left == pytest.approx(plans[1].left, rel=1e-6)
    assert plans[0].right == pytest.approx(plans[1].right, rel=1e-6)


def test_conventions_of_turning_mirror_the_wheels() -> None:
    reference = rounded(1.0)
    plans = [
        NormOptimalLearner(NormOptimalLaw(robot), reference, LIMIT).plan()
        for robot in (Robot(0.2, 0.5), Robot(0.2, 0.5, "rep103"))
    ]
    assert plans[0].left == pytest.approx(plans[1].right, rel=1e-9)
    assert plans[0].right == pytest.approx(plans[1].left, rel=1e-9)
    assert plans[0].feedback == pytest.approx(plans[1].feedback[:, ::-1], rel=1e-9)


@pytest.mark.parametrize("size", [1e20, 1e100, 1e200])
def test_numbers_on_the_way_to_divergence_end_without_an_error(size: float) -> None:
    reference = rounded(1.0)
    learner = NormOptimalLearner(NormOptimalLaw(PLATFORM), reference, math.inf)
    n = reference.samples
    poses = reference.poses + size * np.arange(n + 1)[:, None]
    learned_from(learner, reference, poses, np.full((n, 2), size))
    plan = learner.plan()
    assert plan.left.shape == plan.right.shape == (n,)
    if size > 1e50:
        assert not plan.settled


def without_identification(radius: float, quotient: float, iterations: int) -> Floats:
    """Largest position errors where R and R / B are so many times those believed [m]."""
    model = Robot(PLATFORM.wheel_radius / radius, PLATFORM.half_track * quotient / radius)
    law = NormOptimalLaw(model, identify=False)
    workplace = Workplace(rounded(1.0), (1.0, -2.0, 0.4), law)
    done = workplace.learn(iterations)
    assert_within_limit(done)
    return np.array([workplace.position_error(learned).max() for learned in done])


@pytest.mark.parametrize("radius", [1 / 3, 1.5])
@pytest.mark.parametrize("quotient", [0.4, 2.0])
def test_learning_is_indifferent_to_a_wrong_model_within_the_documented_range(
    radius: float, quotient: float
) -> None:
    errors = without_identification(radius, quotient, 30)
    assert errors[30] < 1e-3
    assert errors[20:].max() < errors[5] < errors[2]


def test_errors_grow_beyond_that_range() -> None:
    errors = without_identification(1.0, 0.2, 20)
    assert errors[10:].min() > 2 * errors[2]
