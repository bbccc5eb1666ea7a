"""Norm-optimal learning on a wrong model: dense matrices, and runs of the law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, Findings
from hilc_cli.theory.laws.norm_optimal import mismatch_findings, model_mismatch, untried_findings
from hilc_cli.theory.learning.outcome import Outcome
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.theory.cases import Case, line, winding

STEPS = 30
ALONE = NormOptimalLaw(PLATFORM, feedback="none", identify=False)
MODELS = [PLATFORM, Robot(0.26, 0.36), Robot(0.14, 0.67), Robot(0.08, 0.4)]

SMALL = ExpectedError(0.1, 0.01, 0.01)


def law(model: Robot, other: NormOptimalLaw = ALONE) -> NormOptimalLaw:
    return replace(other, model=model)


def on_the_line(model: Robot, iterations: int = 0) -> Experiment:
    # A tiny error of the first input: 1 m/s are 5 rad/s of wheels of 0.2 m.
    first = np.full(8, 5.0 + 1e-6)
    made = experiment_of(
        line(8, 0.05), law_of(0.0), initial_input=(first, first), iterations=iterations
    )
    return replace(made, law=law(model))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("input_change", [10.0, 0.01])
def test_strongest_correction_is_that_of_dense_matrices(model: Robot, input_change: float) -> None:
    reference = winding(STEPS)
    parameters = replace(ALONE, input_change=input_change)
    experiment = replace(experiment_of(reference, law_of(0.0)), law=law(model, parameters))

    def plant(platform: Robot) -> Floats:
        linear = Case(0.0, robot=platform).linear(reference)
        columns = np.eye(2 * STEPS).reshape(STEPS, 2, 2 * STEPS)
        errors = linear.errors(columns, np.zeros(3), constant=False)
        moved: Floats = -errors[1:].reshape(3 * STEPS, 2 * STEPS)
        return moved

    believed, true = plant(model), plant(PLATFORM)
    weights = np.tile([1e6, 1e6, 400.0], STEPS)  # 1 mm and 0.05 rad
    hessian = believed.T @ (weights[:, None] * believed) + np.eye(2 * STEPS) / input_change**2
    update = np.linalg.solve(hessian, believed.T @ (weights[:, None] * true))
    eigenvalues = np.linalg.eigvals(update)
    found = model_mismatch(experiment, law(model, parameters))
    assert found is not None
    # The largest ones may be near each other, which the search does not tell apart.
    assert found.strongest == pytest.approx(eigenvalues.real.max(), rel=5e-3)
    assert np.abs(eigenvalues.imag).max() < 1e-6
    assert eigenvalues.real.min() > 0
    assert found.along == pytest.approx(0.2 / model.wheel_radius)
    assert found.turning == pytest.approx(found.along * model.half_track / 0.518)
    assert found.strongest <= max(found.along, found.turning) * (1 + 1e-12)
    assert found.converges == (eigenvalues.real.max() < 2)


@pytest.mark.parametrize("radius", [0.26, 0.14, 0.11, 0.08])
def test_small_errors_of_a_run_go_by_the_ratio_of_the_radii(radius: float) -> None:
    # Straight ahead the turn gain has no part in it. At 1 mm against 10 rad/s the change of input
    # weighs nothing where a speed adds up over 8 samples.
    model = Robot(radius, 0.518 * radius / 0.2)
    errors = [abs(trial.x[-1] - 0.4) for trial in simulate(on_the_line(model, iterations=6))]
    found = model_mismatch(on_the_line(model), law(model))
    assert found is not None
    assert found.left == pytest.approx(abs(1 - 0.2 / radius), rel=1e-9)
    falls = errors[6] < errors[2]
    assert falls == found.converges == (0.2 / radius < 2)
    findings = mismatch_findings(found, SMALL, Outcome.LEARNS)
    if falls:
        assert findings == Findings()
    else:
        (text,) = findings.failures
        assert text.startswith("learning cannot converge: the correction is 2.")
        assert "because R / R_b is 2.5; correct model, or set " in text


def test_turn_gain_is_told_where_it_is_the_worse_one() -> None:
    model = Robot(0.2, 0.518 * 2.4)
    experiment = replace(experiment_of(winding(STEPS), law_of(0.0)), law=law(model))
    found = model_mismatch(experiment, law(model))
    assert found is not None
    (text,) = mismatch_findings(found, SMALL, Outcome.LEARNS).failures
    assert "because R B_b / (R_b B) is 2.4; " in text


@pytest.mark.parametrize("change", [{"identify": True}, {"feedback": "lqr"}])
def test_nothing_is_evaluated_where_the_model_is_made_up_for(change: dict[str, object]) -> None:
    parameters = replace(ALONE, **change)  # type: ignore[arg-type]
    assert model_mismatch(on_the_line(PLATFORM), law(PLATFORM, parameters)) is None


@pytest.mark.parametrize(
    ("model", "is_tried"),
    [
        (PLATFORM, True),
        (Robot(0.3, 0.35), True),
        (Robot(0.6, 1.554), True),  # three times the platform: it drives a third, and turns alike
        (Robot(0.4, 0.259), False),  # turns a quarter of what is believed
        (Robot(0.12, 0.518), False),
    ],
)
def test_feedback_is_not_asked_for_more_than_was_tried(model: Robot, is_tried: bool) -> None:
    parameters = NormOptimalLaw(PLATFORM, identify=False)
    found = untried_findings(on_the_line(model), law(model, parameters))
    assert (found == Findings()) is is_tried
    for other in (ALONE, NormOptimalLaw(PLATFORM)):
        assert untried_findings(on_the_line(model), law(model, other)) == Findings()
