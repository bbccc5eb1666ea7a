"""Experiments as vector lanes: how their numbers get there."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Disturbance, round_keys
from hilc_cli.engine.lanes.between import Planner
from hilc_cli.engine.lanes.kinds import Kind, Member
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
from hilc_cli.engine.lanes.parameters import parameter_rows
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import reference_twist
from hilc_cli.reference.sampled import Floats, Reference

NEVER = -1
_BY_WHEELS = [
    (slice(row, row + rows), slice(row + rows, row + 2 * rows))
    for row, rows in ((Field.MATRIX, 9), (Field.LATERAL, 1))
]
"""Parameters of the left wheel and of the right; in the lanes of the mean and half difference."""
_LINE = 64  # bytes; vectors that lie across two cache lines take twice as long


class Pack:
    """The arrays of up to LANES experiments of one kind; they are used again for the next ones.

    Attributes:
        kind: What the experiments have in common.
        desired: x [m], y [m] and heading [rad] of the reference, shape (n + 1,) each; where lanes
            have references of their own, of the longest.
        tracks: The same of each lane where they do, n + 1 rows of three; None where they share
            one. `twists` and `directions` then have numbers for each lane, too.
        decay: exp(-k d_t), shape (n,); None with Eq. 17.
        directions: Those of the reference, shape (n,), where a lateral gain follows them; None
            without one, and where they are all the same, so that the gain matrix has it.
        lanes: See `Field`, shape (FIELDS * LANES,); the other arrays are flat likewise.
        words: See `Words`.
        noise: See `lanes.Noise`.
        history: See `History`.
        sums: What metrics are made of in each lane's last iteration, in the order of `Sums`.
        last: Each lane's last iteration, shape (LANES,).
        planned: What is known before a pass where laws filter whole passes, rows as in the history;
            None where they do not.
        twists: Speed [m/s] and yaw rate [rad/s] of the reference, cosine and sine of its heading,
            four numbers for each sample; None for other laws than the tracking controller.
        late: By how many numbers of the history each lane's wheels are late, shape (LANES,); None
            for the paper's robot.
        late_alike: The same of all lanes; -1 where they differ.
        diverged_at: The iteration that left the finite numbers, NEVER if none, shape (LANES,).
    """

    def __init__(self, reference: Reference, kind: Kind) -> None:
        self.kind = kind
        # Copies, so that the machine code need not be compiled anew for arrays of another layout.
        self.desired = tuple(np.array(a) for a in (reference.x, reference.y, reference.heading))
        self.lanes = aligned(FIELDS * LANES, np.float64)
        self.words = aligned(WORD_ROWS * LANES, np.uint64)
        self.noise = aligned(NOISE_ROWS * LANES, np.float64)
        self.history = aligned((reference.samples + 3) * HISTORY_FIELDS * LANES, np.float64)
        self.sums = np.empty(SUM_ROWS * LANES)
        self.last = np.empty(LANES, dtype=np.int64)
        self.diverged_at = np.empty(LANES, dtype=np.int64)
        steps = reference.samples
        own = kind.own_reference
        self.tracks = aligned(3 * (steps + 1) * LANES, np.float64) if own else None
        planned = (steps + 1) * HISTORY_FIELDS * LANES
        self.planned = aligned(planned, np.float64) if kind.planned else None
        self._planner: Planner | None = None
        self.twists: Floats | None = None
        if kind.law is FeedbackLaw:
            self.twists = aligned(4 * steps * LANES, np.float64) if own else _twists(reference)
        self.late = None if kind.wheels is None else np.empty(LANES, dtype=np.int64)
        self.late_alike = -1
        self.decay = np.exp(-reference.times[:-1]) if kind.compensation else None
        self.directions: Floats | None = None
        self._direction = 0.0  # with which a lateral gain is in the matrix already
        if kind.lateral and own:
            self.directions = aligned(steps * LANES, np.float64)
        elif kind.lateral:
            directions = reference.directions
            if (directions == directions[0]).all():
                self._direction = float(directions[0])
            else:
                self.directions = directions

    def fill(self, members: Sequence[Member]) -> None:
        """Puts experiments into the lanes; empty lanes repeat the last of them."""
        experiments = [member.experiment for member in members]
        cases = len(experiments)
        last = [experiment.iterations for experiment in experiments]
        self.last[:cases], self.last[cases:] = last, NEVER
        rows = parameter_rows(members, self.kind, self._direction)
        lanes = self.lanes.reshape(FIELDS, LANES)
        for by_left, by_right in _BY_WHEELS:
            left, right = rows[:, by_left].copy(), rows[:, by_right]
            rows[:, by_left], rows[:, by_right] = (left + right) / 2, (left - right) / 2
        lanes[: rows.shape[1], :cases] = rows.T
        lanes[: rows.shape[1], cases:] = rows[-1][:, np.newaxis]
        if self.tracks is not None:
            for lane, experiment in enumerate(experiments):
                self._lay(experiment.reference, lane)
        if self.planned is not None:
            self._planner = Planner(members)
        if self.late is not None:
            self.late[:cases] = list(map(_numbers_late, members))
            self.late[cases:] = self.late[cases - 1]
            first = int(self.late[0])
            self.late_alike = first if (self.late == first).all() else -1
        if self.kind.drawn:
            words = _word_rows([experiment.disturbance for experiment in experiments])
            places = self.words.reshape(WORD_ROWS, LANES)[: len(words)]
            places[:, :cases], places[:, cases:] = words, words[:, -1:]
        self.restart(members)

    def restart(self, members: Sequence[Member]) -> None:
        """Sets the history to before iteration 0, and forgets what has been found out."""
        self.history[:] = 0.0
        self.sums[:] = np.nan
        self.diverged_at[:] = NEVER
        inputs = self.history.reshape(-1, HISTORY_FIELDS, LANES)[1:-2]
        known: dict[tuple[int, int], tuple[Floats, Floats] | None] = {}
        for lane, (experiment, *_) in enumerate(members):
            left, right = experiment.initial_left, experiment.initial_right
            # Most often the cases share their first input, and it is zero.
            both = id(left), id(right)
            if both not in known:
                zero = not (left.any() or right.any())
                known[both] = None if zero else ((left + right) / 2, (left - right) / 2)
            means = known[both]
            if means is not None:
                own = inputs[: len(left), :, lane]
                own[:, History.MEAN], own[:, History.HALF_DIFFERENCE] = means

    @property
    def reached(self) -> tuple[Floats, ...]:
        """`desired` up to the last sample that any lane reaches."""
        if not self.kind.own_reference:
            return self.desired
        most = int(self.lanes[Field.SAMPLES * LANES :][:LANES].max())
        return tuple(part[: most + 1] for part in self.desired)

    def _lay(self, reference: Reference, lane: int) -> None:
        """Puts a reference into a lane and those behind it; at its end it stands for ever."""
        n = reference.samples
        assert self.tracks is not None
        rows = self.tracks.reshape(-1, 3, LANES)[:, :, lane:]
        rows[: n + 1], rows[n + 1 :] = reference.poses[..., np.newaxis], rows[n]
        if self.twists is not None:
            twists = self.twists.reshape(-1, 4, LANES)[:, :, lane:]
            twists[:n], twists[n:] = _twists(reference).reshape(-1, 4, 1), 0.0
        if self.directions is not None:
            directions = self.directions.reshape(-1, LANES)[:, lane:]
            directions[:n], directions[n:] = reference.directions[:, np.newaxis], 0.0

    def plan(self, iteration: int) -> None:
        """Plans an iteration where laws filter whole passes."""
        if self._planner is None or self.planned is None:
            return
        if iteration == 0 and not self.kind.learn_in_first:
            self._planner.first(self.planned)
        else:
            self._planner.plan(self.history, self.planned)


def _twists(reference: Reference) -> Floats:
    """What `Pack.twists` tells of a reference, one sample after the other."""
    heading = reference.heading[:-1]
    columns = [*reference_twist(reference), np.cos(heading), np.sin(heading)]
    return np.stack(columns, axis=1).ravel()


def _numbers_late(member: Member) -> int:
    """How many numbers of the history an experiment's wheels are late, at most all of them."""
    assert member.wheels is not None  # of such a kind
    most = member.experiment.reference.samples + 1
    return min(member.wheels.whole, most) * HISTORY_FIELDS * LANES


def _word_rows(disturbances: Sequence[Disturbance]) -> NDArray[np.uint64]:
    """The rows of `Words` up to Words.PASS, shape (rows, disturbances)."""
    seeds = np.array([disturbance.seed for disturbance in disturbances], np.uint64)
    sources = zip(*((d.state, d.output, d.initial_pose) for d in disturbances), strict=True)
    frequencies = [[0 if source.repeat else 1 for source in of_all] for of_all in sources]
    return np.array([*itertools.chain(*round_keys(seeds)), *frequencies], np.uint64)


def aligned(count: int, kind: Any) -> NDArray[Any]:
    """An array of zeros, eight bytes each, that begins with a cache line."""
    spare = _LINE // 8
    array = np.zeros(count + spare, dtype=kind)
    first = -array.ctypes.data // 8 % spare
    return array[first : first + count]
