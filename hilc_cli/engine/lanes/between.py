"""What laws do with whole passes between them: what is known of the next one, through the Q-filter.

The filter of `LowPass` multiplies a mirrored signal's cosines by 1 / (1 + (tan(w / 2) / c)^4). With
the mirrored second difference L, whose eigenvalues are 2 - 2 cos w, and S = 4 - L, that is

    S^2 / (S^2 + L^2 / c^4) = S Re (S + i L / c^2)^-1,

so that each signal takes one tridiagonal system of complex numbers, S + i L / c^2, and its product
with S. The system has e = 1 - i / c^2 beside the diagonal, and adds up to 4 along each row. What
elimination leaves on the diagonal, p, is -e and little more where c is small: so what is computed
is q = p + e, of which nothing cancels. The first is 4, and each of the next follows from the last,

    q(k) = 4 + r(k - 1) q(k - 1),  r = 1 / (1 - q / e) = -e / p.

With r, elimination is y(k) = v(k) + r(k - 1) y(k - 1), and going back
z(k) = r(k) (z(k + 1) - y(k) / e). At the mirror behind the last sample the diagonal has another e,
which makes p(n - 1) = q(n - 1).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hilc_cli.engine.lanes.kinds import Member
from hilc_cli.engine.lanes.lanes import HISTORY_FIELDS, LANES, History
from hilc_cli.engine.lanes.machine_code import cached, formula, use_widest_vectors
from hilc_cli.laws.pid import PidLaw, combined
from hilc_cli.reference.sampled import Floats

_combined = formula(combined)

W = LANES
ROW = HISTORY_FIELDS * W
MEAN, ERROR = int(History.MEAN) * W, int(History.ERROR) * W

# Rows of the lanes' numbers: parameters; then, of the running pass, sums of the errors and those at
# the start; q, and r at the last sample; z at the next sample, and its real part at the one behind.
KP, KI, KD, KEPT, SMOOTHED = 0, W, 2 * W, 3 * W, 4 * W
E, PER_E, SAMPLES = 5 * W, 7 * W, 9 * W  # e and its reciprocal are complex
PARAMETER_ROWS = 10
SUM, FIRST, Q, LAST_RATIO, Z, BEHIND = 10 * W, 13 * W, 16 * W, 18 * W, 20 * W, 30 * W
NUMBER_ROWS = 35

# Rows of what is added for each sample: to the mean and half difference of the inputs; and what the
# initial errors are multiplied by beside kd.
RETURNED, PULSE = 0, 2 * W
ADDED = 3 * W

# Rows of what elimination leaves of each sample: r, and y of the five signals; complex. Those of
# sample k come behind k + 1 times as many: the first are zeros, and so are those behind the last.
Y = 2 * W
LEFT = 12 * W


def _times(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """The product of two complex numbers, a + ib and c + id."""
    return a * c - b * d, a * d + b * c


_product = formula(_times)


def _weigh(now: Floats, numbers: Floats, j: int, c: int, pulse: float) -> float:
    """One component of the weighted error of `laws.pid`, c rows behind that in x."""
    error = now[ROW + ERROR + c + j]
    total = numbers[SUM + c + j] + error
    numbers[SUM + c + j] = total
    change = error - now[ERROR + c + j] + pulse * numbers[FIRST + c + j]
    weighted: float = _combined(
        numbers[KP + j], error, numbers[KI + j], total, numbers[KD + j], change
    )
    return weighted


_weighed = formula(_weigh)


def _eliminate(left: Floats, at: int, ratio: float, ratio_i: float, known: float) -> None:
    """Sets y of a signal from that of the sample before."""
    y, y_i = _product(ratio, ratio_i, left[at], left[at + W])
    left[at + LEFT], left[at + LEFT + W] = known + y, y_i


_eliminated = formula(_eliminate)


def _forth(history: Floats, added: Floats, left: Floats, numbers: Floats) -> None:
    """Forms what is known of each sample, and eliminates.

    Args:
        history: See `History`, of the pass before.
        added: 3 rows of each sample, see RETURNED.
        left: 12 rows of each sample between those that are zero, set, see Y.
        numbers: Rows KP to BEHIND; those behind the parameters are set.
    """
    use_widest_vectors()
    for j in range(3 * W):
        numbers[FIRST + j] = history[ROW + ERROR + j]
        numbers[SUM + j] = history[ROW + ERROR + j]
    for j in range(Q, NUMBER_ROWS * W):
        numbers[j] = 0.0
    for k in range(len(left) // LEFT - 2):
        # Few arrays, and places in them that are plain numbers: or the compiler finds no vectors.
        here, now, addition = left[k * LEFT :], history[(k + 1) * ROW :], added[k * ADDED :]
        last = float(k + 1)
        for j in range(W):
            smoothed = numbers[SMOOTHED + j] > 0
            # r(k - 1); zero without a filter, and at the start.
            q, q_i = _product(here[j], here[W + j], numbers[Q + j], numbers[Q + W + j])
            q += 4.0
            numbers[Q + j], numbers[Q + W + j] = q, q_i
            by_e, by_e_i = _product(q, q_i, numbers[PER_E + j], numbers[PER_E + W + j])
            rest, rest_i = 1.0 - by_e, -by_e_i
            per_square = 1.0 / (rest * rest + rest_i * rest_i)
            here[LEFT + j] = rest * per_square if smoothed else 0.0
            here[LEFT + W + j] = -rest_i * per_square if smoothed else 0.0
            # At the last sample -e / q.
            per_size = 1.0 / (q * q + q_i * q_i)
            last_ratio, last_ratio_i = _product(
                -numbers[E + j], -numbers[E + W + j], q * per_size, -q_i * per_size
            )
            is_last = numbers[SAMPLES + j] == last
            numbers[LAST_RATIO + j] = last_ratio if is_last else numbers[LAST_RATIO + j]
            numbers[LAST_RATIO + W + j] = last_ratio_i if is_last else numbers[LAST_RATIO + W + j]
        for j in range(W):
            ratio, ratio_i, kept = here[j], here[W + j], numbers[KEPT + j]
            for_mean = kept * now[j] + addition[RETURNED + j]
            for_difference = kept * now[W + j] + addition[RETURNED + W + j]
            _eliminated(here, Y + j, ratio, ratio_i, for_mean)
            _eliminated(here, Y + 2 * W + j, ratio, ratio_i, for_difference)
        for j in range(W):
            ratio, ratio_i, pulse = here[j], here[W + j], addition[PULSE + j]
            known = _weighed(now, numbers, j, 0, pulse)
            _eliminated(here, Y + 4 * W + j, ratio, ratio_i, known)
            known = _weighed(now, numbers, j, W, pulse)
            _eliminated(here, Y + 6 * W + j, ratio, ratio_i, known)
            known = _weighed(now, numbers, j, 2 * W, pulse)
            _eliminated(here, Y + 8 * W + j, ratio, ratio_i, known)


def _step_back(
    here: Floats,
    numbers: Floats,
    planned: Floats,
    ratio: float,
    ratio_i: float,
    is_last: bool,
    is_there: bool,
    s: int,
    j: int,
) -> None:
    """Sets z of a signal from that of the next sample, for which it sets what is planned."""
    next_z, next_z_i = numbers[Z + 2 * s + j], numbers[Z + 2 * s + W + j]
    from_y, from_y_i = _product(
        here[Y + 2 * s + j], here[Y + 2 * s + W + j],
        numbers[PER_E + j], numbers[PER_E + W + j],
    )  # fmt: skip
    z, z_i = _product(ratio, ratio_i, next_z - from_y, next_z_i - from_y_i)
    z, z_i = (z if is_there else 0.0), (z_i if is_there else 0.0)
    behind = numbers[BEHIND + s + j]
    # At the last sample its mirror image.
    numbers[BEHIND + s + j] = z if is_last else next_z
    numbers[Z + 2 * s + j], numbers[Z + 2 * s + W + j] = z, z_i
    filtered, as_it_is = 2.0 * next_z + (z + behind), here[LEFT + Y + 2 * s + j]
    planned[s + j] = filtered if numbers[SMOOTHED + j] > 0 else as_it_is


_stepped_back = formula(_step_back)


def _back(left: Floats, numbers: Floats, planned: Floats) -> None:
    """Goes back, and sets what is known before the next pass.

    Args:
        left: What elimination has left.
        numbers: Rows KP to BEHIND.
        planned: n + 1 rows as in the history; behind the last sample it is left as it comes.
    """
    use_widest_vectors()
    n = len(left) // LEFT - 2
    for step in range(n):
        k = n - 1 - step
        # Of this sample and the next; what is planned is for the next.
        here, there = left[(k + 1) * LEFT :], planned[(k + 1) * ROW :]
        number = float(k + 1)
        for j in range(W):
            samples = numbers[SAMPLES + j]
            is_last, is_there = number == samples, number <= samples
            ratio, ratio_i = here[j], here[W + j]
            last_ratio, last_ratio_i = numbers[LAST_RATIO + j], numbers[LAST_RATIO + W + j]
            ratio = last_ratio if is_last else ratio
            ratio_i = last_ratio_i if is_last else ratio_i
            _stepped_back(here, numbers, there, ratio, ratio_i, is_last, is_there, 0, j)
            _stepped_back(here, numbers, there, ratio, ratio_i, is_last, is_there, W, j)
            _stepped_back(here, numbers, there, ratio, ratio_i, is_last, is_there, 2 * W, j)
            _stepped_back(here, numbers, there, ratio, ratio_i, is_last, is_there, 3 * W, j)
            _stepped_back(here, numbers, there, ratio, ratio_i, is_last, is_there, 4 * W, j)
    for j in range(W):
        for s in range(5):
            # Before the first sample is its mirror image.
            first, second = numbers[Z + 2 * s * W + j], numbers[BEHIND + s * W + j]
            as_it_is = left[LEFT + Y + 2 * s * W + j]
            planned[s * W + j] = 3.0 * first + second if numbers[SMOOTHED + j] > 0 else as_it_is


# History stands for the file that says how lanes are laid out.
forth, back = cached(_forth, [combined, History]), cached(_back, [combined, History])


class Planner:
    """Plans the next pass of all lanes from the history of the one before."""

    def __init__(self, members: Sequence[Member]) -> None:
        """Takes the experiments of the first lanes; the other lanes get the plan of the last."""
        n = max(member.experiment.reference.samples for member in members)
        inputs, added = np.zeros((n, 2, W)), np.zeros((n, 3, W))
        parameters = np.zeros((PARAMETER_ROWS, W))
        for lane, (experiment, law, *_) in enumerate(members):
            reference = experiment.reference
            assert isinstance(law, PidLaw)  # no other law is of this kind
            samples, sample_time = reference.samples, reference.sample_time
            parameters[:, lane:] = np.array(_parameters(law, samples, sample_time))[:, np.newaxis]
            left, right = experiment.initial_left, experiment.initial_right
            means = np.stack([left + right, left - right], axis=1) / 2
            inputs[:, :, lane:], added[:, :, lane:] = 0.0, 0.0
            inputs[:samples, :, lane:] = means[:, :, np.newaxis]
            added[:, :2, lane:] = law.forgetting * inputs[:, :, lane:]
            pulse = law.pulse(samples, sample_time)
            if pulse is not None:
                added[:samples, 2, lane:] = sample_time * pulse[:, np.newaxis]
        self._inputs, self._added = inputs, added.ravel()
        self._numbers = np.concatenate(
            [parameters.ravel(), np.empty((NUMBER_ROWS - PARAMETER_ROWS) * W)]
        )
        self._left = np.zeros((n + 2) * LEFT)

    def first(self, planned: Floats) -> None:
        """Plans to send the first input as it is."""
        rows = planned.reshape(-1, HISTORY_FIELDS, W)[: len(self._inputs)]
        rows[:, : History.ERROR], rows[:, History.ERROR :] = self._inputs, 0.0

    def plan(self, history: Floats, planned: Floats) -> None:
        """Plans the pass after one.

        Args:
            history: See `History`.
            planned: Where the plan goes, n + 1 rows as in the history.
        """
        forth(history, self._added, self._left, self._numbers)
        back(self._left, self._numbers, planned)


def _parameters(law: PidLaw, samples: int, sample_time: float) -> list[float]:
    """The rows of a lane's parameters."""
    kept = 1 - law.forgetting
    gains = law.kp, law.ki * sample_time, law.kd / sample_time
    if law.cutoff is None:
        return [*gains, kept, 0.0, 1.0, 0.0, 1.0, 0.0, samples]
    e = complex(1.0, -1 / math.tan(math.pi * law.cutoff * sample_time) ** 2)
    per_e = 1 / e
    return [*gains, kept, 1.0, e.real, e.imag, per_e.real, per_e.imag, samples]
