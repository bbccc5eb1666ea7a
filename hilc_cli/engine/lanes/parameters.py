"""The parameters of an experiment as rows of the lane array."""

from __future__ import annotations

from typing import NamedTuple

from hilc_cli.disturbance.normal import probabilities
from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.lanes.kinds import Kind, LaneLaw, Member
from hilc_cli.engine.lanes.lanes import Field
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.gain_matrix import Coefficients, model_gain
from hilc_cli.laws.hybrid import with_lateral_gain
from hilc_cli.laws.pid import PidLaw

_ROUNDING = 2.0**-50
"""What the absolute values of a mean and half a difference may add to what they are made of."""
_NONE = (0.0, 0.0, 0.0)
_NO_WHEELS = (0.0,) * (Field.FORGOTTEN - Field.LEFT_GAIN)


def parameter_rows(member: Member, kind: Kind, direction: float) -> list[float]:
    """Returns the rows up to Field.POSITION_GAINS, or to Field.STATE if nothing is drawn.

    Of the matrix and the lateral gain they are those of the wheels.

    Args:
        member: Of the kind.
        kind: Of the member.
        direction: By which a lateral gain comes to the gain matrix, see `LaneParameters`.
    """
    experiment = member.experiment
    sample_time, limit = experiment.reference.sample_time, experiment.speed_limit
    law = _law_rows(member.law, kind, direction, sample_time)
    gains, wheels = _motion(member, sample_time)
    parameters = [
        *law.gains, limit, limit * (1 + _ROUNDING), *gains, *law.falling, law.rate,
        *experiment.initial_pose, *law.matrix, *law.lateral, *wheels, law.forgotten, *law.tracking,
        experiment.reference.samples,
    ]  # fmt: skip
    if kind.drawn:
        disturbance = experiment.disturbance
        for source in (disturbance.state, disturbance.output, disturbance.initial_pose):
            parameters += _noise_rows(source)
    return parameters


class _LawRows(NamedTuple):
    """Those of a law, from Field.L1 on."""

    gains: tuple[float, float, float]
    matrix: Coefficients
    falling: tuple[float, float, float] = (1.0, 0.0, 0.0)  # H, PEAK, SLOPE
    rate: float = 0.0
    lateral: tuple[float, float] = (0.0, 0.0)
    forgotten: float = 0.0
    tracking: tuple[float, float, float] = _NONE


def _law_rows(law: LaneLaw, kind: Kind, direction: float, sample_time: float) -> _LawRows:
    if isinstance(law, FeedbackLaw):
        # Eq. 45 makes wheel speeds of the mean and of half the difference, too.
        tracking, matrix = (law.k_x, law.k_y, law.k_theta), model_gain(law.model).coefficients
        return _LawRows((1.0, 0.0, 0.0), matrix, forgotten=1.0, tracking=tracking)
    if isinstance(law, PidLaw):
        matrix = law.matrix.coefficients
        if kind.planned:
            return _LawRows((1.0, 0.0, 0.0), matrix)
        gains = law.kp, law.ki * sample_time, law.kd / sample_time
        h = law.rectifying or 1  # which is not looked at without a pulse
        return _LawRows(gains, matrix, (h, 2 / h, 0.0), forgotten=law.forgetting)
    h = law.compensation or 1  # which Eq. 17 does not look at
    peak = (law.derivative or 1.0) * (2 / (sample_time * h))
    return _LawRows(
        law.gains,
        with_lateral_gain(law.matrix, direction * law.lateral).coefficients,
        (h, peak, peak / h),
        law.derivative / sample_time,
        (law.lateral * law.matrix.left[2].constant, law.lateral * law.matrix.right[2].constant),
    )


def _motion(member: Member, sample_time: float) -> tuple[tuple[float, float], tuple[float, ...]]:
    """The rows of the gains of mean and half difference, and those from Field.LEFT_GAIN on."""
    wheels = member.wheels
    if wheels is None:
        distance_gain, turn_gain = member.gains
        return (2 * distance_gain, 2 * turn_gain), _NO_WHEELS
    return (0.0, 0.0), (
        wheels.left_gain, wheels.right_gain, wheels.per_half_track, wheels.drift_gain,
        0.5 if wheels.exact else 0.0, wheels.fraction,
        wheels.dead_zone, wheels.followed, wheels.most, wheels.lag, sample_time,
    )  # fmt: skip


def _noise_rows(source: Bounded) -> list[float]:
    """The rows of `NoiseField`."""
    if source.distribution == "uniform":
        return [*source.bound, *[0.0] * 9]
    pairs = [probabilities(b, d) for b, d in zip(source.bound, source.deviation, strict=True)]
    inside, below = zip(*pairs, strict=True)
    return [*source.bound, *inside, *below, *source.deviation]
