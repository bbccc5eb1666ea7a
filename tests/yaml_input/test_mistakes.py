"""What people write who come from other programs or keyboards, and what they are told."""
# ruff: noqa: E501, RUF001

from __future__ import annotations

import re

import pytest

from hilc_cli.errors import InvalidInputError
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.planning import plan_sweep
from tests.cli.inputs import SCENARIO, TRAJECTORY, plus, scenario, trajectory
from tests.conftest import Write

ROBOT = "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}\n"
HERE = "scenario.yaml"


def robot(text: str) -> str:
    return scenario(ROBOT, text)


def told(content: str = SCENARIO, path: str = TRAJECTORY, *, write: Write) -> list[str]:
    """The lines that are told of a scenario and its trajectory."""
    write({HERE: content, "path.yaml": path})
    with pytest.raises(InvalidInputError) as error:
        load_scenario(HERE)
    return [str(problem) for problem in error.value.problems]


SEPARATION = (
    "is an unknown key; the distance between the left and the right wheel is wheel_separation"
)
LEVELS = [
    (
        "flat",
        robot("robot:\nturn_convention: ros\nhalf_track: 0.3\nwheel_radius: 4 cm\n"),
        "4:1: turn_convention: is an unknown key; it is a key of 'robot': indent it below 'robot:'",
    ),
    (
        "below the model",
        plus("model:\nhalf_track: 0.3\n"),
        "9:1: half_track: is an unknown key; it is a key of 'model': indent it below 'model:'",
    ),
    (
        "one level out",
        scenario("  gains: {l1: 0.5}\n", "  gains:\n  l2: 0.5\n"),
        "7:3: controller.l2: is an unknown key of law hybrid; it is a key of 'controller.gains': indent it below 'gains:'",
    ),
    (
        "one level in",
        scenario("  gains: {l1: 0.5}\n  b_w: 180", "  gains:\n    l1: 0.5\n    h: 2"),
        "8:5: controller.gains.h: is an unknown key of law hybrid; it is a key of 'controller': indent it less",
    ),
    (
        "one level in from the top",
        robot(ROBOT.replace("robot: {", "robot: {initial_input: zero, ")),
        "3:9: robot.initial_input: is an unknown key; it is a key of the top level: indent it less",
    ),
    (
        "dots",
        plus("disturbance.seed: 3\n"),
        "8:1: disturbance.seed: is an unknown key; in a file, write each part below the one before it, without dots",
    ),
    (
        "capitals",
        scenario("iterations: 2", "Iterations: 2"),
        "4:1: Iterations: is an unknown key; did you mean 'iterations'?",
    ),
    (
        "camel case",
        robot(ROBOT.replace("half_track", "wheelSeparation")),
        "3:28: robot.wheelSeparation: is an unknown key; did you mean 'wheel_separation'?",
    ),
    (
        "last word",
        robot(ROBOT.replace("half_track", "separation")),
        "3:28: robot.separation: is an unknown key; did you mean 'wheel_separation'?",
    ),
    (
        "wheelbase",
        robot(ROBOT.replace("half_track", "wheelbase")),
        f"3:28: robot.wheelbase: {SEPARATION}",
    ),
    (
        "wheel_base",
        robot(ROBOT.replace("half_track", "wheel_base")),
        f"3:28: robot.wheel_base: {SEPARATION}",
    ),
    (
        "track-width",
        robot(ROBOT.replace("half_track", "track-width")),
        f"3:28: robot.track-width: {SEPARATION}",
    ),
    (
        "axle_track",
        robot(ROBOT.replace("half_track", "axle_track")),
        f"3:28: robot.axle_track: {SEPARATION}",
    ),
    ("track of the model", plus("model: {track: 1}\n"), f"8:9: model.track: {SEPARATION}"),
    (
        "diameter",
        robot(ROBOT.replace("wheel_radius", "Wheel_Diameter")),
        "3:9: robot.Wheel_Diameter: is an unknown key; half of it is wheel_radius",
    ),
    (
        "no gain of this number",
        scenario("{l1: 0.5}", "{l1: 0.5, l7: 1}"),
        "6:20: controller.gains.l7: is an unknown key of law hybrid; known: derivative, l1, l2, l3, lateral",
    ),
]


@pytest.mark.parametrize(
    ("content", "line"), [pytest.param(*case, id=name) for name, *case in LEVELS]
)
def test_misplaced_and_foreign_keys_are_told_what_they_are(
    write: Write, content: str, line: str
) -> None:
    assert f"{HERE}:{line}" in told(content, write=write)


@pytest.mark.parametrize(
    ("segments", "line"),
    [
        (
            "  - arc:\n    radius: 2\n",
            "path.yaml:6:5: trajectory.segments.0.radius: is an unknown key; it is a key of 'trajectory.segments.arc': indent it below 'arc:'",
        ),
        (
            "  - line: {length: 1, duration: 0.3 s, closed: true}\n",
            "path.yaml:5:40: trajectory.segments.0.line.closed: is an unknown key; it is a key of 'trajectory': indent it less",
        ),
        (
            "  - semicircle: {radius: 1, turn: left, sweep: 1, speed: 1}\n",
            "path.yaml:5:41: trajectory.segments.0.semicircle.sweep: is an unknown key; it is a key of 'trajectory.segments.arc'",
        ),
    ],
)
def test_levels_of_a_trajectory(write: Write, segments: str, line: str) -> None:
    path = trajectory("  - line: {length: 1, duration: 0.3 s}\n", segments)
    assert line in told(path=path, write=write)


OVERRIDES = [
    ("l2", "did you mean 'controller.gains.l2'?"),
    ("L2", "did you mean 'controller.gains.l2'?"),
    ("gains.lateral", "did you mean 'controller.gains.lateral'?"),
    ("controller.lateral", "did you mean 'controller.gains.lateral'?"),
    ("Controller.Gains.L3", "did you mean 'controller.gains.l3'?"),
    ("B_W", "did you mean 'controller.b_w'?"),
    ("half_track", "did you mean 'robot.half_track' or 'model.half_track'?"),
    ("seed", "did you mean 'disturbance.seed'?"),
    ("output.repeat", "did you mean 'disturbance.output.repeat'?"),
    ("gravity_center.1", "did you mean 'robot.gravity_center.1'?"),
    ("start.x", "did you mean 'trajectory.start.x'?"),
    ("kd", "did you mean 'controller.gains.kd'? It needs 'law: pid'"),
    ("wheel_seperation", "did you mean 'robot.wheel_separation' or 'model.wheel_separation'?"),
    ("length", "did you mean 'trajectory.segments.0.line.length'?"),
    ("line.length", "did you mean 'trajectory.segments.0.line.length'?"),
    ("speed", "did you mean 'trajectory.timing.speed'?"),
    ("reverse", "entries of 'trajectory.segments' may have it, and none has it here"),
    ("laps", "their number is iterations"),
]


@pytest.mark.parametrize(("key", "hint"), OVERRIDES)
def test_keys_are_completed_by_their_end(write: Write, key: str, hint: str) -> None:
    write()
    with pytest.raises(InvalidInputError) as error:
        load_scenario(HERE, [f"{key}=0.25"])
    (line,) = map(str, error.value.problems)
    assert line.endswith(f"; {hint}")
    if not hint.endswith("pid'"):  # what is suggested is a key: if anything, the value is wrong
        for suggested in re.findall("'([^']*)'", hint):
            try:
                load_scenario(HERE, [f"{suggested}=0.25"])
            except InvalidInputError as wrong:
                assert "unknown key" not in str(wrong)


OF_OTHER_LAW = [
    ("kp", "did you mean 'controller.gains.kp'? It needs 'law: pid'"),
    ("gains.l1", "did you mean 'controller.gains.l1'? It needs 'law: hybrid'"),
    ("gains.lateral", "did you mean 'controller.gains.lateral'? It needs 'law: hybrid'"),
]


@pytest.mark.parametrize(("key", "hint"), OF_OTHER_LAW)
def test_keys_of_another_law_are_told_with_it(write: Write, key: str, hint: str) -> None:
    write({HERE: scenario("  gains: {l1: 0.5}\n", "  law: norm-optimal\n")})
    told = f"{key}=1: {key.split('.')[0]}: is an unknown key; {hint}"
    with pytest.raises(InvalidInputError) as error:
        load_scenario(HERE, [f"{key}=1"])
    assert str(error.value) == f"--set {told}"
    with pytest.raises(InvalidInputError) as error:
        plan_sweep(load_scenario(HERE), [f"{key}=1"])
    assert str(error.value) == f"--vary {told}"


@pytest.mark.parametrize("key", ["l5", "gains.l9", "qqq", "controller.gains.kp9", "robot.hue"])
def test_no_suggestion_is_better_than_a_wrong_one(write: Write, key: str) -> None:
    write()
    with pytest.raises(InvalidInputError, match="known: ") as error:
        load_scenario(HERE, [f"{key}=1"])
    assert "did you mean" not in str(error.value)


NUMBERS = [
    ("speed", "0.7 mps", "0.7 m/s"),
    ("speed", "3 kmh", "3 km/h"),
    ("speed", "3 kph", "3 km/h"),
    ("speed", "3 KM/H", "3 km/h"),
    ("speed", "3 km / hr", "3 km/h"),
    ("speed", "3 meters/second", "3 m/s"),
    ("speed", "2,5 m/s", "2.5 m/s"),
    ("speed", "4 mph", "4*0.44704 m/s"),
    ("length", "3 inches", "3*25.4 mm"),
    ("length", "3 centimetres", "3 cm"),
    ("length", "1,25", "1.25"),
    ("length", "2 MM", "2 mm"),
    ("length", "“3 m”", "3 m"),
    ("length", "3\u00b71 m", "3*1 m"),
    ("length", "2 km", "2*1000 m"),
]


@pytest.mark.parametrize(("key", "text", "meant"), NUMBERS)
def test_numbers_of_others_are_put_into_words_that_work(
    write: Write, key: str, text: str, meant: str
) -> None:
    segment = {
        "speed": f"{{length: 1, speed: '{text}'}}",
        "length": f"{{length: '{text}', speed: 2}}",
    }
    path = trajectory("{length: 1, duration: 0.3 s}", segment[key])
    (line,) = told(path=path, write=write)
    assert line.startswith(
        f"path.yaml:5:{20 if key == 'length' else 30}: trajectory.segments.0.line.{key}: has "
    )
    assert f"; did you mean '{meant}'?" in line
    write({"path.yaml": path.replace(text, meant)})
    load_scenario(HERE)


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ("20 mn", "give it in mm, cm or m"),
        ("3 mps", "give it in mm, cm or m"),
        ("1,500", "give a number above 0, such as 0.2 or 20 cm"),  # a thousand and a half, or more
        ("3 rpm", "give a number above 0, such as 0.2 or 20 cm"),
    ],
)
def test_what_fits_no_unit_gets_no_wrong_one(write: Write, text: str, remedy: str) -> None:
    (line,) = told(robot(ROBOT.replace("0.2", f"'{text}'")), write=write)
    assert line.endswith(f"got '{text}'; {remedy}")


NBSP = "has a no-break space (U+00A0); write a plain space"
CHARACTERS = [
    ("indented by tab", robot(f"robot:\n\t{ROBOT[8:20]}: 0.2\n"), "4:1: is indented with a tab; indent with spaces"),
    ("tab behind spaces", scenario("  b_w: 180", "  \tb_w: 180"), "7:3: is indented with a tab; indent with spaces"),
    ("behind the colon", robot("robot:\n  half_track:\u00a00.5\n  wheel_radius: 0.2\n"), f"4:14: {NBSP}"),
    ("behind the last colon", robot("robot:\n  wheel_radius: 0.2\n  half_track:\u00a00.5\n"), f"5:14: {NBSP}"),
    ("in braces", robot(ROBOT.replace("half_track: ", "half_track:\u00a0")), f"3:39: {NBSP}"),
    ("indented", robot("robot:\n\u00a0 wheel_radius: 0.2\n\u00a0 half_track: 0.5\n"), f"4:1: {NBSP}"),
    ("behind an umlaut", plus("description: größer\nrecord:\u00a0{}\nsweep: {}\n"), f"9:8: {NBSP}"),
    ("narrow", robot(ROBOT.replace("robot: ", "robot:\u202f")), "3:7: has a narrow no-break space (U+202F); write a plain space"),
    ("unseen", robot(ROBOT.replace("half", "\u200bhalf")), "3:28: has a zero width space (U+200B); remove it"),
    ("byte order mark", plus("\ufeffrecord: {}\n"), "8:1: has a byte order mark (U+FEFF); remove it"),
    ("wide colon", robot(ROBOT.replace("half_track:", "half_track：")), "3:38: has a fullwidth colon (U+FF1A); write a plain :"),
    ("backslash", scenario("path.yaml", '"C:\\Users\\path.yaml"'), "2:16: has a backslash in double quotes, where it starts an escape; use single quotes, or / instead"),
    ("stray indentation", scenario("iterations: 2", " iterations: 2"), "4:2: stands in column 2, where nothing above it starts; indent it as its neighbours are"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("content", "line"), [pytest.param(*case, id=name) for name, *case in CHARACTERS]
)
def test_characters_are_named_where_they_stand(write: Write, content: str, line: str) -> None:
    assert told(content, write=write) == [f"{HERE}:{line}"]


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (
            robot(ROBOT.replace("paper", "paper\u00a0")),
            "3:62: robot.turn_convention: is not one of the choices, got 'paper\ufffd'; did you mean 'paper'? It has a no-break space (U+00A0): write a plain space",
        ),
        (
            plus("initial_trial: “feedback”\n"),
            "8:16: initial_trial: is not one of the choices, got '“feedback”'; did you mean 'feedback'? It has a left double quotation mark (U+201C): write plain quotes, or none",
        ),
        (
            scenario("path.yaml", '"data\\test.yaml"'),
            "2:13: trajectory: data\ufffdest.yaml: there is no such file; check the path; it has a tab, since a backslash in double quotes starts an escape: write the text in single quotes, or / instead",
        ),
        (
            robot(ROBOT.replace("0.2", "\ufeff0.2")),
            "3:23: robot.wheel_radius: has '\ufffd', which is no part of it, got '\ufffd0.2'; did you mean '0.2'? It has a byte order mark (U+FEFF): remove it",
        ),
    ],
)
def test_characters_in_wrong_values_are_named_beside_them(
    write: Write, content: str, line: str
) -> None:
    assert told(content, write=write) == [f"{HERE}:{line}"]


def test_odd_characters_are_nothing_odd_in_texts_and_comments(write: Write) -> None:
    write({HERE: plus("# 5\u00a0m\ndescription: “5\u00a0m” – wide # \u200b\n")})
    assert load_scenario(HERE).spec.description == "“5\u00a0m” – wide"


@pytest.mark.parametrize(
    ("content", "lines"),
    [
        (
            robot(ROBOT.replace("0.2", "0,3").replace("0.5", "1,5 m")),
            [
                "3:23: robot.wheel_radius: has a decimal comma, got '0,3'; did you mean '0.3'?",
                "3:40: robot.half_track: has a decimal comma, got '1,5 m'; did you mean '1.5 m'?",
            ],
        ),
        (
            robot(ROBOT.replace("paper", "paper, gravity_center: [0,3, 1,5]")),
            [
                "3:85: robot.gravity_center: has decimal commas, which part the entries of a list; write decimal points"
            ],
        ),
        (
            scenario("b_w: 180", "b_w: 17,5"),
            ["7:8: controller.b_w: has a decimal comma, got '17,5'; did you mean '17.5'?"],
        ),
    ],
)
def test_decimal_commas(write: Write, content: str, lines: list[str]) -> None:
    assert told(content, write=write) == [f"{HERE}:{line}" for line in lines]


def test_commas_without_space_are_no_decimal_commas_elsewhere(write: Write) -> None:
    write({HERE: robot(ROBOT.replace("paper", "paper,gravity_center: [1,2]"))})
    assert load_scenario(HERE).spec.robot.gravity_center == (1, 2)


DEGREES = [
    (
        "heading: 0}",
        "to: [0, 5], speed: 1",
        "arc: {radius: 1, turn: left, sweep: 45, speed: 1}",
        "; segments.0.arc.sweep is 45 rad = 7.16 turns (45 deg?)",
    ),
    (
        "heading: 90}",
        "to: [0, 1], speed: 1",
        "",
        "; start.heading is 90 rad = 14.3 turns (90 deg?)",
    ),
    ("heading: pi/3}", "to: [0, 5], speed: 1", "", ""),
]


@pytest.mark.parametrize(("heading", "line", "arc", "note"), DEGREES)
def test_degrees_without_a_unit_are_noticed_where_the_path_does_not_fit(
    write: Write, heading: str, line: str, arc: str, note: str
) -> None:
    path = trajectory("length: 1, duration: 0.3 s", line).replace("heading: 0}", heading)
    if arc:
        path = path.replace("segments:\n", f"segments:\n  - {arc}\n")
    (problem,) = told(path=path, write=write)
    assert problem.endswith(f"; make them equal or set 'corners: allow'{note}")


def test_degrees_are_noticed_where_the_path_does_not_close(write: Write) -> None:
    arc = "arc: {radius: 2, turn: right, sweep: 360, speed: 1}"
    path = trajectory("line: {length: 1, duration: 0.3 s}", arc) + "closed: true\n"
    (problem,) = told(path=path, write=write)
    assert problem.endswith("; segments.0.arc.sweep is 360 rad = 57.3 turns (360 deg?)")
    write({"path.yaml": path.replace("360", "360 deg")})
    load_scenario(HERE)


KNOWN_KINDS = [
    ("root:$6$abc$HIDDEN:19000:0:99999:7:::\ndaemon:*:HIDDEN:0\n", "3:1"),
    ("HIDDEN: 1\nname: HIDDEN\nstart: HIDDEN\n", "1:1"),
    ("key: [HIDDEN\nHIDDEN]: {\n", "2:8"),
    ("key: *HIDDEN\n", "1:6"),
    ("key: !HIDDEN HIDDEN\n", "1:1"),
    ("HIDDEN: 1\nHIDDEN: 2\n", "1:1"),
    ("- HIDDEN\n", "1:1"),
    ("HIDDEN HIDDEN\n", "1:1"),
    (b"HIDDEN\n\xfe\n", "2:1"),
    ("model: HIDDEN\n", "1:1"),
]


@pytest.mark.parametrize(("content", "place"), KNOWN_KINDS)
def test_nothing_is_shown_of_a_file_that_is_no_trajectory(
    write: Write, content: str | bytes, place: str
) -> None:
    write({"path.yaml": content})
    for changes in ([], ["trajectory=path.yaml"]):
        with pytest.raises(InvalidInputError) as error:
            load_scenario(HERE, changes)
        (line,) = map(str, error.value.problems)
        assert line.startswith(f"path.yaml:{place}: ")
        assert "HIDDEN" not in line
        assert "0x" not in line


@pytest.mark.parametrize("content", [text for text, _ in KNOWN_KINDS[:-1]])
def test_nothing_is_shown_of_a_file_that_is_no_scenario(write: Write, content: str | bytes) -> None:
    write({HERE: content})
    with pytest.raises(InvalidInputError) as error:
        load_scenario(HERE)
    (line,) = map(str, error.value.problems)
    assert "HIDDEN" not in line


def test_a_trajectory_with_a_typo_shows_it(write: Write) -> None:
    (line,) = told(path=trajectory("sample_time: 100 ms", "sample_time: 100 mz"), write=write)
    assert line == (
        "path.yaml:2:14: trajectory.sample_time: has the unknown unit 'mz', got '100 mz'; give it in ms or s"
    )
    (line,) = told(path=TRAJECTORY + "closed: *anchor\n", write=write)
    assert line == "path.yaml:6:9: alias *anchor has no anchor; define &anchor before it"


ABSURD = ["." * 3_000, "a." * 700 + "b", "7" * 5_000, "robot.gravity_center." + "1" * 4_500]


@pytest.mark.parametrize("key", ABSURD, ids=["dots", "parts", "digits", "place in a list"])
def test_absurd_keys_end_in_a_short_line(write: Write, key: str) -> None:
    write()
    for given in ([f"{key}=1"], {key: 1}):
        with pytest.raises(InvalidInputError) as error:
            load_scenario(HERE, given)
        (line,) = map(str, error.value.problems)
        assert len(line) < 200
        assert f"has a key of {len(key)} characters" in line
    scenario = load_scenario(HERE)
    for varied in ([f"{key}=1,2"], {key: [1, 2]}):
        with pytest.raises(InvalidInputError, match=f"has a key of {len(key)} char") as error:
            plan_sweep(scenario, varied)
        assert len(str(error.value)) < 200
    for content in (f"? {key}\n: 1\n", f"sweep:\n  vary:\n    ? {key}\n    : 1,2\n"):
        (line,) = told(plus(content), write=write)
        assert line.endswith(f"has a key of {len(key)} characters; shorten it")


@pytest.mark.parametrize(
    ("change", "ends"),
    [
        ("robot.wheel_radius=5e-324", "from 1e-05 to 1000"),
        ("robot.wheel_radius=2000", "from 1e-05 to 1000"),
        ("model.wheel_separation=1e-9", "from 2e-05 to 2000"),
        ("trajectory.sample_time=1e-9", "from 1e-06 to 10000"),
        ("controller.b_w=1e-30", "from 1e-09 to 1e+09"),
        ("controller.gains.l1=1e-310", "0, or a number from 1e-30 to 1e+12"),
        ("robot.friction=1e-40", "from 1e-06 to 1e+06"),
        ("initial_pose.x=1e9", "from -1e+08 to 1e+08"),
        ("disturbance.state.bound=[0, 1e-320, 0]", "0, or a number from 1e-30 to 1e+08"),
    ],
)
def test_what_no_robot_can_be_is_told_with_what_one_can_be(
    write: Write, change: str, ends: str
) -> None:
    write()
    with pytest.raises(InvalidInputError) as error:
        load_scenario(HERE, [change])
    assert f"; give {'' if ends.startswith('0') else 'a number '}{ends}, such as " in str(
        error.value
    )


@pytest.mark.parametrize("scale", [1e-3, 1, 10])
def test_robots_from_a_millimetre_to_a_mining_truck_are_valid(write: Write, scale: float) -> None:
    write({HERE: robot(ROBOT.replace("0.2", repr(0.2 * scale)).replace("0.5", repr(scale / 2)))})
    assert load_scenario(HERE).experiment().robot.half_track == scale / 2


def test_resolved_scenario_of_the_narrowest_robot_is_valid(write: Write) -> None:
    write({HERE: robot(ROBOT.replace("half_track: 0.5", "wheel_separation: 2e-5"))})
    resolved = load_scenario(HERE).resolved_yaml()
    write({HERE: resolved})
    assert load_scenario(HERE).resolved_yaml() == resolved
