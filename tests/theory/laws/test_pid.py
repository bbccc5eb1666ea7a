"""The condition of law pid: closed forms, and simulations on both sides of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.laws.pid import PidLearning, PidTheory, StepGain, step_gain
from hilc_cli.theory.learning import transient
from hilc_cli.theory.learning.forecast import forecast
from hilc_cli.theory.learning.linear_theory import forecast_findings
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM
from tests.theory.cases import DT, Case, PidCase, driven, line, spot, winding
from tests.transcription import equation_9

MODELS = [Robot(0.15, 0.6), Robot(0.3, 0.518), Robot(0.2, 0.3)]

CANNOT = "learning cannot converge (spectral radius "


@pytest.fixture(autouse=True)
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 10)


def believing(model: Robot) -> Case:
    return Case(0.0, model=model)


def found_of(case: PidCase, experiment: Experiment | None = None) -> StepGain:
    return step_gain(case.experiment(line(3)) if experiment is None else experiment, case.law())


def findings(experiment: Experiment) -> Findings:
    return forecast_findings(PidTheory(experiment))


@pytest.mark.parametrize("model", MODELS)
def test_gain_of_d_type_is_the_ratio_of_the_radii_and_of_the_turn_gains(model: Robot) -> None:
    found = found_of(PidCase(kd=0.5, plant=believing(model)))
    radius, track = model.wheel_radius, model.half_track
    ahead, turning = 0.2 / radius, 0.2 * track / (radius * 0.518)
    assert [found.along, found.turning] == pytest.approx([0.5 * ahead, 0.5 * turning], rel=1e-12)
    assert found.bounds == (0.0, 2.0)
    left = max(abs(1 - 0.5 * ahead), abs(1 - 0.5 * turning))
    assert found.left == pytest.approx(left, rel=1e-12)
    # The largest kd: 2 by the larger of both ratios.
    assert found.largest_time == pytest.approx(2 / max(ahead, turning), rel=1e-12)


def test_every_gain_counts_with_its_power_of_the_sample_time() -> None:
    found = found_of(PidCase(0.3, 0.2, 0.1, 0.25))
    assert found.time == pytest.approx(0.1 + 0.3 * DT + 0.2 * DT**2, rel=1e-14)
    assert found.bounds == (-0.25, 1.75)
    assert found.left == pytest.approx(abs(0.75 - found.time), rel=1e-12)
    assert found.largest_time == pytest.approx(1.75, rel=1e-12)


def test_bound_of_complex_loop_gains_is_where_the_circle_is_left() -> None:
    # G B = [[1, -1], [1, 1]] / sqrt(2) times the platform's: eigenvalues exp(+-i pi/4).
    found = StepGain(0.81, 1.0, np.exp([[0.25j * np.pi, -0.25j * np.pi]]), None, None)
    largest = found.largest_time
    assert abs(0.81 - largest * np.exp(0.25j * np.pi)) == pytest.approx(1, rel=1e-12)
    assert largest > 0


def deviations(case: PidCase, iterations: int) -> Floats:
    """Of the input over iterations, from a tiny one, without limit, shape (N + 1, n, 2)."""
    drive, reference = driven(case.plant, winding(30))
    change = 1e-7 * np.random.default_rng(1).standard_normal(drive.shape)
    first = drive + change
    experiment = replace(
        case.experiment(reference, (first[:, 0].copy(), first[:, 1].copy())), iterations=iterations
    )
    trials = list(simulate(experiment))
    return np.array([np.stack([each.left, each.right], axis=1) - drive for each in trials])


def sizes(arrays: Floats) -> Floats:
    return np.array([np.linalg.norm(each) for each in arrays])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("share", [0.5, 0.93, 1.07, 1.5])
def test_simulated_deviations_grow_beyond_the_condition_and_fall_before_it(
    model: Robot, share: float
) -> None:
    # By hand: every iteration multiplies the mean of both wheels by 1 - kd R / R_b, and half their
    # difference by 1 - kd R B_b / (R_b B), at every sample alike.
    ahead = PLATFORM.wheel_radius / model.wheel_radius
    turning = ahead * model.half_track / PLATFORM.half_track
    kd = share * 2 / max(ahead, turning)
    case = PidCase(kd=kd, plant=believing(model))
    norms = sizes(deviations(case, 12))
    slowest = max(abs(1 - kd * ahead), abs(1 - kd * turning))
    if share == 0.5:
        assert norms[12] < norms[0]
    else:
        # After some iterations the slower of both is all that is left.
        assert norms[12] / norms[11] == pytest.approx(slowest, rel=0.01)
    assert (norms[12] > norms[0]) == (share > 1)
    assert (found_of(case).left < 1) == (share < 1)
    found = findings(case.experiment(line(3)))
    told = [text for text in (*found.failures, *found.warnings) if text.startswith(CANNOT)]
    assert len(told) == (share > 1)
    if share == 1.5:  # by a gain that is just too large errors may still fall at first
        assert told == list(found.failures)
    if share > 1:
        bound = float(told[0].rpartition("below ")[2].removesuffix(" s"))
        assert bound == pytest.approx(2 / max(ahead, turning), rel=5e-3)
        assert f"controller.gains.kd of {kd:g} s turns the error" in told[0]


@pytest.mark.parametrize("forgetting", [0.2, 0.6])
def test_forgetting_lowers_the_bound(forgetting: float) -> None:
    # |1 - gamma - kd| < 1. From a deviation of u_0 an input goes to gamma / (gamma + kd) of it;
    # what is left beside that is multiplied by 1 - gamma - kd.
    for kd, grows in ((0.95 * (2 - forgetting), False), (1.05 * (2 - forgetting), True)):
        case = PidCase(kd=kd, forgetting=forgetting)
        changes = sizes(np.diff(deviations(case, 24), axis=0))
        # From iteration to iteration, of each wheel at each sample alike.
        assert changes[23] / changes[22] == pytest.approx(kd - 1 + forgetting, rel=1e-3)
        found = findings(case.experiment(line(3)))
        told = [text for text in (*found.failures, *found.warnings) if text.startswith(CANNOT)]
        assert len(told) == grows


def test_sum_of_the_gains_is_told_with_its_bound() -> None:
    experiment = PidCase(1.0, 2.0, 1.5).experiment(line(3))
    (text,) = findings(experiment).failures
    # 1.5 + 1 * 0.5 + 2 * 0.25 = 2.5 of 2.
    assert text.endswith(
        "controller.gains turn the error that a sample's wheel speeds cause into one as large or "
        "larger: kd + kp d_t + ki d_t^2 is 2.5 s; keep it below 2 s"
    )


def test_without_gains_every_iteration_is_the_first() -> None:
    (text,) = findings(PidCase().experiment(line(3))).failures
    assert text.endswith(
        "controller.gains are all 0, so every iteration is the first; give kp, ki or kd"
    )
    # With forgetting they settle at once, at the first input.
    assert findings(PidCase(forgetting=0.5).experiment(line(3))).failures == ()


def test_gain_that_is_lost_in_rounding_learns_nothing() -> None:
    (text,) = findings(PidCase(kd=1e-17).experiment(line(3))).failures
    assert "change wheel speeds by less than the rounding of their numbers" in text


def test_matrix_that_turns_the_wrong_way_is_found_out() -> None:
    case = PidCase(kd=0.5, plant=believing(Robot(0.2, 0.518, "rep103")))
    (text,) = findings(case.experiment(spot(4))).failures
    assert "controller.gain_matrix corrects some errors the wrong way, " in text
    found = found_of(case)
    assert found.turning == pytest.approx(-0.5)
    assert found.largest_time == 0


def test_other_matrix_has_no_gain_along_the_path() -> None:
    matrix = GainMatrix(
        (Affine(cos=5.0), Affine(sin=2.0), Affine(2.0)), (Affine(cos=5.0), Affine(), Affine(-2.0))
    )
    law = replace(PidCase(kd=0.5).law(), matrix=matrix)
    experiment = replace(PidCase().experiment(winding(12)), law=law)
    found = step_gain(experiment, law)
    assert (found.along, found.turning) == (None, None)
    products = []
    for angle in experiment.reference.heading[:-1]:
        c, s = math.cos(angle), math.sin(angle)
        gain = np.array([[5 * c, 2 * s, 2], [5 * c, 0, -2]])
        products.append(np.eye(2) - 0.5 * gain @ equation_9(0.2, 0.518)(c, s))
    expected = np.abs(np.linalg.eigvals(products)).max()
    assert found.left == pytest.approx(expected, rel=1e-12)


def test_filter_that_mixes_samples_is_told_apart() -> None:
    # What passes a narrow filter is a few cosines of the whole path, in which kp acts as over
    # its length: 1 - kp T / 2 of a constant speed's mean error, T = 60 s here.
    case = PidCase(kp=0.1, cutoff=0.004)
    experiment = case.experiment(line(120))
    assert found_of(case, experiment).left == pytest.approx(0.95)
    (text,) = findings(experiment).failures
    radius = float(text.removeprefix("learning cannot converge (spectral radius about ")[:4])
    assert radius == pytest.approx(2, rel=0.05)
    assert text.endswith("lower kp and ki, or raise controller.cutoff")


def test_forgetting_does_not_rest_on_the_reference() -> None:
    # The wheels end at kd / (gamma + kd) of what would be right: 4/5 of 5 m.
    experiment = PidCase(kd=0.4, forgetting=0.1).experiment(line(10))
    (text,) = findings(experiment).warnings
    assert "its position error after the start is up to 1 m, 20 % of the path's size; " in text
    assert text.endswith("lower it, or begin with a better one")


def test_filtered_learning_ends_where_its_predicted_errors_do() -> None:
    experiment = PidCase(kd=0.9, forgetting=0.1, cutoff=0.5).experiment(line(10))
    (text,) = findings(replace(experiment, iterations=60)).warnings
    # Of a constant the filter leaves all: 0.9 / (0.1 + 0.9) of the way.
    assert "the predicted error ends at 0.5 m, 10 % of the path's size" in text


def test_derivative_alone_does_not_see_an_error_that_stays() -> None:
    plant = Case(0.0, offset=(0.5, 0.0, 0.0))
    (text,) = findings(PidCase(kd=0.9, plant=plant).experiment(line(10))).warnings
    assert text.endswith(
        "up to 0.5 m, 10 % of the path's size; its derivative is all that the law sees of an "
        "initial error; give kp as well"
    )
    rectified = PidCase(kd=0.9, rectifying=4, plant=plant).experiment(line(10))
    assert findings(rectified) == Findings()


def test_ripples_of_pid_are_told_with_a_remedy() -> None:
    # z = exp(i phi): 1 - 1.5 - 0.45 / (1 - 1 / z) is -0.725 + 0.225 i cot(phi / 2), phi = pi / 10.
    case = PidCase(kp=0.45 / DT, kd=1.5)
    found = forecast(case.experiment(line(200)))
    assert found.ripple.factor == pytest.approx(math.hypot(0.725, 0.225 / math.tan(math.pi / 20)))
    assert found.settles
    (text,) = [text for text in findings(case.experiment(line(200))).warnings if "ripples" in text]
    assert text.endswith("stop in time, or lower the gains, or set controller.cutoff")
    summed = PidLearning(replace(case, ki=0.1, cutoff=0.5).experiment(line(3)))
    assert summed.against_ripples() == "lower ki, or lower controller.cutoff"


def test_filter_that_rounds_the_path_off_is_told() -> None:
    experiment = PidCase(kd=0.9, cutoff=1.0).experiment(winding(60))
    (text,) = findings(replace(experiment, iterations=100)).warnings
    assert "learning does not rest on the reference: the predicted error ends at " in text
    assert text.endswith(
        "controller.cutoff takes away what is faster, and the law does not see all errors; raise it"
    )
