"""What laws do with whole passes between them, in NumPy: a lane at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.kinds import known_parameters
from hilc_cli.engine.lanes.lanes import HISTORY_FIELDS, LANES
from hilc_cli.laws.law import Iteration, Task
from hilc_cli.laws.pid import PidLaw, Smoothing
from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True)
class _Lane:
    """A law that plans; its wheels are the mean of both and half their difference.

    Attributes:
        law: The law.
        task: What it knows before the first pass.
        smoothed: Its Q-filter; None for none.
    """

    law: PidLaw
    task: Task
    smoothed: Smoothing | None


class Planner:
    """Plans the next pass of all lanes from the history of the one before."""

    def __init__(self, experiments: Sequence[Experiment]) -> None:
        """Takes the experiments of the first lanes; the other lanes get the plan of the last."""
        self._lanes: list[_Lane] = []
        filters: dict[float | None, Smoothing | None] = {}
        for experiment in experiments:
            law, reference = known_parameters(experiment), experiment.reference
            assert isinstance(law, PidLaw)  # no other law is of this kind
            if law.cutoff not in filters:
                filters[law.cutoff] = law.smoothing(reference.sample_time)
            left, right = experiment.initial_left, experiment.initial_right
            means = (left + right) / 2, (left - right) / 2
            task = Task(reference, *means, experiment.speed_limit)
            self._lanes.append(_Lane(law, task, filters[law.cutoff]))

    def first(self, planned: Floats) -> None:
        """Plans to send the first input as it is."""
        for number, lane in enumerate(self._lanes):
            task = lane.task
            rows = planned.reshape(-1, HISTORY_FIELDS, LANES)[: task.reference.samples, :, number:]
            rows[:, 0], rows[:, 1] = (
                means[:, np.newaxis] for means in (task.initial_left, task.initial_right)
            )
            rows[:, 2:] = 0.0

    def plan(self, history: Floats, planned: Floats) -> None:
        """Plans the pass after one.

        Args:
            history: See `History`, n + 2 rows.
            planned: Where the plan goes: the same without the first and the last row.
        """
        # A lane's numbers side by side.
        passes = np.ascontiguousarray(history.reshape(-1, HISTORY_FIELDS, LANES).transpose(2, 1, 0))
        rows = planned.reshape(-1, HISTORY_FIELDS, LANES)
        # On the way to divergence filters overflow; that shows in the state they lead to.
        with np.errstate(over="ignore", invalid="ignore"):
            for number, (lane, last) in enumerate(zip(self._lanes, passes, strict=False)):
                n = lane.task.reference.samples
                iteration = Iteration(*last[:2, 1 : n + 1], *last[2:, 1 : n + 2])
                mean, half_difference, past = lane.law.known_before(
                    iteration, lane.task, lane.smoothed
                )
                known = np.stack([mean, half_difference, *past], axis=1)
                rows[:n, :, number:] = known[:, :, np.newaxis]
