"""Pictures of runs that stay on the spot: headings over time, by the data that they carry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.runs.pictures.error import error_figure
from hilc_cli.runs.pictures.error_along_path import error_along_path_figure
from hilc_cli.runs.pictures.final_path import final_path_figure
from hilc_cli.runs.pictures.on_the_spot import stays_on_the_spot
from hilc_cli.runs.pictures.path_change import path_change_figure
from hilc_cli.runs.pictures.summary import summary_figure
from tests.drawing.reading import line, lines, overlaps

TURN = np.linspace(0, np.pi / 2, 21)
STILL = np.full(21, 3.0)
SPOT = Reference("spot", 0.1, STILL, STILL, TURN)


def turned(factors: Sequence[float], name: str = "spot", away: float = 0.0) -> RunData:
    """A run whose iterations turn by so many times the reference's turn, so far from the spot."""
    metrics, trials = MetricsTable(), {}
    for iteration, factor in enumerate(factors):
        nothing = np.zeros(20)
        trial = Trial(iteration, STILL + away, STILL, factor * TURN, nothing, nothing)
        metrics.append(measure(trial, SPOT, None))
        trials[iteration] = trial
    return RunData(name, SPOT, metrics, trials)


def panel(figure: Figure, title: str) -> Axes:
    (found,) = [each for each in figure.axes if each.get_title(loc="left").startswith(title)]
    return found


def check_headings(axes: Axes, label: str, factors: Sequence[float]) -> None:
    """Holds the lines of a panel against headings of closed form."""
    assert axes.get_ylabel() == "Heading [rad]"
    assert axes.get_xlabel() == "Time [s]"
    drawn = lines(axes, label)
    assert len(drawn) == len(factors)
    for each, factor in zip(drawn, factors, strict=True):
        np.testing.assert_allclose(np.asarray(each.get_xdata()), 0.1 * np.arange(21))
        np.testing.assert_allclose(np.asarray(each.get_ydata()), factor * TURN)
    np.testing.assert_allclose(np.asarray(line(axes, "Reference").get_ydata()), TURN)


def test_headings_take_the_place_of_paths() -> None:
    run = turned([1.2, 0.9, 1.0])
    figure = path_change_figure([run])
    check_headings(panel(figure, "Heading over the iterations"), "_path", [1.2, 0.9, 1.0])
    assert not overlaps(figure)
    figure = final_path_figure([run])
    check_headings(panel(figure, "Final heading"), "Iteration 2", [1.0])
    assert not overlaps(figure)
    figure = error_along_path_figure([run])
    check_headings(panel(figure, "Heading, iteration 2"), "_heading", [1.0])
    assert len(figure.axes) == 4  # nothing is coloured by an error of the position
    assert not overlaps(figure)
    assert panel(summary_figure([run]), "Heading over the iterations").get_aspect() == "auto"


def test_several_runs_are_told_by_the_errors_of_their_headings() -> None:
    runs = [turned([1.2, 1.1], "one"), turned([0.5, 0.9], "two")]
    (axes,) = error_figure(runs).axes
    assert axes.get_ylabel() == "Heading error [rad]"
    for name, errors in (("one", [0.2, 0.1]), ("two", [0.5, 0.1])):
        drawn = np.asarray(line(axes, name).get_ydata(), float)
        np.testing.assert_allclose(drawn, np.array(errors) * np.pi / 2)
    figure = path_change_figure(runs)
    check_headings(panel(figure, "two"), "_path", [0.5, 0.9])
    check_headings(panel(final_path_figure(runs), "Final heading"), "one", [1.1])
    assert not overlaps(figure)


def test_robot_that_leaves_its_spot_has_a_path() -> None:
    assert stays_on_the_spot([turned([1.0], away=0.005)])
    away = turned([1.0], away=0.5)
    assert not stays_on_the_spot([away])
    assert not stays_on_the_spot([turned([1.0]), away])
    figure = path_change_figure([away])
    assert panel(figure, "Path over the iterations").get_aspect() == 1
    (axes,) = error_figure([away]).axes
    assert axes.get_ylabel() == "Position error [m]"
