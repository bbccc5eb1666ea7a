"""What theory says of an experiment, whichever law it has."""

from __future__ import annotations

from dataclasses import dataclass, field

from hilc_cli.analysis.expected_error import ExpectedError
from hilc_cli.analysis.findings import Findings, joined
from hilc_cli.analysis.forecast import Forecast, forecast, rest_error
from hilc_cli.analysis.forecast_findings import forecast_findings
from hilc_cli.analysis.merging import Merging, merging, merging_findings
from hilc_cli.analysis.model_mismatch import (
    ModelMismatch,
    mismatch_findings,
    model_mismatch,
    untried_findings,
)
from hilc_cli.analysis.planned_noise import planned_noise
from hilc_cli.analysis.tracking_loop import TrackingLoop, tracking_findings, tracking_loop
from hilc_cli.analysis.tracking_response import TrackingResponse, tracking_response
from hilc_cli.analysis.wheel_noise import WheelNoise, wheel_findings
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.pid import PidLaw


@dataclass(frozen=True, slots=True)
class LawTheory:
    """What theory says of one law; of the others' questions, None.

    Attributes:
        forecast: What learning is expected to do, of the laws hybrid and pid.
        rest_error_m: Largest position error where learning rests, after the start or, with a
            compensation, after sample h; None if it rests at no finite motion.
        merging: The way of law norm-optimal into the trajectory.
        mismatch: What a wrong model does to its learning, if it can make up for it by nothing.
        identifies: Whether that identifies the platform.
        tracking: The closed loop of law feedback.
        response: What it does along the path.
        wheels: What disturbances make of the wheel speeds.
        expected: How large the error of the last iteration will be; None if that is not known.
        findings: What all this means.
    """

    forecast: Forecast | None = None
    rest_error_m: float | None = None
    merging: Merging | None = None
    mismatch: ModelMismatch | None = None
    identifies: bool = False
    tracking: TrackingLoop | None = None
    response: TrackingResponse | None = None
    wheels: WheelNoise | None = None
    expected: ExpectedError | None = None
    findings: Findings = field(default_factory=Findings)


def law_theory(experiment: Experiment) -> LawTheory:
    """What is known of the experiment's law."""
    law = experiment.law
    if isinstance(law, HybridLaw | PidLaw):
        expected = forecast(experiment)
        rest = expected.rest
        return LawTheory(
            forecast=expected,
            rest_error_m=rest_error(experiment, rest) if rest and rest.is_finite else None,
            findings=forecast_findings(experiment, expected),
        )
    if isinstance(law, NormOptimalLaw):
        way, mismatch = merging(experiment, law), model_mismatch(experiment, law)
        wheels = planned_noise(experiment, law)
        found = [
            merging_findings(way),
            untried_findings(experiment, law),
            wheel_findings(wheels, "raise controller.feedback_weights, or set 'feedback: none'"),
        ]
        if mismatch is not None:
            found.append(mismatch_findings(mismatch))
        return LawTheory(
            merging=way,
            mismatch=mismatch,
            wheels=wheels,
            identifies=law.parameters.identify,
            findings=joined(found),
        )
    if isinstance(law, FeedbackLaw):
        loop, response = tracking_loop(experiment, law), tracking_response(experiment, law)
        found = [
            tracking_findings(loop, response),
            wheel_findings(response.wheels, "lower controller.gains.k_y and k_theta"),
        ]
        return LawTheory(
            tracking=loop,
            response=response,
            wheels=response.wheels,
            expected=response.expected,
            findings=joined(found),
        )
    return LawTheory()
