"""The picture that moves: frames of some passes, with the robot in its place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from hilc_cli.errors import UsageError
from hilc_cli.plants.kinematic import Robot
from hilc_cli.runs.pictures import animation
from hilc_cli.runs.pictures.animation import robot_outline
from hilc_cli.runs.pictures.catalogue import draw, save_figures
from tests.made_up_runs import MakeRun

Pixels = NDArray[np.int64]
ORANGE = np.array([0xD5, 0x5E, 0x00])


@pytest.fixture(autouse=True)
def _few_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(animation, "_FRAMES", 4)
    monkeypatch.setattr(animation, "_HELD", 0)


def frames(file: Path) -> list[Pixels]:
    found: list[Pixels] = []
    with Image.open(file) as picture:
        for number in range(getattr(picture, "n_frames", 1)):
            picture.seek(number)
            found.append(np.asarray(picture.convert("RGB")).astype(np.int64))
    return found


def orange(frame: Pixels) -> int:
    """Pixels that are about as orange as the path of this pass."""
    return int((np.abs(frame - ORANGE).sum(axis=2) < 60).sum())


def test_the_path_grows_in_each_pass(make_run: MakeRun, tmp_path: Path) -> None:
    (file,) = save_figures([make_run(factors=(0.5, 0.9))], tmp_path, ["animation"], dpi=40)
    assert file == tmp_path / "animation.gif"
    found = frames(file)
    assert len(found) == 8
    driven = [orange(frame) for frame in found]
    legend = driven[0]
    for first in (0, 4):
        assert driven[first] == pytest.approx(legend, abs=3)
        assert driven[first] < driven[first + 1] < driven[first + 2] < driven[first + 3]
    assert driven[7] > driven[3]  # the larger circle


def test_few_passes_of_many_with_both_ends(make_run: MakeRun) -> None:
    trials = list(make_run(factors=np.linspace(0.2, 0.9, 40).tolist()).trials.values())
    numbers = [trial.iteration for trial in animation._spread(trials)]
    assert len(numbers) <= 6
    assert (numbers[0], numbers[-1]) == (0, 39)
    assert (np.diff(numbers, n=2) >= 0).all()  # dense at the start


def test_chosen_iterations_alone(make_run: MakeRun, tmp_path: Path) -> None:
    save_figures([make_run()], tmp_path, ["animation"], dpi=30, iterations={1})
    assert len(frames(tmp_path / "animation.gif")) == 4


def test_outline_is_as_wide_as_the_track_and_points_ahead() -> None:
    corners = np.asarray(robot_outline(Robot(0.2, 0.5)).vertices, dtype=float)
    assert np.abs(corners[:, 1]).max() == pytest.approx(0.5 * 1.15)  # a wheel's half width more
    wheels = corners[np.abs(corners[:, 1]) > 0.43]
    assert np.abs(wheels[:, 0]).max() == pytest.approx(0.2)  # their radius
    assert corners[:, 0].max() > -corners[:, 0].min()


def test_it_is_drawn_of_one_run_and_only_if_it_is_asked_for(
    make_run: MakeRun, tmp_path: Path
) -> None:
    save_figures([make_run()], tmp_path, dpi=30)
    assert not list(tmp_path.glob("*.gif"))
    with pytest.raises(UsageError, match="picture 'animation' is of one run, got 2"):
        save_figures([make_run(), make_run("b")], tmp_path, ["animation"])
    with pytest.raises(UsageError, match="picture 'animation' moves"):
        draw("animation", [make_run()])
