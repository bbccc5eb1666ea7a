"""Experiments as vector lanes: what can share them, and how its numbers get there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.normal import probabilities
from hilc_cli.disturbance.streams import Bounded, round_keys
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.lanes import (
    FIELDS,
    HISTORY_FIELDS,
    LANES,
    NOISE_ROWS,
    SUM_ROWS,
    WORD_ROWS,
    Field,
    History,
)
from hilc_cli.engine.lanes.noise import NONE, NORMAL, UNIFORM
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import GainHeading, LaneParameters
from hilc_cli.laws.hybrid import with_lateral_gain
from hilc_cli.numba_loading import DISABLED
from hilc_cli.reference.sampled import Floats, Reference

NEVER = -1
_ROUNDING = 2.0**-50
"""What the absolute values of a mean and half a difference may add to what they are made of."""
_BY_WHEELS = [
    (slice(row, row + rows), slice(row + rows, row + 2 * rows))
    for row, rows in ((Field.MATRIX, 9), (Field.LATERAL, 1))
]
"""Parameters of the left wheel and of the right; in the lanes of the mean and half difference."""
_LINE = 64  # bytes; vectors that lie across two cache lines take twice as long


class Kind(NamedTuple):
    """What experiments in the lanes of one pack have in common, beside the reference.

    Attributes:
        compensation: Whether they run Eq. 21, not Eq. 17.
        derivative: Whether they learn from the derivative of the error as well.
        gain_heading: As in `LaneParameters`.
        lateral: Whether an error aside turns the wheels as well.
        full_matrix: Whether the gain matrix has another form than that of Eq. 45.
        learn_in_first: As in `Experiment`.
        state: NONE, UNIFORM or NORMAL: the distribution of the state's disturbance.
        output: The distribution of the output's disturbance.
        pose: The distribution of the initial pose's disturbance.
    """

    compensation: bool
    derivative: bool
    gain_heading: GainHeading
    lateral: bool
    full_matrix: bool
    learn_in_first: bool
    state: int
    output: int
    pose: int

    @classmethod
    def of(cls, experiment: Experiment) -> Kind:
        """The kind of an experiment.

        Raises:
            UsageError: It has a law that the batch engine does not know.
        """
        law, disturbance = _known_parameters(experiment), experiment.disturbance
        return cls(
            law.compensation is not None,
            law.derivative != 0,
            law.gain_heading,
            law.lateral != 0,
            law.lateral != 0 or not law.matrix.is_kinematic,
            experiment.learn_in_first,
            _distribution(disturbance.state),
            _distribution(disturbance.output),
            _distribution(disturbance.initial_pose),
        )

    @property
    def disturbed(self) -> bool:
        """Whether anything is drawn at each sample."""
        return self.state != NONE or self.output != NONE

    @property
    def drawn(self) -> bool:
        """Whether anything is drawn at all."""
        return self.disturbed or self.pose != NONE


def knows(experiment: Experiment) -> bool:
    """Whether the batch engine runs here, and knows the experiment's law and plant."""
    offered = _lane_parameters(experiment) is not None and _lane_gains(experiment) is not None
    return offered and not DISABLED


def _lane_gains(experiment: Experiment) -> tuple[float, float] | None:
    """Returns the gains of the experiment's plant; None if it moves in a way not known here."""
    return experiment.plant.lane_gains(experiment.reference.sample_time)


def _lane_parameters(experiment: Experiment) -> LaneParameters | None:
    """Returns what the experiment's law offers to be run here; None if it offers nothing."""
    offer = getattr(experiment.law, "lane_parameters", None)
    return None if offer is None else offer()


def _known_parameters(experiment: Experiment) -> LaneParameters:
    """Returns the same of a law that offers something; of another one raises a UsageError."""
    parameters = _lane_parameters(experiment)
    if parameters is None:
        raise UsageError("the batch engine knows the hybrid law only")
    return parameters


def _distribution(source: Bounded) -> int:
    if not source.active:
        return NONE
    return UNIFORM if source.distribution == "uniform" else NORMAL


class Pack:
    """The arrays of up to LANES experiments of one kind; they are used again for the next ones.

    Attributes:
        kind: What the experiments have in common.
        sample_time: d_t [s] of the reference.
        desired: x [m], y [m] and heading [rad] of the reference, shape (n + 1,) each.
        decay: exp(-k d_t), shape (n,); None with Eq. 17.
        directions: Those of the reference, shape (n,), where a lateral gain follows them; None
            without one, and where they are all the same, so that the gain matrix has it.
        lanes: See `Field`, shape (FIELDS * LANES,); the other arrays are flat likewise.
        words: See `Words`.
        noise: See `lanes.Noise`.
        history: See `History`.
        sums: What metrics are made of in each lane's last iteration, in the order of `Sums`.
        last: Each lane's last iteration, shape (LANES,).
        diverged_at: The iteration that left the finite numbers, NEVER if none, shape (LANES,).
    """

    def __init__(self, reference: Reference, kind: Kind) -> None:
        self.kind, self.sample_time = kind, reference.sample_time
        # Copies, so that the machine code need not be compiled anew for arrays of another layout.
        self.desired = tuple(np.array(a) for a in (reference.x, reference.y, reference.heading))
        self.lanes = aligned(FIELDS * LANES, np.float64)
        self.words = aligned(WORD_ROWS * LANES, np.uint64)
        self.noise = aligned(NOISE_ROWS * LANES, np.float64)
        self.history = aligned((reference.samples + 2) * HISTORY_FIELDS * LANES, np.float64)
        self.sums = np.empty(SUM_ROWS * LANES)
        self.last = np.empty(LANES, dtype=np.int64)
        self.diverged_at = np.empty(LANES, dtype=np.int64)
        self.decay = np.exp(-reference.times[:-1]) if kind.compensation else None
        self.directions: Floats | None = None
        self._direction = 0.0  # with which a lateral gain is in the matrix already
        if kind.lateral:
            directions = reference.directions
            if (directions == directions[0]).all():
                self._direction = float(directions[0])
            else:
                self.directions = directions

    def fill(self, experiments: Sequence[Experiment]) -> None:
        """Puts experiments into the lanes; empty lanes repeat the last of them."""
        cases = len(experiments)
        last = [experiment.iterations for experiment in experiments]
        self.last[:cases], self.last[cases:] = last, NEVER
        rows = np.array([self._parameters(experiment) for experiment in experiments])
        lanes = self.lanes.reshape(FIELDS, LANES)
        for by_left, by_right in _BY_WHEELS:
            left, right = rows[:, by_left].copy(), rows[:, by_right]
            rows[:, by_left], rows[:, by_right] = (left + right) / 2, (left - right) / 2
        lanes[: rows.shape[1], :cases] = rows.T
        lanes[: rows.shape[1], cases:] = rows[-1][:, np.newaxis]
        if self.kind.drawn:
            words = np.array([_word_rows(experiment) for experiment in experiments], np.uint64)
            places = self.words.reshape(WORD_ROWS, LANES)
            places[: words.shape[1], :cases] = words.T
            places[: words.shape[1], cases:] = words[-1][:, np.newaxis]
        self.restart(experiments)

    def restart(self, experiments: Sequence[Experiment]) -> None:
        """Sets the history to before iteration 0, and forgets what has been found out."""
        self.history[:] = 0.0
        self.sums[:] = np.nan
        self.diverged_at[:] = NEVER
        inputs = self.history.reshape(-1, HISTORY_FIELDS, LANES)[1:-1]
        known: dict[tuple[int, int], tuple[Floats, Floats] | None] = {}
        for lane, experiment in enumerate(experiments):
            left, right = experiment.initial_left, experiment.initial_right
            # Most often the cases share their first input, and it is zero.
            both = id(left), id(right)
            if both not in known:
                zero = not (left.any() or right.any())
                known[both] = None if zero else ((left + right) / 2, (left - right) / 2)
            means = known[both]
            if means is not None:
                inputs[:, History.MEAN, lane], inputs[:, History.HALF_DIFFERENCE, lane] = means

    def _parameters(self, experiment: Experiment) -> list[float]:
        """The rows of the lane array up to Field.POSITION_GAINS; the matrix still by wheels."""
        law, gains = _known_parameters(experiment), _lane_gains(experiment)
        if gains is None:
            raise UsageError("the batch engine does not know the plant")
        distance_gain, turn_gain = gains
        sample_time, limit = self.sample_time, experiment.speed_limit
        length = law.compensation or 1  # which Eq. 17 does not look at
        peak = (law.derivative or 1.0) * (2 / (sample_time * length))
        parameters = [
            *law.gains, limit, limit * (1 + _ROUNDING),
            2 * distance_gain, 2 * turn_gain, length, peak, peak / length,
            law.derivative / sample_time,
            *experiment.initial_pose,
            *with_lateral_gain(law.matrix, self._direction * law.lateral).coefficients,
            law.lateral * law.matrix.left[2].constant, law.lateral * law.matrix.right[2].constant,
        ]  # fmt: skip
        if self.kind.drawn:
            disturbance = experiment.disturbance
            for source in (disturbance.state, disturbance.output, disturbance.initial_pose):
                parameters += _noise_rows(source)
        return parameters


def _noise_rows(source: Bounded) -> list[float]:
    """The rows of `NoiseField`."""
    if source.distribution == "uniform":
        return [*source.bound, *[0.0] * 9]
    pairs = [probabilities(b, d) for b, d in zip(source.bound, source.deviation, strict=True)]
    inside, below = zip(*pairs, strict=True)
    return [*source.bound, *inside, *below, *source.deviation]


def _word_rows(experiment: Experiment) -> list[int]:
    """The rows of `Words` up to Words.PASS."""
    disturbance = experiment.disturbance
    sources = (disturbance.state, disturbance.output, disturbance.initial_pose)
    keys = [word for pair in round_keys(disturbance.seed) for word in pair]
    return [*keys, *(0 if source.repeat else 1 for source in sources)]


def aligned(count: int, kind: Any) -> NDArray[Any]:
    """An array of zeros, eight bytes each, that begins with a cache line."""
    spare = _LINE // 8
    array = np.zeros(count + spare, dtype=kind)
    first = -array.ctypes.data // 8 % spare
    return array[first : first + count]
