"""When the motion began, on logs whose start is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.fitting import LAG, OFFSET, ROBOT, Drive
from hilc_cli.logs.start_of_motion import fit_pass
from hilc_cli.reference.sampled import Floats
from tests.logs.made_up_logs import MadeUpRobot, winding_plan


def deviations(seeds: range, *, lag_is_known: bool) -> Floats:
    """Errors of onset and of onset plus lag, each followed by its standard error [s].

    The robot is another one than believed: radius and separation by 10 %, the lag by up to 0.1 s.
    """
    found = []
    for seed in seeds:
        random = np.random.default_rng(seed)
        sample_time = float(random.choice([0.01, 0.02, 0.05]))
        plan = winding_plan(sample_time, float(random.integers(6, 12)), random.uniform(0.3, 0.8))
        lag, start = random.uniform(0, 0.12), 1000 + random.uniform(0, 10)
        radius = 0.1 * random.uniform(0.9, 1.1)
        robot = MadeUpRobot(radius, radius, 0.25 * random.uniform(0.9, 1.1), lag=lag)
        wheels = np.stack([plan.left, plan.right], axis=1)
        seen = robot.drive(
            sample_time,
            wheels,
            clock=start,
            before=random.uniform(0.5, 4),
            after=random.uniform(0.3, 3),
            seed=seed,
        )
        drive = Drive(seen[:, 0], seen[:, 1:], *plan.with_stop)
        believed = Motor(0.1, 0.1, -0.25, 0.0, lag if lag_is_known else 0.05, 0.0)
        fit = fit_pass(
            drive, believed, sample_time, plan.end, offset=None, lag_is_known=lag_is_known
        )
        assert fit is not None
        covariance, place = fit.fitted.covariance, len(ROBOT) + OFFSET
        together = covariance[LAG, LAG] + covariance[place, place] + 2 * covariance[LAG, place]
        onset = fit.offset - start
        late = onset + float(fit.fitted.belief.values[LAG]) - lag
        found.append((onset, fit.offset_error, late, math.sqrt(together)))
    return np.array(found)


def check(known: Floats, unknown: Floats) -> None:
    assert (np.abs(known[:, 0]) <= 0.005).mean() >= 0.95
    assert (np.abs(unknown[:, 2]) <= 0.005).mean() >= 0.95
    # With the lag unknown the onset alone is less sure, and says so.
    assert np.sqrt(np.mean((unknown[:, 0] / unknown[:, 1]) ** 2)) < 1.6


def test_a_few_logs() -> None:
    check(deviations(range(6), lag_is_known=True), deviations(range(6), lag_is_known=False))


@pytest.mark.slow
def test_two_hundred_logs() -> None:
    check(deviations(range(200), lag_is_known=True), deviations(range(200), lag_is_known=False))
