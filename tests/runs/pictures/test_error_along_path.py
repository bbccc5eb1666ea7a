from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from hilc_cli.drawing import style
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.runs.pictures.error_along_path import (
    ANGLES,
    LENGTHS,
    distance_along,
    error_along_path_figure,
    errors_along,
    fitting_unit,
)
from tests.drawing.reading import legend, line, overlaps, texts
from tests.made_up_runs import MakeRun, circle

SIDEWAYS, LENGTHWISE, TURNED = 3e-3, -20e-3, 5e-3  # [m, m, rad]


def run_beside(reference: Reference, errors: np.ndarray, name: str = "run") -> RunData:
    """A run with errors (sideways, lengthwise, heading) in the reference's frame, shape (n, 3)."""
    # The complex plane turns them: a second way to the rotation.
    offset = (errors[:, 1] + 1j * errors[:, 0]) * np.exp(1j * reference.heading)
    speeds = np.ones(reference.samples)
    trial = Trial(
        0,
        reference.x - offset.real,
        reference.y - offset.imag,
        reference.heading - errors[:, 2],
        *(speeds, speeds),
    )
    metrics = MetricsTable()
    metrics.append(measure(trial, reference, None))
    return RunData(name, reference, metrics, {0: trial})


def constant(reference: Reference) -> np.ndarray:
    return np.tile([SIDEWAYS, LENGTHWISE, TURNED], (reference.samples + 1, 1))


def test_errors_are_turned_into_the_frame_of_the_reference() -> None:
    reference = circle(samples=360)
    # Driven on a circle 3 mm farther out, 2 mrad ahead of the reference: of closed form.
    phase = np.linspace(0, 2 * np.pi, 361) + 0.002
    x, y = 10.003 * np.cos(phase), 10.003 * np.sin(phase)
    outer = Trial(0, x, y, phase + np.pi / 2, phase[1:], phase[1:])
    errors = errors_along(reference, outer)
    # To the left of the heading of a circle that is driven anticlockwise is its centre.
    np.testing.assert_allclose(errors.sideways, 10.003 * np.cos(0.002) - 10, atol=1e-12)
    np.testing.assert_allclose(errors.lengthwise, -10.003 * np.sin(0.002), atol=1e-12)
    np.testing.assert_allclose(errors.heading, -0.002, atol=1e-12)


def test_distance_is_that_along_the_reference() -> None:
    chord = 2 * 10 * np.sin(np.pi / 80)
    np.testing.assert_allclose(distance_along(circle()), chord * np.arange(81), rtol=1e-12)


@pytest.mark.parametrize(
    ("largest", "units", "unit"),
    [
        (1.0, LENGTHS, "m"),
        (0.999, LENGTHS, "mm"),
        (2e-3, LENGTHS, "mm"),
        (9e-4, LENGTHS, "µm"),
        (1e-9, LENGTHS, "µm"),
        (0.0, LENGTHS, "µm"),
        (0.5, ANGLES, "mrad"),
    ],
)
def test_units_fit(largest: float, units: tuple[tuple[float, str], ...], unit: str) -> None:
    assert fitting_unit(largest, units)[1] == unit


def test_picture_shows_millimetres_over_the_distance() -> None:
    reference = circle(samples=1000)
    run = run_beside(reference, constant(reference))
    figure = error_along_path_figure([run])
    *panels, path, bar = figure.axes

    for axes, label, value in zip(
        panels,
        ("Sideways [mm]", "Lengthwise [mm]", "Heading [mrad]"),
        (3, -20, 5),
        strict=True,
    ):
        shown = line(axes, "_error")
        assert axes.get_ylabel() == label
        np.testing.assert_allclose(np.asarray(shown.get_ydata(), float), value, rtol=1e-9)
        assert np.max(shown.get_xdata()) == pytest.approx(20 * np.pi, rel=1e-5)
        assert shown.get_color() == style.FINAL_PATH_COLOR
    assert panels[2].get_xlabel() == "Distance along the reference [m]"
    assert panels[0].get_title(loc="left") == "Reference less robot, iteration 0"
    (pieces,) = [each for each in path.collections if isinstance(each, LineCollection)]
    expected = np.hypot(SIDEWAYS, LENGTHWISE) * 1000
    np.testing.assert_allclose(np.asarray(pieces.get_array()), expected, rtol=1e-9)
    np.testing.assert_allclose(pieces.get_segments()[7][0], [run.last.x[21], run.last.y[21]])
    assert bar.get_ylabel() == "Position error [mm]"
    assert bar.get_ylim() == pytest.approx((0, expected))
    assert overlaps(figure) == []


def test_start_beside_the_path_does_not_hide_what_is_left() -> None:
    reference = circle(samples=1000)
    errors = constant(reference)
    errors[:400] += [1.0, 0, 0.1]
    figure = error_along_path_figure([run_beside(reference, errors)])
    sideways, _, heading, _, bar = figure.axes

    assert sideways.get_ylabel() == "Sideways [mm]" and sideways.get_ylim()[1] < 5
    assert heading.get_ylim()[1] < 10
    assert "scaled to the second half; errors of the first are up to 1 m" in texts(figure)
    assert bar.get_ylabel() == "Position error [mm]"
    # An error in the middle of a path that starts right is no initial error.
    errors[0] = 0
    whole = error_along_path_figure([run_beside(reference, errors)])
    assert whole.axes[0].get_ylabel() == "Sideways [m]"
    assert "second half" not in texts(whole)


def test_several_runs_have_the_colours_of_comparisons_and_one_scale() -> None:
    reference = circle()
    runs = [run_beside(reference, constant(reference) * k, f"r{k}") for k in (1, 10)]
    figure = error_along_path_figure(runs)
    sideways, _, heading, *paths, bar = figure.axes

    for k in (1, 10):
        drawn = line(sideways, f"r{k}")
        np.testing.assert_allclose(np.asarray(drawn.get_ydata(), float), 3 * k, rtol=1e-9)
    assert [axes.get_title(loc="left") for axes in paths] == ["r1", "r10"]
    np.testing.assert_allclose(paths[0].get_xlim(), paths[1].get_xlim())
    assert bar.get_ylim()[1] == pytest.approx(10 * np.hypot(3, 20))
    assert [name for axes in figure.axes for name in legend(axes)][:2] == ["r1", "r10"]
    assert heading.get_ylabel() == "Heading [mrad]"


def test_turn_in_place_is_drawn_over_time(make_run: MakeRun) -> None:
    zero = np.zeros(11)
    spot = Reference("spot", 0.1, zero, zero, np.linspace(0, 1, 11))
    figure = error_along_path_figure([run_beside(spot, constant(spot))])
    figure.draw_without_rendering()
    assert figure.axes[2].get_xlabel() == "Time [s]"
    np.testing.assert_allclose(np.asarray(line(figure.axes[0], "_error").get_xdata()), spot.times)
    none = replace(make_run(factors=[], diverged_at=0), reference=spot)
    error_along_path_figure([none]).draw_without_rendering()
