"""What theory knows of law feedback, which does not learn: its closed loop along the reference.

Linearised in the reference's frame, with e the errors ahead, to the left and of the heading, v and
w speed and yaw rate of the reference's next step, and the ratios p = R / R_b and
t = R B_b / (R_b B) by which the true platform drives and turns further than the believed one,
e(k+1) is

    (1 - p k_x d_t) e_x + (1 - p) v d_t
    e_y + v d_t e_theta + v d_t (w d_t / 2)
    e_theta - t v d_t (k_y e_y + k_theta e_theta) + (1 - t) w d_t

turned by -w d_t: the platform steps along its heading, the reference half a turn to the left of
it. On a line or a circle the loop is the same in each sample. Its eigenvalues tell whether errors
fall, and its point of rest is where the platform stays, pass after pass. An error ahead of -a at
rest adds a v t (k_y e_y + k_theta e_theta) to the rate of e_y: the platform swings the reference
aside as it turns. The trace of the loop then is -v t (k_theta - k_y a), so that a platform which is
ahead of its reference by more than k_theta / k_y does not stay there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import reference_twist
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, Findings, Rows, disturbed_rows, joined
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.laws.feedback_response import (
    TrackingResponse,
    response_rows,
    tracking_response,
)
from hilc_cli.theory.learning.outcome import CLEARLY
from hilc_cli.theory.noise import Remedies, WheelNoise, noise_findings, wheel_findings, wheel_rows
from hilc_cli.theory.reach import late_start

_REMEDIES = Remedies(
    start="place the robot better, or raise controller.gains",
    readings="measure better, or lower controller.gains",
    state="make it smaller, or raise controller.gains",
)


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
            tracking_findings(self.loop, self.response),
            wheel_findings(self.wheels, "lower controller.gains.k_y and k_theta"),
            noise_findings(self.experiment, self.expected, _REMEDIES, learns=False),
        )

    @property
    def rows(self) -> Rows:
        """What the feedback does along the path, and to small errors."""
        return [*response_rows(self.response), *_loop_rows(self.loop)]

    @property
    def brief(self) -> Rows:
        """What it does along the path, with and without disturbances."""
        disturbed = disturbed_rows(self.expected)
        return [*response_rows(self.response), *disturbed, *wheel_rows(self.wheels)]

    @property
    def document(self) -> dict[str, object]:
        """What is known, as JSON."""
        found, response = self.loop, self.response
        return {
            "path_max_position_error_m": response.error_m,
            "initial_position_error_m": response.way.off,
            "on_trajectory_from_s": response.way.joins_s,
            "left_of_start_at_end_m": response.way.left,
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


def _loop_rows(found: TrackingLoop) -> Rows:
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
    return [*rows, ("Rests on long stretches", _rest_text(found))] if found.lasts else rows


def _rest_text(found: TrackingLoop) -> str:
    """Returns where the platform stays on a line or a circle that lasts."""
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


_MARGIN = 1e-9  # beyond what rounding may make of a limiting case
_SOFT = 0.25  # of an error to the side: who leaves more of it at the end hardly acts
_SWINGS = 0.2  # damping below which an error swings for long
_TURNED = 0.05  # [rad]; heading that a turn in place may leave
_HOPELESS = 3.0  # decades by which an error grows over the path
_REACHED = 0.05  # of the way to a point of rest: who has no more left is there
_SINGULAR = 1e13  # condition beyond which there is no single point of rest


@dataclass(frozen=True, slots=True)
class TrackingLoop:
    """What feedback alone does, without speed limit and disturbances.

    Attributes:
        growth: Largest absolute eigenvalue of a sample: below 1 errors fall there.
        decades: By how many powers of ten an error may grow over the path where it is above 1.
        time_ahead: In which an error ahead falls to 1/e, 1 / (p k_x) [s]; infinite for k_x = 0.
        length_aside: l = 1 / sqrt(t k_y) [m]: over the path a small error to the side follows
            l^2 e'' + 2 D l e' + e = 0; infinite for k_y = 0.
        damping: D; 1 is critical.
        swings: The same as the sampling makes of it, where the reference is fastest: the damping of
            the swings in which an error to the side falls from sample to sample, 1 if it does not
            swing, 0 if it swings for ever.
        lasts: Whether the path goes on along any line or circle until its point of rest is reached.
        lag: Largest error ahead at a point of rest, about v (R_b / R - 1) / k_x [m]: above 0 the
            platform is behind.
        rest: Largest distance from the reference at a point of rest [m], of the lines and circles
            that last, if any does; infinite if there is none.
        most_ahead: k_theta / k_y [m]: a platform that would rest further ahead of the reference
            swings about it instead; infinite for k_y = 0.
        model_is_right: Whether p = t = 1.
    """

    growth: float
    decades: float
    time_ahead: float
    length_aside: float
    damping: float
    swings: float
    lasts: bool
    lag: float
    rest: float
    most_ahead: float
    model_is_right: bool

    @property
    def is_stable(self) -> bool:
        """Whether errors do not grow from sample to sample."""
        return self.growth <= 1 + _MARGIN

    @property
    def stays(self) -> bool:
        """Whether the platform stays at its points of rest."""
        return self.is_stable and math.isfinite(self.rest) and -self.lag < self.most_ahead


def tracking_loop(experiment: Experiment, law: FeedbackLaw) -> TrackingLoop:
    """Returns the closed loop of an experiment of the law."""
    reference, robot, model = experiment.reference, experiment.robot, law.model
    driven = robot.wheel_radius / model.wheel_radius
    turned = driven * model.signed_half_track / robot.signed_half_track
    twists, which, samples = np.unique(
        np.stack(reference_twist(reference), axis=1).round(9),
        axis=0,
        return_inverse=True,
        return_counts=True,
    )
    matrices, offsets = _loop(law, twists, driven, turned, reference.sample_time)
    growths = np.abs(np.linalg.eigvals(matrices)).max(axis=1)
    runs = _longest_runs(which.ravel(), len(twists))
    grown = np.log10(np.maximum(growths, 1.0)) @ samples
    lasting = growths**runs < _REACHED
    rests = lasting if lasting.any() else np.ones_like(lasting)
    ahead, away = _at_rest(matrices[rests], offsets[rests])
    ahead = np.where(twists[rests, 0] < 0, -ahead, ahead)  # in the direction of travel
    stiffness = math.sqrt(max(turned * law.k_y, 0.0))
    return TrackingLoop(
        float(growths.max()),
        float(grown),
        1 / (driven * law.k_x) if law.k_x else math.inf,
        1 / stiffness if stiffness else math.inf,
        turned * law.k_theta / (2 * stiffness) if stiffness else math.inf,
        _swings(turned, law, float(np.abs(twists[:, 0]).max()) * reference.sample_time),
        bool(lasting.any()),
        float(ahead[np.abs(ahead).argmax()]),
        float(away.max()),
        law.k_theta / law.k_y if law.k_y else math.inf,
        abs(driven - 1) <= _MARGIN and abs(turned - 1) <= _MARGIN,
    )


def tracking_findings(found: TrackingLoop, response: TrackingResponse) -> Findings:
    """Returns what the closed loop and its response along the path mean for the experiment."""
    failures, warnings = _along_the_path(found, response)
    if not found.is_stable:
        (failures if found.decades >= _HOPELESS else warnings).insert(
            0,
            f"the feedback is unstable: an error grows to {found.growth:.4g} times its size from "
            "sample to sample; lower controller.gains, or shorten sample_time",
        )
        return Findings(tuple(failures), tuple(warnings))
    if found.growth >= 1 - _MARGIN and math.inf in (found.time_ahead, found.length_aside):
        warnings.append(
            "there are errors that do not fall: raise those of controller.gains that are 0"
        )
    elif found.stays and response.aside_left > _SOFT and not response.only_stands:
        warnings.append(
            f"controller.gains.k_y is too soft for this path: of an error to the side at the start "
            f"{100 * response.aside_left:.0f} % is left at its end, since it falls over a length "
            f"of {found.length_aside:.3g} m only; raise k_y, or make the path longer"
        )
    if found.swings < _SWINGS:
        warnings.append(
            "controller.gains.k_y is too stiff: at this sample_time and speed an error to the side "
            f"swings with a damping of {found.swings:.2g} (1 is critical, 0 never ends); lower "
            "k_y, raise k_theta, or shorten sample_time"
        )
    return Findings(tuple(failures), tuple(warnings))


def way_findings(loop: TrackingLoop, found: TrackingResponse) -> Findings:
    """What the way from the initial pose means; nothing where no start would be near enough."""
    explodes = not math.isfinite(found.expected.final_m) or loop.decades >= _HOPELESS
    if not found.is_off or explodes:
        return Findings()
    late = late_start(
        found.way,
        "the platform",
        "start nearer, raise controller.gains, or make the path longer",
        hopeless=found.way.off >= found.unlearned_m / CLEARLY,
    )
    # Errors that fall by and by are late, and nothing to mind.
    return late if found.way.joins is None else Findings(late.failures)


def _along_the_path(found: TrackingLoop, response: TrackingResponse) -> tuple[list[str], list[str]]:
    """Returns failures and warnings of the response."""
    failures, warnings = [], []
    if not math.isfinite(response.expected.final_m):
        failures.append(
            "the feedback drives the platform beyond all numbers along this path; lower "
            "controller.gains, or set controller.b_w"
        )
    if response.error_m > response.way.near and found.decades < _HOPELESS:
        # The model is to blame for what goes away with a right one.
        by_model = response.error_known_m < response.error_m / CLEARLY
        model = (
            "though its model is right"
            if found.model_is_right
            else "and hardly less with a right model"
        )
        error = f"up to {response.error_m:.3g} m off the reference"
        if by_model and not found.stays and found.is_stable and math.isfinite(found.rest):
            warnings.append(
                f"the wrong model drives the platform {error}, ahead of it, and beyond "
                f"k_theta / k_y, {found.most_ahead:.3g} m, it turns away from it: correct "
                "model, or raise controller.gains.k_x"
            )
        elif by_model and not found.model_is_right:
            warnings.append(
                f"the wrong model leaves the platform {error} along this path, in each iteration "
                "again; correct model, raise controller.gains, or take a law that learns"
            )
        elif response.at_limit:
            warnings.append(
                f"controller.b_w acts in {100 * response.at_limit:.2g} % of the samples and leaves "
                f"the platform {error}; make the trajectory slower"
            )
        else:
            warnings.append(
                f"the feedback leaves the platform {error} along this path, {model}: raise "
                "controller.gains, shorten sample_time, or round its corners"
            )
    if response.heading_error_rad > _TURNED:
        warnings.append(
            f"for {response.standing_s:.4g} s the reference turns in place, where its speed is 0 "
            "and the law steers neither heading nor side: the heading is up to "
            f"{response.heading_error_rad:.3g} rad off there; correct model, or take a law that "
            "learns"
        )
    return failures, warnings


def _loop(
    law: FeedbackLaw, twists: Floats, driven: float, turned: float, sample_time: float
) -> tuple[Floats, Floats]:
    """Returns matrices (m, 3, 3) and offsets (m, 3), for speeds and yaw rates of shape (m, 2)."""
    step, turn = sample_time * twists.T
    matrices, offsets = np.zeros((len(twists), 3, 3)), np.zeros((len(twists), 3))
    matrices[:] = np.eye(3)
    matrices[:, 0, 0] -= driven * law.k_x * sample_time
    matrices[:, 1, 2] = step
    matrices[:, 2, 1] = -turned * step * law.k_y
    matrices[:, 2, 2] -= turned * np.abs(step) * law.k_theta
    offsets[:, 0] = (1 - driven) * step
    offsets[:, 1] = step * turn / 2
    offsets[:, 2] = (1 - turned) * turn
    rotation = np.zeros_like(matrices)
    rotation[:, 0, 0] = rotation[:, 1, 1] = np.cos(turn)
    rotation[:, 0, 1], rotation[:, 1, 0] = np.sin(turn), -np.sin(turn)
    rotation[:, 2, 2] = 1.0
    return rotation @ matrices, np.einsum("kab,kb->ka", rotation, offsets)


def _longest_runs(which: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Returns for how many samples each twist lasts at a time, at most, shape (count,)."""
    begins = np.flatnonzero(np.concatenate([[True], np.diff(which) != 0, [True]]))
    longest = np.zeros(count, dtype=np.intp)
    np.maximum.at(longest, which[begins[:-1]], np.diff(begins))
    return longest


def _swings(turned: float, law: FeedbackLaw, step: float) -> float:
    """The least damping of what z^2 - (2 - t k_theta s) z + 1 - t k_theta s + t k_y s^2 = 0 has."""
    steered = turned * law.k_theta * step
    roots = np.roots([1.0, steered - 2, 1 - steered + turned * law.k_y * step**2]).astype(complex)
    damping = 1.0
    for root in roots:
        if abs(root) > _MARGIN and (root.real < 0 or abs(root.imag) > _MARGIN):
            decay = -np.log(root)
            damping = min(damping, float(decay.real / abs(decay)))
    return damping


def _at_rest(matrices: Floats, offsets: Floats) -> tuple[Floats, Floats]:
    """Returns error ahead and distance from the reference at points of rest, shape (m,) each.

    Of several the nearest, as from a start without error; where there is none both are infinite.
    """
    returns = np.eye(3) - matrices
    regular = np.linalg.cond(returns) < _SINGULAR
    points = np.full((len(offsets), 3), math.inf)
    points[regular] = np.linalg.solve(returns[regular], offsets[regular][..., None])[..., 0]
    for which in np.flatnonzero(~regular):
        free = returns[which].copy()
        if np.abs(free[2]).max() <= _MARGIN:
            free[:, 2] = 0.0  # the heading is not steered: it stays as it is at the start
        nearest = np.linalg.lstsq(free, offsets[which], rcond=1 / _SINGULAR)[0]
        left = np.abs(returns[which] @ nearest - offsets[which]).max()
        if left <= _MARGIN * np.abs(offsets[which]).max():
            points[which] = nearest
    return points[:, 0], np.hypot(points[:, 0], points[:, 1])
