"""What columns are about: names, units, and what belongs together."""

from __future__ import annotations

from hilc_cli.results.learning import Quantity, Series, quantities


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
