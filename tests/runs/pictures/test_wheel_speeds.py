from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import style
from hilc_cli.laws.law import Plan
from hilc_cli.plants.kinematic import Robot
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.wheel_speeds import (
    APPLIED,
    LIMIT_LABEL,
    PLAN,
    REFERENCE,
    draw_wheel_speeds,
    wheel_speeds_figure,
)
from tests.drawing.reading import legend, line, lines, texts
from tests.made_up_runs import MakeRun, circle

MINUS = "\N{MINUS SIGN}"


def panels(*runs: RunData) -> tuple[Axes, Axes]:
    left, right = wheel_speeds_figure(runs).axes
    return left, right


def test_each_wheel_has_a_panel_with_the_speeds_of_the_last_iteration(make_run: MakeRun) -> None:
    run = make_run()
    left, right = panels(run)

    for axes, speeds in ((left, run.last.left), (right, run.last.right)):
        shown = line(axes, APPLIED)
        np.testing.assert_array_equal(shown.get_xdata(), run.reference.times)
        np.testing.assert_array_equal(np.asarray(shown.get_ydata())[:-1], speeds)
        assert shown.get_drawstyle() == "steps-post"
    assert (left.get_ylabel(), right.get_ylabel()) == ("Left wheel [rad/s]", "Right wheel [rad/s]")
    assert (left.get_xlabel(), right.get_xlabel()) == ("", "Time [s]")
    assert left.get_title(loc="left") == "Wheel speeds, iteration 3"
    assert left.get_ylim() == right.get_ylim() and left.get_xlim() == right.get_xlim()


def test_plan_is_thin_over_what_was_applied_and_the_reference_grey(make_run: MakeRun) -> None:
    # A circle of 10 m in 2 s: v = 10 pi m/s, omega = pi rad/s; a faster left wheel turns left.
    run = make_run(reference=circle(samples=2000))
    reference = replace(run.reference, sample_time=0.001)
    speeds = 100 + np.arange(2000.0)
    plan = Plan(speeds, -speeds, reference.poses)
    run = replace(run, reference=reference, plan=plan, robot=Robot(0.2, 0.518))
    for axes, asked, planned in zip(
        panels(run),
        ((10 + 0.518) * np.pi / 0.2, (10 - 0.518) * np.pi / 0.2),
        (speeds, -speeds),
        strict=True,
    ):
        aim, thin, applied = (line(axes, label) for label in (REFERENCE, PLAN, APPLIED))
        np.testing.assert_allclose(np.asarray(aim.get_ydata(), float), asked, rtol=1e-5)
        np.testing.assert_array_equal(np.asarray(thin.get_ydata())[:-1], planned)
        assert aim.get_color() == style.AIM_COLOR
        assert thin.get_linewidth() < applied.get_linewidth() < aim.get_linewidth()
        assert thin.get_zorder() > applied.get_zorder()


def test_limit_lines_carry_their_value(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(speed_limit=180.0)])
    left, right = figure.axes
    limits = [lines(axes, LIMIT_LABEL) for axes in (left, right)]

    assert [float(np.asarray(each.get_ydata())[0]) for (each,) in limits] == [180, 180]
    assert "+180" in texts(figure) and f"{MINUS}180" not in texts(figure)
    assert left.get_ylim()[0] > 0, "wheels that never turn back leave no room below"
    assert legend(right) == [APPLIED, LIMIT_LABEL]


def test_no_limit_no_line(make_run: MakeRun) -> None:
    assert legend(panels(make_run(speed_limit=None))[1]) == [APPLIED]


@pytest.mark.parametrize(("slowest", "drawn"), [(-17.0, [180]), (-19.0, [180, -180])])
def test_lower_limit_is_drawn_if_a_wheel_comes_near_it(
    make_run: MakeRun, slowest: float, drawn: list[float]
) -> None:
    run = make_run()
    run.last.right[3] = slowest  # near is a tenth of the limit
    for axes in panels(run):  # the other wheel has the same axis
        limits = lines(axes, LIMIT_LABEL)
        assert [float(np.asarray(each.get_ydata())[0]) for each in limits] == drawn


def test_limit_far_above_the_speeds_is_told_instead(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(speed_limit=1e5)])

    assert lines(figure.axes[0], LIMIT_LABEL) == []
    assert "speed limit ±1e5 rad/s is out of view" in texts(figure)


def test_limit_is_shown_for_a_robot_that_stands_still(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5])
    run.last.left[:] = run.last.right[:] = 0

    assert len(lines(panels(run)[0], LIMIT_LABEL)) == 2


def test_limits_that_fall_together_share_a_label(make_run: MakeRun) -> None:
    run = make_run(speed_limit=1.0)
    run.last.right[3] = -50
    assert "±1\n" in texts(wheel_speeds_figure([run])) + "\n"


def test_several_runs_by_colour_with_what_they_share_in_grey(make_run: MakeRun) -> None:
    robot = Robot(0.2, 0.518)
    runs = [
        replace(make_run(name, speed_limit=limit), robot=robot)
        for name, limit in (("a", 150.0), ("b", 180.0))
    ]
    figure = wheel_speeds_figure(runs)
    left, right = figure.axes

    for name, run in zip("ab", runs, strict=True):
        assert line(left, name).get_color() == line(right, name).get_color()
        np.testing.assert_array_equal(
            np.asarray(line(right, name).get_ydata())[:-1], run.last.right
        )
    assert len({str(line(left, name).get_color()) for name in "ab"}) == 2
    assert len(lines(left, REFERENCE)) == 1
    assert {"+150", "+180"} <= set(texts(figure).split("\n"))
    assert legend(right) == ["a", "b", REFERENCE, LIMIT_LABEL]


def test_references_that_differ_have_the_colours_of_their_runs(make_run: MakeRun) -> None:
    runs = [
        replace(make_run(name), robot=Robot(radius, 0.518))
        for name, radius in (("a", 0.2), ("b", 0.1))
    ]
    left, _ = panels(*runs)
    slow, fast = lines(left, "_reference")
    assert np.max(fast.get_ydata()) == pytest.approx(2 * np.max(slow.get_ydata()))
    assert [slow.get_color(), fast.get_color()] == [line(left, name).get_color() for name in "ab"]
    assert REFERENCE in legend(left) + legend(panels(*runs)[1])


def test_both_wheels_share_a_panel_where_room_is_short(make_run: MakeRun) -> None:
    run, axes = make_run(), Figure().add_subplot()
    draw_wheel_speeds(axes, [run], [180])
    for label, speeds in (("Left wheel", run.last.left), ("Right wheel", run.last.right)):
        np.testing.assert_array_equal(np.asarray(line(axes, label).get_ydata())[:-1], speeds)
    assert line(axes, "Right wheel").is_dashed()
    assert axes.get_ylabel() == "Wheel speed [rad/s]"


@pytest.mark.parametrize("samples", [1, 2])
def test_very_short_runs(make_run: MakeRun, samples: int) -> None:
    figure = wheel_speeds_figure([make_run(reference=circle(samples=samples))])

    figure.draw_without_rendering()
    assert len(np.asarray(line(figure.axes[0], APPLIED).get_ydata())) == samples + 1


def test_run_without_iterations(make_run: MakeRun) -> None:
    figure = wheel_speeds_figure([make_run(factors=[], diverged_at=0)])

    figure.draw_without_rendering()
    assert "no iteration completed" in texts(figure)
