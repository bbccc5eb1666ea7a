"""What theory knows of the norm-optimal law: how soon it is on the trajectory, and what is left.

It identifies what robot it has before it, and plans anew for that: on a platform that moves as
Eq. 8 has it no belief is wrong for long, and no condition has to hold for learning to converge.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import cast

from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.theory.findings import ExpectedError, Findings, Rows, expected_rows, joined
from hilc_cli.theory.identifiable import Identifiable
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.laws.norm_optimal_merging import Merging, merging, merging_findings
from hilc_cli.theory.laws.norm_optimal_noise import expected_of_norm_optimal
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.noise import Remedies, WheelNoise, noise_findings, wheel_findings, wheel_rows


class NormOptimalTheory(LawTheory):
    """How soon the law is on the trajectory, and what is left in the last iteration."""

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
    def _last_iteration(self) -> tuple[ExpectedError, Outcome, WheelNoise | None]:
        return expected_of_norm_optimal(self.experiment, self.law)

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
        return joined(
            wheel_findings(self.wheels, "set 'feedback: none', or give the wheels more room"),
            noise_findings(self.experiment, self.expected, _remedies(self.law)),
        )

    @property
    def rows(self) -> Rows:
        """The way in, and what learning does to errors."""
        none = "no condition is evaluated: the robot and its motors are identified"
        return [*_way_in(self.merging), *self._learning("Theory", none)]

    @property
    def brief(self) -> Rows:
        """The way in and what learning does in short, and the error to be expected."""
        found, told = (
            self.merging,
            self._learning("Learning", f"identifies the robot and its motors{self._not_told()}"),
        )
        if found.is_off:
            planned = _merge(found)
            text = (
                f"from {found.position_error:.4g} m, {found.heading_error:.4g} rad off: {planned}"
            )
            if found.earliest is not None and math.isfinite(found.speed_limit):
                text += f"; any law from {found.earliest} on"
            told.insert(0, ("Merges", text))
        return [*told, *expected_rows(self.expected, self.experiment), *wheel_rows(self.wheels)]

    @property
    def document(self) -> dict[str, object]:
        """What is known, as JSON."""
        found = self.merging
        return {
            "initial_position_error_m": found.position_error,
            "initial_heading_error_rad": found.heading_error,
            "h_samples": found.h,
            "earliest_merge_sample": found.earliest,
            "merge_sample": found.planned,
            "believed_max_wheel_speed_rad_s": found.fastest_believed,
        }

    def _not_told(self) -> str:
        hidden = Identifiable(self.experiment).hidden
        return f"; a pass tells no {', '.join(hidden)}" if hidden else ""

    def _learning(self, label: str, text: str) -> Rows:
        found, rows = self.merging, [(label, text)]
        if (
            math.isfinite(found.speed_limit)
            and found.is_possible
            and not found.is_believed_possible
        ):
            needs = f"needs {found.fastest_believed:.4g} rad/s, above b_w: the law lags at first"
            rows.insert(0, ("Believed robot", needs))
        return rows


def _remedies(law: NormOptimalLaw) -> Remedies:
    """Returns what can be done about disturbances."""
    if law.feedback == "none":
        return Remedies(
            start="place the robot better, or set controller.feedback: regulator",
            readings="measure better, or raise iterations",
            state="make it smaller, or set controller.feedback: regulator",
        )
    return Remedies(
        start="place the robot better",
        readings="measure better, or set 'feedback: none'",
        state="make it smaller, or measure better, which makes the feedback faster",
    )


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
    if found.way.joins is None:
        return "not before the end"
    what = "it" if found.is_possible else "what the limit leaves of it"
    return f"within {found.way.near:.2g} m of {what} from {_sample(found, found.way.joins, '')}"


def _sample(found: Merging, sample: int | None, none: str) -> str:
    return none if sample is None else f"sample {sample} ({sample * found.way.sample_time:.6g} s)"
