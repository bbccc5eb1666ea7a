"""What theory says of an experiment, whichever law it has."""

from __future__ import annotations

from dataclasses import dataclass, field

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.pid import PidLaw
from hilc_cli.theory.findings import ExpectedError, Findings, joined
from hilc_cli.theory.laws.merging import Merging, merging, merging_findings
from hilc_cli.theory.laws.model_mismatch import (
    ModelMismatch,
    mismatch_findings,
    model_mismatch,
    untried_findings,
)
from hilc_cli.theory.laws.tracking_loop import (
    TrackingLoop,
    tracking_findings,
    tracking_loop,
    way_findings,
)
from hilc_cli.theory.laws.tracking_response import TrackingResponse, tracking_response
from hilc_cli.theory.learning.expected import expected_of_learning, expected_of_norm_optimal
from hilc_cli.theory.learning.findings import forecast_findings
from hilc_cli.theory.learning.forecast import Forecast, forecast, rest_error
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.noise.findings import noise_findings
from hilc_cli.theory.noise.wheels import WheelNoise, wheel_findings


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
        outcome: What comes of learning.
        start: What the way from the initial pose means, of the laws whose way is known.
        findings: What all the rest means.
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
    outcome: Outcome | None = None
    start: Findings = field(default_factory=Findings)
    findings: Findings = field(default_factory=Findings)


def law_theory(experiment: Experiment) -> LawTheory:
    """What is known of the experiment's law."""
    law = experiment.law
    if isinstance(law, HybridLaw | PidLaw):
        found = forecast(experiment)
        rest, expected = found.rest, expected_of_learning(experiment, found)
        wheels = _learned_noise(experiment, found)
        return LawTheory(
            forecast=found,
            outcome=found.outcome,
            rest_error_m=rest_error(experiment, rest) if rest and rest.is_finite else None,
            expected=expected,
            wheels=wheels,
            findings=joined(
                [
                    forecast_findings(experiment, found, expected),
                    noise_findings(experiment, expected),
                    wheel_findings(wheels, _less_learned(law)),
                ]
            ),
        )
    if isinstance(law, NormOptimalLaw):
        way, mismatch = merging(experiment, law), model_mismatch(experiment, law)
        expected, outcome, wheels = expected_of_norm_optimal(experiment, law, mismatch)
        parts = [
            untried_findings(experiment, law),
            wheel_findings(wheels, "raise controller.feedback_weights, or set 'feedback: none'"),
        ]
        if mismatch is not None:
            parts.append(mismatch_findings(mismatch, expected, outcome))
        parts.append(noise_findings(experiment, expected))
        return LawTheory(
            merging=way,
            mismatch=mismatch,
            wheels=wheels,
            identifies=law.parameters.identify,
            expected=expected,
            outcome=outcome,
            start=merging_findings(way),
            findings=joined(parts),
        )
    if isinstance(law, FeedbackLaw):
        loop, response = tracking_loop(experiment, law), tracking_response(experiment, law)
        parts = [
            tracking_findings(loop, response),
            wheel_findings(response.wheels, "lower controller.gains.k_y and k_theta"),
            noise_findings(experiment, response.expected, learns=False),
        ]
        return LawTheory(
            tracking=loop,
            response=response,
            wheels=response.wheels,
            expected=response.expected,
            start=way_findings(loop, response),
            findings=joined(parts),
        )
    return LawTheory()


def _learned_noise(experiment: Experiment, found: Forecast) -> WheelNoise | None:
    """What laws that learn make of disturbances; None if it is not known of the last iteration."""
    ensemble = found.ensemble
    if ensemble.iterations < experiment.iterations or not ensemble.is_limited:
        return None
    return WheelNoise.of_seeds(ensemble.change_rad_s, ensemble.at_limit[-1])


def _less_learned(law: HybridLaw | PidLaw) -> str:
    """What makes a law learn less of the noise."""
    if isinstance(law, PidLaw) and law.cutoff is None:
        return "set controller.cutoff, or lower controller.gains"
    return "lower controller.gains"
