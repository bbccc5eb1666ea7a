"""The closed loop of the tracking controller without learning, linearised along its reference.

In the reference's frame, with e the errors ahead, to the left and of the heading, v and w speed
and yaw rate of the reference's next step, and the ratios p = R / R_b and t = R B_b / (R_b B) by
which the true platform drives and turns further than the believed one, e(k+1) is

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

import numpy as np

from hilc_cli.analysis.findings import Findings
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.feedforward import reference_twist
from hilc_cli.reference.sampled import Floats

_MARGIN = 1e-9  # beyond what rounding may make of a limiting case
_FAR = 0.01  # of the path's size: what is further off does not count as on the reference
_HOPELESS = 3.0  # decades by which an error grows over the path
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
        lag: Largest error ahead at a point of rest, about v (R_b / R - 1) / k_x [m]: above 0 the
            platform is behind.
        rest: Largest distance from the reference at a point of rest [m]; infinite if there is none.
        most_ahead: k_theta / k_y [m]: a platform that would rest further ahead of the reference
            swings about it instead; infinite for k_y = 0.
        model_is_right: Whether p = t = 1.
        path_size: Longer side of the trajectory's bounding box [m].
    """

    growth: float
    decades: float
    time_ahead: float
    length_aside: float
    damping: float
    lag: float
    rest: float
    most_ahead: float
    model_is_right: bool
    path_size: float

    @property
    def is_stable(self) -> bool:
        """Whether errors do not grow from sample to sample."""
        return self.growth <= 1 + _MARGIN

    @property
    def stays(self) -> bool:
        """Whether the platform stays at its points of rest."""
        return self.is_stable and math.isfinite(self.rest) and -self.lag < self.most_ahead


def tracking_loop(experiment: Experiment, law: FeedbackLaw) -> TrackingLoop:
    """The closed loop of an experiment of the law."""
    reference, robot, model = experiment.reference, experiment.robot, law.model
    driven = robot.wheel_radius / model.wheel_radius
    turned = driven * model.signed_half_track / robot.signed_half_track
    twists, samples = np.unique(
        np.stack(reference_twist(reference), axis=1).round(9), axis=0, return_counts=True
    )
    matrices, offsets = _loop(law, twists, driven, turned, reference.sample_time)
    growths = np.abs(np.linalg.eigvals(matrices)).max(axis=1)
    grown = np.log10(np.maximum(growths, 1.0)) @ samples
    ahead, away = _at_rest(matrices, offsets)
    stiffness = math.sqrt(max(turned * law.k_y, 0.0))
    return TrackingLoop(
        float(growths.max()),
        float(grown),
        1 / (driven * law.k_x) if law.k_x else math.inf,
        1 / stiffness if stiffness else math.inf,
        turned * law.k_theta / (2 * stiffness) if stiffness else math.inf,
        float(ahead[np.abs(ahead).argmax()]),
        float(away.max()),
        law.k_theta / law.k_y if law.k_y else math.inf,
        abs(driven - 1) <= _MARGIN and abs(turned - 1) <= _MARGIN,
        reference.size,
    )


def tracking_findings(found: TrackingLoop) -> Findings:
    """What the closed loop means for the experiment."""
    failures: list[str] = []
    warnings: list[str] = []
    if not found.is_stable:
        (failures if found.decades >= _HOPELESS else warnings).append(
            f"the feedback is unstable: an error grows to {found.growth:.4g} times its size from "
            "sample to sample; lower controller.gains, or shorten sample_time"
        )
    elif math.isinf(found.rest):
        cause = "the sampling" if found.model_is_right else "the wrong model"
        warnings.append(
            f"{cause} leaves the platform ever further off the reference, since nothing brings it "
            "back; raise those of controller.gains that are 0"
        )
    elif not found.stays:
        warnings.append(
            f"the wrong model drives the platform up to {-found.lag:.3g} m ahead of the reference, "
            f"and beyond k_theta / k_y, {found.most_ahead:.3g} m, it turns away from it: correct "
            "model, or raise controller.gains.k_x"
        )
    elif found.growth >= 1 - _MARGIN and math.inf in (found.time_ahead, found.length_aside):
        warnings.append(
            "there are errors that do not fall: raise those of controller.gains that are 0"
        )
    elif not found.model_is_right and found.rest > _FAR * found.path_size:
        warnings.append(
            f"the wrong model leaves the platform up to {found.rest:.3g} m off the reference, in "
            "each iteration again; correct model, raise controller.gains, or take a law that learns"
        )
    return Findings(tuple(failures), tuple(warnings))


def _loop(
    law: FeedbackLaw, twists: Floats, driven: float, turned: float, sample_time: float
) -> tuple[Floats, Floats]:
    """Matrices, shape (m, 3, 3), and offsets, shape (m, 3), for speeds and yaw rates (m, 2)."""
    step, turn = sample_time * twists.T
    matrices, offsets = np.zeros((len(twists), 3, 3)), np.zeros((len(twists), 3))
    matrices[:] = np.eye(3)
    matrices[:, 0, 0] -= driven * law.k_x * sample_time
    matrices[:, 1, 2] = step
    matrices[:, 2, 1] = -turned * step * law.k_y
    matrices[:, 2, 2] -= turned * step * law.k_theta
    offsets[:, 0] = (1 - driven) * step
    offsets[:, 1] = step * turn / 2
    offsets[:, 2] = (1 - turned) * turn
    rotation = np.zeros_like(matrices)
    rotation[:, 0, 0] = rotation[:, 1, 1] = np.cos(turn)
    rotation[:, 0, 1], rotation[:, 1, 0] = np.sin(turn), -np.sin(turn)
    rotation[:, 2, 2] = 1.0
    return rotation @ matrices, np.einsum("kab,kb->ka", rotation, offsets)


def _at_rest(matrices: Floats, offsets: Floats) -> tuple[Floats, Floats]:
    """Error ahead and distance from the reference at the points of rest, shape (m,) each.

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
