"""Metrics by hand on a trial of three samples, and the table of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import (
    MAX_ERROR,
    METRICS,
    MetricsTable,
    first_within,
    measure,
    share_within,
)
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import summarise
from hilc_cli.results.trial import Trial

REFERENCE = Reference("line", 0.1, np.array([0.0, 1.0, 2.0]), np.zeros(3), np.zeros(3))
# Errors: (0, 0), (3, -4), (0, 12): distances 0, 5, 12.
TRIAL = Trial(
    4,
    x=np.array([0.0, -2.0, 2.0]),
    y=np.array([0.0, 4.0, -12.0]),
    heading=np.array([0.0, 7.0, -0.5]),
    left=np.array([1.0, -9.0]),
    right=np.array([2.0, 3.0]),
    saturated_samples=1,
)


def test_errors_are_those_worked_out_by_hand() -> None:
    metrics = measure(TRIAL, REFERENCE, None)
    assert metrics["max_position_error_m"] == 12
    assert metrics["mean_position_error_m"] == pytest.approx(17 / 3)
    assert metrics["rms_position_error_m"] == pytest.approx(math.sqrt((25 + 144) / 3))
    assert metrics["final_position_error_m"] == 12
    assert metrics["max_abs_error_x_m"] == 3
    assert metrics["max_abs_error_y_m"] == 12


def test_heading_error_is_not_wrapped() -> None:
    assert measure(TRIAL, REFERENCE, None)["max_abs_error_heading_rad"] == 7


def test_fastest_wheel_counts_by_its_absolute_speed() -> None:
    assert measure(TRIAL, REFERENCE, None)["max_wheel_speed_rad_s"] == 9


def test_fastest_wheel_may_be_the_right_one() -> None:
    trial = replace(TRIAL, right=np.array([2.0, -30.0]))
    assert measure(trial, REFERENCE, None)["max_wheel_speed_rad_s"] == 30


def test_saturated_samples_are_those_of_the_trial() -> None:
    assert measure(TRIAL, REFERENCE, None)["saturated_samples"] == 1


def test_change_of_the_first_input_is_zero() -> None:
    assert measure(TRIAL, REFERENCE, None)["input_change_rms_rad_s"] == 0


def test_change_of_the_input_runs_over_both_wheels() -> None:
    # Changes: left 1, 2; right 0, 4; RMS over the four numbers.
    before = replace(TRIAL, left=np.array([0.0, -11.0]), right=np.array([2.0, -1.0]))
    change = measure(TRIAL, REFERENCE, before)["input_change_rms_rad_s"]
    assert change == pytest.approx(math.sqrt((1 + 4 + 0 + 16) / 4))


def test_perfect_trial_has_no_error() -> None:
    trial = Trial(0, REFERENCE.x, REFERENCE.y, REFERENCE.heading, np.zeros(2), np.zeros(2))
    assert set(measure(trial, REFERENCE, trial).values()) == {0}


def test_final_error_is_that_of_the_last_sample() -> None:
    trial = replace(TRIAL, y=np.array([0.0, 4.0, -1.0]))
    metrics = measure(trial, REFERENCE, None)
    assert (metrics["final_position_error_m"], metrics["max_position_error_m"]) == (1, 5)


@pytest.mark.parametrize(
    ("errors", "largest", "mean"),
    [
        ([9, 9, 2, 1, 3], 3, 2),  # n = 4: samples 2 to 4
        ([9, 9, 9, 2, 1, 3], 3, 2),  # n = 5: samples 3 to 5
        ([9, 4], 4, 4),  # n = 1
    ],
)
def test_second_half_is_the_samples_from_the_middle_on(
    errors: list[float], largest: int, mean: int
) -> None:
    size = np.array(errors, dtype=np.float64)
    nothing, speeds = np.zeros(len(size)), np.zeros(len(size) - 1)
    # 3-4-5 triangles.
    trial = Trial(0, -0.6 * size, 0.8 * size, nothing, speeds, speeds)
    metrics = measure(trial, Reference("path", 0.1, nothing, nothing, nothing), None)
    assert metrics["max_position_error_second_half_m"] == pytest.approx(largest, rel=1e-15)
    assert metrics["mean_position_error_second_half_m"] == pytest.approx(mean, rel=1e-15)


@pytest.mark.parametrize("size", [1e200, 1.5e308])
def test_errors_of_a_diverging_run_stay_finite_as_long_as_they_can(size: float) -> None:
    # Three equal errors of that size: maximum, mean and RMS are that size.
    trial = Trial(0, np.full(3, size), np.zeros(3), np.zeros(3), np.zeros(2), np.zeros(2))
    metrics = measure(trial, replace(REFERENCE, x=np.zeros(3)), None)
    assert metrics["max_position_error_m"] == size
    assert metrics["rms_position_error_m"] == pytest.approx(size, rel=1e-15)
    assert metrics["mean_position_error_m"] == pytest.approx(size, rel=1e-15)
    assert metrics["mean_position_error_second_half_m"] == pytest.approx(size, rel=1e-15)


def table_of(errors: list[float]) -> MetricsTable:
    """A table with these maximum position errors."""
    blank = measure(TRIAL, REFERENCE, None)
    table = MetricsTable()
    for error in errors:
        table.append({**blank, MAX_ERROR: error})
    return table


def test_metric_names_are_the_columns_of_the_contract() -> None:
    assert tuple(METRICS) == (
        "max_position_error_m",
        "mean_position_error_m",
        "rms_position_error_m",
        "final_position_error_m",
        "max_abs_error_x_m",
        "max_abs_error_y_m",
        "max_abs_error_heading_rad",
        "max_wheel_speed_rad_s",
        "saturated_samples",
        "input_change_rms_rad_s",
        "max_position_error_second_half_m",
        "mean_position_error_second_half_m",
    )


def test_table_gives_back_columns_and_rows() -> None:
    table = table_of([3.0, 2.0, 1.0])
    assert len(table) == 3
    assert table["max_position_error_m"].tolist() == [3.0, 2.0, 1.0]
    assert table["max_wheel_speed_rad_s"].tolist() == [9.0, 9.0, 9.0]
    assert table.row(-1) == measure(TRIAL, REFERENCE, None) | {"max_position_error_m": 1.0}
    assert [row["max_position_error_m"] for row in table.rows()] == [3.0, 2.0, 1.0]


def test_whole_numbers_stay_whole_in_a_row() -> None:
    assert isinstance(table_of([1.0]).row(0)["saturated_samples"], int)


def test_unknown_metric_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        table_of([1.0])["median_position_error_m"]


@pytest.mark.parametrize(
    ("errors", "settled"),
    [
        ([], None),
        ([5.0], None),
        ([0.5], 0),
        ([5.0, 2.0, 0.9, 0.8], 2),
        ([5.0, 0.5, 2.0, 0.8], 3),  # left the bound again in between
        ([5.0, 0.5, 0.5, 2.0], None),
        ([0.5, 0.5, 0.5], 0),
        ([5.0, 1.0, 1.0], 1),  # at the bound is within it
        ([5.0, 0.5, math.nan], None),
        ([math.inf, 0.5], 1),
    ],
)
def test_settled_at_is_the_iteration_from_which_the_error_stays_within(
    errors: list[float], settled: int | None
) -> None:
    assert table_of(errors).settled_at(1.0) == settled


@pytest.mark.parametrize(
    ("errors", "first", "share"),
    [
        ([3.0, 2.0, 1.5], None, None),
        ([3.0, 1.0, 2.0, 1.0, 0.5], 1, 0.75),  # the bound itself is within
        ([0.5, math.inf, math.inf, math.nan], 0, 0.25),
        ([math.nan, 0.5], 1, 1.0),
        ([], None, None),
    ],
)
def test_first_iteration_within_a_bound_and_the_share_since(
    errors: list[float], first: int | None, share: float | None
) -> None:
    assert first_within(np.array(errors), 1.0) == first
    assert share_within(np.array(errors), 1.0) == share


def test_share_of_limited_samples_counts_all_samples_of_all_iterations() -> None:
    straight = Reference("line", 1.0, np.arange(5.0), np.zeros(5), np.zeros(5))
    table = MetricsTable()
    for iteration, limited in enumerate([3, 0, 1]):
        zero = np.zeros(5)
        trial = Trial(iteration, zero, zero, zero, np.zeros(4), np.zeros(4), limited)
        table.append(measure(trial, straight, None))
    zero = np.zeros(5)
    last = Trial(2, zero, zero, zero, np.zeros(4), np.zeros(4))
    summary = summarise(RunData("run", straight, table, {2: last}))
    assert summary.saturated_share == 4 / 12
    assert summary.iterations == 2
