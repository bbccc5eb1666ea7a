"""The table of a panel holds what is drawn in it, and reads back exactly."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.axes import Axes

from hilc_cli.paper.panel import Panel, PanelKind, PanelRow, panel_table
from hilc_cli.paper.sheet import sheet_figure
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.run import RunData
from tests.drawing.reading import line, lines
from tests.made_up_runs import (
    MakeRun,
    make_run as make_run,  # the fixture
)

PATH_HEADER = "iteration,sample,reference_x_m,reference_y_m,x_m,y_m"
HEADERS = {
    PanelKind.PATH_CHANGE: PATH_HEADER,
    PanelKind.PATHS: PATH_HEADER,
    PanelKind.FINAL_PATH: PATH_HEADER,
    PanelKind.WHEEL_SPEEDS: "sample,t_s,left_wheel_rad_s,right_wheel_rad_s,speed_limit_rad_s",
    PanelKind.MAXIMUM_ERROR: "iteration,max_position_error_m,saturated_samples",
    PanelKind.AVERAGE_ERROR: "iteration,mean_position_error_m,saturated_samples",
}


def drawn(panel: Panel) -> Axes:
    return sheet_figure("Figure 9", "as it is", [PanelRow("", (panel,))]).axes[0]


def written(panel: Panel) -> tuple[str, dict[str, Floats]]:
    header, *rows = panel_table(panel).decode().splitlines()
    table = np.array([[float(value) for value in row.split(",")] for row in rows])
    return header, dict(zip(header.split(","), table.T, strict=True))


@pytest.fixture
def run(make_run: MakeRun) -> RunData:
    return make_run(factors=[0.2, 0.5, 0.7, 0.8, 0.9, 0.95], saturated=20)


@pytest.mark.parametrize("kind", PanelKind)
def test_headers_are_those_of_the_run_folder(run: RunData, kind: PanelKind) -> None:
    header, _ = written(Panel("a", kind, "", run, 180.0))
    assert header == HEADERS[kind]


@pytest.mark.parametrize("kind", [PanelKind.PATH_CHANGE, PanelKind.PATHS])
def test_paths_are_those_drawn(run: RunData, kind: PanelKind) -> None:
    panel = Panel("a", kind, "", run, 180.0)
    _, table = written(panel)
    axes = drawn(panel)

    blocks = [table["iteration"] == iteration for iteration in dict.fromkeys(table["iteration"])]
    for block, path in zip(blocks, lines(axes, "_path"), strict=True):
        np.testing.assert_array_equal(table["x_m"][block], path.get_xdata())
        np.testing.assert_array_equal(table["y_m"][block], path.get_ydata())
        reference = line(axes, "Reference")
        np.testing.assert_array_equal(table["reference_x_m"][block], reference.get_xdata())
        np.testing.assert_array_equal(table["reference_y_m"][block], reference.get_ydata())
        assert table["sample"][block].tolist() == list(range(81))
    assert list(dict.fromkeys(table["iteration"])) == [0, 1, 2, 3, 5]
    if kind is PanelKind.PATHS:
        np.testing.assert_array_equal(
            table["x_m"][blocks[-1]], line(axes, "Final path").get_xdata()
        )


def test_final_path_is_that_drawn(run: RunData) -> None:
    panel = Panel("a", PanelKind.FINAL_PATH, "", run, 180.0)
    _, table = written(panel)
    axes = drawn(panel)

    for label, columns in (
        ("Final path", ("x_m", "y_m")),
        ("Reference", ("reference_x_m", "reference_y_m")),
    ):
        expected = np.column_stack([table[column] for column in columns])
        np.testing.assert_array_equal(line(axes, label).get_xydata(), expected)
    assert set(table["iteration"]) == {5}


def test_wheel_speeds_are_those_drawn(run: RunData) -> None:
    panel = Panel("a", PanelKind.WHEEL_SPEEDS, "", run, 150.0)
    _, table = written(panel)
    axes = drawn(panel)

    for label, column in (
        ("Left wheel", "left_wheel_rad_s"),
        ("Right wheel", "right_wheel_rad_s"),
    ):
        times, speeds = line(axes, label).get_data()
        np.testing.assert_array_equal(times[:-1], table["t_s"])  # type: ignore[index]
        np.testing.assert_array_equal(speeds[:-1], table[column])  # type: ignore[index]
        assert speeds[-1] == speeds[-2]  # type: ignore[index]  # held to the end
    limit = lines(axes, "Limit of the motors")[0].get_ydata()
    assert set(table["speed_limit_rad_s"]) == {limit[0]} == {150}  # type: ignore[index]


@pytest.mark.parametrize("kind", [PanelKind.MAXIMUM_ERROR, PanelKind.AVERAGE_ERROR])
def test_errors_are_those_drawn(run: RunData, kind: PanelKind) -> None:
    panel = Panel("a", kind, "", run, 180.0)
    header, table = written(panel)
    axes = drawn(panel)

    (errors,) = axes.lines
    np.testing.assert_array_equal(errors.get_xdata(), table["iteration"])
    np.testing.assert_array_equal(errors.get_ydata(), table[header.split(",")[1]])
    strip = next(patch for patch in axes.patches if patch.get_label() == "_share")
    heights, _, baseline = strip.get_data()  # type: ignore[attr-defined]
    full = next(patch for patch in axes.patches if patch.get_gid() == "full").get_height()  # type: ignore[attr-defined]
    np.testing.assert_allclose(
        (heights - baseline) / full, table["saturated_samples"] / 80, rtol=1e-12
    )
