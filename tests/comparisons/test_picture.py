from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hilc_cli.comparisons.picture import (
    MOST_LINES,
    MOST_PATHS,
    MOST_ROWS,
    comparison_figure,
    save_comparison,
)
from hilc_cli.errors import UsageError
from hilc_cli.runs.pictures.error import ZERO_LABEL
from tests.drawing.reading import legend, line, lines, overlaps, texts
from tests.made_up_runs import MakeRun, circle, straight


def place(mark: Line2D) -> tuple[float, float]:
    """Where the first point of a line is."""
    x, y = np.asarray(mark.get_xdata(), float), np.asarray(mark.get_ydata(), float)
    return float(x[0]), float(y[0])


def row_names(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.axes[-1].get_yticklabels()]


def test_sheet_shows_errors_paths_and_last_errors(make_run: MakeRun) -> None:
    runs = [make_run("a"), make_run("b", factors=(0.2, 0.5, 0.9))]
    figure = comparison_figure(runs)
    error, path, last = figure.axes

    for name, run in zip("ab", runs, strict=True):
        np.testing.assert_array_equal(
            line(error, name).get_ydata(), run.metrics["max_position_error_m"]
        )
        np.testing.assert_array_equal(line(path, name).get_xdata(), run.last.x)
    assert error.get_yscale() == last.get_xscale() == "log"
    assert row_names(figure) == ["a", "b"]
    assert [axes.get_xlabel() for axes in figure.axes] == ["Iteration", "x [m]", last.get_xlabel()]
    assert last.get_xlabel() == "Position error [m]"
    # A circle of 10 m, blown up by 0.95 and 0.9 about a point on it: 5 and 10 % of its diameter.
    np.testing.assert_allclose([place(mark)[0] for mark in lines(last, "_maximum")], [1, 2])
    # The points of a circle are 4 r / pi from one of them on average; here that one, from which the
    # error is zero, is counted twice: as the first and the last of 81 samples.
    means = [place(mark)[0] for mark in lines(last, "_mean")]
    np.testing.assert_allclose(means, np.array([0.05, 0.1]) * 40 / np.pi * 80 / 81, rtol=1e-3)


def test_rows_are_the_legend_of_the_lines(make_run: MakeRun) -> None:
    runs = [make_run(f"r{number}") for number in range(8)]
    error, path, last = comparison_figure(runs).axes
    keys = lines(last, "_key")

    for number, key in enumerate(keys):
        for axes in (error, path):
            drawn = line(axes, f"r{number}")
            assert (key.get_color(), key.get_marker()) == (drawn.get_color(), drawn.get_marker())
        assert place(key)[1] == number
    assert len({key.get_marker() for key in keys}) == 8, "told apart in grey as well"
    assert not any(f"r{number}" in legend(axes) for axes in (error, path) for number in range(8))
    # One legend, below all panels, names what they have in common.
    assert not legend(error) and not legend(path)
    last_errors = ["Last maximum error", "Last mean error"]
    assert legend(last) == ["Maximum error", "Start", "End", "Reference", *last_errors]


def test_of_many_runs_the_best_have_lines(make_run: MakeRun) -> None:
    runs = [make_run(f"r{i:02d}", factors=(0.2, 1.3 - 0.01 * i)) for i in range(MOST_LINES + 2)]
    figure = comparison_figure(runs)
    error, _, last = figure.axes

    names = [f"r{number:02d}" for number in range(MOST_LINES + 2)]
    assert [name for name in names if lines(error, name)] == names[2:]
    assert row_names(figure) == names
    assert [place(key)[1] for key in lines(last, "_key")] == list(range(2, len(runs)))
    assert f"lines above: the {MOST_LINES} runs with the smallest maximum error" in texts(figure)
    assert "left out" not in texts(figure)


def test_of_very_many_runs_the_worst_are_left_out_and_counted(make_run: MakeRun) -> None:
    runs = [make_run(f"r{i}", factors=(1.0 - 0.01 * i,)) for i in range(MOST_ROWS + 3)]
    runs.insert(1, make_run("wild", factors=(1.0,), diverged_at=1))
    figure = comparison_figure(runs)

    assert row_names(figure) == [f"r{number}" for number in range(MOST_ROWS)]
    assert f"4 of {len(runs)} runs, with larger errors, are left out" in texts(figure)
    assert overlaps(figure) == []


def test_different_trajectories_are_named(make_run: MakeRun) -> None:
    figure = comparison_figure([make_run("a"), make_run("b", straight())])

    assert row_names(figure) == ["a (circle)", "b (line)"]
    error, *paths, _ = figure.axes
    assert lines(error, "a") and lines(error, "b")
    for axes, name, other in zip(paths, "ab", "ba", strict=True):
        assert line(axes, name).get_color() == line(error, name).get_color()
        assert not lines(axes, other)
        assert line(axes, "Reference").get_color() == "black"
    assert overlaps(figure) == []


def test_of_many_trajectories_some_have_a_panel(make_run: MakeRun) -> None:
    runs = [make_run(f"r{i}", circle(10.0**i)) for i in range(MOST_PATHS + 2)]
    figure = comparison_figure(runs)

    assert len(figure.axes) == 1 + MOST_PATHS + 1
    assert f"those on {MOST_PATHS} of {MOST_PATHS + 2} trajectories" in texts(figure)
    assert overlaps(figure) == []


def test_heading_names_as_many_runs_as_fit(make_run: MakeRun) -> None:
    assert "2 runs: a, b" in texts(comparison_figure([make_run("a"), make_run("b")]))
    long = [make_run(f"{number}{'n' * 49}") for number in range(3)]
    assert f"3 runs: 0{'n' * 49}, 1{'n' * 49} and 1 more" in texts(comparison_figure(long))


def test_run_that_diverged_is_named_and_stretches_nothing(make_run: MakeRun) -> None:
    tame = [make_run("a"), make_run("b", factors=(0.2, 0.5))]
    wild = make_run("wild", factors=(0.5, 1e100), diverged_at=2)
    figure = comparison_figure([*tame, wild])
    last = figure.axes[2]

    assert "diverged in iteration 2" in texts(figure)
    assert last.get_xlim() == comparison_figure(tame).axes[2].get_xlim()
    assert len(lines(last, "_maximum")) == 2


def test_zero_error_stands_at_the_edge(make_run: MakeRun) -> None:
    figure = comparison_figure([make_run("a"), make_run("exact", factors=(0.5, 1.0))])
    last = figure.axes[2]
    marks = lines(last, "_zero")

    assert len(marks) == 2 and all(0 < place(mark)[0] < 0.05 for mark in marks)
    assert {place(mark)[1] for mark in marks} == {1}
    assert ZERO_LABEL in legend(last)


@pytest.mark.parametrize("factors", [(1.0,), (0.5,), (1e9,), (1 - 1e-14,)])
def test_equal_errors_leave_a_usable_axis(make_run: MakeRun, factors: tuple[float, ...]) -> None:
    figure = comparison_figure([make_run("a", factors=factors), make_run("b", factors=factors)])
    last = figure.axes[2]
    low, high = last.get_xlim()

    assert 0 < low < high < np.inf
    assert sum(low <= tick <= high for tick in last.get_xticks()) >= 2


@pytest.mark.parametrize(
    ("count", "name"),
    [(2, "_$x^2$"), (3, "a-name-of-sixty-characters-as-it-comes-out-of-a-gain-sweep-1"), (12, "N")],
)
def test_nothing_overlaps_or_leaves_the_sheet(make_run: MakeRun, count: int, name: str) -> None:
    runs = [make_run(name * (1 if len(name) > 1 else 64), saturated=5) for _ in range(count)]
    runs[-1] = make_run("other", circle(1e3), factors=(0.5, 9.0), diverged_at=2)
    figure = comparison_figure(runs)

    assert overlaps(figure) == []
    for label in figure.axes[-1].get_yticklabels():
        assert label.get_window_extent().x0 >= 0
    assert len(set(row_names(figure))) == count


def test_saved_in_each_format_asked_for(make_run: MakeRun, tmp_path: Path) -> None:
    runs = [make_run("a"), make_run("b")]
    paths = save_comparison(runs, tmp_path, ["png", "svg", "png"], dpi=40)
    assert paths == [tmp_path / "comparison.png", tmp_path / "comparison.svg"]
    before = [path.read_bytes() for path in paths]
    save_comparison(runs, tmp_path, ["png", "svg"], dpi=40)
    assert [path.read_bytes() for path in paths] == before


def test_nothing_is_drawn_of_nothing(tmp_path: Path, make_run: MakeRun) -> None:
    with pytest.raises(UsageError, match="no run to draw"):
        comparison_figure([])
    with pytest.raises(UsageError, match="unknown picture format 'gif'"):
        save_comparison([make_run("a"), make_run("b")], tmp_path, ["png", "gif"])
    assert list(tmp_path.iterdir()) == []
