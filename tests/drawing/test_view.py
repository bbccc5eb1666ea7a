"""The reference in pictures: dashed ahead, dotted backward, a dot where it stands."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from hilc_cli.drawing.view import draw_reference
from hilc_cli.reference.path import LinePlan, SegmentPlan, StopPlan, TurnPlan, build_reference
from hilc_cli.reference.sampled import Floats

AHEAD = LinePlan(length=1.0, duration=0.4)


def drawn(plans: list[SegmentPlan]) -> dict[str, Floats]:
    axes = Figure().subplots()
    draw_reference(axes, build_reference("path", (0.0, 0.0, 0.0), plans, 0.1))
    return {str(line.get_label()): np.asarray(line.get_xdata()) for line in axes.lines}


def test_reference_ahead_is_one_line() -> None:
    lines = drawn([AHEAD])
    assert list(lines) == ["Reference"]
    np.testing.assert_allclose(lines["Reference"], [0, 0.25, 0.5, 0.75, 1])


def test_way_backward_and_stands_are_told_apart() -> None:
    back = LinePlan(length=0.5, duration=0.2, reverse=True)
    lines = drawn([AHEAD, StopPlan(0.2), back, TurnPlan(1.0, duration=0.1)])
    assert list(lines) == ["Reference", "Reference, backward", "Stop or turn in place"]
    np.testing.assert_allclose(lines["Reference, backward"][6:9], [1, 0.75, 0.5])
    assert np.isnan(lines["Reference, backward"][:6]).all()
    np.testing.assert_allclose(lines["Stop or turn in place"], [1, 0.5])
