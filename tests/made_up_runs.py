from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from hilc_cli.reference.sampled import Reference
from hilc_cli.results.learning import LearningTable
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial

MakeRun = Callable[..., RunData]
SAMPLES = 80
YARDSTICKS = {"wheel_radius_m": {"true": 0.2, "believed": 0.14}, "merge_time_s": {"h": 0.2}}

USERS_SETTINGS: dict[Any, Any] = {
    "axes.facecolor": "black",
    "axes.formatter.limits": (-1, 1),
    "axes.prop_cycle": "cycler(color=['red', 'lime'])",
    "axes.xmargin": 0.3,
    "figure.dpi": 31,
    "figure.subplot.left": 0.4,
    "font.family": "serif",
    "font.weight": "bold",
    "hatch.color": "red",
    "image.cmap": "jet",
    "image.interpolation": "bicubic",
    "legend.loc": "lower left",
    "lines.linewidth": 9,
    "lines.marker": "o",
    "mathtext.fontset": "stix",
    "patch.linewidth": 5,
    "path.sketch": (5, 100, 2),
    "pdf.compression": 0,
    "savefig.dpi": 10,
    "svg.fonttype": "none",
    "text.usetex": True,
    "xtick.direction": "in",
    "xtick.minor.visible": True,
    "ytick.right": True,
}
"""Of Matplotlib, in which nothing is as hilc has it."""


def circle(radius: float = 10.0, samples: int = SAMPLES) -> Reference:
    angle = np.linspace(0, 2 * np.pi, samples + 1)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return Reference("circle", 0.025, x, y, angle + np.pi / 2)


def straight(length: float = 10.0, samples: int = SAMPLES) -> Reference:
    x = np.linspace(0, length, samples + 1)
    return Reference("line", 0.025, x, np.zeros_like(x), np.zeros_like(x))


def trial_beside(reference: Reference, iteration: int, factor: float, saturated: int = 0) -> Trial:
    """A path whose distance from the start is a multiple of the reference's."""
    wave = np.sin(np.arange(reference.samples) / 10)
    x, y = reference.x, reference.y
    return Trial(
        iteration,
        x + (factor - 1) * (x - x[0]),
        y + (factor - 1) * (y - y[0]),
        reference.heading.copy(),
        100 + 50 * wave,
        90 + 50 * wave,
        saturated,
    )


def told(values: Sequence[tuple[float, ...]], merge_times: Sequence[float] = ()) -> LearningTable:
    """What a law tells: a wheel radius alone and of all so far, with standard errors [mm]."""
    table = LearningTable()
    names = ("wheel_radius_m", "wheel_radius_standard_error_m")
    for place, row in enumerate(values):
        columns = dict(zip((*names, *(f"model_{name}" for name in names)), row, strict=False))
        merge = {"merge_time_s": merge_times[place]} if merge_times else {}
        table.append({name: value / 1000 for name, value in columns.items()} | merge)
    return table


@pytest.fixture
def make_run() -> MakeRun:
    def make(
        name: str = "run",
        reference: Reference | None = None,
        factors: Sequence[float] = (0.2, 0.5, 0.8, 0.95),
        recorded: Sequence[int] | None = None,
        speed_limit: float | None = 180.0,
        saturated: int = 0,
        diverged_at: int | None = None,
        learning: LearningTable | None = None,
        yardsticks: Mapping[str, Mapping[str, float]] = YARDSTICKS,
    ) -> RunData:
        """A run whose iteration i is the reference, blown up by ``factors[i]`` about its start."""
        reference = circle() if reference is None else reference
        metrics, trials, before = MetricsTable(), {}, None
        for iteration, factor in enumerate(factors):
            trial = trial_beside(reference, iteration, factor, saturated)
            metrics.append(measure(trial, reference, before))
            if recorded is None or iteration in recorded:
                trials[iteration] = trial
            before = trial
        if learning is None:
            learning = told([(201, 3, 200, 2)] * len(factors), [0.3] * len(factors))
        return RunData(
            name,
            reference,
            metrics,
            trials,
            speed_limit,
            diverged_at=diverged_at,
            learning=learning,
            yardsticks=yardsticks,
        )

    return make
