"""What theory knows of law feedback, which does not learn."""

from __future__ import annotations

import math
from functools import cached_property
from typing import cast

from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.theory.findings import ExpectedError, Findings, Rows, disturbed_rows, joined
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.laws.tracking_loop import (
    TrackingLoop,
    tracking_findings,
    tracking_loop,
    way_findings,
)
from hilc_cli.theory.laws.tracking_response import TrackingResponse, tracking_response
from hilc_cli.theory.noise.findings import noise_findings
from hilc_cli.theory.noise.wheels import WheelNoise, wheel_findings, wheel_rows


class FeedbackTheory(LawTheory):
    """The closed loop in the small, and what it does along the path."""

    title = "What does the feedback reach?"

    @property
    def law(self) -> FeedbackLaw:
        """The law."""
        return cast("FeedbackLaw", self.experiment.law)

    @cached_property
    def loop(self) -> TrackingLoop:
        """The closed loop."""
        return tracking_loop(self.experiment, self.law)

    @cached_property
    def response(self) -> TrackingResponse:
        """What it does along the path."""
        return tracking_response(self.experiment, self.law)

    @property
    def expected(self) -> ExpectedError:
        """How large the error of a pass will be."""
        return self.response.expected

    @property
    def wheels(self) -> WheelNoise | None:
        """What disturbances make of the wheel speeds."""
        return self.response.wheels

    @property
    def way_in(self) -> Findings:
        """What the way from the start means."""
        return way_findings(self.loop, self.response)

    @property
    def findings(self) -> Findings:
        """What all this means."""
        return joined(
            [
                tracking_findings(self.loop, self.response),
                wheel_findings(self.wheels, "lower controller.gains.k_y and k_theta"),
                noise_findings(self.experiment, self.expected, learns=False),
            ]
        )

    @property
    def rows(self) -> Rows:
        """What the feedback does along the path, and to small errors."""
        return [*_response_rows(self.response), *_loop(self.loop)]

    @property
    def brief(self) -> Rows:
        """What it does along the path, with and without disturbances."""
        disturbed = disturbed_rows(self.expected)
        return [*_response_rows(self.response), *disturbed, *wheel_rows(self.wheels)]

    @property
    def document(self) -> dict[str, object]:
        """The same as JSON."""
        found, response = self.loop, self.response
        return {
            "path_max_position_error_m": response.error_m,
            "initial_position_error_m": response.start_off_m,
            "on_trajectory_from_s": response.joins_s,
            "left_of_start_at_end_m": response.end_off_m,
            "left_of_side_error_at_end": response.aside_left,
            "standing_s": response.standing_s,
            "standing_max_heading_error_rad": response.heading_error_rad,
            "largest_eigenvalue": found.growth,
            "stable": found.is_stable,
            "time_ahead_s": found.time_ahead,
            "length_aside_m": found.length_aside,
            "damping": found.damping,
            "lag_m": found.lag,
            "swing_damping": found.swings,
            "rest_is_reached": found.lasts,
            "rest_max_position_error_m": found.rest,
            "stays_at_rest": found.stays,
        }


def _response_rows(found: TrackingResponse) -> Rows:
    """What law feedback does along the path."""
    error = f"up to {found.error_m:.4g} m from the trajectory's start"
    if found.at_limit:
        error += f"; at the limit in {found.at_limit:.1%} of the samples"
    rows = [("Error along this path", error)]
    if found.is_off:
        joins = (
            f"not by the end, where {found.end_off_m:.3g} m are left"
            if found.joins_s is None
            else f"from {found.joins_s:.4g} s on"
        )
        rows.append(("On the trajectory", f"{joins}; starts {found.start_off_m:.4g} m off"))
    if found.standing_s:
        heading = f"heading up to {found.heading_error_rad:.3g} rad off there"
        text = f"{found.standing_s:.4g} s, in which nothing is steered; {heading}"
        rows.append(("Turns in place", text))
    return rows


def _loop(found: TrackingLoop) -> Rows:
    falls = "errors fall" if found.growth < 1 else "errors do not fall"
    ahead, aside = "stays: k_x is 0", "stays: k_y is 0"
    if math.isfinite(found.time_ahead):
        ahead = f"falls to 1/e in {found.time_ahead:.4g} s"
    if math.isfinite(found.length_aside):
        aside = (
            f"falls over a length of {found.length_aside:.4g} m, damping {found.damping:.3g} "
            "(1 is critical)"
        )
    rows = [
        ("Largest eigenvalue", f"{found.growth:.6g} from sample to sample, {falls}"),
        ("Error ahead", ahead),
        ("Error to the side", aside),
    ]
    return [*rows, ("Rests on long stretches", _at_rest(found))] if found.lasts else rows


def _at_rest(found: TrackingLoop) -> str:
    """Where the platform stays on a line or a circle that lasts."""
    if math.isinf(found.rest):
        return "ever further off" if found.is_stable else "nowhere"
    if not found.is_stable:
        return "nowhere"
    if not found.stays:
        return f"nowhere: it turns away further than {found.most_ahead:.4g} m ahead"
    rest = f"up to {found.rest:.4g} m off"
    if found.lag and not found.model_is_right:
        side = "behind" if found.lag > 0 else "ahead"
        rest += f", {abs(found.lag):.4g} m {side}, about v (R_b / R - 1) / k_x"
    return rest
