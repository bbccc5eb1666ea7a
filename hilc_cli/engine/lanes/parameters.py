"""The parameters of an experiment as rows of the lane array."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hilc_cli.disturbance.normal import probabilities
from hilc_cli.disturbance.streams import Bounded
from hilc_cli.engine.lanes.kinds import Kind, LaneLaw, Member
from hilc_cli.engine.lanes.lanes import Field
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.gain_matrix import Coefficients, model_gain
from hilc_cli.laws.hybrid import with_lateral_gain
from hilc_cli.laws.pid import PidLaw
from hilc_cli.reference.sampled import Floats

_ROUNDING = 2.0**-50
"""What the absolute values of a mean and half a difference may add to what they are made of."""
_NONE = (0.0, 0.0, 0.0)
_NO_WHEELS = (0.0,) * (Field.SAMPLES - Field.LEFT_GAIN)


def parameter_rows(members: Sequence[Member], kind: Kind, direction: float) -> Floats:
    """Returns the rows up to Field.POSITION_GAINS, or to Field.STATE if nothing is drawn.

    Of the matrix and the lateral gain they are those of the wheels. What experiments have in common
    beside their law is put into numbers once.

    Args:
        members: Of the kind.
        kind: Of the members.
        direction: By which a lateral gain comes to the gain matrix, see `LaneParameters`.

    Returns:
        Shape (members, rows).
    """
    laws, rest = [], []
    others: dict[tuple[float, ...], list[float]] = {}
    for member in members:
        experiment = member.experiment
        reference, disturbance = experiment.reference, experiment.disturbance
        laws.append(_law_rows(member.law, kind, direction, reference.sample_time))
        part = (
            experiment.speed_limit,
            *map(
                id, (reference, member.wheels, member.gains, experiment.initial_pose, disturbance)
            ),
        )
        if part not in others:
            others[part] = _other_rows(member, kind)
        rest.append(others[part])
    return np.hstack([np.array(laws), np.array(rest)])


def _other_rows(member: Member, kind: Kind) -> list[float]:
    """Those behind the law's."""
    experiment, limit = member.experiment, member.experiment.speed_limit
    reference, disturbance = experiment.reference, experiment.disturbance
    gains, wheels = _motion(member, reference.sample_time)
    rows = [limit, limit * (1 + _ROUNDING), *gains, *experiment.initial_pose]
    rows += [*wheels, reference.samples]
    if kind.drawn:
        for source in (disturbance.state, disturbance.output, disturbance.initial_pose):
            rows += _noise_rows(source)
    return rows


def _rows_of(
    gains: tuple[float, float, float],
    matrix: Coefficients,
    falling: tuple[float, float, float] = (1.0, 0.0, 0.0),
    rate: float = 0.0,
    lateral: tuple[float, float] = (0.0, 0.0),
    forgotten: float = 0.0,
    tracking: tuple[float, float, float] = _NONE,
) -> list[float]:
    """Those of a law; ``falling`` are H, PEAK and SLOPE."""
    return [*gains, *falling, rate, *matrix, *lateral, forgotten, *tracking]


def _law_rows(law: LaneLaw, kind: Kind, direction: float, sample_time: float) -> list[float]:
    if isinstance(law, FeedbackLaw):
        # Eq. 45 makes wheel speeds of the mean and of half the difference, too.
        tracking, matrix = (law.k_x, law.k_y, law.k_theta), model_gain(law.model).coefficients
        return _rows_of((1.0, 0.0, 0.0), matrix, forgotten=1.0, tracking=tracking)
    if isinstance(law, PidLaw):
        matrix = law.matrix.coefficients
        if kind.planned:
            return _rows_of((1.0, 0.0, 0.0), matrix)
        gains = law.kp, law.ki * sample_time, law.kd / sample_time
        h = law.rectifying or 1  # which is not looked at without a pulse
        return _rows_of(gains, matrix, (h, 2 / h, 0.0), forgotten=law.forgetting)
    h = law.compensation or 1  # which Eq. 17 does not look at
    peak = (law.derivative or 1.0) * (2 / (sample_time * h))
    return _rows_of(
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
    if source.distribution == "uniform" or not source.active:
        # Where others draw from the normal distribution, the middle of none: zero.
        return [*source.bound, *_NONE, *[0.5] * 3, *_NONE]
    pairs = [probabilities(b, d) for b, d in zip(source.bound, source.deviation, strict=True)]
    inside, below = zip(*pairs, strict=True)
    return [*source.bound, *inside, *below, *source.deviation]
