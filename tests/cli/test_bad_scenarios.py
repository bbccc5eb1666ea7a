"""Wrong scenarios: each with the exact message that a person reads."""
# ruff: noqa: E501

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.inputs import SCENARIO, TRAJECTORY, listing, plus, put_odd_things, scenario
from tests.conftest import Hilc, Outcome, Write

# Of these tables, a value, what is told of it, and what all of one have in common stands in CASES.
RADII = [
    ("radius-bool", "true", "must be a number, got true"),
    ("radius-null", "", "must be a number, got nothing"),
    ("radius-list", "[1]", "must be a number, got a list of 1"),
    ("radius-zero", "0", "must be above 0, got 0"),
    ("radius-negative", "-0.2", "must be above 0, got -0.2"),
    ("radius-nan", ".nan", "must be finite, got .nan"),
    ("radius-inf", ".inf", "must be finite, got .inf"),
    ("radius-1e999", "1e999", "must be finite, got 1e999"),
    (
        "radius-5000",
        "9" * 5000,
        "has 5000 digits, got '9999999999999999999999999999999999999999...'",
    ),
    ("radius-unit-time", "200 ms", "has the wrong unit, got '200 ms'"),
    ("radius-unit-deg", "20 deg", "has the wrong unit, got '20 deg'"),
    ("radius-word", "big", "has the unknown name 'big', got 'big'"),
    ("radius-empty-text", "''", "ends where a number should be, got ''"),
    ("radius-yes", "yes", "has the unknown name 'yes', got 'yes'"),
    (
        "radius-underscore",
        "1_000",
        "has '_000' where it should end or have an operator, got '1_000'",
    ),
    ("expr-floordiv", "pi//2", "has '/' where a number should be, got 'pi//2'"),
    ("expr-open", "(1", "has an opening bracket without a closing one, got '(1'"),
    ("expr-close", "1)", "has ')' where it should end or have an operator, got '1)'"),
    ("expr-ends", "1+", "ends where a number should be, got '1+'"),
    ("expr-foo", "foo", "has the unknown name 'foo', got 'foo'"),
    ("expr-units", "1 m + 2 s", "adds values of different units, got '1 m + 2 s'"),
    ("expr-zero", "1/0", "divides by zero, got '1/0'"),
    ("expr-power", "2**3", "has '*' where a number should be, got '2**3'"),
    ("expr-caret", "2^3", "has '^' where it should end or have an operator, got '2^3'"),
    (
        "expr-long",
        "1+" * 70 + "1",
        "is longer than 120 characters, got '1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+...'",
    ),
    (
        "expr-brackets",
        "(" * 21 + "1" + ")" * 21,
        "has more than 20 nested brackets, got '(((((((((((((((((((((1))))))))))))))))))...'",
    ),
    (
        "expr-import",
        "__import__('os').getcwd()",
        "has ''', which is no part of it, got '__import__('os').getcwd()'",
    ),
    ("expr-call", "sqrt(2)", "has the unknown name 'sqrt', got 'sqrt(2)'"),
    ("expr-pii", "pj/2", "has the unknown name 'pj', got 'pj/2'"),
    ("expr-two-numbers", "1 2", "has '2' where it should end or have an operator, got '1 2'"),
    ("expr-unit-first", "m", "has the unit 'm' without a number before it, got 'm'"),
    ("expr-double-unit", "1 m m", "has 'm' where it should end or have an operator, got '1 m m'"),
    ("expr-overflow", "1e300*1e300", "must be finite, got '1e300*1e300'"),
    ("expr-nan", "1e999-1e999", "must be finite, got '1e999-1e999'"),
    ("expr-digit-unicode", "'٣'", "has '٣', which is no part of it, got '٣'"),
]
NAMES = [
    ("name-number", "12", "must be text, got 12; put it in quotes"),
    (
        "name-slash",
        "a/b",
        "has characters that are not allowed, got 'a/b'; use letters, digits, '.', '_' and '-'",
    ),
    (
        "name-dots",
        "'..'",
        "has characters that are not allowed, got '..'; begin with a letter or digit: hidden files and folders begin with '.'",
    ),
    (
        "name-draft",
        ".s.hilc-043a718b-aaaaaaaa",
        "has characters that are not allowed, got '.s.hilc-043a718b-aaaaaaaa'; begin with a letter or digit: hidden files and folders begin with '.'",
    ),
    (
        "name-empty",
        "''",
        "has characters that are not allowed, got ''; use letters, digits, '.', '_' and '-'",
    ),
    (
        "name-long",
        "n" * 101,
        "is too long, got 'nnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnnn...'; shorten it",
    ),
    (
        "name-newline",
        '"a\\nb"',
        "has characters that are not allowed, got 'a�b'; use letters, digits, '.', '_' and '-'; it has a line break, since a backslash in double quotes starts an escape: write the text in single quotes, or / instead",
    ),
    (
        "name-trailing-newline",
        '"ab\\n"',
        "has characters that are not allowed, got 'ab�'; use letters, digits, '.', '_' and '-'; it has a line break, since a backslash in double quotes starts an escape: write the text in single quotes, or / instead",
    ),
    (
        "tag",
        "!!python/object:os.system ls",
        "has the tag tag:yaml.org,2002:python/object:os.system; leave tags out",
    ),
    ("tag-str", "!!str test", "has the tag tag:yaml.org,2002:str; leave tags out"),
    ("tag-own", "!foo test", "has the tag !foo; leave tags out"),
]
MATRICES = [
    (
        "matrix-unknown",
        "[[tan, 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: has the unknown name 'tan', got 'tan'",
    ),
    (
        "matrix-unit",
        "[[1 m, 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: has 'm' where it should end or have an operator, got '1 m'",
    ),
    (
        "matrix-null",
        "[[null, 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: must be a number or an expression, got nothing",
    ),
    (
        "matrix-inf",
        "[[.inf, 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: must be finite, got .inf",
    ),
    (
        "matrix-zero-by-model",
        "[[1/(B-0.5), 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: divides by zero, got '1/(B-0.5)'",
    ),
    (
        "matrix-bool-entry",
        "[[true, 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: must be a number or an expression, got true",
    ),
    (
        "matrix-long-int",
        "[[" + "9" * 5000 + ", 2, 3], [4, 5, 6]]",
        "18: controller.gain_matrix.0.0: is longer than 120 characters, got '9999999999999999999999999999999999999999...'",
    ),
]
CASES = [
    *(
        (
            name,
            scenario("wheel_radius: 0.2", f"wheel_radius: {value}"),
            f"scenario.yaml:3:23: robot.wheel_radius: {told}; give a number above 0, such as 0.2 or 20 cm",
        )
        for name, value, told in RADII
    ),
    *(
        (
            name,
            scenario("name: test", f"name: {value}"),
            f"scenario.yaml:1:7: name: {told}",
        )
        for name, value, told in NAMES
    ),
    *(
        (
            name,
            scenario("b_w: 180", f"gain_matrix: {value}"),
            f"scenario.yaml:7:{told}; give a number or an expression in cos, sin, R and B",
        )
        for name, value, told in MATRICES
    ),
    (
        "missing-robot",
        scenario("robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}\n", ""),
        "scenario.yaml:1:1: robot: is missing; give it",
    ),
    ("missing-name", scenario("name: test\n", ""), "scenario.yaml:1:1: name: is missing; give it"),
    (
        "missing-trajectory",
        scenario("trajectory: path.yaml\n", ""),
        "scenario.yaml:1:1: trajectory: is missing; give it",
    ),
    (
        "missing-controller",
        SCENARIO.partition("controller")[0],
        "scenario.yaml:1:1: controller: is missing; give it",
    ),
    (
        "missing-gains",
        scenario("  gains: {l1: 0.5}\n", ""),
        "scenario.yaml:5:1: controller.gains: is missing; give it",
    ),
    (
        "missing-l1",
        scenario("{l1: 0.5}", "{l2: 0.5}"),
        "scenario.yaml:6:3: controller.gains.l1: is missing; give it (of the previous iteration's error, e_i(k+1))",
    ),
    (
        "missing-wheel-radius",
        scenario("wheel_radius: 0.2, ", ""),
        "scenario.yaml:3:1: robot.wheel_radius: is missing; give it (R_c [m])",
    ),
    (
        "no-track",
        scenario(", half_track: 0.5", ""),
        "scenario.yaml:3:1: robot: needs exactly one of half_track and wheel_separation; give one of them",
    ),
    (
        "both-tracks",
        scenario("half_track: 0.5", "half_track: 0.5, wheel_separation: 1"),
        "scenario.yaml:3:1: robot: needs exactly one of half_track and wheel_separation; give one of them",
    ),
    (
        "model-both-tracks",
        plus("model: {half_track: 0.5, wheel_separation: 1}\n"),
        "scenario.yaml:8:1: model: has both half_track and wheel_separation; give one of them",
    ),
    (
        "unknown-top",
        plus("iteration: 3\n"),
        "scenario.yaml:8:1: iteration: is an unknown key; did you mean 'iterations'?",
    ),
    (
        "unknown-top-far",
        plus("zzz: 3\n"),
        "scenario.yaml:8:1: zzz: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory",
    ),
    (
        "unknown-nested",
        scenario("wheel_radius: 0.2", "wheel_radios: 0.2"),
        (
            "scenario.yaml:3:1: robot.wheel_radius: is missing; give it (R_c [m])\n"
            "scenario.yaml:3:9: robot.wheel_radios: is an unknown key; did you mean 'wheel_radius'?"
        ),
    ),
    (
        "unknown-gain",
        scenario("{l1: 0.5}", "{l1: 0.5, l4: 1}"),
        "scenario.yaml:6:20: controller.gains.l4: is an unknown key of law hybrid; known: derivative, l1, l2, l3, lateral",
    ),
    (
        "unknown-record",
        plus("record: {iteration: all}\n"),
        "scenario.yaml:8:10: record.iteration: is an unknown key; did you mean 'iterations'?",
    ),
    (
        "unknown-disturbance",
        plus("disturbance: {states: {bound: [0,0,0]}}\n"),
        "scenario.yaml:8:15: disturbance.states: is an unknown key; did you mean 'state'?",
    ),
    (
        "robot-scalar",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}", "robot: 0.2"
        ),
        "scenario.yaml:3:8: robot: must be a mapping of keys and values, got 0.2; write its keys below it",
    ),
    (
        "robot-list",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}",
            "robot: [0.2, 0.5]",
        ),
        "scenario.yaml:3:8: robot: must be a mapping of keys and values, got a list of 2; write its keys below it",
    ),
    (
        "robot-null",
        scenario("robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}", "robot:"),
        "scenario.yaml:3:7: robot: must be a mapping of keys and values, got nothing; write its keys below it",
    ),
    (
        "gains-scalar",
        scenario("gains: {l1: 0.5}", "gains: 0.5"),
        "scenario.yaml:6:10: controller.gains: must be a mapping of keys and values, got 0.5; write its keys below it",
    ),
    (
        "name-null",
        scenario("name: test", "name:"),
        "scenario.yaml:1:6: name: must be text, got nothing; put it in quotes",
    ),
    (
        "description-number",
        plus("description: 12\n"),
        "scenario.yaml:8:14: description: must be text, got 12; put it in quotes",
    ),
    (
        "radius-map",
        scenario("wheel_radius: 0.2", "wheel_radius: {a: 1}"),
        "scenario.yaml:3:9: robot.wheel_radius.left: is missing; give it (R_c of the left wheel [m])\n"
        "scenario.yaml:3:9: robot.wheel_radius.right: is missing; give it (R_c of the right wheel [m])\n"
        "scenario.yaml:3:24: robot.wheel_radius.a: is an unknown key; known: left, right",
    ),
    (
        "radius-huge",
        scenario("wheel_radius: 0.2", "wheel_radius: 1e10"),
        "scenario.yaml:3:23: robot.wheel_radius: must be at most 1000, got 1e10; give a number from 1e-05 to 1000, such as 0.2 or 20 cm",
    ),
    (
        "radius-bignum",
        scenario("wheel_radius: 0.2", "wheel_radius: 1" + "0" * 60),
        "scenario.yaml:3:23: robot.wheel_radius: must be at most 1000, got 1000000000000000000000000000000000000000...; give a number from 1e-05 to 1000, such as 0.2 or 20 cm",
    ),
    (
        "radius-unit-unknown",
        scenario("wheel_radius: 0.2", "wheel_radius: 20 inch"),
        "scenario.yaml:3:23: robot.wheel_radius: has the unknown unit 'inch', got '20 inch'; did you mean '20*25.4 mm'?",
    ),
    (
        "radius-unit-nm",
        scenario("wheel_radius: 0.2", "wheel_radius: 20 mn"),
        "scenario.yaml:3:23: robot.wheel_radius: has the unknown unit 'mn', got '20 mn'; give it in mm, cm or m",
    ),
    (
        "radius-comma",
        scenario("wheel_radius: 0.2", "wheel_radius: '0,2'"),
        "scenario.yaml:3:23: robot.wheel_radius: has a decimal comma, got '0,2'; did you mean '0.2'?",
    ),
    (
        "expr-2pi",
        scenario("wheel_radius: 0.2", "wheel_radius: 2pi"),
        "scenario.yaml:3:23: robot.wheel_radius: has 'pi' where it should end or have an operator, got '2pi'; did you mean '2*pi'?",
    ),
    (
        "expr-unicode",
        scenario("wheel_radius: 0.2", "wheel_radius: 2π"),
        "scenario.yaml:3:23: robot.wheel_radius: has the unknown unit 'π', got '2π'; did you mean '2*pi'?",
    ),
    (
        "expr-pi-unicode",
        scenario("wheel_radius: 0.2", "wheel_radius: π"),
        "scenario.yaml:3:23: robot.wheel_radius: has the unknown name 'π', got 'π'; did you mean 'pi'?",
    ),
    (
        "iterations-negative",
        scenario("iterations: 2", "iterations: -1"),
        "scenario.yaml:4:13: iterations: must be at least 0, got -1; give a whole number from 0 up, such as 100",
    ),
    (
        "iterations-fraction",
        scenario("iterations: 2", "iterations: 2.5"),
        "scenario.yaml:4:13: iterations: must be a whole number, got 2.5; give a whole number from 0 up, such as 100",
    ),
    (
        "iterations-huge",
        scenario("iterations: 2", "iterations: 10000001"),
        "scenario.yaml:4:13: iterations: must be at most 10000000, got 10000001; give a whole number from 0 to 10000000, such as 100",
    ),
    (
        "iterations-unit",
        scenario("iterations: 2", "iterations: 2 s"),
        "scenario.yaml:4:13: iterations: must have no unit, got '2 s'; give a whole number from 0 up, such as 100",
    ),
    (
        "iterations-expr",
        scenario("iterations: 2", "iterations: 5/2"),
        "scenario.yaml:4:13: iterations: must be a whole number, got '5/2'; give a whole number from 0 up, such as 100",
    ),
    (
        "iterations-5000",
        scenario("iterations: 2", "iterations: 1" + "0" * 5000),
        "scenario.yaml:4:13: iterations: has 5001 digits, got '1000000000000000000000000000000000000000...'; give a whole number from 0 up, such as 100",
    ),
    (
        "iterations-bool",
        scenario("iterations: 2", "iterations: true"),
        "scenario.yaml:4:13: iterations: must be a number, got true; give a whole number from 0 up, such as 100",
    ),
    (
        "gain-negative",
        scenario("{l1: 0.5}", "{l1: -0.5}"),
        "scenario.yaml:6:15: controller.gains.l1: must be at least 0, got -0.5; give a number from 0 up, such as 0.5",
    ),
    (
        "gain-unit",
        scenario("{l1: 0.5}", "{l1: 0.5 m}"),
        "scenario.yaml:6:15: controller.gains.l1: must have no unit, got '0.5 m'; give a number from 0 up, such as 0.5",
    ),
    (
        "gain-inf",
        scenario("{l1: 0.5}", "{l1: .inf}"),
        "scenario.yaml:6:15: controller.gains.l1: must be finite, got .inf; give a number from 0 up, such as 0.5",
    ),
    (
        "h-zero",
        scenario("b_w: 180", "h: 0"),
        "scenario.yaml:7:6: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200",
    ),
    (
        "h-over-n",
        scenario("b_w: 180", "h: 4"),
        "scenario.yaml:7:6: controller.h: must be at most the trajectory's 3 samples, got 4; give a whole number from 1 to 3",
    ),
    (
        "h-fraction",
        scenario("b_w: 180", "h: 1.5"),
        "scenario.yaml:7:6: controller.h: must be a whole number, got 1.5; give a whole number from 1 up, such as 200",
    ),
    (
        "h-ms",
        scenario("b_w: 180", "h: 200 ms"),
        "scenario.yaml:7:6: controller.h: must have no unit, got '200 ms'; give a whole number from 1 up, such as 200",
    ),
    (
        "bw-zero",
        scenario("b_w: 180", "b_w: 0"),
        "scenario.yaml:7:8: controller.b_w: must be above 0, got 0; give a number above 0, such as 180 or 1700 rpm",
    ),
    (
        "bw-negative",
        scenario("b_w: 180", "b_w: -180"),
        "scenario.yaml:7:8: controller.b_w: must be above 0, got -180; give a number above 0, such as 180 or 1700 rpm",
    ),
    (
        "bw-unit",
        scenario("b_w: 180", "b_w: 180 deg"),
        "scenario.yaml:7:8: controller.b_w: has the wrong unit, got '180 deg'; did you mean '180 deg/s'?",
    ),
    (
        "bw-inf",
        scenario("b_w: 180", "b_w: .inf"),
        "scenario.yaml:7:8: controller.b_w: must be finite, got .inf; give a number above 0, such as 180 or 1700 rpm",
    ),
    (
        "bw-word",
        scenario("b_w: 180", "b_w: none"),
        "scenario.yaml:7:8: controller.b_w: has the unknown name 'none', got 'none'; give a number above 0, such as 180 or 1700 rpm",
    ),
    (
        "lateral-negative",
        scenario("{l1: 0.5}", "{l1: 0.5, lateral: -0.3}"),
        "scenario.yaml:6:29: controller.gains.lateral: must be at least 0, got -0.3; give a number from 0 up, such as 0.3 or 0.3 rad/m",
    ),
    (
        "lateral-unit",
        scenario("{l1: 0.5}", "{l1: 0.5, lateral: 0.3 m}"),
        "scenario.yaml:6:29: controller.gains.lateral: has the wrong unit, got '0.3 m'; give a number from 0 up, such as 0.3 or 0.3 rad/m",
    ),
    (
        "lateral-matrix",
        scenario("{l1: 0.5}", "{l1: 0.5, lateral: 0.3}").replace(
            "b_w: 180", "gain_matrix: [[cos, sin, 1], [cos, sin, -1 - cos]]"
        ),
        "scenario.yaml:6:29: controller.gains.lateral: needs a gain matrix whose heading entries have no cos and sin, got 0.3; give 0, or other entries in the third column",
    ),
    (
        "law",
        scenario("b_w: 180", "law: hybird"),
        "scenario.yaml:7:8: controller.law: is not one of the choices, got 'hybird'; did you mean 'hybrid'?",
    ),
    (
        "compensation",
        scenario("b_w: 180", "compensation: yes"),
        "scenario.yaml:7:17: controller.compensation: is not one of the choices, got 'yes'; give auto, on or off",
    ),
    (
        "compensation-true",
        scenario("b_w: 180", "compensation: true"),
        "scenario.yaml:7:17: controller.compensation: is not one of the choices, got true; give auto, on or off",
    ),
    (
        "gain-heading",
        scenario("b_w: 180", "gain_heading: measure"),
        "scenario.yaml:7:17: controller.gain_heading: is not one of the choices, got 'measure'; did you mean 'measured'?",
    ),
    (
        "tolerance",
        scenario("b_w: 180", "switch_tolerance: -1"),
        "scenario.yaml:7:21: controller.switch_tolerance: must be at least 0, got -1; give a number from 0 up, such as 1e-9, in m and rad",
    ),
    (
        "turn-convention",
        scenario("turn_convention: paper", "turn_convention: rose"),
        "scenario.yaml:3:62: robot.turn_convention: is not one of the choices, got 'rose'; give paper or rep103",
    ),
    (
        "no-turn-convention",
        scenario(", turn_convention: paper", ""),
        "scenario.yaml:3:1: robot.turn_convention: is missing; give it (paper: left wheel faster turns left; rep103 or ros: right wheel faster turns left)",
    ),
    (
        "turn-convention-of-nothing",
        scenario("turn_convention: paper", "turn_convention: "),
        "scenario.yaml:3:62: robot.turn_convention: is not one of the choices, got nothing; give paper or rep103",
    ),
    (
        "initial-trial",
        plus("initial_trial: openloop\n"),
        "scenario.yaml:8:16: initial_trial: is not one of the choices, got 'openloop'; did you mean 'open-loop'?",
    ),
    (
        "friction-zero",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, friction: 0"),
        "scenario.yaml:3:38: robot.friction: must be above 0, got 0; give a number above 0, such as 0.8",
    ),
    (
        "friction-negative",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, friction: -1/2"),
        "scenario.yaml:3:38: robot.friction: must be above 0, got '-1/2'; give a number above 0, such as 0.8",
    ),
    (
        "friction-unit",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, friction: 8 m"),
        "scenario.yaml:3:38: robot.friction: must have no unit, got '8 m'; give a number above 0, such as 0.8",
    ),
    (
        "friction-infinite",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, friction: .inf"),
        "scenario.yaml:3:38: robot.friction: must be finite, got .inf; give a number above 0, such as 0.8",
    ),
    (
        "friction-bool",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, friction: true"),
        "scenario.yaml:3:38: robot.friction: must be a number, got true; give a number above 0, such as 0.8",
    ),
    (
        "friction-of-the-model",
        plus("model: {friction: 0.8}\n"),
        "scenario.yaml:8:9: model.friction: is an unknown key; it is a key of 'robot'",
    ),
    (
        "gravity-center-short",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, gravity_center: [1]"),
        "scenario.yaml:3:44: robot.gravity_center.1: is missing; the list has too few entries",
    ),
    (
        "gravity-center-long",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, gravity_center: [1, 2, 3]"),
        "scenario.yaml:3:44: robot.gravity_center: has too many entries, got a list of 3; remove some",
    ),
    (
        "gravity-center-scalar",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, gravity_center: 1"),
        "scenario.yaml:3:44: robot.gravity_center: must be a list, got 1; write [..., ...]",
    ),
    (
        "gravity-center-word",
        scenario("wheel_radius: 0.2", "wheel_radius: 0.2, gravity_center: [a, 2]"),
        "scenario.yaml:3:45: robot.gravity_center.0: has the unknown name 'a', got 'a'; give a number, such as 1.5 or 20 cm",
    ),
    (
        "matrix-word",
        scenario("b_w: 180", "gain_matrix: modell"),
        "scenario.yaml:7:16: controller.gain_matrix: is no gain matrix, got 'modell'; did you mean 'model'?",
    ),
    (
        "matrix-number",
        scenario("b_w: 180", "gain_matrix: 3"),
        "scenario.yaml:7:16: controller.gain_matrix: must be model, unit or two rows, got 3; give model, unit, or two rows of three numbers or expressions in cos, sin, R and B",
    ),
    (
        "matrix-3x2",
        scenario("b_w: 180", "gain_matrix: [[1, 2], [3, 4], [5, 6]]"),
        "scenario.yaml:7:16: controller.gain_matrix: must be model, unit or two rows, got a list of 3; give model, unit, or two rows of three numbers or expressions in cos, sin, R and B",
    ),
    (
        "matrix-one-row",
        scenario("b_w: 180", "gain_matrix: [[1, 2, 3]]"),
        "scenario.yaml:7:16: controller.gain_matrix: must be model, unit or two rows, got a list of 1; give model, unit, or two rows of three numbers or expressions in cos, sin, R and B",
    ),
    (
        "matrix-short-row",
        scenario("b_w: 180", "gain_matrix: [[1, 2, 3], [4, 5]]"),
        "scenario.yaml:7:28: controller.gain_matrix.1: must be a row of three entries, got a list of 2; give model, unit, or two rows of three numbers or expressions in cos, sin, R and B",
    ),
    (
        "matrix-not-affine",
        scenario("b_w: 180", "gain_matrix: [[cos*sin, 2, 3], [4, 5, 6]]"),
        "scenario.yaml:7:18: controller.gain_matrix.0.0: multiplies cos and sin with each other, got 'cos*sin'; entries are affine in them",
    ),
    (
        "matrix-divides",
        scenario("b_w: 180", "gain_matrix: [[1/cos, 2, 3], [4, 5, 6]]"),
        "scenario.yaml:7:18: controller.gain_matrix.0.0: divides by cos or sin, got '1/cos'; entries are affine in them",
    ),
    (
        "matrix-unknown-near",
        scenario("b_w: 180", "gain_matrix: [[coss, 2, 3], [4, 5, 6]]"),
        "scenario.yaml:7:18: controller.gain_matrix.0.0: has the unknown name 'coss', got 'coss'; did you mean 'cos'?",
    ),
    (
        "matrix-two",
        scenario("b_w: 180", "gain_matrix: [[tan, 2, 3], [4, 5, 1/0]]"),
        (
            "scenario.yaml:7:18: controller.gain_matrix.0.0: has the unknown name 'tan', got 'tan'; give a number or an expression in cos, sin, R and B\n"
            "scenario.yaml:7:37: controller.gain_matrix.1.2: divides by zero, got '1/0'; give a number or an expression in cos, sin, R and B"
        ),
    ),
    (
        "seed-negative",
        plus("disturbance: {seed: -1}\n"),
        "scenario.yaml:8:21: disturbance.seed: must be at least 0, got -1; give a whole number from 0 up, such as 0",
    ),
    (
        "seed-big",
        plus("disturbance: {seed: 18446744073709551616}\n"),
        "scenario.yaml:8:21: disturbance.seed: must be at most 18446744073709551615, got 18446744073709551616; give a whole number from 0 to 18446744073709551615, such as 0",
    ),
    (
        "seed-fraction",
        plus("disturbance: {seed: 0.5}\n"),
        "scenario.yaml:8:21: disturbance.seed: must be a whole number, got 0.5; give a whole number from 0 up, such as 0",
    ),
    (
        "bound-short",
        plus("disturbance: {state: {bound: [0, 0]}}\n"),
        "scenario.yaml:8:30: disturbance.state.bound.2: is missing; the list has too few entries",
    ),
    (
        "bound-negative",
        plus("disturbance: {output: {bound: [0, -1 mm, 0]}}\n"),
        "scenario.yaml:8:35: disturbance.output.bound.1: must be at least 0, got '-1 mm'; give a number from 0 up, such as 0.001 or 1 mm",
    ),
    (
        "bound-unit",
        plus("disturbance: {output: {bound: [0, 0, 1 mm]}}\n"),
        "scenario.yaml:8:38: disturbance.output.bound.2: has the wrong unit, got '1 mm'; give a number from 0 up, such as 0.001 or 0.1 deg",
    ),
    (
        "bound-scalar",
        plus("disturbance: {output: {bound: 1}}\n"),
        "scenario.yaml:8:31: disturbance.output.bound: must be a list, got 1; write [..., ...]",
    ),
    (
        "distribution",
        plus("disturbance: {output: {bound: [0, 0, 0], distribution: normal}}\n"),
        "scenario.yaml:8:56: disturbance.output.distribution: is not one of the choices, got 'normal'; give uniform or truncated-normal",
    ),
    (
        "deviation-uniform",
        plus("disturbance: {output: {bound: [1, 1, 1], standard_deviation: [1, 1, 1]}}\n"),
        "scenario.yaml:8:62: disturbance.output.standard_deviation: has no meaning for a uniform distribution; remove it or set 'distribution: truncated-normal'",
    ),
    (
        "deviation-zero",
        plus(
            "disturbance: {output: {bound: [1, 1, 1], distribution: truncated-normal, standard_deviation: [1, 0, 1]}}\n"
        ),
        "scenario.yaml:8:98: disturbance.output.standard_deviation.1: must be above 0, got 0; give a number above 0 or set this bound to 0",
    ),
    (
        "repeat",
        plus("disturbance: {output: {repeat: 1}}\n"),
        "scenario.yaml:8:32: disturbance.output.repeat: must be true or false, got 1; give true or false",
    ),
    (
        "record-word",
        plus("record: {iterations: some}\n"),
        "scenario.yaml:8:22: record.iterations: is no choice of iterations, got 'some'; give auto, all, or a list of iterations such as [0, 10, 100]",
    ),
    (
        "record-range",
        plus("record: {iterations: [0, 3]}\n"),
        "scenario.yaml:8:26: record.iterations.1: must be at most the last iteration, 2, got 3; give whole numbers from 0 to 2",
    ),
    (
        "record-negative",
        plus("record: {iterations: [-1]}\n"),
        "scenario.yaml:8:23: record.iterations.0: must be at least 0, got -1; give a whole number from 0 up, such as 100",
    ),
    (
        "record-fraction",
        plus("record: {iterations: [0.5, a]}\n"),
        (
            "scenario.yaml:8:23: record.iterations.0: must be a whole number, got 0.5; give a whole number from 0 up, such as 100\n"
            "scenario.yaml:8:28: record.iterations.1: has the unknown name 'a', got 'a'; give a whole number from 0 up, such as 100"
        ),
    ),
    (
        "record-number",
        plus("record: {iterations: 5}\n"),
        "scenario.yaml:8:22: record.iterations: is no choice of iterations, got 5; give auto, all, or a list of iterations such as [0, 10, 100]",
    ),
    (
        "record-gravity",
        plus("record: {gravity_center: maybe}\n"),
        "scenario.yaml:8:26: record.gravity_center: must be true or false, got 'maybe'; give true or false",
    ),
    (
        "record-gravity-number",
        plus("record: {gravity_center: 1}\n"),
        "scenario.yaml:8:26: record.gravity_center: must be true or false, got 1; give true or false",
    ),
    (
        "record-gravity-yes",
        plus("record: {gravity_center: yes}\n"),
        "scenario.yaml:8:26: record.gravity_center: must be true or false, got 'yes'; give true or false",
    ),
    (
        "initial-pose-word",
        plus("initial_pose: {x: a}\n"),
        "scenario.yaml:8:19: initial_pose.x: has the unknown name 'a', got 'a'; give a number, such as 1.5 or 20 cm",
    ),
    (
        "initial-pose-list",
        plus("initial_pose: [1, 2, 3]\n"),
        "scenario.yaml:8:15: initial_pose: must be a mapping of keys and values, got a list of 3; write its keys below it",
    ),
    (
        "initial-pose-theta",
        plus("initial_pose: {theta: 1}\n"),
        "scenario.yaml:8:16: initial_pose.theta: is an unknown key; it is heading",
    ),
    (
        "initial-pose-unit",
        plus("initial_pose: {heading: 1 m}\n"),
        "scenario.yaml:8:25: initial_pose.heading: has the wrong unit, got '1 m'; give a number, such as pi/2 or 90 deg",
    ),
    (
        "initial-input-number",
        plus("initial_input: 3\n"),
        "scenario.yaml:8:16: initial_input: must be text, got 3; put it in quotes",
    ),
    (
        "initial-input-missing",
        plus("initial_input: nosuch.csv\n"),
        "scenario.yaml:8:16: initial_input: nosuch.csv: there is no such file; check the path (initial_input is zero, feedforward or such a file)",
    ),
    (
        "initial-input-typo",
        plus("initial_input: feedfoward\n"),
        "scenario.yaml:8:16: initial_input: feedfoward: there is no such file; check the path (initial_input is zero, feedforward or such a file)",
    ),
    (
        "initial-input-empty",
        plus("initial_input: ''\n"),
        "scenario.yaml:8:16: initial_input: .: is a folder; give a regular file (initial_input is zero, feedforward or such a file)",
    ),
    (
        "initial-input-folder",
        plus("initial_input: .\n"),
        "scenario.yaml:8:16: initial_input: .: is a folder; give a regular file (initial_input is zero, feedforward or such a file)",
    ),
    (
        "dup-key",
        plus("iterations: 3\n"),
        "scenario.yaml:8:1: iterations: is given twice, first in line 4; keep one of them",
    ),
    (
        "dup-nested",
        scenario("{l1: 0.5}", "{l1: 0.5, l1: 0.6}"),
        "scenario.yaml:6:20: controller.gains.l1: is given twice, first in line 6; keep one of them",
    ),
    (
        "merge",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}",
            "robot: {<<: {half_track: 0.5}, wheel_radius: 0.2, turn_convention: paper}",
        ),
        "scenario.yaml:3:9: <<: merge keys are not part of YAML 1.2; write the keys out\n"
        "scenario.yaml:3:1: robot: needs exactly one of half_track and wheel_separation; give one of them",
    ),
    (
        "tag-apply",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}",
            "robot: !!python/object/apply:os.system ['true']",
        ),
        "scenario.yaml:3:8: robot: has the tag tag:yaml.org,2002:python/object/apply:os.system; leave tags out\n"
        "scenario.yaml:3:8: robot: must be a mapping of keys and values, got a list of 1; write its keys below it",
    ),
    (
        "alias-cycle",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}",
            "robot: &a {wheel_radius: *a}",
        ),
        "scenario.yaml:3:26: alias *a contains itself; write the value out",
    ),
    (
        "alias-unknown",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}", "robot: *a"
        ),
        "scenario.yaml:3:8: alias *a has no anchor; define &a before it",
    ),
    (
        "key-number",
        plus("1: 2\n"),
        "scenario.yaml:8:1: 1: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory",
    ),
    (
        "key-list",
        plus("[1, 2]: 2\n"),
        "scenario.yaml:8:1: has a key that is no plain word; use words as keys",
    ),
    (
        "key-null",
        plus("? \n: 2\n"),
        "scenario.yaml:8:2: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory",
    ),
    (
        "tab",
        scenario("  gains: {l1: 0.5}", "\tgains: {l1: 0.5}"),
        "scenario.yaml:6:1: is indented with a tab; indent with spaces",
    ),
    ("empty", "", "scenario.yaml:1:1: is empty; write a mapping of keys and values"),
    (
        "only-comment",
        "# nothing\n",
        "scenario.yaml:1:1: is empty; write a mapping of keys and values",
    ),
    (
        "only-null",
        "~\n",
        "scenario.yaml:1:1: is no scenario, got nothing; write a mapping of keys and values",
    ),
    (
        "two-docs",
        SCENARIO + "---\n" + SCENARIO,
        "scenario.yaml:8:1: holds a second YAML document; keep one document in a file",
    ),
    (
        "top-list",
        "- a\n- b\n",
        "scenario.yaml:1:1: is no scenario, got a list of 2; write a mapping of keys and values",
    ),
    (
        "top-scalar",
        "hello\n",
        "scenario.yaml:1:1: is no scenario, got a single value; write a mapping of keys and values",
    ),
    (
        "unclosed",
        scenario(
            "robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}",
            "robot: {wheel_radius: 0.2",
        ),
        "scenario.yaml:4:11: is not valid YAML: did not find expected ',' or '}'; check quotes, colons, brackets and indentation",
    ),
    (
        "unclosed-quote",
        scenario("name: test", "name: 'test"),
        "scenario.yaml:8:1: is not valid YAML: found unexpected end of stream; check quotes, colons, brackets and indentation",
    ),
    (
        "indent",
        scenario("iterations: 2", "   iterations: 2"),
        "scenario.yaml:4:4: stands in column 4, where nothing above it starts; indent it as its neighbours are",
    ),
    (
        "colon",
        scenario("name: test", "name: a: b"),
        "scenario.yaml:1:8: is not valid YAML: mapping values are not allowed in this context; check quotes, colons, brackets and indentation",
    ),
    (
        "at",
        scenario("name: test", "name: @test"),
        "scenario.yaml:1:7: is not valid YAML: found character that cannot start any token; check quotes, colons, brackets and indentation",
    ),
    (
        "percent",
        "%YAML 9.9\n---\n" + SCENARIO,
        "scenario.yaml:1:1: is not valid YAML: found incompatible YAML document; check quotes, colons, brackets and indentation",
    ),
    (
        "directive",
        "%FOO\n---\n" + SCENARIO,
        "scenario.yaml:1:5: is not valid YAML: found unknown directive name; check quotes, colons, brackets and indentation",
    ),
    (
        "deep",
        "a: " + "[" * 30 + "]" * 30 + "\n",
        "scenario.yaml:1:24: is nested more than 20 deep; flatten it",
    ),
    (
        "is-trajectory",
        TRAJECTORY,
        "scenario.yaml:1:1: is a trajectory, not a scenario; name it under 'trajectory:' in a scenario",
    ),
    (
        "is-leaderboard",
        "name: board\ncases: {path: path.yaml}\nlaws: {paper: {gains: {l1: 1}}}\n",
        "scenario.yaml:1:1: is a leaderboard, not a scenario; give it to hilc compare --laws",
    ),
    (
        "traj-is-example-of-scenario",
        scenario("path.yaml", "example:fig3-circle"),
        "scenario.yaml:2:13: trajectory: example:fig3-circle: is a scenario, not a trajectory; name a trajectory file",
    ),
    (
        "traj-is-itself",
        scenario("path.yaml", "scenario.yaml"),
        "scenario.yaml:2:13: trajectory: is a scenario, not a trajectory, got scenario.yaml; name a trajectory file",
    ),
    (
        "traj-missing",
        scenario("path.yaml", "nosuch.yaml"),
        "scenario.yaml:2:13: trajectory: nosuch.yaml: there is no such file; check the path",
    ),
    (
        "traj-folder",
        scenario("path.yaml", "."),
        "scenario.yaml:2:13: trajectory: .: is a folder; give a regular file",
    ),
    (
        "traj-fifo",
        scenario("path.yaml", "fifo"),
        "scenario.yaml:2:13: trajectory: fifo: is a named pipe; give a regular file",
    ),
    (
        "traj-dev",
        scenario("path.yaml", "/dev/zero"),
        "scenario.yaml:2:13: trajectory: /dev/zero: is a device; give a regular file",
    ),
    (
        "traj-example-unknown",
        scenario("path.yaml", "example:circel"),
        "scenario.yaml:2:13: trajectory: example:circel: there is no such example; did you mean 'circle'?",
    ),
    (
        "traj-example-unknown-far",
        scenario("path.yaml", "example:qqq"),
        "scenario.yaml:2:13: trajectory: example:qqq: there is no such example; known: arc-and-line, cardioid, circle, circle-from-rest, corridor, figure-eight, parking, rounded-square, slalom, spiral, square-lap, timed-lap, turn-in-place",
    ),
    (
        "traj-number",
        scenario("path.yaml", "3"),
        "scenario.yaml:2:13: trajectory: must be the path of a trajectory file or a mapping, got 3; name a trajectory file",
    ),
    (
        "traj-null",
        scenario("path.yaml", ""),
        "scenario.yaml:2:12: trajectory: must be the path of a trajectory file or a mapping, got nothing; name a trajectory file",
    ),
    (
        "traj-list",
        scenario("path.yaml", "[path.yaml]"),
        "scenario.yaml:2:13: trajectory: must be the path of a trajectory file or a mapping, got a list of 1; name a trajectory file",
    ),
    (
        "traj-empty",
        scenario("path.yaml", "''"),
        "scenario.yaml:2:13: trajectory: must be the path of a trajectory file or a mapping, got ''; name a trajectory file",
    ),
    (
        "traj-loop",
        scenario("path.yaml", "loop"),
        "scenario.yaml:2:13: trajectory: loop: cannot be read: too many levels of symbolic links",
    ),
    (
        "traj-csv",
        scenario("path.yaml", "input.csv"),
        "scenario.yaml:2:13: trajectory: must be a trajectory file, got 'input.csv'; points go into a segment of one, as 'path: {file: points.csv, speed: 0.5}'",
    ),
    (
        "traj-inline-missing",
        scenario("path.yaml", "{name: inline}"),
        (
            "scenario.yaml:2:1: trajectory.sample_time: is missing; give it (s)\n"
            "scenario.yaml:2:1: trajectory.segments: is missing; give it"
        ),
    ),
    (
        "several",
        scenario("wheel_radius: 0.2", "wheel_radius: -1")
        .replace("l1: 0.5", "l1: a")
        .replace("iterations: 2", "iterations: 1.5")
        + "zzz: 1\n",
        (
            "scenario.yaml:3:23: robot.wheel_radius: must be above 0, got -1; give a number above 0, such as 0.2 or 20 cm\n"
            "scenario.yaml:4:13: iterations: must be a whole number, got 1.5; give a whole number from 0 up, such as 100\n"
            "scenario.yaml:6:15: controller.gains.l1: has the unknown name 'a', got 'a'; give a number from 0 up, such as 0.5\n"
            "scenario.yaml:8:1: zzz: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory"
        ),
    ),
]


@pytest.mark.parametrize(
    ("content", "message"), [pytest.param(content, text, id=name) for name, content, text in CASES]
)
def test_wrong_scenario_is_explained(
    hilc: Hilc, write: Write, folder: Path, content: str, message: str
) -> None:
    write({"scenario.yaml": content})
    put_odd_things(folder)
    before = listing(folder)
    assert hilc("run", "scenario.yaml", "--no-plots") == Outcome(2, "", f"{message}\n")
    assert listing(folder) == before


EMPTY_VALUES = [
    ("iterations:", "iterations: 2"),
    ("half_track: 0.5, friction: ,", "half_track: 0.5,"),
    ("b_w:", "b_w: 180"),
    ("b_w: 180\n  gain_matrix:", "b_w: 180"),
    ("b_w: 180\ninitial_pose:", "b_w: 180"),
    ("b_w: 180\ndisturbance: {seed: , state: ~}", "b_w: 180"),
]


@pytest.mark.parametrize(("written", "instead_of"), EMPTY_VALUES)
def test_key_with_nothing_behind_it_has_its_default(
    hilc: Hilc, write: Write, written: str, instead_of: str
) -> None:
    write({"scenario.yaml": scenario(instead_of, written)})
    outcome = hilc("run", "scenario.yaml", "--no-plots", "-q")
    assert outcome == Outcome(0, "", "")


def test_position_of_a_control_character_is_told(hilc: Hilc, write: Write) -> None:
    write({"scenario.yaml": scenario("iterations: 2", "iterations: \x012")})
    outcome = hilc("run", "scenario.yaml")
    assert outcome.code == 2
    assert outcome.err.startswith("scenario.yaml:4:13: is not valid YAML: ")


def test_integer_that_no_float_and_no_int64_holds_is_fine_in_a_gain_matrix(
    hilc: Hilc, write: Write
) -> None:
    big = "1" + "0" * 30
    write({"scenario.yaml": scenario("b_w: 180", f"gain_matrix: [[0, 0, 0], [0, 0, {big}]]")})
    assert hilc("run", "scenario.yaml", "--no-plots", "-q") == Outcome(0, "", "")


@pytest.mark.parametrize(
    "content",
    [
        plus('"a\\nb": 1\n'),
        plus('"\\e[31mred": 1\n'),
        scenario("path.yaml", '"\\e[31mred"'),
        scenario("path.yaml", '"no\\nsuch.yaml"'),
        scenario("path.yaml", '"a\\0b"'),
        plus('initial_input: "a\\nb"\n'),
        scenario("b_w: 180", 'gain_matrix: "\\e[31m\\n"'),
        scenario("{l1: 0.5}", '{l1: "\\e\\n"}'),
    ],
)
def test_message_is_one_printable_line_whatever_the_file_says(
    hilc: Hilc, write: Write, content: str
) -> None:
    write({"scenario.yaml": content})
    outcome = hilc("run", "scenario.yaml")
    assert outcome.code == 2
    assert outcome.err.count("\n") == 1
    assert outcome.err.removesuffix("\n").isprintable()


def test_what_does_not_fit_is_told_beside_what_is_wrong_by_itself(hilc: Hilc, write: Write) -> None:
    content = scenario("half_track: 0.5,", "half_track: 0.5, foo: 1,")
    content = content.replace("b_w: 180", "b_w: -1\n  h: 5000")
    write({"scenario.yaml": f"{content.rstrip()}\nrecord: {{iterations: [2000]}}\n"})
    outcome = hilc("run", "scenario.yaml")
    assert outcome.code == 2
    assert [line.split(": ")[1] for line in outcome.err.splitlines()] == [
        "robot.foo",
        "controller.b_w",
        "controller.h",
        "record.iterations.0",
    ]
