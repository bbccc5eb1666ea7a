"""What learning can be expected to do: each sentence beside what a simulation does."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainMatrix, model_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import LinePlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.law_theory import law_theory
from hilc_cli.theory.learning import transient
from hilc_cli.theory.learning.forecast import forecast
from hilc_cli.theory.learning.linear_theory import LinearTheory, forecast_findings
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM, experiment_of, law_of, matrix_of
from tests.theory.cases import DT, errors, line, spot

OTHER = Robot(0.2, 0.518, "rep103")
CANNOT = "learning cannot converge (spectral radius "


@pytest.fixture(autouse=True)
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """What is said of an experiment does not depend on how far the errors are predicted."""
    monkeypatch.setattr(transient, "ITERATIONS", 10)
    yield


def findings(experiment: Experiment) -> Findings:
    theory = law_theory(experiment)
    assert isinstance(theory, LinearTheory)
    return forecast_findings(theory)


def failure(experiment: Experiment) -> tuple[float, str]:
    """The spectral radius that the only finding tells, and why that is none below 1."""
    found = findings(experiment)
    (text,) = found.failures
    assert text.startswith(CANNOT)
    assert found.warnings == ()
    radius, _, why = text.removeprefix(CANNOT).partition("): ")
    return float(radius), why


def warning(experiment: Experiment) -> str:
    found = findings(experiment)
    assert found.failures == ()
    (text,) = found.warnings
    return text


def last_error(experiment: Experiment) -> float:
    *_, last = simulate(experiment)
    return float(np.abs(errors(experiment.reference, last)).max())


@pytest.mark.parametrize("reference", [line(4), spot(4)], ids=["line", "spot"])
@pytest.mark.parametrize("model", [Robot(0.1, 0.4), Robot(0.3, 0.9)])
def test_bound_of_l1_parts_what_settles_from_what_does_not(
    reference: Reference, model: Robot
) -> None:
    ahead, turning = 0.2 / model.wheel_radius, 0.2 / 0.518 * model.half_track / model.wheel_radius
    bound = 2 / DT / max(ahead, turning)
    radius, why = failure(
        experiment_of(reference, law_of(1.1 * bound, matrix=model_gain(model)), iterations=1)
    )
    assert radius == pytest.approx(1.2, rel=1e-6)  # 1 - 1.1 * 2
    assert why.startswith(f"controller.gains.l1 of {1.1 * bound:g} turns the error ")
    assert float(why.rpartition(" ")[2]) == pytest.approx(bound, rel=5e-3)
    ours = 2 / DT / (turning if reference.name == "spot" else ahead)
    for factor in (0.8, 1.2):
        law = law_of(factor * ours, matrix=model_gain(model))
        worst = last_error(experiment_of(reference, law, iterations=150))
        assert worst < 1e-6 if factor < 1 else worst > 1e6
    slow = experiment_of(reference, law_of(0.8 * bound, matrix=model_gain(model)), iterations=150)
    assert findings(slow) == Findings()


def test_without_l1_the_first_step_is_never_corrected() -> None:
    experiment = experiment_of(line(3), law_of(0.0, 0.5), iterations=40)
    radius, why = failure(experiment)
    assert radius == 1
    assert why == (
        "controller.gains.l1 is 0, so no wheel speed is corrected by the error that it causes, "
        "only by those before; raise it"
    )
    trials = list(simulate(experiment))
    assert {trial.x[1] for trial in trials} == {0.0}
    # The second wheel speed meets the same error again and again, and grows without end.
    speeds = [trial.left[1] for trial in trials]
    np.testing.assert_allclose(np.diff(speeds), 0.5 * DT / 0.2, rtol=1e-9)


@pytest.mark.parametrize("law", [law_of(0.0), law_of(0.0, 1.0, 1.0, compensation=True, h=1)])
def test_without_gains_every_iteration_is_the_first(law: object) -> None:
    experiment = experiment_of(line(3), law)  # type: ignore[arg-type]
    radius, why = failure(experiment)
    assert radius == 1
    assert why == "controller.gains.l1 is 0, so every iteration is the first; raise it"
    assert {tuple(trial.x) for trial in simulate(experiment)} == {(0, 0, 0, 0)}


def test_gain_that_is_lost_in_rounding_learns_nothing() -> None:
    experiment = experiment_of(line(3), law_of(1e-17, matrix=model_gain(PLATFORM)), iterations=2)
    radius, why = failure(experiment)
    assert radius == 1
    assert why == (
        "controller.gains.l1 of 1e-17 changes wheel speeds by less than the rounding of their "
        "numbers; raise it"
    )
    assert findings(replace(experiment, law=law_of(1e-9))).failures == ()


def test_matrix_that_turns_the_wrong_way_drives_the_heading_off() -> None:
    law = law_of(0.5, matrix=model_gain(OTHER))
    radius, why = failure(experiment_of(spot(4), law))
    assert radius == pytest.approx(1 + 0.5 * DT)
    assert why.startswith("controller.gain_matrix corrects some errors the wrong way, ")
    assert "at 4 of 4 samples, at first at sample 0; its first row is the left wheel" in why
    assert last_error(experiment_of(spot(4), law, iterations=60)) > 1e3
    right = experiment_of(spot(4), law, robot=OTHER)
    assert findings(right) == Findings()


def test_matrix_is_judged_where_the_reference_heads() -> None:
    # Both wheels get cos(heading) times the error in x: nothing of one in y, and none in heading.
    matrix = GainMatrix(
        (Affine(cos=5.0), Affine(), Affine(2.0)), (Affine(cos=5.0), Affine(), Affine(-2.0))
    )
    ahead = build_reference("a", (0, 0, 0), [LinePlan(length=1.0, duration=1.0)], 0.1)
    aside = build_reference("b", (0, 0, math.pi / 2), [LinePlan(length=1.0, duration=1.0)], 0.1)
    assert findings(experiment_of(ahead, law_of(1.0, matrix=matrix))) == Findings()
    radius, why = failure(experiment_of(aside, law_of(1.0, matrix=matrix)))
    assert radius == pytest.approx(1, rel=1e-12)
    assert why.startswith("controller.gain_matrix corrects some errors the wrong way, or not at")


def test_gains_beyond_all_numbers_have_no_radius() -> None:
    law = law_of(1.0, matrix=model_gain(Robot(1e-10, 0.5)))
    with np.errstate(all="ignore"):
        found = findings(experiment_of(line(3), law, robot=Robot(1e300, 0.5)))
    assert found.failures == (
        "learning cannot converge: what the law makes of an error leaves the range of floating "
        "point; check the units of robot, model and controller.gains",
    )


@pytest.mark.parametrize("l1", [0.0, 1.0, 1e3])
def test_nothing_is_said_where_nothing_is_to_be_learned(l1: float) -> None:
    assert findings(experiment_of(line(3), law_of(l1, 5.0, 9.0), iterations=0)) == Findings()


# Of slow ripples 1 + 2 cos(phi) is nearly 3; of the fastest it is -1.
@pytest.mark.parametrize(
    ("gains", "period"),
    [
        ((0.1, 0.0, 0.0), None),
        ((0.1, 0.05, 0.0), None),
        ((0.1, 0.0, 0.05), 20.0),
        ((0.1, 0.11, 0.0), 2.0),
    ],
)
def test_growing_ripples_are_told(gains: tuple[float, float, float], period: float | None) -> None:
    experiment = experiment_of(line(200, 0.01), law_of(*gains), iterations=100)
    if period is None:
        assert findings(experiment).warnings == ()
        return
    text = next(text for text in findings(experiment).warnings if "ripples" in text)
    l1, l2, l3 = gains
    # c d_k = 0.01, exactly.
    z = np.exp(2j * math.pi / period)
    growth = abs(1 - 1 / z - l1 * 0.01) / abs(1 - 1 / z + 0.01 * (l2 / z + l3 / z**2))
    assert text == (
        f"controller.gains let ripples of the wheel speeds grow by {100 * (growth - 1):.2g} % in "
        f"each iteration, {growth**100:.3g} times in 100 (at a period of {period:g} samples), "
        "which in the long run spoils what was learned; stop in time, or lower l2 and l3 until "
        "l2 + 3 l3 is below l1"
    )


def test_remedy_of_ripples_is_general_for_other_matrices() -> None:
    reference = line(200, 0.01)
    law = law_of(0.1, 0.0, 0.3, matrix=matrix_of("contradicting", PLATFORM))
    text = next(
        text for text in findings(experiment_of(reference, law)).warnings if "ripples" in text
    )
    assert text.endswith("; stop in time, or lower the gains")


# A line of 2 m. What is off ahead is made up for in the first step, what is off across never.
@pytest.mark.parametrize(("aside", "share"), [(0.3, "15"), (-0.3, "15"), (0.019, None), (0, None)])
def test_an_error_across_the_heading_rests(aside: float, share: str | None) -> None:
    reference = line(4)
    experiment = experiment_of(
        reference, law_of(1.0), initial_pose=(0.25, aside, 0.0), iterations=80
    )
    *_, last = simulate(experiment)
    assert last.y[-1] == pytest.approx(aside)
    assert last.x[-1] == pytest.approx(reference.x[-1])
    if share is None:
        assert findings(experiment) == Findings()
    else:
        assert warning(experiment) == (
            "learning does not rest on the reference: there its position error after the start is "
            f"up to 0.3 m, {share} % of the path's size; the law sees no error across the heading"
        )


def test_full_matrix_rests_where_it_sees_nothing() -> None:
    matrix = GainMatrix((Affine(5.0), Affine(), Affine(2.5)), (Affine(5.0), Affine(), Affine(-2.5)))
    law = law_of(1.0, matrix=matrix)
    text = warning(experiment_of(line(4), law, initial_pose=(0.0, 0.3, 0.0)))
    assert text.endswith(
        "path's size; the law does not see what controller.gain_matrix turns to zero"
    )


def test_compensated_error_counts_after_sample_h() -> None:
    # Across the heading nothing is compensated either; ahead e(k + 1) = -w(k) e(0) until h.
    law = law_of(1.0, compensation=True, h=3)
    experiment = experiment_of(line(10), law, initial_pose=(-0.5, 0.3, 0.0))
    found = forecast(experiment)
    assert found.rest is not None
    assert found.rest.max_position_error_m > 0.5
    assert found.rest_error_m == pytest.approx(0.3)
    assert "there its position error after sample h is up to 0.3 m" in warning(experiment)
    whole = forecast(replace(experiment, law=replace(law, h=10)))
    assert whole.rest is not None and whole.rest_from == 1
    assert whole.rest_error_m == whole.rest.position_error_m[1:].max()


def test_feedback_that_outweighs_learning_has_an_error_that_grows() -> None:
    # l1 e(k + 1) + l2 e(k) = 0: twice the error in each of ten samples.
    experiment = experiment_of(line(10), law_of(0.1, 0.2), initial_pose=(-0.1, 0.0, 0.0))
    text = findings(experiment).warnings[-1]
    assert text == (
        "learning does not rest on the reference: there its position error after the start is up "
        "to 102 m, 20.5 times the path's size; its feedback makes errors grow from sample to "
        "sample; lower l2 and l3"
    )
    long = experiment_of(line(400, 0.01), law_of(0.1, 1.0), initial_pose=(-0.1, 0.0, 0.0))
    assert findings(long).warnings[-1] == (
        "learning has no finite motion to rest at: its feedback makes errors grow from sample to "
        "sample; lower l2 and l3"
    )


# 1 m/s are 5 rad/s. The first step makes up for 0.1 m in 0.5 s: 6 rad/s.
@pytest.mark.parametrize(("limit", "told"), [(4.9, False), (5.5, True), (6.1, False)])
def test_rest_beyond_the_limit_is_told_if_the_reference_keeps_it(limit: float, told: bool) -> None:
    experiment = experiment_of(
        line(10), law_of(1.0), initial_pose=(-0.1, 0.0, 0.0), speed_limit=limit
    )
    texts = [text for text in findings(experiment).warnings if "b_w" in text]
    assert (
        texts
        == [
            "wheel speeds where learning rests, up to 6 rad/s, exceed controller.b_w of 5.5 rad/s, "
            "though the reference keeps it: learning cannot rest exactly there"
        ]
        * told
    )


@pytest.mark.parametrize(("turned", "told"), [(0.9, False), (1.5, True), (-1.5, True)])
def test_start_that_is_turned_far_makes_the_prediction_rough(turned: float, told: bool) -> None:
    experiment = experiment_of(line(10), law_of(1.0), initial_pose=(0.0, 0.0, turned))
    texts = [text for text in findings(experiment).warnings if "initial_pose" in text]
    assert (
        texts
        == [
            "initial_pose.heading is off by 1.5 rad: the predicted errors are rough then, only "
            "where learning rests is exact"
        ]
        * told
    )


def test_monotone_and_settling_are_different_questions() -> None:
    # In one sample the update is the factor 1 - l1 d; over many it sums errors up.
    one = forecast(experiment_of(line(1), law_of(1.0)))
    assert (one.spectral_radius, one.singular_value.value) == pytest.approx((0.5, 0.5))
    assert one.settles
    assert one.is_monotone
    many = forecast(experiment_of(line(40), law_of(1.0)))
    dense = np.eye(40) - 0.5 * np.tril(np.ones((40, 40)))
    assert many.singular_value.value == pytest.approx(np.linalg.norm(dense, 2), rel=1e-9)
    assert many.spectral_radius == pytest.approx(0.5)
    assert many.settles
    assert not many.is_monotone
