"""The picture of a path by the data that it carries."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from hilc_cli.paths.picture import path_figure
from hilc_cli.paths.plane import BACKWARD, CORNER, JOINT, STOP, TURN
from hilc_cli.paths.showing import ShownPath, show, show_reference
from tests.cli.inputs import SCENARIO, TRAJECTORY
from tests.conftest import Write
from tests.drawing.reading import legend, line, lines, overlaps, texts
from tests.paths.made_up import FORTH_AND_BACK, driven


def panel(figure: Figure, title: str) -> Axes:
    (found,) = [each for each in figure.axes if each.get_title(loc="left").startswith(title)]
    return found


def forth_and_back() -> ShownPath:
    reference, names = driven(FORTH_AND_BACK)
    return show_reference("forth-and-back", reference, names)


def test_path_alone_is_coloured_by_speed_and_tells_backward_stop_and_turn() -> None:
    path = forth_and_back()
    figure = path_figure(path)
    plane = panel(figure, "Path")
    assert plane.get_aspect() == 1
    assert figure.axes[1].get_ylabel() == "Speed [m/s]"  # of the colours
    back, forth = (each for each in plane.collections if isinstance(each, LineCollection))
    # Where both lie on each other, both are seen.
    assert back.get_zorder() < forth.get_zorder()
    assert np.min(back.get_linewidth()) > np.max(forth.get_linewidth())
    pieces = [*forth.get_segments(), *back.get_segments()]
    ends = [segment[[0, -1]] for segment in pieces]
    # A piece for each stretch of one speed and direction, end to end.
    assert len(ends) == 5
    for one, other in pairwise(ends):
        np.testing.assert_allclose(one[1], other[0], atol=1e-12)
    colors = np.concatenate([np.array(each.get_colors()) for each in (forth, back)])
    assert len(np.unique(colors, axis=0)) == 5
    reference = path.reference
    (dashes,) = lines(plane, "_backward")
    np.testing.assert_array_equal(dashes.get_xdata(), reference.x[350:])
    assert np.asarray(line(plane, STOP).get_xdata()).tolist() == [reference.x[100]]
    assert np.asarray(line(plane, TURN).get_xdata()).tolist() == [reference.x[150]]
    assert legend(plane) == [BACKWARD, JOINT, TURN, STOP, "Start"]
    assert len(lines(plane, "_arrow")) == 8
    numbers = [text.get_text() for text in plane.texts]
    assert numbers == ["1, 2", "0", "3", "4", "5", "6"]  # it stops and turns at one place
    assert not overlaps(figure)


def test_arrows_point_where_it_is_driven_to() -> None:
    path = forth_and_back()
    plane = panel(path_figure(path), "Path")
    last = lines(plane, "_arrow")[-1]
    turned = last._marker.get_user_transform()  # type: ignore[attr-defined]
    (tip,) = turned.transform([(1.0, 0.0)])
    heading = path.reference.heading[-1]
    np.testing.assert_allclose(tip / np.hypot(*tip), [-np.cos(heading), -np.sin(heading)])


def test_panels_beside_it_show_curvature_speed_and_yaw_rate() -> None:
    path = forth_and_back()
    figure = path_figure(path)
    curvature = line(panel(figure, "Curvature"), "_curvature")
    np.testing.assert_array_equal(curvature.get_xdata(), path.motion.distance)
    shown = np.asarray(curvature.get_ydata(), dtype=float)
    np.testing.assert_array_equal(shown[:-1], path.motion.curvature)
    assert panel(figure, "Curvature").get_xlabel() == "Distance [m]"
    for title, values in (("Speed", path.motion.speed), ("Yaw rate", path.motion.yaw_rate)):
        drawn = line(panel(figure, title), "_values")
        np.testing.assert_array_equal(drawn.get_xdata(), path.reference.times)
        np.testing.assert_array_equal(np.asarray(drawn.get_ydata())[:-1], values)


def test_wheels_are_drawn_against_their_limit() -> None:
    path = show("example:rounded-square")
    figure = path_figure(path)
    assert panel(figure, "Path").get_title(loc="left") == "Path, driven at 0.5 m/s"
    wheels = panel(figure, "Wheel speeds")
    for label, speeds in zip(("Left wheel", "Right wheel"), path.demand.wheels, strict=True):
        np.testing.assert_array_equal(np.asarray(line(wheels, label).get_ydata())[:-1], speeds)
    assert np.unique(line(wheels, "Speed limit").get_ydata()) == 10
    assert wheels.texts[0].get_text() == "+10"
    assert legend(wheels) == ["Left wheel", "Right wheel", "Speed limit"]
    assert not overlaps(figure)
    far = path_figure(show("example:rounded-square", ["controller.b_w=500"]))
    assert "speed limit ±500 rad/s is out of view" in texts(far)
    assert not lines(panel(far, "Wheel speeds"), "Speed limit")


def test_corners_are_marked_and_left_out_of_the_wheels(write: Write) -> None:
    corner = TRAJECTORY + "  - line: {to: [1, 1], duration: 0.3 s}\ncorners: allow\n"
    write({"path.yaml": corner, "scenario.yaml": SCENARIO})
    figure = path_figure(show("scenario.yaml"))
    assert np.asarray(line(panel(figure, "Path"), CORNER).get_xdata()).tolist() == [1.0]
    # In 0.1 s: (10 / 3 + 0.5 * 10 pi / 2) / 0.2 = 55.9 rad/s.
    assert "without corners, which take up to 55.9 rad/s" in texts(figure)
    assert not overlaps(figure)


def test_path_on_the_spot_and_one_of_a_single_step_are_drawn() -> None:
    spot = [piece for piece in FORTH_AND_BACK if piece[0] == "turn"]
    for pieces, panels in ((spot, 3), ([("line", np.ones(1), np.zeros(1))], 4)):
        reference, names = driven(pieces)
        figure = path_figure(show_reference("short", reference, names))
        figure.draw_without_rendering()
        assert len(figure.axes) == panels


def test_on_the_spot_the_heading_is_drawn_over_time() -> None:
    reference, names = driven([piece for piece in FORTH_AND_BACK if piece[0] in ("turn", "stop")])
    figure = path_figure(show_reference("spot", reference, names))
    drawn = line(panel(figure, "Heading"), "_heading")
    assert np.asarray(drawn.get_xdata()).tolist() == reference.times.tolist()
    assert np.asarray(drawn.get_ydata()).tolist() == reference.heading.tolist()
    assert panel(figure, "Path").get_title(loc="left") == "Path, on the spot"
    assert not overlaps(figure)


def test_stops_and_turns_are_numbered_as_segments() -> None:
    figure = path_figure(show("example:turn-in-place"))
    numbers = {each.get_text() for each in panel(figure, "Path").texts}
    assert numbers == {"0", "1", "2", "3, 4", "5"}
    assert not overlaps(figure)


def test_picture_names_the_trajectory_within_a_scenario() -> None:
    shown = show("example:small-robot", {"trajectory": "example:square-lap"})
    assert "small-robot: square-lap" in texts(path_figure(shown))
