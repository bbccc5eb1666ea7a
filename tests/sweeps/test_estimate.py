"""What a sweep is said to cost."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

import hilc_cli as hilc_api
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.compute import samples_per_case
from hilc_cli.sweeps.estimate import estimate
from tests.conftest import Write


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write()


def test_cost_follows_from_cases_and_columns() -> None:
    scenario = hilc_api.load_scenario("scenario.yaml")
    plan = hilc_api.plan_sweep(scenario, {"controller.gains.l1": "0:1:50"}, bands=True)
    cost = estimate(plan, 2)
    assert (cost.cases, cost.samples, cost.workers) == (50, 50 * 3 * 3, 2)
    assert cost.disk == 8 * 50 * (len(CASE_COLUMNS) + 3)
    assert cost.memory > cost.disk
    assert cost.seconds > 0


@pytest.mark.parametrize(
    ("vary", "options", "samples"),
    [
        ({"iterations": [0, 9]}, {}, 3 * 5.5),
        ({"iterations": "0..9999"}, {"sample": "random", "cases": 1000}, 3 * 5000),
        ({"trajectory.segments.0.line.duration": "0.1:0.4:5"}, {}, 3 * 2.5),
    ],
)
def test_samples_are_those_of_the_cases_that_run(
    vary: Mapping[str, object], options: Mapping[str, object], samples: float
) -> None:
    scenario = hilc_api.load_scenario("scenario.yaml")
    plan = hilc_api.plan_sweep(scenario, vary, **options)  # type: ignore[arg-type]
    assert samples_per_case(plan) == pytest.approx(samples, rel=0.05)
