from __future__ import annotations

from typing import Any

import pytest
from matplotlib.figure import Figure

from hilc_cli.drawing.labels import PlainFormatter, shortened, tick_text, wrapped
from hilc_cli.drawing.layout import panel_size, root_figure


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([0.0, 0.5, 1.0], "0.0 0.5 1.0"),
        ([-5.0, 0.0, 5.0], "~5 0 5"),
        ([-1e6, 0.0, 1.5e6], "~1e6 0 1.5e6"),
        ([5e6, 5e6 + 2, 5e6 + 4], "5000000 5000002 5000004"),
        ([0.0, 5e-7], "0 5e~7"),
        ([1e99], "1e99"),
        ([], ""),
    ],
)
def test_ticks_are_short_and_never_alike(values: list[float], texts: str) -> None:
    assert " ".join(PlainFormatter().format_ticks(values)) == texts.replace("~", "\N{MINUS SIGN}")


def test_single_ticks() -> None:
    assert [tick_text(0.0), tick_text(0.02), tick_text(2e6)] == ["0", "0.02", "2e6"]
    assert PlainFormatter()(2e6) == "2e6"


def test_shortened_keeps_both_ends() -> None:
    assert shortened("abcdefghij", 10) == "abcdefghij"
    assert shortened("abcdefghijk", 6) == "ab\u2026ijk"


@pytest.mark.parametrize("name", ["x" * 200, "a-" * 100, "short", "two words"])
def test_wrapped_to_two_lines_at_most(name: str) -> None:
    lines = wrapped(name, 2.75).split("\n")

    assert len(lines) <= 2
    assert max(map(len, lines)) <= 2.75 * 72 / (0.6 * 9.5)


def test_size_of_panels_within_a_figure_of_a_figure() -> None:
    figure = Figure(figsize=(8, 4))
    halves: Any = figure.subfigures(1, 2)
    axes = halves[0].add_axes((0.25, 0.25, 0.5, 0.5))

    assert root_figure(axes) is figure
    assert panel_size(axes) == pytest.approx((2, 2))
