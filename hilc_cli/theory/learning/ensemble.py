"""Learning with disturbances and within the speed limit, by the linear theory.

Many seeds side by side: each iteration of `LiftedIteration` gets disturbances of its own, and wheel
speeds are held within the limit. What is linear in the errors stays so: the plant along the
reference, and the gain matrix at the reference's heading.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import active_sources
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.matrices import driven_errors, times
from hilc_cli.theory.noise import SEEDS, DisturbanceDraws, changes_beside_first

_MOST_STEPS = 30_000
"""Samples that may be followed one by one: about 1 s. More is done without the limit."""
_MOST_SAMPLES = 6_000_000
"""Samples of all iterations and seeds, 1 to 2.5 s: what is longer is not followed to its end."""
_SAMPLES_AS_LONG_AS_A_CALL = 300
"""What an iteration costs beside its samples, counted in samples."""
_FEWEST = 7
"""Seeds where more would take too long."""
_WITHIN = 1e-9  # relative: a limit that is met exactly is met in spite of rounding


@dataclass(frozen=True, slots=True, eq=False)
class NoisyLearning:
    """Errors of all iterations, a column for each seed; the first one is not disturbed.

    Attributes:
        position_m: Largest position error of each iteration [m], shape (N + 1, seeds).
        heading_rad: Likewise of the heading.
        at_limit: Share of samples whose wheel speeds are held by the limit, likewise.
        change_rad_s: RMS change of the last iteration's wheel speeds from sample to sample beside
            those of the first seed [rad/s], shape (seeds,).
        is_limited: Whether the limit was kept; if not, what is told of it is too high.
    """

    position_m: Floats
    heading_rad: Floats
    at_limit: Floats
    change_rad_s: Floats
    is_limited: bool

    @property
    def iterations(self) -> int:
        """The last iteration, that of the experiment if it could be followed so far."""
        return len(self.position_m) - 1

    @property
    def seeds(self) -> int:
        """Number of columns; 1 without disturbances."""
        return int(self.position_m.shape[1])

    @property
    def final_m(self) -> Floats:
        """Largest position error of the last iteration [m], shape (seeds,)."""
        last: Floats = self.position_m[-1]
        return last


def noisy_learning(experiment: Experiment, seeds: int = SEEDS) -> NoisyLearning:
    """Returns the errors of an experiment of the laws hybrid and pid.

    Args:
        experiment: With its disturbances and its limit.
        seeds: How many are followed, the first of them without disturbances; one where there are
            none. The draws are the same in each call, and those of no run.
    """
    samples = experiment.reference.samples + _SAMPLES_AS_LONG_AS_A_CALL
    if not active_sources(experiment.disturbance):
        seeds = 1
    elif seeds * samples * (experiment.iterations + 1) > _MOST_SAMPLES:
        seeds = _FEWEST
    iterations = min(experiment.iterations, _MOST_SAMPLES // (samples * seeds))
    return _Ensemble(experiment, seeds).learned(iterations)


class _Ensemble:
    """Iterations of all seeds at once: inputs (n, 2, seeds), errors (n + 1, 3, seeds)."""

    def __init__(self, experiment: Experiment, seeds: int) -> None:
        self._experiment, self._seeds = experiment, seeds
        self._lifted = LiftedIteration(experiment)
        self._draws = DisturbanceDraws(experiment.disturbance, seeds)
        self._limit = experiment.speed_limit
        self._held_from = self._limit * (1 + _WITHIN)
        self._steps_left = _MOST_STEPS
        self._is_limited = True
        plant = self._lifted.plant
        self._gains = np.ascontiguousarray(self._lifted.gains)
        self._inputs = np.ascontiguousarray(plant.inputs)
        self._loop = self._inputs @ self._gains
        self._feedforward = plant.feedforward[:, :, None]

    def learned(self, last: int) -> NoisyLearning:
        shape = last + 1, self._seeds
        position, heading, held = np.full(shape, np.inf), np.full(shape, np.inf), np.zeros(shape)
        lifted, n = self._lifted, self._lifted.samples
        inputs = np.repeat(lifted.first_input[:, :, None], self._seeds, axis=2)
        seen: Floats = np.zeros((n + 1, 3, self._seeds))
        with np.errstate(over="ignore", invalid="ignore"):
            for iteration in range(last + 1):
                open_loop = iteration == 0 and not self._experiment.learn_in_first
                if not open_loop:
                    inputs = lifted.law.learned(inputs, seen)
                    if lifted.added is not None:
                        inputs = inputs + lifted.added[:, :, None]
                start, state, output = (
                    self._draws.start.drawn(1),
                    self._draws.state.drawn(n),
                    self._draws.output.drawn(n + 1),
                )
                feeds = lifted.has_feedback and not open_loop
                inputs, errors, held[iteration] = self._pass(inputs, start, state, output, feeds)
                if not np.isfinite(errors).all():
                    break
                exact = None if feeds else self._driven(inputs, start, state)
                far = errors if exact is None else exact
                position[iteration] = np.sqrt((far[:, 0] ** 2 + far[:, 1] ** 2).max(axis=0))
                heading[iteration] = np.abs(errors[:, 2]).max(axis=0)
                seen = errors if output is None else errors - output
            changes = changes_beside_first(inputs)
        return NoisyLearning(position, heading, held, changes, self._is_limited)

    def _pass(
        self,
        inputs: Floats,
        start: Floats | None,
        state: Floats | None,
        output: Floats | None,
        feeds: bool,
    ) -> tuple[Floats, Floats, Floats]:
        """Returns inputs as applied, errors, and the share of samples at the limit."""
        lifted, n = self._lifted, self._lifted.samples
        # Columns of a single seed lie together in memory, else its seeds.
        right = np.empty((n + 1, 3, self._seeds), order="F" if self._seeds == 1 else "C")
        right[0] = lifted.start[:, None] if start is None else lifted.start[:, None] - start[0]
        right[1:] = lifted.plant.residual[:, :, None]
        if state is not None:
            right[1:] -= state
        if not feeds:
            applied, held = self._within(inputs)
            right[1:] -= self._moved(applied)
            return applied, lifted.open_loop.solve(right), held
        plain = right.copy(order="K")
        plain[1:] -= self._moved(inputs)
        if output is not None:
            plain[1:] += lifted.l2 * (self._loop @ output[:-1])
            plain[2:] += lifted.l3 * (self._loop[1:] @ output[:-2])
        errors = lifted.closed_loop.solve(plain)
        seen = errors[:-1] if output is None else (errors - output)[:-1]
        fed = lifted.l2 * seen
        fed[1:] += lifted.l3 * seen[:-1]
        demanded = inputs + self._gains @ fed
        applied, held = self._within(demanded)
        if not held.any():
            return demanded, errors, held
        if self._steps_left < n:
            self._is_limited = False
            return demanded, errors, held
        self._steps_left -= n
        return self._one_by_one(inputs, right, output)

    def _moved(self, inputs: Floats) -> Floats:
        """Returns what inputs move in each sample."""
        if self._seeds == 1:
            return times(self._lifted.plant.inputs, inputs)
        moved: Floats = self._inputs @ inputs
        return moved

    def _within(self, inputs: Floats) -> tuple[Floats, Floats]:
        """Returns inputs within the limit, and the share of samples at which it acts."""
        if not np.isfinite(self._limit):
            return inputs, np.zeros(self._seeds)
        speeds = inputs + self._feedforward
        left, right = np.abs(speeds[:, 0]), np.abs(speeds[:, 1])
        fastest = np.maximum(left, right)
        held = fastest > self._held_from
        if not held.any():
            return inputs, np.zeros(self._seeds)
        scale = np.where(held, self._limit / np.maximum(fastest, self._limit), 1.0)
        return speeds * scale[:, None] - self._feedforward, held.mean(axis=0)

    def _one_by_one(
        self, inputs: Floats, right: Floats, output: Floats | None
    ) -> tuple[Floats, Floats, Floats]:
        """Returns the same of a pass with feedback within the limit, sample by sample."""
        lifted, n = self._lifted, self._lifted.samples
        errors, applied = np.empty_like(right), np.empty_like(inputs)
        held = np.zeros(self._seeds)
        states = lifted.plant.states
        errors[0] = now = right[0]
        before = np.zeros_like(now)
        wanted = inputs + self._feedforward
        for k in range(n):
            seen = now if output is None else now - output[k]
            speeds = wanted[k] + self._gains[k] @ (lifted.l2 * seen + lifted.l3 * before)
            before = seen
            fastest = np.abs(speeds).max(axis=0)
            beyond = fastest > self._held_from
            if beyond.any():
                held += beyond
                speeds = speeds * np.where(
                    beyond, self._limit / np.maximum(fastest, self._limit), 1.0
                )
            applied[k] = speeds - self._feedforward[k]
            now = states[k] @ now - self._inputs[k] @ applied[k] + right[k + 1]
            errors[k + 1] = now
        return applied, errors, held / n

    def _driven(self, inputs: Floats, start: Floats | None, state: Floats | None) -> Floats:
        """Returns errors of the exact plant that drives the inputs, shape (n + 1, 2, seeds)."""
        poses = np.tile(np.array(self._experiment.initial_pose)[:, None], self._seeds)
        if start is not None:
            poses += start[0]
        left, right = np.moveaxis(inputs + self._feedforward, 1, 0)
        errors = driven_errors(self._experiment, left, right, poses, state)
        return np.stack(errors, axis=1)
