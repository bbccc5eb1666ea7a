from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.runs.pictures.wheel_speeds import LIMIT_LABEL, wheel_speeds_figure
from tests.drawing.reading import legend, line, lines, texts
from tests.made_up_runs import MakeRun, circle

MINUS = "\N{MINUS SIGN}"


def test_speeds_are_those_of_the_last_iteration(make_run: MakeRun) -> None:
    run = make_run()
    (axes,) = wheel_speeds_figure([run]).axes

    for label, speeds in (("Left wheel", run.last.left), ("Right wheel", run.last.right)):
        shown = line(axes, label)
        np.testing.assert_array_equal(shown.get_xdata(), run.reference.times)
        np.testing.assert_array_equal(np.asarray(shown.get_ydata())[:-1], speeds)
        assert shown.get_drawstyle() == "steps-post"
    assert line(axes, "Right wheel").is_dashed()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Time [s]", "Wheel speed [rad/s]")
    assert axes.get_title(loc="left") == "Wheel speeds, iteration 3"


def test_limit_lines_carry_their_value(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(speed_limit=180.0)])
    limits = lines(figure.axes[0], LIMIT_LABEL)

    assert [float(np.asarray(each.get_ydata())[0]) for each in limits] == [180]
    assert "+180" in texts(figure) and f"{MINUS}180" not in texts(figure)
    assert figure.axes[0].get_ylim()[0] > 0, "wheels that never turn back leave no room below"
    assert legend(figure.axes[0]) == ["Left wheel", "Right wheel", LIMIT_LABEL]


def test_no_limit_no_line(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(speed_limit=None)])

    assert legend(figure.axes[0]) == ["Left wheel", "Right wheel"]


@pytest.mark.parametrize(("slowest", "drawn"), [(-17.0, [180]), (-19.0, [180, -180])])
def test_lower_limit_is_drawn_if_a_wheel_comes_near_it(
    make_run: MakeRun, slowest: float, drawn: list[float]
) -> None:
    run = make_run()
    run.last.right[3] = slowest  # near is a tenth of the limit
    limits = lines(wheel_speeds_figure([run]).axes[0], LIMIT_LABEL)

    assert [float(np.asarray(each.get_ydata())[0]) for each in limits] == drawn


def test_limit_far_above_the_speeds_is_told_instead(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(speed_limit=1e5)])

    assert lines(figure.axes[0], LIMIT_LABEL) == []
    assert "speed limit ±1e5 rad/s is out of view" in texts(figure)


def test_limit_is_shown_for_a_robot_that_stands_still(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5])
    run.last.left[:] = run.last.right[:] = 0

    assert len(lines(wheel_speeds_figure([run]).axes[0], LIMIT_LABEL)) == 2


def test_limits_that_fall_together_share_a_label(make_run: MakeRun) -> None:
    run = make_run(speed_limit=1.0)
    run.last.right[3] = -50
    assert "±1\n" in texts(wheel_speeds_figure([run])) + "\n"


def test_several_runs_by_colour_wheels_by_dashes(make_run: MakeRun) -> None:
    runs = [make_run("a", speed_limit=150.0), make_run("b", speed_limit=180.0)]
    figure = wheel_speeds_figure(runs)
    axes = figure.axes[0]
    rights = lines(axes, "_right")

    for name, right in zip("ab", rights, strict=True):
        assert line(axes, name).get_color() == right.get_color()
        assert right.is_dashed()
    assert {"+150", "+180"} <= set(texts(figure).split("\n"))
    assert legend(axes) == ["a", "b", "Left wheel", "Right wheel", LIMIT_LABEL]


@pytest.mark.parametrize("samples", [1, 2])
def test_very_short_runs(make_run: MakeRun, samples: int) -> None:
    figure = wheel_speeds_figure([make_run(reference=circle(samples=samples))])

    figure.draw_without_rendering()
    assert len(np.asarray(line(figure.axes[0], "Left wheel").get_ydata())) == samples + 1


def test_run_without_iterations(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(factors=[], diverged_at=0)])

    figure.draw_without_rendering()
    assert "no iteration completed" in texts(figure)
