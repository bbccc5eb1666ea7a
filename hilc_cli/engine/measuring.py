"""Simulates an experiment in the loop engine and measures each iteration as it is completed."""

from __future__ import annotations

from collections.abc import Iterator

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.learning import Learning
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.results.metrics import IterationMetrics, measure
from hilc_cli.results.trial import Trial


class MeasuredTrials:
    """The completed iterations of an experiment with their metrics; a divergence ends them.

    Only the last iteration is remembered: whoever goes through them keeps what is wanted.

    Attributes:
        last: The last iteration that has been completed; None if none has.
        diverged_at: The iteration that left the finite numbers; None if none has.
    """

    def __init__(self, experiment: Experiment, learning: Learning | None = None) -> None:
        """With an experiment, and its learning if that is to be asked for plans, see `simulate`."""
        self._experiment, self._learning = experiment, learning
        self.last: Trial | None = None
        self.diverged_at: int | None = None

    def __iter__(self) -> Iterator[tuple[Trial, IterationMetrics]]:
        try:
            for trial in simulate(self._experiment, self._learning):
                metrics = measure(trial, self._experiment.reference, self.last)
                self.last = trial
                yield trial, metrics
        except DivergedError as error:
            self.diverged_at = error.iteration
