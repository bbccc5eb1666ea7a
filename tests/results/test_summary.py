"""What a summary says first, on errors whose course is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import OnPath, Summary, summarise
from hilc_cli.results.trial import Trial

SAMPLES, SAMPLE_TIME, SIZE = 400, 0.01, 8.0  # 4 s along 8 m
STRAIGHT = Reference(
    "line",
    SAMPLE_TIME,
    np.linspace(0, SIZE, SAMPLES + 1),
    np.zeros(SAMPLES + 1),
    np.zeros(SAMPLES + 1),
)
K = np.arange(SAMPLES + 1)


def run_of(errors: Sequence[Floats], heading: float = 0.0) -> RunData:
    """A run whose iterations are beside the line by these many metres at each sample."""
    metrics, trials = MetricsTable(), {}
    speeds = np.zeros(SAMPLES)
    for iteration, error in enumerate(errors):
        headings = np.where(K == 0, heading, 0.0)
        trial = Trial(iteration, STRAIGHT.x, np.asarray(error), headings, speeds, speeds)
        metrics.append(measure(trial, STRAIGHT, None))
        trials[iteration] = trial
    return RunData("r", STRAIGHT, metrics, {len(errors) - 1: trials[len(errors) - 1]})


def fading(start: float, decay_s: float, rest: float = 0.0) -> Floats:
    size: Floats = np.maximum(abs(start) * np.exp(-K * SAMPLE_TIME / decay_s), rest)
    return size if start > 0 else -size


def summary_of(*errors: Floats, heading: float = 0.0) -> Summary:
    return summarise(run_of(errors, heading))


@pytest.mark.parametrize(("start", "decay_s"), [(0.5, 0.3), (-1.2, 0.21), (0.09, 0.4)])
def test_from_a_start_beside_the_path_the_time_is_that_of_the_decay(
    start: float, decay_s: float
) -> None:
    summary = summary_of(fading(3, 5), fading(start, decay_s), fading(start, decay_s))
    # |start| exp(-t / decay) = 8 mm: the tighter share, 0.1 % of 8 m, is kept in the second half.
    expected = decay_s * math.log(abs(start) / 0.008)
    assert summary.starts_off
    assert summary.on_path is not None
    assert summary.on_path.tolerance_m == pytest.approx(0.008)
    assert expected <= summary.on_path.from_s < expected + SAMPLE_TIME * (1 + 1e-9)
    assert summary.on_path.from_iteration == 1
    text = f"on the path from {summary.on_path.from_s:.4g} s; second half within 8 mm from"
    assert summary.headline == f"{text} iteration 1"


def test_looser_share_where_the_tighter_is_not_kept() -> None:
    summary = summary_of(fading(0.5, 0.2, rest=0.05))
    assert summary.on_path is not None
    assert summary.on_path.tolerance_m == pytest.approx(0.08)
    assert summary.settled_second_half_at == {"1 %": 0, "0.1 %": None}


@pytest.mark.parametrize(("off", "iteration"), [(0.0, 3), (0.008, 3), (0.009, 1), (5.0, 1)])
def test_share_that_noise_decides_is_not_told(off: float, iteration: int) -> None:
    errors = [fading(0.5, 0.2, rest=rest) for rest in (0.4, 0.005, 0.01, 0.007)]
    summary = summarise(replace(run_of(errors), readings_off_m=off))
    within = "8 mm" if iteration == 3 else "80 mm"
    assert summary.headline.endswith(f"; second half within {within} from iteration {iteration}")


def test_late_return_to_the_path_is_none() -> None:
    # Within 8 cm only from 3 s on, of 4 s.
    summary = summary_of(np.where(K < 300, 0.3, 0.0))
    assert summary.on_path is None
    assert summary.headline == "not on the path: up to 0.3 m off in the second half"


def test_error_that_comes_back_counts_to_its_end() -> None:
    error = fading(0.5, 0.05)
    error[150] = 0.02
    summary = summary_of(error)
    assert summary.on_path is not None
    assert summary.on_path.from_s == pytest.approx(1.51)


def test_right_start_is_judged_by_the_whole_path() -> None:
    bump = 0.3 * np.sin(math.pi * K / SAMPLES) ** 2
    summary = summary_of(bump, bump / 10, bump / 100, bump / 100)
    assert not summary.starts_off
    assert summary.on_path == OnPath(pytest.approx(0.008), 0.0, 2)  # type: ignore[arg-type]
    assert summary.headline == "on the path from the start; within 8 mm from iteration 2"
    far = summary_of(bump)
    assert far.headline == "not on the path: up to 0.3 m off"


def test_wrong_heading_is_a_wrong_start() -> None:
    bump = np.where(K < 100, 0.3 * np.sin(math.pi * K / 100), 0.0)
    assert summary_of(bump).on_path is None
    turned = summary_of(bump, heading=0.2)
    assert turned.on_path is not None
    # The last sample above 8 mm.
    last = math.ceil(100 - 100 / math.pi * math.asin(0.008 / 0.3))
    assert turned.on_path.from_s == pytest.approx(last * SAMPLE_TIME)


def test_learning_that_was_better_before_is_told() -> None:
    summary = summary_of(*(fading(0.5, 0.2, rest=rest) for rest in (0.4, 0.0125, 0.2)))
    assert (summary.least_error_m, summary.least_error_iteration) == (0.0125, 1)
    assert summary.headline == (
        "not on the path: up to 0.2 m off in the second half; iteration 1 was within 12.5 mm"
    )


@pytest.mark.parametrize(
    ("error", "decides"),
    [(fading(0.5, 0.2), True), (0.3 * K / SAMPLES, False), (0.1 + 0.3 * K / SAMPLES, False)],
)
def test_start_decides_the_maximum(error: Floats, decides: bool) -> None:
    assert run_of([error]).start_decides == decides
