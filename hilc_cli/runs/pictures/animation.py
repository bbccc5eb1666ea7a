"""The robot on its way, pass by pass, as a picture that moves."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.text import Text
from matplotlib.transforms import Affine2D
from PIL.Image import Dither, Image, fromarray, new

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.drawing.sheet import Sheet
from hilc_cli.plants.kinematic import Robot
from hilc_cli.results.look import Look
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.runs.pictures.catalogue import MovingPicture
from hilc_cli.runs.pictures.path_change import chosen_trials

_MOST_PASSES = 6
_FRAMES, _HELD = 20, 5  # of a pass, and on which it stands at its end
_PER_SECOND = 15
_COLORS = 256  # of a GIF
_WIDTH = 3.8  # of the panel [inch]
_SMALLEST = 0.022  # half the robot's width, of the view
_PAST_COLOR = "0.72"


def save_animation(
    run: RunData, file: Path, dpi: int, iterations: Collection[int] | None, look: Look
) -> None:
    """Draws some of the recorded iterations frame by frame, and writes a GIF.

    Args:
        run: At least one iteration is recorded.
        file: Where to write.
        dpi: Dots per inch.
        iterations: The iterations that are shown; None for a few of all that are recorded.
        look: What the user asks for.

    Raises:
        OSError: The file cannot be written.
    """
    trials = _spread(chosen_trials(run, iterations))
    with style.applied(look):
        stage = _Stage(run, trials, look, dpi)
        frames = [
            stage.show(trial, sample)
            for trial in trials
            for sample in _samples(run.reference.samples)
        ]
    palette = _palette(frames[-1])
    first, *others = (frame.quantize(palette=palette, dither=Dither.NONE) for frame in frames)
    first.save(file, save_all=True, append_images=others, duration=1000 // _PER_SECOND, loop=0)


def _palette(last: Image) -> Image:
    """An image with the commonest colours of the last frame, which has all that there are.

    With one palette for all frames a GIF has a fifth of the bytes.
    """
    width, height = last.size
    counted: Any = last.getcolors(width * height)  # is typed for images of one channel, too
    common = sorted(counted, reverse=True)[:_COLORS]
    palette = new("P", (1, 1))
    palette.putpalette([channel for _, color in common for channel in color])
    return palette


def _samples(last: int) -> Iterator[int]:
    yield from np.linspace(0, last, _FRAMES).round().astype(int).tolist()
    yield from [last] * _HELD


def _spread(trials: list[Trial]) -> list[Trial]:
    """Returns at most as many passes as somebody watches, the first and the last among them.

    They lie at equal ratios, as learning changes the path most at the start.
    """
    if len(trials) <= _MOST_PASSES:
        return trials
    places = np.geomspace(1, len(trials), _MOST_PASSES).round().astype(int) - 1
    return [trials[place] for place in sorted(set(places.tolist()))]


class _Stage:
    """The sheet, on which everything that moves can be put in its place."""

    def __init__(self, run: RunData, trials: list[Trial], look: Look, dpi: int) -> None:
        """Draws what stays as it is, which takes longer than what moves."""
        self._run, self._trials = run, trials
        shown = view.view_of([run.reference], trials)
        height = max(2.4, _WIDTH * view.shape_of(shown))
        figure, axes = layout.single_panel(labels.shortened(run.name), _WIDTH, height, 0.0, look)
        assert isinstance(figure, Sheet)
        self.figure: Sheet = figure
        self._axes = axes
        shown = view.show(axes, shown)
        past, driven = style.THIN, 1.6 * style.PATH_WIDTH
        (self._past,) = axes.plot([], [], color=_PAST_COLOR, linewidth=past, label="Passes before")
        (self._driven,) = axes.plot(
            *([], []), color=style.FINAL_PATH_COLOR, linewidth=driven, label="This pass"
        )
        view.draw_reference(axes, run.reference)
        half = _SMALLEST * max(shown.width, shown.height)
        true = half if run.robot is None else run.robot.half_track
        self._scale = max(half / true, 1.0)
        self._robot = PathPatch(
            robot_outline(run.robot or Robot(0.4 * half, half)),
            facecolor="white",
            edgecolor="black",
            linewidth=style.THIN,
            zorder=7,
        )
        axes.add_patch(self._robot)
        title = self._title(trials[-1], run.reference.samples)
        layout.finish(figure, axes)
        figure.dpi = dpi * figure.scale
        canvas: Any = FigureCanvasAgg(figure)  # is not typed
        self._canvas = canvas
        self._moving: list[Artist] = [*axes.lines, self._robot, title]
        self._moving.sort(key=lambda artist: artist.get_zorder())
        for artist in self._moving:
            artist.set_animated(True)  # is left out of what stays
        canvas.draw()
        self._still = canvas.copy_from_bbox(figure.bbox)

    def show(self, trial: Trial, sample: int) -> Image:
        """A picture of the robot where it was at a sample of an iteration."""
        before = [each for each in self._trials if each.iteration < trial.iteration]
        gap = np.array([np.nan])
        self._past.set_data(
            *(
                np.concatenate([gap, *(np.append(getattr(each, axis), gap) for each in before)])
                for axis in ("x", "y")
            )
        )
        self._driven.set_data(trial.x[: sample + 1], trial.y[: sample + 1])
        turned = math.remainder(float(trial.heading[sample]), math.tau)
        there = Affine2D().scale(self._scale).rotate(turned)
        there.translate(float(trial.x[sample]), float(trial.y[sample]))
        self._robot.set_transform(there + self._axes.transData)
        self._title(trial, sample)
        self._canvas.restore_region(self._still)
        for artist in self._moving:
            self._axes.draw_artist(artist)
        return fromarray(np.asarray(self._canvas.buffer_rgba())[..., :3])

    def _title(self, trial: Trial, sample: int) -> Text:
        time = sample * self._run.reference.sample_time
        error = float(self._run.position_error(trial.iteration)[sample])
        text = f"Iteration {trial.iteration}, {time:.2f} s, error {labels.number_text(error, 3)} m"
        return labels.set_title(self._axes, text, [])


def robot_outline(robot: Robot) -> Outline:
    """A robot seen from above, at the origin and with heading 0 [m].

    Its wheels are to scale; how long it is, is not known, so it is drawn as long as it is wide.
    """
    half, radius = robot.half_track, robot.wheel_radius
    body = [(-0.9, -0.85), (1.1, -0.85), (1.1, 0.85), (-0.9, 0.85)]
    nose = [(1.0, 0.0), (0.35, -0.45), (0.35, 0.45)]
    shapes = [half * np.array(body), half * np.array(nose)]
    for side in (-half, half):
        wheel = np.array([(-radius, -0.15), (radius, -0.15), (radius, 0.15), (-radius, 0.15)])
        wheel[:, 1] = side + half * wheel[:, 1]
        shapes.append(wheel)
    return Outline.make_compound_path(
        *(Outline([*corners, corners[0]], closed=True) for corners in shapes)
    )


PICTURE = MovingPicture(save_animation)
