from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.patches import StepPatch

from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.error import (
    MAXIMUM,
    MEAN,
    MOST_DETAILED,
    SECOND_HALF_LABEL,
    STRIP_LABEL,
    ZERO_LABEL,
    drawable,
    error_figure,
    saturated_share,
)
from tests.drawing.reading import legend, line, lines, overlaps, texts
from tests.made_up_runs import SAMPLES, MakeRun


def test_lines_are_the_metrics(make_run: MakeRun) -> None:
    run = make_run()
    (axes,) = error_figure([run]).axes

    for label, metric in (("Maximum", "max"), ("RMS", "rms"), ("Mean", "mean")):
        shown = line(axes, label)
        np.testing.assert_array_equal(shown.get_xdata(), [0, 1, 2, 3])
        np.testing.assert_array_equal(shown.get_ydata(), run.metrics[f"{metric}_position_error_m"])
    assert axes.get_yscale() == "log"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Iteration", "Position error [m]")
    assert legend(axes) == ["Maximum", "RMS", "Mean"]


def test_lines_can_be_told_apart_without_colour(make_run: MakeRun) -> None:
    axes = error_figure([make_run()]).axes[0]

    styles = {str(line(axes, label)._dash_pattern) for label in ("Maximum", "RMS", "Mean")}  # type: ignore[attr-defined]
    assert len(styles) == 3


@pytest.mark.parametrize("factors", [[0.5], [1.0], [1.0, 1.0], [0.5, 1.0, 0.7], [1 - 1e-14], [1e9]])
def test_any_error_leaves_a_usable_axis(make_run: MakeRun, factors: list[float]) -> None:
    figure = error_figure([make_run(factors=factors)])
    figure.draw_without_rendering()
    low, high = figure.axes[0].get_ylim()

    assert 0 < low < high < np.inf
    assert len(figure.axes[0].get_yticks()) >= 2


def test_zero_error_is_marked_at_the_bottom(make_run: MakeRun) -> None:
    (axes,) = error_figure([make_run(factors=[0.5, 1.0, 0.7, 1.0])]).axes

    assert np.isnan(line(axes, "Maximum").get_ydata()).tolist() == [False, True, False, True]
    np.testing.assert_array_equal(line(axes, "_zero").get_xdata(), [1, 3])
    assert ZERO_LABEL in legend(axes)


def test_single_iteration_is_a_marker(make_run: MakeRun) -> None:
    (axes,) = error_figure([make_run(factors=[0.5])]).axes

    assert line(axes, "Maximum").get_marker() == "o"
    low, high = axes.get_xlim()
    assert [tick for tick in axes.get_xticks() if low <= tick <= high] == [0]


def test_strip_shows_the_share_of_limited_samples(make_run: MakeRun) -> None:
    run = make_run(saturated=SAMPLES // 4)
    (axes,) = error_figure([run]).axes
    (strip,) = [patch for patch in axes.patches if isinstance(patch, StepPatch)]
    values, edges, _ = strip.get_data()
    (full,) = [patch for patch in axes.patches if patch.get_gid() == "full"]

    assert saturated_share(run).tolist() == [0.25] * 4
    np.testing.assert_allclose(np.asarray(values) / full.get_bbox().height, 0.25)  # type: ignore[attr-defined]
    np.testing.assert_array_equal(edges, [-0.5, 0.5, 1.5, 2.5, 3.5])
    assert STRIP_LABEL in legend(axes)


def test_strips_stay_below_the_lines(make_run: MakeRun) -> None:
    runs = [make_run(f"r{i}", saturated=10) for i in range(MOST_DETAILED)]
    axes = error_figure(runs).axes[0]
    tops = [np.max(p.get_data()[0]) for p in axes.patches if isinstance(p, StepPatch)]
    least = min(np.nanmin(np.asarray(shown.get_ydata(), float)) for shown in lines(axes, "_mean"))
    lowest = axes.transAxes.inverted().transform(axes.transData.transform((0, least)))[1]

    assert max(tops) < lowest


def test_several_runs_have_a_colour_and_a_marker_each(make_run: MakeRun) -> None:
    names = [f"r{i}" for i in range(10)]
    axes = error_figure([make_run(name) for name in names]).axes[0]
    shown = [line(axes, name) for name in names]

    assert len({str(each.get_color()) for each in shown}) == 10
    assert len({str(each.get_marker()) for each in shown}) == 10
    assert legend(axes) == [*names, MAXIMUM]


@pytest.mark.parametrize(
    ("count", "drawn"), [(MOST_DETAILED, MOST_DETAILED), (MOST_DETAILED + 1, 0)]
)
def test_means_and_strips_are_those_of_few_runs(make_run: MakeRun, count: int, drawn: int) -> None:
    axes = error_figure([make_run(f"r{i}", saturated=5) for i in range(count)]).axes[0]

    assert len(lines(axes, "_mean")) == drawn
    assert sum(isinstance(patch, StepPatch) for patch in axes.patches) == drawn
    assert (MEAN in legend(axes)) == bool(drawn)


def test_divergence_is_noted(make_run: MakeRun) -> None:
    one = make_run("wild", diverged_at=7)
    figure = error_figure([one])

    assert "diverged to non-finite values in iteration 7" in texts(figure)
    assert figure.axes[0].get_xlim()[1] > 7
    assert "diverged: wild in iteration 7" in texts(error_figure([make_run(), one]))
    assert "2 of 3 runs diverged" in texts(error_figure([make_run(), one, one]))


def test_run_without_iterations(make_run: MakeRun) -> None:
    figure = error_figure([make_run(factors=[], diverged_at=0)])

    figure.draw_without_rendering()
    assert "iteration 0" in texts(figure)


def test_drawable_leaves_out_what_a_logarithm_cannot_show() -> None:
    shown = drawable(np.array([0.0, 1.0, np.inf, np.nan, 1e305]))

    assert np.isnan(shown).tolist() == [True, False, True, True, True]


def test_errors_beyond_all_numbers_are_counted(make_run: MakeRun) -> None:
    run = make_run(factors=[0.5, 0.6])
    run.trials[1].x[:] = 1e305
    again = make_run(factors=[0.5])
    with np.errstate(over="ignore"):
        again.metrics.append(measure(run.trials[1], run.reference, None))

    assert "1 errors above 1e300 m are not drawn" in texts(error_figure([again]))


def beside_its_start(run: RunData, offset: float) -> RunData:
    """The run with another first sample."""
    trials = {
        number: replace(trial, x=np.concatenate([trial.x[:1] + offset, trial.x[1:]]))
        for number, trial in run.trials.items()
    }
    metrics = MetricsTable()
    for trial in trials.values():
        metrics.append(measure(trial, run.reference, None))
    return replace(run, metrics=metrics, trials=trials)


def test_second_half_is_drawn_where_the_start_decides_the_maximum(make_run: MakeRun) -> None:
    off = beside_its_start(make_run(), 30.0)
    (axes,) = error_figure([off]).axes
    shown = line(axes, SECOND_HALF_LABEL)

    np.testing.assert_array_equal(
        shown.get_ydata(), off.metrics["max_position_error_second_half_m"]
    )
    np.testing.assert_allclose(np.asarray(line(axes, "Maximum").get_ydata(), float), 30)
    assert legend(axes) == ["Maximum", "RMS", "Mean", SECOND_HALF_LABEL]
    styles = {str(line(axes, label)._dash_pattern) for label in legend(axes)}  # type: ignore[attr-defined]
    assert len(styles) == 4
    assert not overlaps(error_figure([off]))
    assert legend(error_figure([make_run()]).axes[0]) == ["Maximum", "RMS", "Mean"]


def test_second_half_takes_the_place_of_the_mean_among_several(make_run: MakeRun) -> None:
    runs = [beside_its_start(make_run("off"), 30.0), make_run("right")]
    (axes,) = error_figure(runs).axes

    shown = lines(axes, "_second half")
    assert len(shown) == 2 and not lines(axes, "_mean")
    for each, run in zip(shown, runs, strict=True):
        expected = run.metrics["max_position_error_second_half_m"]
        np.testing.assert_array_equal(each.get_ydata(), expected)
    assert legend(axes) == ["off", "right", MAXIMUM, f"{MAXIMUM}, second half"]
