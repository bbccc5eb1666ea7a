"""The closed loop of the tracking controller beside what it does."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.laws.feedback import TrackingLoop, tracking_findings, tracking_loop
from hilc_cli.theory.laws.feedback_response import tracking_response
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import Pose
from tests.theory.cases import line, spot

# 3 m/s and 1.5 rad/s for 4 s, 6 mm in a sample.
CIRCLE = build_reference(
    "circle", (2, 0, math.pi / 2), [ArcPlan(6.0, "left", radius=2.0, duration=4.0)], 0.002
)
GAINS = (5.0, 16.0, 8.0)


def experiment(
    reference: Reference,
    believed: Robot = PLATFORM,
    gains: tuple[float, float, float] = GAINS,
    start: Pose | None = None,
) -> tuple[Experiment, FeedbackLaw]:
    law = FeedbackLaw(*gains, believed)
    made = experiment_of(
        reference, law_of(0.0), initial_pose=start, iterations=0, learn_in_first=True
    )
    return replace(made, law=law), law


def away(made: Experiment) -> Floats:
    (trial,) = simulate(made)
    distance: Floats = np.hypot(made.reference.x - trial.x, made.reference.y - trial.y)
    return distance


def found_of(
    reference: Reference,
    believed: Robot = PLATFORM,
    gains: tuple[float, float, float] = GAINS,
) -> TrackingLoop:
    return tracking_loop(*experiment(reference, believed, gains))


def findings_of(
    reference: Reference,
    believed: Robot = PLATFORM,
    gains: tuple[float, float, float] = GAINS,
    start: Pose | None = None,
) -> Findings:
    made, law = experiment(reference, believed, gains, start)
    return tracking_findings(tracking_loop(made, law), tracking_response(made, law))


def test_right_model_has_the_textbook_figures() -> None:
    found = found_of(line(20, 0.01))  # 1 m/s
    assert found.time_ahead == pytest.approx(1 / 5)
    assert (found.length_aside, found.damping) == pytest.approx((1 / 4, 1))
    # z = 1 - k_x d, and (z - 1)^2 + k_theta s (z - 1) + k_y s^2 = (z - 1 + 4 s)^2, s = 1 cm: 0.96.
    assert found.growth == pytest.approx(0.96, abs=1e-6)  # a double root is known to half digits
    assert found.decades == 0
    assert (found.lag, found.rest) == (0, 0)
    assert found.stays
    assert not found.lasts  # 0.96 ** 20 = 0.44
    assert found_of(line(80, 0.01)).lasts  # 0.04


@pytest.mark.parametrize("believed", [PLATFORM, Robot(0.22, 0.45), Robot(0.19, 0.6)])
def test_small_errors_fall_by_the_largest_eigenvalue(believed: Robot) -> None:
    # Two passes that begin apart by little; where they end, the slowest of their difference is
    # left: a pair of complex eigenvalues turns it as well, so that it is looked at over a while.
    gains = (20.0, 16.0, 2.5)  # the slowest is aside
    made, law = experiment(CIRCLE, believed, gains)
    x, y, heading = made.initial_pose
    passes = []
    for shift in (0.0, 1e-6):
        (trial,) = simulate(replace(made, initial_pose=(x + shift, y, heading)))
        passes.append(np.stack([trial.x, trial.y, trial.heading]))
    norm = np.linalg.norm(passes[1] - passes[0], axis=0)
    late, early = norm[800:1000].max(), norm[300:500].max()
    found = tracking_loop(made, law)
    assert (late / early) ** (1 / 500) == pytest.approx(found.growth, rel=1e-3)
    assert found.growth < 1


# The platform settles at a point of rest: to second order in its error, 2 % of the radius.
@pytest.mark.parametrize(
    ("factor", "track"), [(1.0, 1.0), (1.01, 1.0), (0.99, 1.0), (1.0, 1.04), (1.02, 0.97)]
)
def test_platform_ends_at_the_point_of_rest(factor: float, track: float) -> None:
    believed = Robot(0.2 * factor, 0.518 * track)
    found, made = found_of(CIRCLE, believed), experiment(CIRCLE, believed)[0]
    end = away(made)[1000:]
    assert np.ptp(end) < 1e-3 * end.max()
    assert end.max() == pytest.approx(found.rest, rel=0.02)
    # v (R_b / R - 1) / k_x, and what the turning of 1.5 rad/s makes of the error aside.
    aside = math.sqrt(found.rest**2 - found.lag**2)
    assert abs(found.lag - 3.0 * (factor - 1) / 5.0) <= 1.01 * factor * 1.5 / 5.0 * aside
    assert found.model_is_right == (factor == track == 1)
    assert findings_of(CIRCLE, believed) == Findings()


def test_lag_of_a_wrong_radius_is_warned_of() -> None:
    found = found_of(line(20, 0.01), Robot(0.24, 0.518))
    assert found.lag == pytest.approx(1.0 * 0.2 / 5, rel=1e-9)
    # In 200 ms it does not get all the way: what is left falls by 1 - k_x d R / R_b a sample.
    fallen = 0.04 * (1 - (1 - 5 * 0.01 / 1.2) ** 20)
    (text,) = findings_of(line(20, 0.01), Robot(0.24, 0.518)).warnings[:1]
    assert text.startswith(f"the wrong model leaves the platform up to {fallen:.3g} m off the ref")


@pytest.mark.parametrize(("factor", "stays"), [(0.9, True), (0.7, False)])
def test_platform_does_not_stay_too_far_ahead(factor: float, stays: bool) -> None:
    # k_theta / k_y = 0.1 m; v (R_b / R - 1) / k_x = -0.06 and -0.18 m.
    gains, believed = (5.0, 40.0, 4.0), Robot(0.2 * factor, 0.518)
    found = found_of(CIRCLE, believed, gains)
    assert found.most_ahead == pytest.approx(0.1)
    assert found.stays == stays
    end = away(experiment(CIRCLE, believed, gains)[0])[1200:]
    if stays:
        assert end.max() == pytest.approx(found.rest, rel=0.05)
    else:
        assert end.max() < 0.8 * found.rest
        (text,) = findings_of(CIRCLE, believed, gains).warnings
        most = away(experiment(CIRCLE, believed, gains)[0]).max()
        assert text.startswith(f"the wrong model drives the platform up to {most:.3g} m off the ")
        assert "beyond k_theta / k_y, 0.1 m, it turns away" in text


@pytest.mark.parametrize(("k_x", "fails"), [(19.0, None), (20.1, False), (21.0, True)])
def test_unstable_feedback_grows_over_the_path(k_x: float, fails: bool | None) -> None:
    # z = 1 - k_x d: over 80 samples 1.01 and 1.1 to the 80th are 2.2 and 2000.
    reference, gains = line(80, 0.1), (k_x, 1.0, 2.0)
    found = found_of(reference, gains=gains)
    findings = findings_of(reference, gains=gains)
    if fails is None:
        assert findings == Findings()
        return
    (text,) = findings.failures if fails else findings.warnings
    assert found.growth == pytest.approx(0.1 * k_x - 1)
    assert found.decades == pytest.approx(80 * math.log10(0.1 * k_x - 1))
    assert text.startswith(f"the feedback is unstable: an error grows to {found.growth:.4g} times")
    ends = away(experiment(reference, gains=gains, start=(-1e-3, 0, 0))[0])
    assert ends[-1] / ends[0] == pytest.approx(10**found.decades, rel=1e-6)


def test_wrong_model_may_make_feedback_unstable() -> None:
    gains = (15.0, 1.0, 2.0)  # 1 - 15 * 0.1 * 0.2 / 0.14 = -1.14
    assert found_of(line(80, 0.1), gains=gains).is_stable
    assert found_of(line(80, 0.1), Robot(0.14, 0.518), gains).growth == pytest.approx(8 / 7)


def test_nothing_is_steered_on_the_spot() -> None:
    # Each step turns further than it should: no rest. With the right model nothing drives it off.
    gains = (2.0, 16.0, 8.0)
    wrong = found_of(spot(10), Robot(0.2, 0.6), gains)
    assert wrong.rest == math.inf
    assert wrong.is_stable
    right = found_of(spot(10), gains=gains)
    assert right.rest == 0


def test_without_gains_an_error_stays() -> None:
    found = found_of(line(20, 0.01), gains=(0.0, 0.0, 0.0))
    assert (found.time_ahead, found.length_aside, found.damping) == (math.inf,) * 3
    assert found.most_ahead == math.inf
    lost = found_of(line(20, 0.01), Robot(0.22, 0.518), (0.0, 0.0, 0.0))
    assert lost.rest == math.inf
    off, stays = findings_of(line(20, 0.01), Robot(0.22, 0.518), (0.0, 0.0, 0.0)).warnings
    assert off.startswith("the wrong model leaves the platform up to 0.0182 m off")  # of 0.2 m
    assert stays.startswith("there are errors that do not fall")


def test_without_a_gain_of_heading_and_side_an_error_of_the_heading_stays() -> None:
    found = found_of(CIRCLE, gains=(5.0, 0.0, 0.0))
    assert found.growth == pytest.approx(1, abs=1e-12)
    assert found.is_stable
    (text,) = findings_of(CIRCLE, gains=(5.0, 0.0, 0.0)).warnings
    assert text.startswith("there are errors that do not fall")
    # The heading is right in each sample. Ahead and aside, in steps of s that turn by a, rest is
    # where e = T(-a) (diag(1 - k_x d, 1) e + (0, s a / 2)).
    a, d, s = 3e-3, 0.002, 6e-3
    turned = np.array([[math.cos(a), math.sin(a)], [-math.sin(a), math.cos(a)]])
    rest = np.linalg.solve(np.eye(2) - turned @ np.diag([1 - 5 * d, 1]), turned @ [0, s * a / 2])
    assert found.rest == pytest.approx(np.hypot(*rest), rel=1e-3)
