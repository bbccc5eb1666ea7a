"""What ``hilc check`` says of learning by the laws pid, norm-optimal and feedback."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hilc_cli.theory.laws.law_theory import LawTheory
    from hilc_cli.theory.laws.merging import Merging
    from hilc_cli.theory.laws.model_mismatch import ModelMismatch
    from hilc_cli.theory.laws.tracking_loop import TrackingLoop
    from hilc_cli.theory.laws.tracking_response import TrackingResponse
    from hilc_cli.theory.learning.gains import StepGain
    from hilc_cli.theory.noise.wheels import WheelNoise

Rows = list[tuple[str, str]]


def other_law(theory: LawTheory) -> tuple[Rows, dict[str, object]]:
    """Rows and JSON of a law of which no errors are predicted."""
    if theory.merging is not None:
        rows = [*_way_in(theory.merging), *_learning(theory, theory.merging)]
        return rows, _norm_optimal(theory.merging, theory.mismatch)
    return [("Theory", "none is known of this law")], {}


def feedback_law(theory: LawTheory) -> tuple[Rows, dict[str, object]]:
    """Rows and JSON of law feedback."""
    found, response = theory.tracking, theory.response
    assert found is not None and response is not None  # of this law
    return [*response_rows(theory), *_loop(found)], _feedback(found, response)


def wheel_rows(found: WheelNoise | None) -> Rows:
    """What disturbances make of the wheel speeds; nothing without any."""
    if found is None:
        return []
    without = f", {found.undisturbed:.1%} undisturbed" if found.undisturbed else ""
    return [
        (
            "Wheel noise",
            f"{found.change_rad_s:.3g} rad/s RMS in a sample; {found.at_limit:.1%} of the samples "
            f"at the limit{without}",
        )
    ]


def wheel_document(found: WheelNoise | None) -> dict[str, object]:
    """The same as JSON."""
    if found is None:
        return {}
    return {
        "wheel_noise_rms_change_rad_s": found.change_rad_s,
        "share_at_limit": found.at_limit,
        "share_at_limit_undisturbed": found.undisturbed,
    }


def step_gain_row(found: StepGain) -> tuple[str, str]:
    """The condition of law pid."""
    low, high = found.bounds
    needed = f"{low:.4g} < s < {high:.4g}"
    if found.along is not None and found.turning is not None:
        text = f"{found.along:.4g} along the path, {found.turning:.4g} in turning"
    else:
        sizes = np.abs(found.time * found.loop)
        text = f"of absolute value {sizes.min():.4g} to {sizes.max():.4g}"
        needed = f"|{found.kept:.4g} - s| < 1"
    violated = "" if found.left < 1 else ", violated"
    return "Step gain s", f"{text}; needed: {needed}{violated}"


def step_gain_document(found: StepGain) -> dict[str, object]:
    """The condition of law pid as JSON."""
    low, high = found.bounds
    return {
        "step_gain_along": found.along,
        "step_gain_turning": found.turning,
        "step_gain_above": low,
        "step_gain_below": high,
        "step_gain_leaves": found.left,
        "condition_holds": found.left < 1,
    }


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
    """Where the law's own way in ends: within a millimetre, or else as near as counts."""
    if found.planned is not None:
        return _sample(found, found.planned, "")
    if found.joins is None:
        return "not before the end"
    what = "it" if found.is_possible else "what the limit leaves of it"
    return f"within {found.near:.2g} m of {what} from {_sample(found, found.joins, '')}"


def way_in_brief(theory: LawTheory, found: Merging) -> Rows:
    """Rows of law norm-optimal for the report of one screen."""
    told = _learning(theory, found)
    if theory.mismatch is None:
        told[-1] = (
            "Learning",
            "identifies wheel radius and half track"
            if theory.identifies
            else "feedback makes up for a wrong model",
        )
    if not found.is_off:
        return told
    planned = _merge(found)
    text = f"from {found.position_error:.4g} m, {found.heading_error:.4g} rad off: {planned}"
    if found.earliest is not None and math.isfinite(found.speed_limit):
        text += f"; any law from {found.earliest} on"
    return [("Merges", text), *told]


def _learning(theory: LawTheory, found: Merging) -> Rows:
    rows, mismatch = [], theory.mismatch
    if math.isfinite(found.speed_limit) and found.is_possible and not found.is_believed_possible:
        rows.append(
            (
                "Believed robot",
                f"needs {found.fastest_believed:.4g} rad/s, above b_w: the law lags at first",
            )
        )
    if mismatch is None:
        why = (
            "wheel radius and half track are identified"
            if theory.identifies
            else "the feedback makes up for a wrong model"
        )
        return [*rows, ("Theory", f"no condition is evaluated: {why}")]
    strongest = f"{mismatch.along:.4g} along the path, {mismatch.turning:.4g} in turning"
    return [
        *rows,
        ("Correction, times the right one", f"{strongest}; must be below 2"),
        ("An iteration leaves", f"{mismatch.left:.3g} of small errors that weigh much"),
    ]


def response_rows(theory: LawTheory) -> Rows:
    """What law feedback does along the path."""
    found = theory.response
    assert found is not None  # of this law
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


def _sample(found: Merging, sample: int | None, none: str) -> str:
    return none if sample is None else f"sample {sample} ({sample * found.sample_time:.6g} s)"


def _norm_optimal(found: Merging, mismatch: ModelMismatch | None) -> dict[str, object]:
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


def _feedback(found: TrackingLoop, response: TrackingResponse) -> dict[str, object]:
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
