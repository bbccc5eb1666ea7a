from __future__ import annotations

import subprocess
import sys
from collections import Counter
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from hilc_cli.drawing.save import FORMATS
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.learning import LearningTable
from hilc_cli.results.picture_kinds import RUN_PICTURES
from hilc_cli.runs.pictures.catalogue import draw, kinds_of, save_figures
from tests.drawing.reading import legend, overlaps
from tests.made_up_runs import MakeRun, circle, straight


def test_unknown_kind_is_named_with_the_nearest_or_all(make_run: MakeRun) -> None:
    with pytest.raises(
        UsageError, match="unknown kind of picture 'sumary'; did you mean 'summary'"
    ):
        draw("sumary", [make_run()])
    with pytest.raises(
        UsageError,
        match="known: animation, error, error-along-path, final-path, learning, path-change, sum",
    ):
        draw("xyz", [make_run()])


@pytest.mark.parametrize("kind", RUN_PICTURES)
def test_every_kind_checks_its_runs_and_iterations(make_run: MakeRun, kind: str) -> None:
    with pytest.raises(UsageError, match="no run to draw"):
        draw(kind, [])
    with pytest.raises(UsageError, match="iterations 7, 8 not recorded; recorded: 0, 1, 2, 3"):
        draw(kind, [make_run()], [8, 7])


def test_iteration_that_was_not_recorded(make_run: MakeRun) -> None:
    runs = [make_run(recorded=[0, 3]), make_run(recorded=[1, 3])]

    with pytest.raises(UsageError, match=r"^iteration 2 not recorded; recorded: 0, 1, 3$"):
        draw("path-change", runs, [1, 2])
    with pytest.raises(UsageError, match=r"^no iterations to draw; recorded: 0, 1, 3$"):
        draw("path-change", runs, [])


def test_saves_each_kind_in_each_format(make_run: MakeRun, tmp_path: Path) -> None:
    kinds = ("error", "learning")  # that all kinds are drawn is seen in one format
    paths = save_figures([make_run()], tmp_path, kinds, formats=FORMATS, dpi=50)

    assert paths == [tmp_path / f"{kind}.{name}" for kind in kinds for name in FORMATS]
    starts = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert all(path.read_bytes().startswith(starts[path.suffix]) for path in paths)


def test_there_is_no_picture_of_what_is_not_told(make_run: MakeRun, tmp_path: Path) -> None:
    silent = make_run("silent", learning=LearningTable())
    others = [kind for kind in RUN_PICTURES if kind != "learning"]

    assert kinds_of([silent]) == others
    assert kinds_of([silent, make_run()]) == list(RUN_PICTURES)
    assert [path.stem for path in save_figures([silent], tmp_path, dpi=30)] == others
    with pytest.raises(UsageError, match="there is no picture 'learning' of silent: nothing is"):
        draw("learning", [silent])
    with pytest.raises(UsageError, match="of these 2 runs: nothing is told of what was learned"):
        draw("learning", [silent, silent])


def test_nothing_is_written_if_anything_is_unknown(make_run: MakeRun, tmp_path: Path) -> None:
    runs = [make_run()]
    with pytest.raises(UsageError, match="unknown picture format 'gif'"):
        save_figures(runs, tmp_path, formats=["png", "gif"])
    with pytest.raises(UsageError, match="unknown kind"):
        save_figures(runs, tmp_path, kinds=["error", "eror"])
    with pytest.raises(UsageError, match="not recorded"):
        save_figures(runs, tmp_path, iterations=[9])

    assert list(tmp_path.iterdir()) == []


LONG = "a-name-of-sixty-characters-as-it-comes-out-of-a-gain-sweep-1"


@pytest.mark.parametrize("kind", RUN_PICTURES)
@pytest.mark.parametrize(
    ("count", "name"), [(1, "_$x^2$"), (1, "N" * 60), (2, "run"), (3, LONG), (10, LONG)]
)
def test_nothing_overlaps(make_run: MakeRun, kind: str, count: int, name: str) -> None:
    runs = [make_run(name, saturated=5, factors=[0.5, 9.0]) for _ in range(count)]

    assert overlaps(draw(kind, runs)) == []


@pytest.mark.parametrize("kind", RUN_PICTURES)
@pytest.mark.parametrize("reference", [circle(1e-3), circle(1e6), straight()])
def test_other_paths_do_not_overlap_either(
    make_run: MakeRun, kind: str, reference: Reference
) -> None:
    runs = [make_run(reference=reference, diverged_at=9, factors=[0.5, 9.0, 1.0])]

    assert overlaps(draw(kind, runs)) == []


def test_equal_names_are_told_apart(make_run: MakeRun) -> None:
    axes = draw("error", [make_run("a"), make_run("a"), make_run("a (2)"), make_run("_b")]).axes[0]

    assert legend(axes)[:4] == ["a", "a (2)", "a (2) (2)", " _b"]


def test_summary_shows_four_kinds(make_run: MakeRun) -> None:
    panels = draw("summary", [make_run()]).axes

    wheels = {"Left wheel [rad/s]", "Right wheel [rad/s]"}
    labels = {axes.get_ylabel() for axes in panels}
    assert labels == {"y [m]", "Iteration", "Position error [m]", *wheels}
    assert len(panels) == 6


@pytest.mark.parametrize("count", [2, 5, 7])
@pytest.mark.parametrize("kind", ["summary", "path-change", "error-along-path"])
def test_several_runs_have_one_legend_one_title_and_no_empty_place(
    make_run: MakeRun, kind: str, count: int
) -> None:
    runs = [make_run(f"r{i}", factors=(0.5, 1 + i / 10)) for i in range(count)]
    figure = draw(kind, runs)
    paths = [axes for axes in figure.axes if axes.get_ylabel() == "y [m]"]

    boxes = [axes.get_legend() for axes in figure.axes]
    (box,) = [box for box in (*boxes, *figure.legends) if box is not None]
    found = [text.get_text() for text in box.get_texts()]
    assert len(set(found)) == len(found) and "Reference" in found
    if kind != "path-change":  # whose panels are called as the runs
        assert found[:count] == [f"r{i}" for i in range(count)]
    heading = figure.texts[0].get_text()
    assert f"{count} runs" in heading and "r0, r1" in heading
    of_runs = [axes for axes in paths if not axes.get_title(loc="left").startswith("Final")]
    assert len(of_runs) == count
    limits = [(*axes.get_xlim(), *axes.get_ylim()) for axes in of_runs]
    np.testing.assert_allclose(limits, limits[:1] * count, rtol=1e-12)
    # Rows from the top down are full, up to the last: there the legend or wheel speeds are.
    rows = Counter(round(axes.get_position().y0, 6) for axes in paths)
    per_row = [rows[place] for place in sorted(rows, reverse=True)]
    assert set(per_row[:-1]) <= {per_row[0]}
    if kind == "summary":
        wheel = next(axes for axes in figure.axes if axes.get_ylabel().startswith("Right wheel"))
        first_row = max(axes.get_position().x1 for axes in of_runs)
        assert wheel.get_position().x1 == pytest.approx(first_row)


@pytest.mark.parametrize("kind", RUN_PICTURES)
def test_numbers_near_the_end_of_double_precision(
    make_run: MakeRun, kind: str, tmp_path: Path
) -> None:
    run = make_run(factors=[0.5, 1e100, 1e140], diverged_at=3)
    run.last.left[:] = 1e150

    save_figures([run], tmp_path, [kind], dpi=50)


def test_ink_lies_where_the_reference_is(make_run: MakeRun) -> None:
    run = make_run(factors=[1.0])
    figure = draw("final-path", [run])
    figure.dpi = 60
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].min(axis=2)  # type: ignore[no-untyped-call]
    points = np.column_stack((run.reference.x, run.reference.y))
    columns, rows = figure.axes[0].transData.transform(points).round().astype(int).T
    height = pixels.shape[0]
    inked = [
        pixels[height - r - 3 : height - r + 2, c - 2 : c + 3].min() < 128
        for r, c in zip(rows.tolist(), columns.tolist(), strict=True)
    ]

    assert np.mean(inked) > 0.98


def test_drawing_changes_no_global_settings(make_run: MakeRun, tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)

    save_figures([make_run()], tmp_path, dpi=50)

    assert dict(matplotlib.rcParams) == before


def test_drawing_needs_neither_pyplot_nor_a_screen(tmp_path: Path) -> None:
    program = """
import sys
import numpy as np
from pathlib import Path
from hilc_cli.runs.pictures.catalogue import save_figures
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import MetricsTable, measure
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
x = np.linspace(0, 1, 11)
reference = Reference("line", 0.1, x, 0 * x, 0 * x)
trial = Trial(0, x, 0 * x + 1, 0 * x, x[1:], x[1:])
table = MetricsTable()
table.append(measure(trial, reference, None))
save_figures([RunData("r", reference, table, {0: trial})], Path(sys.argv[1]), dpi=30)
print([name for name in ("matplotlib.pyplot", "tkinter", "matplotlib.backends.backend_svg",
                         "matplotlib.backends.backend_pdf") if name in sys.modules])
"""
    done = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)],
        capture_output=True,
        text=True,
        check=False,
    )

    assert (done.stdout.strip(), done.stderr, done.returncode) == ("[]", "", 0)
