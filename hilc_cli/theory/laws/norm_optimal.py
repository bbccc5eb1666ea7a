"""What theory knows of the norm-optimal law."""

from __future__ import annotations

import math
from functools import cached_property
from typing import cast

from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.theory.findings import ExpectedError, Findings, Rows, expected_rows, joined
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.laws.merging import Merging, merging, merging_findings
from hilc_cli.theory.laws.model_mismatch import (
    ModelMismatch,
    mismatch_findings,
    model_mismatch,
    untried_findings,
)
from hilc_cli.theory.learning.expected import expected_of_norm_optimal
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.noise.findings import noise_findings
from hilc_cli.theory.noise.wheels import WheelNoise, wheel_findings, wheel_rows


class NormOptimalTheory(LawTheory):
    """How soon the law is on the trajectory, and what a wrong model does to its learning."""

    tells_the_way_in = True

    @property
    def law(self) -> NormOptimalLaw:
        """The law."""
        return cast("NormOptimalLaw", self.experiment.law)

    @cached_property
    def merging(self) -> Merging:
        """The way into the trajectory."""
        return merging(self.experiment, self.law)

    @cached_property
    def mismatch(self) -> ModelMismatch | None:
        """What a wrong model does, if the law can make up for it by nothing."""
        return model_mismatch(self.experiment, self.law)

    @cached_property
    def _last_iteration(self) -> tuple[ExpectedError, Outcome, WheelNoise | None]:
        return expected_of_norm_optimal(self.experiment, self.law, self.mismatch)

    @property
    def expected(self) -> ExpectedError:
        """How large the error of the last iteration will be."""
        return self._last_iteration[0]

    @property
    def outcome(self) -> Outcome:
        """What comes of learning."""
        return self._last_iteration[1]

    @property
    def wheels(self) -> WheelNoise | None:
        """What disturbances make of the wheel speeds."""
        return self._last_iteration[2]

    @property
    def way_in(self) -> Findings:
        """What the way into the trajectory means."""
        return merging_findings(self.merging)

    @property
    def findings(self) -> Findings:
        """What all the rest means."""
        softer = "raise controller.feedback_weights, or set 'feedback: none'"
        return joined(
            [
                untried_findings(self.experiment, self.law),
                wheel_findings(self.wheels, softer),
                Findings()
                if self.mismatch is None
                else mismatch_findings(self.mismatch, self.expected, self.outcome),
                noise_findings(self.experiment, self.expected),
            ]
        )

    @property
    def rows(self) -> Rows:
        """The way in, and what learning does to errors."""
        return [*_way_in(self.merging), *self._learning()]

    @property
    def brief(self) -> Rows:
        """The same in short, and the error to be expected."""
        found = self.merging
        told = self._learning()
        if self.mismatch is None:
            told[-1] = (
                "Learning",
                "identifies wheel radius and half track"
                if self.law.parameters.identify
                else "feedback makes up for a wrong model",
            )
        if found.is_off:
            planned = _merge(found)
            text = (
                f"from {found.position_error:.4g} m, {found.heading_error:.4g} rad off: {planned}"
            )
            if found.earliest is not None and math.isfinite(found.speed_limit):
                text += f"; any law from {found.earliest} on"
            told.insert(0, ("Merges", text))
        last = self.experiment.iterations
        return [*told, *expected_rows(self.expected, last), *wheel_rows(self.wheels)]

    @property
    def document(self) -> dict[str, object]:
        """The same as JSON."""
        found, mismatch = self.merging, self.mismatch
        document: dict[str, object] = {
            "initial_position_error_m": found.position_error,
            "initial_heading_error_rad": found.heading_error,
            "h_samples": found.h,
            "earliest_merge_sample": found.earliest,
            "merge_sample": found.planned,
            "believed_max_wheel_speed_rad_s": found.fastest_believed,
        }
        if mismatch is not None:
            document |= {
                "correction_along": mismatch.along,
                "correction_turning": mismatch.turning,
                "correction_strongest": mismatch.strongest,
                "iteration_leaves": mismatch.left,
                "converges": mismatch.converges,
            }
        return document

    def _learning(self) -> Rows:
        rows: Rows = []
        found, mismatch = self.merging, self.mismatch
        if (
            math.isfinite(found.speed_limit)
            and found.is_possible
            and not found.is_believed_possible
        ):
            rows.append(
                (
                    "Believed robot",
                    f"needs {found.fastest_believed:.4g} rad/s, above b_w: the law lags at first",
                )
            )
        if mismatch is None:
            why = (
                "wheel radius and half track are identified"
                if self.law.parameters.identify
                else "the feedback makes up for a wrong model"
            )
            return [*rows, ("Theory", f"no condition is evaluated: {why}")]
        strongest = f"{mismatch.along:.4g} along the path, {mismatch.turning:.4g} in turning"
        return [
            *rows,
            ("Correction, times the right one", f"{strongest}; must be below 2"),
            ("An iteration leaves", f"{mismatch.left:.3g} of small errors that weigh much"),
        ]


def _way_in(found: Merging) -> Rows:
    off = f"{found.position_error:.4g} m, {found.heading_error:.4g} rad"
    if not found.is_off:
        return [("Initial error", f"{off}: the trajectory itself is the reference")]
    earliest = _sample(found, found.earliest, "at no sample")
    if math.isinf(found.speed_limit):
        earliest = "at once: there is no speed limit"
    planned = _merge(found)
    return [
        ("Initial error", off),
        ("Earliest merge of any law", earliest),
        ("Merge of this law", f"{planned}; h is {found.h}"),
    ]


def _merge(found: Merging) -> str:
    """Returns where the law's way in ends: within a millimetre, or else as near as counts."""
    if found.planned is not None:
        return _sample(found, found.planned, "")
    if found.joins is None:
        return "not before the end"
    what = "it" if found.is_possible else "what the limit leaves of it"
    return f"within {found.near:.2g} m of {what} from {_sample(found, found.joins, '')}"


def _sample(found: Merging, sample: int | None, none: str) -> str:
    return none if sample is None else f"sample {sample} ({sample * found.sample_time:.6g} s)"
