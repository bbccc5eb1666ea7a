"""What laws tell: the table of it, and what its columns are about."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.results.learning import (
    LearningTable,
    Quantity,
    Series,
    quantities,
    read_learning,
    write_learning,
)


def test_numbers_read_back_exactly(tmp_path: Path) -> None:
    table = LearningTable()
    rows = [(math.pi, math.nan), (1e-300, -0.0), (math.inf, 1 / 3)]
    for first, second in rows:
        table.append({"first_m": first, "second_rad": second})
    write_learning(tmp_path / "learning.csv", table)
    again = read_learning(tmp_path / "learning.csv")
    assert again.names == ("first_m", "second_rad")
    assert len(again) == 3
    for name in again.names:
        np.testing.assert_array_equal(again[name], table[name])
    assert again.last() == {"first_m": math.inf, "second_rad": 1 / 3}


def test_nothing_told_is_an_empty_table(tmp_path: Path) -> None:
    table = LearningTable()
    table.append({})
    assert (len(table), table.names, table.last()) == (0, (), {})
    assert read_learning(tmp_path / "learning.csv").names == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "learning.csv: is no such table; its first line must begin with iteration,"),
        ("iteration\n0\n", "learning.csv: is no such table"),
        ("sample,a\n0,1\n", "learning.csv: is no such table"),
        ("iteration,a\n0,1\n1\n", "learning.csv:3: is damaged: 2 cells should stand here"),
        ("iteration,a\n0,1\n2,1\n", "learning.csv:3: is damaged: iteration 1 should stand here"),
        ("iteration,a\n0,x\n", "learning.csv:2: is damaged: holds something that is no number"),
    ],
)
def test_damage_is_told(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "learning.csv").write_text(text)
    with pytest.raises(UsageError) as caught:
        read_learning(tmp_path / "learning.csv")
    assert message in str(caught.value)


def test_estimates_alone_and_of_the_model_are_one_quantity() -> None:
    columns = [
        "wheel_radius_m",
        "wheel_radius_standard_error_m",
        "model_wheel_radius_m",
        "model_wheel_radius_standard_error_m",
    ]
    (found,) = quantities(columns)
    alone = Series("wheel_radius_m", "wheel_radius_standard_error_m")
    model = Series("model_wheel_radius_m", "model_wheel_radius_standard_error_m")
    assert found == Quantity("wheel_radius_m", "wheel radius", "m", alone, model)
    assert found.best == model


def test_what_there_is_of_a_quantity_is_its_best() -> None:
    (alone,) = quantities(["merge_time_s"])
    assert (alone.name, alone.unit, alone.model) == ("merge time", "s", None)
    assert alone.best == Series("merge_time_s", None)
    (model,) = quantities(["model_mass_percent"])
    assert (model.column, model.unit, model.alone) == ("mass_percent", "%", None)


def test_quantities_are_in_the_order_of_their_first_columns() -> None:
    columns = ["b_rad_s", "iterations_seen", "model_a_rad", "a_rad", "b_standard_error_rad_s"]
    found = quantities(columns)
    assert [(each.column, each.unit) for each in found] == [
        ("b_rad_s", "rad/s"),
        ("iterations_seen", ""),
        ("a_rad", "rad"),
    ]
    assert found[0].best.error == "b_standard_error_rad_s"
