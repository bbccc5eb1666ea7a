"""The picture of an alignment."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hilc_cli.drawing.looks import picture_look
from hilc_cli.drawing.save import render
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.alignment import AlignedTrial, AlignOptions, align
from hilc_cli.logs.picture import alignment_figure
from hilc_cli.logs.planned import PlannedPass
from hilc_cli.logs.reading import read_log
from hilc_cli.plants.kinematic import Robot
from hilc_cli.results.look import USUAL, Look
from tests.logs.made_up_logs import MadeUpRobot, winding_plan, write_csv


@pytest.fixture(scope="module")
def aligned(tmp_path_factory: pytest.TempPathFactory) -> tuple[AlignedTrial, PlannedPass]:
    plan = winding_plan()
    wheels = np.stack([plan.left, plan.right], axis=1)
    place = tmp_path_factory.mktemp("logs") / "log.csv"
    log = read_log(write_csv(place, MadeUpRobot(delay=0.1).drive(0.02, wheels)))
    believed = Motor(0.1, 0.1, -0.25, 0.1, 0.05, 0.0)
    options = AlignOptions(lag_is_known=True)
    return align(log, plan, believed, Robot(0.1, 0.25, "rep103"), options), plan


def look_of_width(width: str | None) -> Look:
    if width is None:
        return USUAL
    return picture_look(width=width, font="", font_size=None, style=None, title=True)


@pytest.mark.parametrize("width", [None, "85mm"])
def test_the_picture_shows_path_and_speeds(
    aligned: tuple[AlignedTrial, PlannedPass], width: str | None, tmp_path: Path
) -> None:
    trial, plan = aligned
    figure = alignment_figure(trial, plan, look_of_width(width))
    path, speeds = figure.axes
    lines = {line.get_label(): line for line in path.lines}
    assert lines["Reference"].get_xydata()[:, 0] == pytest.approx(plan.reference.x)  # type: ignore[index]
    inside = (trial.reading_times >= 0) & (trial.reading_times <= plan.end)
    assert np.shape(lines["Measured"].get_xydata()) == (inside.sum(), 2)
    assert path.get_aspect() == 1
    assert (path.get_xlabel(), path.get_ylabel()) == ("x [m]", "y [m]")
    assert (speeds.get_xlabel(), speeds.get_ylabel()) == ("Time from sample 0 [s]", "Speed [m/s]")
    likeliest = next(line for line in speeds.lines if line.get_label() == "Likeliest path")
    # The plan's 0.5 m/s.
    assert np.median(np.asarray(likeliest.get_ydata())) == pytest.approx(0.5, abs=0.02)
    assert render(figure, "png", 40).startswith(b"\x89PNG")
