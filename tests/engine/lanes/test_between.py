"""What is known of the next pass, against the law's own NumPy and its cosine transform."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes import between
from hilc_cli.engine.lanes.between import Planner
from hilc_cli.engine.lanes.kinds import member
from hilc_cli.engine.lanes.lanes import HISTORY_FIELDS, LANES
from hilc_cli.engine.lanes.packs import aligned
from hilc_cli.laws.law import Iteration, Task
from hilc_cli.laws.pid import LowPass, PidLaw
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.runs.running import load_scenario

CUTOFFS = (1e-3, 0.1, 1.0, 20.0, 400.0, 499.9, None)
LENGTHS = (300, 1, 2, 3, 77)


def law_and_length(lane: int) -> tuple[PidLaw, int]:
    base = load_scenario("example:pid-figure-eight").experiment().law
    assert isinstance(base, PidLaw)
    length = LENGTHS[lane % len(LENGTHS)]
    law = replace(
        base,
        ki=0.1 * (lane % 3),
        kd=0.02 * (lane % 2),
        forgetting=0.05 * (lane % 4),
        cutoff=CUTOFFS[lane % len(CUTOFFS)],
        rectifying=min(10, length) if lane % 2 else None,
    )
    return law, length


def lane_experiment(lane: int, draw: np.random.Generator) -> Experiment:
    experiment = load_scenario("example:fig3-circle").experiment()
    law, n = law_and_length(lane)
    whole = experiment.reference
    part = Reference(str(lane), 1e-3, whole.x[: n + 1], whole.y[: n + 1], whole.heading[: n + 1])
    return replace(
        experiment,
        reference=part,
        law=law,
        initial_left=draw.normal(size=n),
        initial_right=draw.normal(size=n),
    )


def test_lanes_plan_what_the_law_plans() -> None:
    draw = np.random.default_rng(1)
    experiments = [lane_experiment(lane, draw) for lane in range(LANES - 2)]
    most = max(LENGTHS)
    history = aligned((most + 3) * HISTORY_FIELDS * LANES, np.float64)
    # Slow waves beside noise: what a filter keeps is large.
    waves = np.cumsum(draw.normal(size=(most + 3, HISTORY_FIELDS, LANES)), axis=0)
    history[:] = (waves + draw.normal(size=waves.shape)).ravel()
    planned = aligned((most + 1) * HISTORY_FIELDS * LANES, np.float64)
    planner = Planner([member(experiment) for experiment in experiments])
    planner.plan(history, planned)
    planner.plan(history, planned)  # nothing is left of the first time
    rows = planned.reshape(-1, HISTORY_FIELDS, LANES)
    passes = history.reshape(-1, HISTORY_FIELDS, LANES)
    for lane in range(LANES):
        experiment = experiments[min(lane, LANES - 3)]
        known = known_before(experiment, passes[:, :, lane])
        size = np.abs(known).max()
        n = experiment.reference.samples
        np.testing.assert_allclose(rows[:n, :, lane], known, rtol=0, atol=1e-12 * size)


def known_before(experiment: Experiment, last: Floats) -> Floats:
    """By the law, of the mean and half difference as if they were wheels; shape (n, 5)."""
    law, n = experiment.law, experiment.reference.samples
    assert isinstance(law, PidLaw)
    left, right = experiment.initial_left, experiment.initial_right
    means = (left + right) / 2, (left - right) / 2
    task = Task(experiment.reference, *means, math.inf)
    iteration = Iteration(*last[1 : n + 1, :2].T, *last[1 : n + 2, 2:].T)
    smoothing = law.smoothing(experiment.reference.sample_time)
    mean, half_difference, past = law.known_before(iteration, task, smoothing)
    return np.stack([mean, half_difference, *past], axis=1)


@pytest.mark.parametrize("cutoff", [0.01, 5.0, 300.0])
def test_a_cosine_is_multiplied_by_the_factor_of_the_filter(cutoff: float) -> None:
    """In closed form: cosines of the mirrored signal are eigenvectors."""
    experiment = lane_experiment(0, np.random.default_rng(2))
    assert isinstance(experiment.law, PidLaw)
    law = replace(experiment.law, cutoff=cutoff, forgetting=0.0, rectifying=None)
    n = experiment.reference.samples
    history = aligned((n + 3) * HISTORY_FIELDS * LANES, np.float64)
    planned = aligned((n + 1) * HISTORY_FIELDS * LANES, np.float64)
    rows = history.reshape(-1, HISTORY_FIELDS, LANES)
    frequencies = np.pi * np.arange(LANES) * 12 / n
    cosines = np.cos(frequencies * (np.arange(n)[:, np.newaxis] + 0.5))
    rows[1 : n + 1, 0] = cosines
    Planner([member(replace(experiment, law=law))]).plan(history, planned)
    factors = 1 / (1 + (np.tan(frequencies / 2) / np.tan(np.pi * cutoff * 1e-3)) ** 4)
    found = planned.reshape(-1, HISTORY_FIELDS, LANES)[:n, 0]
    np.testing.assert_allclose(found, factors * cosines, atol=1e-13)
    np.testing.assert_allclose(LowPass(cutoff, 1e-3).factors(frequencies), factors)


@pytest.mark.parametrize("n", [1, 2, 40])
def test_no_place_is_beyond_its_array(n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interpreted, NumPy looks at each of them; machine code does not."""
    draw = np.random.default_rng(3)
    history = draw.normal(size=(n + 3) * between.ROW)
    added = np.zeros(n * between.ADDED)
    numbers = np.zeros(between.NUMBER_ROWS * LANES)
    rows = [0.5, 0.1, 0.05, 1.0, 1.0, 1.0, -3.0, 0.1, 0.3, n]
    numbers[: len(rows) * LANES] = np.repeat(rows, LANES)

    def planned(forth: Callable[..., None], back: Callable[..., None]) -> Floats:
        left, known = np.zeros((n + 2) * between.LEFT), numbers.copy()
        found = np.zeros((n + 1) * between.ROW)
        forth(history, added, left, known)
        back(left, known, found)
        return found[: n * between.ROW]

    compiled = planned(between.forth, between.back)
    for name in ("_product", "_combined", "_weighed", "_eliminated", "_stepped_back"):
        monkeypatch.setattr(between, name, getattr(between, name).py_func)
    monkeypatch.setattr(between, "use_widest_vectors", lambda: None)
    interpreted = planned(between.forth.py_func, between.back.py_func)
    np.testing.assert_allclose(compiled, interpreted, rtol=1e-12, atol=1e-14)
