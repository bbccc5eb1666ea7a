"""The picture of a leaderboard, by the data and labels that it carries."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.picture import leaderboard_figure, save_leaderboard
from tests.drawing.reading import overlaps
from tests.leaderboards.test_contests import ENTRY, FAST

NOISY = [replace(entry, disturbance="noise") for entry in (ENTRY, FAST)]
OTHER = replace(ENTRY, case="line", max_m=(1.0, 0.25))
DATA = LeaderboardData("test", (1, 8), 0.01, (ENTRY, FAST, OTHER, *NOISY))


def test_a_panel_for_each_disturbance_with_medians_and_ranges() -> None:
    left, right = leaderboard_figure(DATA).axes
    assert [axes.get_title(loc="left").splitlines()[0] for axes in (left, right)] == [
        "Disturbance: none",
        "Disturbance: noise",
    ]
    lines = {str(line.get_label()): line for line in left.lines}
    assert overlaps(left.figure.figure) == []
    assert {"slow", "fast", "Tolerance, 0.01 m"} <= set(lines)
    np.testing.assert_allclose(np.asarray(lines["slow"].get_ydata(), float), [2, 0.375])
    for law in ("slow", "fast"):
        np.testing.assert_allclose(np.asarray(lines[law].get_xdata(), float), [1, 8])
    assert left.get_xscale() == "log"
    bars = [path.vertices for path in left.collections[0].get_paths()]
    heights = [sorted(float(y) for _, y in np.asarray(bar)) for bar in bars]
    assert heights == [[1, 3], [0.25, 0.5]]
    assert [text.get_text() for text in left.get_xticklabels()] == ["1", "8"]
    assert left.get_ylim() == right.get_ylim()


def test_what_has_diverged_or_has_no_error_is_drawn_at_the_edge() -> None:
    lost = replace(ENTRY, max_m=(math.inf, math.inf), diverged_at=1)
    none = replace(FAST, max_m=(0.0, 0.0))
    axes, *_ = leaderboard_figure(LeaderboardData("test", (1, 8), 0.01, (lost, none))).axes
    low, high = axes.get_ylim()
    assert 0 < low < 0.01 < high < math.inf


def test_iteration_zero_has_a_place_and_labels_do_not_meet() -> None:
    counts = (0, 1, 2, *range(90, 101))
    entries = [replace(entry, max_m=(1.0,) * len(counts)) for entry in (ENTRY, FAST)]
    figure = leaderboard_figure(LeaderboardData("test", counts, 0.01, tuple(entries)))
    assert overlaps(figure) == []
    labels = [label for label in figure.axes[0].get_xticklabels() if label.get_text()]
    assert [label.get_text() for label in labels[:4]] == ["0", "1", "2", "90"]
    boxes = [label.get_window_extent() for label in labels]
    assert all(one.x1 < other.x0 for one, other in pairwise(boxes))


def test_formats(tmp_path: Path) -> None:
    written = save_leaderboard(DATA, tmp_path, ["png", "svg"])
    assert [path.name for path in written] == ["leaderboard.png", "leaderboard.svg"]
    assert all(path.stat().st_size > 1000 for path in written)
    with pytest.raises(UsageError, match="gif"):
        save_leaderboard(DATA, tmp_path, ["gif"])
