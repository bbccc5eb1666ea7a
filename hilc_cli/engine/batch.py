"""The batch engine: many experiments at once, one per vector lane, metrics only."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.kernel import run_iteration
from hilc_cli.engine.lanes import FIELDS, HISTORY_FIELDS, LANES, Field, History
from hilc_cli.errors import UsageError
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import LARGEST, METRIC_NAMES
from hilc_cli.robot import step_gains

Integers = NDArray[np.int64]
NEVER = -1


@dataclass(frozen=True, slots=True, eq=False)
class BatchResult:
    """What is kept of each experiment of a batch.

    Attributes:
        final: Metrics of the last completed iteration, shape (cases, metrics), in the order of
            METRIC_NAMES; not-a-number if not even iteration 0 stayed within the finite numbers.
        errors: Largest position error [m] of each iteration, shape (cases, iterations + 1);
            not-a-number where an experiment has no such iteration.
        diverged_at: The iteration that left the finite numbers, shape (cases,); NEVER if none.
    """

    final: Floats
    errors: Floats
    diverged_at: Integers


def simulate_batch(experiments: Sequence[Experiment]) -> BatchResult:
    """Runs experiments side by side.

    Experiments that share their reference, law and kinds of disturbance share vector lanes;
    gains, matrices, limits, robots, poses, seeds and iterations are each experiment's own. The
    result of an experiment does not depend on which others are run with it.

    Args:
        experiments: At least one, each with the hybrid law.

    Raises:
        UsageError: An experiment has a law that this engine does not know.
    """
    cases = len(experiments)
    most = max(experiment.iterations for experiment in experiments)
    final = np.full((cases, len(METRIC_NAMES)), np.nan)
    errors = np.full((cases, most + 1), np.nan)
    diverged_at = np.full(cases, NEVER)
    for members in _groups(experiments):
        for first in range(0, len(members), LANES):
            numbers = members[first : first + LANES]
            pack = _Pack([experiments[number] for number in numbers])
            pack.run()
            for lane, number in enumerate(numbers):
                final[number] = pack.final[:, lane]
                last = experiments[number].iterations
                errors[number, : last + 1] = pack.errors[: last + 1, lane]
                diverged_at[number] = pack.diverged_at[lane]
    return BatchResult(final, errors, diverged_at)


def _groups(experiments: Sequence[Experiment]) -> Iterator[list[int]]:
    """Numbers of the experiments that can share lanes."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for number, experiment in enumerate(experiments):
        law, disturbance = _law(experiment), experiment.disturbance
        kind = (
            id(experiment.reference),
            law.compensation,
            law.gain_heading,
            law.matrix.is_kinematic,
            experiment.learn_in_first,
            disturbance.state.active,
            disturbance.output.active,
        )
        groups.setdefault(kind, []).append(number)
    yield from groups.values()


def _law(experiment: Experiment) -> HybridLaw:
    if not isinstance(experiment.law, HybridLaw):
        raise UsageError("the batch engine knows the hybrid law only")
    return experiment.law


class _Pack:
    """Up to LANES experiments of one kind; empty lanes repeat the first."""

    def __init__(self, experiments: Sequence[Experiment]) -> None:
        self.experiments = [*experiments, *[experiments[0]] * (LANES - len(experiments))]
        first = self.experiments[0]
        self.reference = first.reference
        self.last = np.array([experiment.iterations for experiment in self.experiments])
        self.final = np.full((len(METRIC_NAMES), LANES), np.nan)
        self.errors = np.full((int(self.last.max()) + 1, LANES), np.nan)
        self.diverged_at = np.full(LANES, NEVER)
        self.lanes = np.zeros((FIELDS, LANES))
        steps = self.reference.samples
        self.history = np.zeros((steps + 1, HISTORY_FIELDS, LANES))
        for lane, experiment in enumerate(self.experiments):
            self._fill(lane, experiment)
        self.scattered = any(e.disturbance.initial_pose.active for e in self.experiments)
        law = _law(first)
        self.full_matrix = None if law.matrix.is_kinematic else True
        times = np.arange(steps) * self.reference.sample_time
        self.decay = np.exp(-times) if law.compensation else None
        self.reference_heading = True if law.gain_heading == "reference" else None
        self.previous_heading = True if law.gain_heading == "previous" else None

    def _fill(self, lane: int, experiment: Experiment) -> None:
        law, robot = _law(experiment), experiment.robot
        column = self.lanes[:, lane]
        column[Field.L1], column[Field.L2], column[Field.L3] = law.l1, law.l2, law.l3
        column[Field.SPEED_LIMIT] = experiment.speed_limit
        column[Field.DISTANCE_GAIN], column[Field.TURN_GAIN] = step_gains(
            robot.wheel_radius, robot.signed_half_track, self.reference.sample_time
        )
        peak = 2 / (self.reference.sample_time * law.h)
        column[Field.H], column[Field.PEAK], column[Field.SLOPE] = law.h, peak, peak / law.h
        column[Field.MATRIX : Field.MATRIX + 18] = law.matrix.coefficients
        self.history[:-1, History.LEFT, lane] = experiment.initial_left
        self.history[:-1, History.RIGHT, lane] = experiment.initial_right

    def run(self) -> None:
        """Runs all iterations; lanes that have diverged are run again up to where they did."""
        start = self.history.copy()
        self._run(self.last)
        gone = self.diverged_at >= 0
        if gone.any():
            final, diverged_at, errors = self.final.copy(), self.diverged_at.copy(), self.errors
            self.history[:] = start
            self.errors = errors.copy()
            self._run(np.where(gone, diverged_at - 1, NEVER))
            self.final = np.where(gone, self.final, final)
            self.diverged_at, self.errors = diverged_at, errors

    def _run(self, last: Integers) -> None:
        """Runs as many iterations as asked for, noting metrics at each lane's last."""
        first = self.experiments[0]
        gains = self.lanes[: Field.L3 + 1].copy()
        self.final[:] = np.nan
        for iteration in range(int(last.max()) + 1):
            closed = iteration > 0 or first.learn_in_first
            self.lanes[: Field.L3 + 1] = gains if closed else 0.0
            self._place_at_start(iteration)
            ends = last == iteration
            with np.errstate(all="ignore"):
                run_iteration(
                    self.lanes.ravel(),
                    self.history.ravel(),
                    self.reference.x,
                    self.reference.y,
                    self.reference.heading,
                    self.full_matrix,
                    self.decay,
                    self.reference_heading,
                    self.previous_heading,
                    self._noise(iteration, "output"),
                    self._noise(iteration, "state"),
                    True if ends.any() else None,
                )
            self._note(iteration, ends)
        self.lanes[: Field.L3 + 1] = gains

    def _place_at_start(self, iteration: int) -> None:
        """Puts each lane at its initial pose, which changes only where it is disturbed."""
        if iteration > 0 and not self.scattered:
            return
        for lane, experiment in enumerate(self.experiments):
            offset = experiment.disturbance.of_initial_pose(iteration)
            pose = [p + o for p, o in zip(experiment.initial_pose, offset, strict=True)]
            self.lanes[Field.START_X : Field.START_HEADING + 1, lane] = pose

    def _noise(self, iteration: int, kind: str) -> Floats | None:
        disturbance = self.experiments[0].disturbance
        steps = self.reference.samples
        if not getattr(disturbance, kind).active:
            return None
        count = steps if kind == "state" else steps + 1
        noise = np.empty((count, 3, LANES))
        for lane, experiment in enumerate(self.experiments):
            draw = getattr(experiment.disturbance, f"of_{kind}")
            noise[:, :, lane] = draw(iteration, count)
        return noise.ravel()

    def _note(self, iteration: int, ends: NDArray[np.bool_]) -> None:
        lanes, samples = self.lanes, self.reference.samples
        largest = np.sqrt(lanes[Field.LARGEST_SQUARE])
        state = np.abs(lanes[Field.X : Field.HEADING + 1]).max(axis=0)
        sane = (largest <= LARGEST) & (state <= LARGEST)
        lost = (self.diverged_at < 0) & ~sane & (iteration <= self.last)
        self.diverged_at[lost] = iteration
        self.errors[iteration] = np.where(self.diverged_at < 0, largest, np.nan)
        if not ends.any():
            return
        change = lanes[Field.CHANGE_SQUARES] if iteration > 0 else np.zeros(LANES)
        metrics = {
            "max_position_error_m": largest,
            "mean_position_error_m": lanes[Field.ERROR_SUM] / (samples + 1),
            "rms_position_error_m": np.sqrt(lanes[Field.SQUARE_SUM] / (samples + 1)),
            "final_position_error_m": np.hypot(
                self.reference.x[-1] - lanes[Field.X], self.reference.y[-1] - lanes[Field.Y]
            ),
            "max_abs_error_x_m": lanes[Field.LARGEST_X],
            "max_abs_error_y_m": lanes[Field.LARGEST_Y],
            "max_abs_error_heading_rad": lanes[Field.LARGEST_HEADING],
            "max_wheel_speed_rad_s": lanes[Field.FASTEST_WHEEL],
            "saturated_samples": lanes[Field.SATURATED],
            "input_change_rms_rad_s": np.sqrt(change / (2 * samples)),
        }
        for row, name in enumerate(METRIC_NAMES):
            self.final[row, ends] = metrics[name][ends]
