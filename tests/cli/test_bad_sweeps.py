"""Wrong sweeps: each with the exact message that a person reads, and nothing written."""
# ruff: noqa: E501

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.inputs import listing, plus
from tests.conftest import Hilc, Outcome, Write

CASES: list[tuple[list[str], int, str]] = [
    (
        ["--vary", "controller.gains.l1"],
        2,
        "--vary controller.gains.l1: must read KEY=VALUES, such as controller.gains.l1=0:1:11",
    ),
    (
        ["--vary", "=1,2"],
        2,
        "--vary =1,2: must read KEY=VALUES, such as controller.gains.l1=0:1:11",
    ),
    (
        ["--vary", "controller.gains.l1="],
        2,
        "--vary controller.gains.l1=: must read KEY=VALUES, such as controller.gains.l1=0:1:11",
    ),
    (
        ["--vary", "controller..l1=1,2"],
        2,
        "--vary controller..l1=1,2: must read KEY=VALUES, such as controller.gains.l1=0:1:11",
    ),
    (
        ["--vary", "controller.gains.l1=0.1,,0.2"],
        2,
        "--vary controller.gains.l1=0.1,,0.2: controller.gains.l1: has an empty value, got '0.1,,0.2'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=,"],
        2,
        "--vary controller.gains.l1=,: controller.gains.l1: has an empty value, got ','; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=a,b"],
        2,
        (
            "--vary controller.gains.l1=a,b: controller.gains.l1: has the unknown name 'a', got 'a'; give a number from 0 up, such as 0.5\n"
            "--vary controller.gains.l1=a,b: controller.gains.l1: has the unknown name 'b', got 'b'; give a number from 0 up, such as 0.5"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=-1,1"],
        2,
        "--vary controller.gains.l1=-1,1: controller.gains.l1: must be at least 0, got -1; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=0.1,0.1"],
        2,
        "--vary controller.gains.l1=0.1,0.1: controller.gains.l1: has the value 0.1 more than once; remove one",
    ),
    (
        ["--vary", "controller.gains.l1=0.1,1e-1"],
        2,
        "--vary controller.gains.l1=0.1,1e-1: controller.gains.l1: has the value 0.1 more than once; remove one",
    ),
    (
        ["--vary", "controller.gains.l1=1:0:3"],
        2,
        "--vary controller.gains.l1=1:0:3: controller.gains.l1: must rise, got '1:0:3'; give the smaller number first, such as 0.1:10:20",
    ),
    (
        ["--vary", "controller.gains.l1=0:1"],
        2,
        "--vary controller.gains.l1=0:1: controller.gains.l1: is a range without a number of values, got '0:1'; add it, such as 0.1:10:20, or draw from the range with 'sample'",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:1"],
        2,
        "--vary controller.gains.l1=0:1:1: controller.gains.l1: needs 2 or more values, got '0:1:1'; give their number last, such as 0.1:10:20",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:0"],
        2,
        "--vary controller.gains.l1=0:1:0: controller.gains.l1: needs 2 or more values, got '0:1:0'; give their number last, such as 0.1:10:20",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:x"],
        2,
        "--vary controller.gains.l1=0:1:x: controller.gains.l1: needs 2 or more values, got '0:1:x'; give their number last, such as 0.1:10:20",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:2.5"],
        2,
        "--vary controller.gains.l1=0:1:2.5: controller.gains.l1: needs 2 or more values, got '0:1:2.5'; give their number last, such as 0.1:10:20",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:-3"],
        2,
        "--vary controller.gains.l1=0:1:-3: controller.gains.l1: needs 2 or more values, got '0:1:-3'; give their number last, such as 0.1:10:20",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:3:foo"],
        2,
        "--vary controller.gains.l1=0:1:3:foo: controller.gains.l1: is no range, got '0:1:3:foo'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:3:log"],
        2,
        "--vary controller.gains.l1=0:1:3:log: controller.gains.l1: has no logarithm, got '0:1:3:log'; start above 0, such as 0.1:10:20:log",
    ),
    (
        ["--vary", "controller.gains.l1=-1:1:3:log"],
        2,
        "--vary controller.gains.l1=-1:1:3:log: controller.gains.l1: has no logarithm, got '-1:1:3:log'; start above 0, such as 0.1:10:20:log",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:3:4:log"],
        2,
        "--vary controller.gains.l1=0:1:3:4:log: controller.gains.l1: is no range, got '0:1:3:4:log'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=::"],
        2,
        "--vary controller.gains.l1=::: controller.gains.l1: holds '', which ends where a number should be, got '::'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=:"],
        2,
        "--vary controller.gains.l1=:: controller.gains.l1: holds '', which ends where a number should be, got ':'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=1:"],
        2,
        "--vary controller.gains.l1=1:: controller.gains.l1: holds '', which ends where a number should be, got '1:'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=a:b:3"],
        2,
        "--vary controller.gains.l1=a:b:3: controller.gains.l1: holds 'a', which has the unknown name 'a', got 'a:b:3'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=1e400:2:3"],
        2,
        "--vary controller.gains.l1=1e400:2:3: controller.gains.l1: must be finite, got '1e400:2:3'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=0:1e400:3"],
        2,
        "--vary controller.gains.l1=0:1e400:3: controller.gains.l1: must be finite, got '0:1e400:3'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=nan"],
        2,
        "--vary controller.gains.l1=nan: controller.gains.l1: has the unknown name 'nan', got 'nan'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=.nan,1"],
        2,
        "--vary controller.gains.l1=.nan,1: controller.gains.l1: must be finite, got nan; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=1.."],
        2,
        "--vary controller.gains.l1=1..: controller.gains.l1: has '.', which is no part of it, got '1..'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=5..1"],
        2,
        "--vary controller.gains.l1=5..1: controller.gains.l1: must rise, got '5..1'; give the smaller number first, such as 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=1.5..3"],
        2,
        "--vary controller.gains.l1=1.5..3: controller.gains.l1: has '.', which is no part of it, got '1.5..3'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=0:1:2000000"],
        2,
        "--vary controller.gains.l1=0:1:2000000: controller.gains.l1: has 2000000 values, got '0:1:2000000'; give at most 1000000, or draw from a range",
    ),
    (
        ["--vary", "controller.gains.l1=0..2000000"],
        2,
        "--vary controller.gains.l1=0..2000000: controller.gains.l1: has 2000001 values, got '0..2000000'; give at most 1000000, or draw from a range",
    ),
    (
        ["--vary", "controller.gains.l1=0..99999999999999999999999"],
        2,
        "--vary controller.gains.l1=0..99999999999999999999999: controller.gains.l1: has '.99999999999999999999999' where it should end or have an operator, got '0..99999999999999999999999'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gain.l1=0.1,0.2"],
        2,
        "--vary controller.gain.l1=0.1,0.2: controller.gain: is an unknown key of law hybrid; did you mean 'controller.gains.l1'?",
    ),
    (
        ["--vary", "controllr.gains.l1=0.1,0.2"],
        2,
        "--vary controllr.gains.l1=0.1,0.2: controllr: is an unknown key; did you mean 'controller.gains.l1'?",
    ),
    (
        ["--vary", "controller.gains.l4=0.1,0.2"],
        2,
        "--vary controller.gains.l4=0.1,0.2: controller.gains.l4: is an unknown key of law hybrid; known: derivative, l1, l2, l3, lateral",
    ),
    (
        ["--vary", "controller.gains=0.1,0.2"],
        2,
        (
            "--vary controller.gains=0.1,0.2: controller.gains: must be a mapping of keys and values, got 0.1; write its keys below it\n"
            "--vary controller.gains=0.1,0.2: controller.gains: must be a mapping of keys and values, got 0.2; write its keys below it"
        ),
    ),
    (
        ["--vary", "controller=1,2"],
        2,
        (
            "--vary controller=1,2: controller: must be a mapping of keys and values, got 1; write its keys below it\n"
            "--vary controller=1,2: controller: must be a mapping of keys and values, got 2; write its keys below it"
        ),
    ),
    (
        ["--vary", "gains.l1=1,2"],
        2,
        "--vary gains.l1=1,2: gains: is an unknown key; did you mean 'controller.gains.l1'?",
    ),
    (
        ["--vary", "l1=1,2"],
        2,
        "--vary l1=1,2: l1: is an unknown key; did you mean 'controller.gains.l1'?",
    ),
    (
        ["--vary", "name=a,b"],
        2,
        "--vary name=a,b: name: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "description=a,b"],
        2,
        "--vary description=a,b: description: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "record.iterations=all,auto"],
        2,
        "--vary record.iterations=all,auto: record.iterations: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "sweep.seed=1,2"],
        2,
        "--vary sweep.seed=1,2: sweep.seed: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "sweep=1,2"],
        2,
        "--vary sweep=1,2: sweep: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "controller.law=hybrid,pid"],
        2,
        "--vary controller.law=hybrid,pid: controller.law: cannot be varied, since each law has parameters of its own; make a scenario for each law",
    ),
    (
        ["--vary", "controller.compensation=on,off,maybe"],
        2,
        "--vary controller.compensation=on,off,maybe: controller.compensation: is not one of the choices, got 'maybe'; give auto, on or off",
    ),
    (
        ["--vary", "controller.gain_heading=measured,refrence"],
        2,
        "--vary controller.gain_heading=measured,refrence: controller.gain_heading: is not one of the choices, got 'refrence'; did you mean 'reference'?",
    ),
    (
        ["--vary", "controller.gain_heading=1:2:3"],
        2,
        (
            "--vary controller.gain_heading=1:2:3: controller.gain_heading: is not one of the choices, got '1'; give measured, previous or reference\n"
            "--vary controller.gain_heading=1:2:3: controller.gain_heading: is not one of the choices, got '2'; give measured, previous or reference"
        ),
    ),
    (
        ["--vary", "controller.gain_matrix=model,foo"],
        2,
        "--vary controller.gain_matrix=model,foo: controller.gain_matrix: is no gain matrix, got 'foo'; give model, unit, or two rows of three numbers or expressions in cos, sin, R and B",
    ),
    (
        ["--vary", "controller.gain_matrix.0.0=cos/R,x"],
        2,
        "--vary controller.gain_matrix.0.0=cos/R,x: controller.gain_matrix.0: cannot be set, since controller.gain_matrix is a single value; set that instead",
    ),
    (
        ["--vary", "controller.gain_matrix.0.0=0.1:2:3"],
        2,
        "--vary controller.gain_matrix.0.0=0.1:2:3: controller.gain_matrix.0: cannot be set, since controller.gain_matrix is a single value; set that instead",
    ),
    (
        ["--vary", "controller.b_w=180,0"],
        2,
        "--vary controller.b_w=180,0: controller.b_w: must be above 0, got 0; give a number above 0, such as 180 or 1700 rpm",
    ),
    (
        ["--vary", "controller.b_w=180,null,-1"],
        2,
        "--vary controller.b_w=180,null,-1: controller.b_w: must be above 0, got -1; give a number above 0, such as 180 or 1700 rpm",
    ),
    (
        ["--vary", "controller.b_w=null,null"],
        2,
        "--vary controller.b_w=null,null: controller.b_w: has the value null more than once; remove one",
    ),
    (
        ["--vary", "controller.h=1,2,7"],
        2,
        "--vary controller.h=1,2,7: controller.h: must be at most the trajectory's 3 samples, got 7; give a whole number from 1 to 3",
    ),
    (
        ["--vary", "controller.h=1.5,2"],
        2,
        "--vary controller.h=1.5,2: controller.h: must be a whole number, got 1.5; give a whole number from 1 up, such as 200",
    ),
    (
        ["--vary", "controller.h=1:7:3"],
        2,
        "--vary controller.h=1:7:3: controller.h: must be at most the trajectory's 3 samples, got '7'; give a whole number from 1 to 3",
    ),
    (
        ["--vary", "controller.h=1..7"],
        2,
        "--vary controller.h=1..7: controller.h: must be at most the trajectory's 3 samples, got 7; give a whole number from 1 to 3",
    ),
    (
        ["--vary", "controller.h=0..3"],
        2,
        "--vary controller.h=0..3: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200",
    ),
    (
        ["--vary", "controller.switch_tolerance=-1,1"],
        2,
        "--vary controller.switch_tolerance=-1,1: controller.switch_tolerance: must be at least 0, got -1; give a number from 0 up, such as 1e-9, in m and rad",
    ),
    (
        ["--vary", "iterations=-1,2"],
        2,
        "--vary iterations=-1,2: iterations: must be at least 0, got -1; give a whole number from 0 up, such as 100",
    ),
    (
        ["--vary", "iterations=1:2.5:3"],
        2,
        "--vary iterations=1:2.5:3: iterations: must be a whole number, got '2.5'; give a whole number from 0 up, such as 100",
    ),
    (
        ["--vary", "iterations=1..20000000"],
        2,
        "--vary iterations=1..20000000: iterations: has 20000000 values, got '1..20000000'; give at most 1000000, or draw from a range",
    ),
    (
        ["--vary", "iterations=20 s,2"],
        2,
        "--vary iterations=20 s,2: iterations: must have no unit, got '20 s'; give a whole number from 0 up, such as 100",
    ),
    (
        ["--vary", "robot.wheel_radius=20 cm,30 deg"],
        2,
        "--vary robot.wheel_radius=20 cm,30 deg: robot.wheel_radius: has the wrong unit, got '30 deg'; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        ["--vary", "robot.wheel_radius=20 cm:30 deg:3"],
        2,
        "--vary robot.wheel_radius=20 cm:30 deg:3: robot.wheel_radius: has the wrong unit, got '30 deg'; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        ["--vary", "robot.wheel_radius=-1:1:3"],
        2,
        "--vary robot.wheel_radius=-1:1:3: robot.wheel_radius: must be above 0, got '-1'; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        ["--vary", "robot.wheel_radius=0:1:3"],
        2,
        "--vary robot.wheel_radius=0:1:3: robot.wheel_radius: must be above 0, got '0'; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        ["--vary", "robot.wheel_separation=1,2"],
        2,
        "--vary robot.wheel_separation=1,2: robot: needs exactly one of half_track and wheel_separation; give one of them",
    ),
    (
        ["--vary", "robot.turn_convention=paper,rosy"],
        2,
        "--vary robot.turn_convention=paper,rosy: robot.turn_convention: is not one of the choices, got 'rosy'; give paper or rep103",
    ),
    (
        ["--vary", "robot.turn_convention=paper,ros,rep103"],
        2,
        "--vary robot.turn_convention=paper,ros,rep103: robot.turn_convention: has the value rep103 more than once; remove one",
    ),
    (
        ["--vary", "robot.gravity_center.0=1,2"],
        2,
        "--vary robot.gravity_center.0=1,2: robot.gravity_center.0: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "robot.gravity_center.2=1,2"],
        2,
        "--vary robot.gravity_center.2=1,2: robot.gravity_center.2: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "robot.gravity_center=1,2"],
        2,
        "--vary robot.gravity_center=1,2: robot.gravity_center: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "robot.friction=0.5,1"],
        2,
        "--vary robot.friction=0.5,1: robot.friction: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "model.half_track=1,2", "--vary", "model.wheel_separation=1,2"],
        2,
        "--vary model.wheel_separation=1,2: model: has both half_track and wheel_separation; give one of them",
    ),
    (
        ["--vary", "model.weel_radius=1,2"],
        2,
        "--vary model.weel_radius=1,2: model.weel_radius: is an unknown key; did you mean 'wheel_radius'?",
    ),
    (
        ["--vary", "initial_pose.x=a"],
        2,
        "--vary initial_pose.x=a: initial_pose.x: has the unknown name 'a', got 'a'; give a number, such as 1.5 or 20 cm",
    ),
    (
        ["--vary", "initial_pose.z=1"],
        2,
        "--vary initial_pose.z=1: initial_pose.z: is an unknown key; known: heading, x, y",
    ),
    (
        ["--vary", "initial_pose=1,2"],
        2,
        (
            "--vary initial_pose=1,2: initial_pose: must be a mapping of keys and values, got 1; write its keys below it\n"
            "--vary initial_pose=1,2: initial_pose: must be a mapping of keys and values, got 2; write its keys below it"
        ),
    ),
    (
        ["--vary", "initial_input=zero,foo.csv"],
        2,
        "--vary initial_input=zero,foo.csv: initial_input: must be zero or feedforward in a sweep, got 'foo.csv'",
    ),
    (
        ["--vary", "initial_input=input.csv"],
        2,
        "--vary initial_input=input.csv: initial_input: must be zero or feedforward in a sweep, got 'input.csv'",
    ),
    (
        ["--vary", "initial_input=1:2:3"],
        2,
        (
            "--vary initial_input=1:2:3: initial_input: must be zero or feedforward in a sweep, got '1'\n"
            "--vary initial_input=1:2:3: initial_input: must be zero or feedforward in a sweep, got '2'"
        ),
    ),
    (
        ["--vary", "initial_trial=open-loop,closed"],
        2,
        "--vary initial_trial=open-loop,closed: initial_trial: is not one of the choices, got 'closed'; give open-loop or feedback",
    ),
    (
        ["--vary", "disturbance.seed=-1,2"],
        2,
        "--vary disturbance.seed=-1,2: disturbance.seed: must be at least 0, got -1; give a whole number from 0 up, such as 0",
    ),
    (
        ["--vary", "disturbance.seed=1.5"],
        2,
        "--vary disturbance.seed=1.5: disturbance.seed: must be a whole number, got 1.5; give a whole number from 0 up, such as 0",
    ),
    (
        ["--vary", "disturbance.seed=1..3", "--vary", "disturbance.seed=1..4"],
        2,
        "--vary disturbance.seed=1..4: disturbance.seed: is varied more than once; give it once",
    ),
    (
        ["--vary", "disturbance.output.bound=1,2"],
        2,
        (
            "--vary disturbance.output.bound=1,2: disturbance.output.bound: must be a list, got 1; write [..., ...]\n"
            "--vary disturbance.output.bound=1,2: disturbance.output.bound: must be a list, got 2; write [..., ...]"
        ),
    ),
    (
        ["--vary", "disturbance.output.bound.0=-1,2"],
        2,
        "--vary disturbance.output.bound.0=-1,2: disturbance.output.bound.0: must be at least 0, got -1; give a number from 0 up, such as 0.001 or 1 mm",
    ),
    (
        ["--vary", "disturbance.output.bound.3=1,2"],
        2,
        "--vary disturbance.output.bound.3=1,2: disturbance.output.bound.3: is no entry of the list; give a number from 0 to 2",
    ),
    (
        ["--vary", "disturbance.output.bound.x=1,2"],
        2,
        "--vary disturbance.output.bound.x=1,2: disturbance.output.bound.x: is no entry of the list; give a number from 0 to 2",
    ),
    (
        ["--vary", "disturbance.output.distribution=uniform,normal"],
        2,
        "--vary disturbance.output.distribution=uniform,normal: disturbance.output.distribution: is not one of the choices, got 'normal'; give uniform or truncated-normal",
    ),
    (
        ["--vary", "disturbance.output.standard_deviation.0=1,2"],
        2,
        "--vary disturbance.output.standard_deviation.0=1,2: disturbance.output.standard_deviation: must be a list, got a mapping; write [..., ...]",
    ),
    (
        ["--vary", "disturbance.output.repeat=true,false,maybe"],
        2,
        "--vary disturbance.output.repeat=true,false,maybe: disturbance.output.repeat: must be true or false, got 'maybe'; give true or false",
    ),
    (
        ["--vary", "disturbance.output.repeat=0,1"],
        2,
        (
            "--vary disturbance.output.repeat=0,1: disturbance.output.repeat: must be true or false, got 0; give true or false\n"
            "--vary disturbance.output.repeat=0,1: disturbance.output.repeat: must be true or false, got 1; give true or false"
        ),
    ),
    (
        ["--vary", "disturbance.noise.bound.0=1,2"],
        2,
        "--vary disturbance.noise.bound.0=1,2: disturbance.noise: is an unknown key; known: initial_pose, output, seed, state",
    ),
    (
        ["--vary", "trajectory=path.yaml,nosuch.yaml"],
        2,
        "--vary trajectory=path.yaml,nosuch.yaml: trajectory: nosuch.yaml: there is no such file; check the path",
    ),
    (
        ["--vary", "trajectory=path.yaml,path.yaml"],
        2,
        "--vary trajectory=path.yaml,path.yaml: trajectory: has two trajectories named path; give them different names",
    ),
    (
        ["--vary", "trajectory=scenario.yaml"],
        2,
        "--vary trajectory=scenario.yaml: trajectory: is a scenario, not a trajectory, got scenario.yaml; name a trajectory file",
    ),
    (
        ["--vary", "trajectory=1,2"],
        2,
        "--vary trajectory=1,2: trajectory: must be a list of trajectory files; give their paths",
    ),
    (
        ["--vary", "trajectory=1:2:3"],
        2,
        "--vary trajectory=1:2:3: trajectory: must be a list of trajectory files; give their paths",
    ),
    (
        ["--vary", "trajectory=1..2"],
        2,
        "--vary trajectory=1..2: trajectory: must be a list of trajectory files; give their paths",
    ),
    (
        ["--vary", "trajectory=example:qqq"],
        2,
        "--vary trajectory=example:qqq: trajectory: example:qqq: there is no such example; known: arc-and-line, cardioid, circle, circle-from-rest, corridor, figure-eight, parking, rounded-square, slalom, spiral, square-lap, timed-lap, turn-in-place",
    ),
    (
        ["--vary", "trajectory=input.csv"],
        2,
        "--vary trajectory=input.csv: trajectory: must be a trajectory file, got 'input.csv'; points go into a segment of one, as 'path: {file: points.csv, speed: 0.5}'",
    ),
    (
        ["--vary", "trajectory.segments.0.line.length=-1,2"],
        2,
        "--vary trajectory.segments.0.line.length=-1,2: trajectory.segments.0.line.length: must be above 0, got -1; give a number above 0, such as 5 or 5 m",
    ),
    (
        ["--vary", "trajectory.segments.1.line.length=1,2"],
        2,
        "--vary trajectory.segments.1.line.length=1,2: trajectory.segments.1: is no entry of the list; give a number from 0 to 0",
    ),
    (
        ["--vary", "trajectory.segments.0.arc.radius=1,2"],
        2,
        (
            "--vary trajectory.segments.0.arc.radius=1,2: trajectory.segments.0.arc.turn: is missing; give it (left is counterclockwise)\n"
            "--vary trajectory.segments.0.arc.radius=1,2: trajectory.segments.0.arc.sweep: is missing; give it (rad; more than 2*pi is more than one turn)\n"
            "--vary trajectory.segments.0.arc.radius=1,2: trajectory.segments.0: needs exactly one of arc, semicircle, line, turn, stop, clothoid, spline and path; give one of them\n"
            "--vary trajectory.segments.0.arc.radius=1,2: trajectory.segments.0.arc: needs exactly one of duration and speed; give one of them"
        ),
    ),
    (
        ["--vary", "trajectory.segments.0.line.duration=0.3,0.35"],
        2,
        "--vary trajectory.segments.0.line.duration=0.3,0.35: trajectory.segments.0.line.duration: takes 0.35 s, which is 3.5 samples of 0.1 s, got 0.35; give a whole number of samples, such as 0.3 s",
    ),
    (
        ["--vary", "trajectory.segments.0.line.speed=1,2"],
        2,
        "--vary trajectory.segments.0.line.speed=1,2: trajectory.segments.0.line: needs exactly one of duration and speed; give one of them",
    ),
    (
        ["--vary", "trajectory.sample_time=0.1,0.2"],
        2,
        "--vary trajectory.sample_time=0.1,0.2: trajectory.segments.0.line.duration: takes 0.3 s, which is 1.5 samples of 0.2 s, got 0.3; give a whole number of samples, such as 0.2 s",
    ),
    (
        ["--vary", "trajectory.name=a,b"],
        2,
        "--vary trajectory.name=a,b: trajectory.name: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "trajectory.closed=true,false"],
        2,
        "--vary trajectory.closed=true,false: trajectory.closed: has no effect on the results; vary another key",
    ),
    (
        ["--vary", "controller.gains.l1=a", "--vary", "controller.h=0", "--vary", "foo=1"],
        2,
        (
            "--vary controller.gains.l1=a: controller.gains.l1: has the unknown name 'a', got 'a'; give a number from 0 up, such as 0.5\n"
            "--vary controller.h=0: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200\n"
            "--vary foo=1: foo: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory"
        ),
    ),
    (
        ["--vary", "controller.gains.l1", "--vary", "foo"],
        2,
        (
            "--vary controller.gains.l1: must read KEY=VALUES, such as controller.gains.l1=0:1:11\n"
            "--vary foo: must read KEY=VALUES, such as controller.gains.l1=0:1:11"
        ),
    ),
    (
        ["--vary", "controller.h=1,3", "--vary", "trajectory.segments.0.line.duration=0.2,0.3"],
        2,
        "--vary controller.h=1,3: controller.h: must be at most the trajectory's 2 samples, got 3; give a whole number from 1 to 2",
    ),
    (
        [
            "--vary",
            "disturbance.output.bound.0=0,1",
            "--vary",
            "disturbance.output.standard_deviation.0=0,1",
        ],
        2,
        "--vary disturbance.output.standard_deviation.0=0,1: disturbance.output.standard_deviation: must be a list, got a mapping; write [..., ...]",
    ),
    (
        [
            "--vary",
            "disturbance.output.distribution=truncated-normal,uniform",
            "--vary",
            "disturbance.output.standard_deviation.0=1,2",
        ],
        2,
        "--vary disturbance.output.standard_deviation.0=1,2: disturbance.output.standard_deviation: must be a list, got a mapping; write [..., ...]",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "random"],
        2,
        "--sample random: sample: needs the number of cases to draw, got 'random'; give it too, such as 'cases: 1000' or --cases 1000",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--cases", "3"],
        2,
        (
            "--cases 3: cases: has no meaning for a grid, got 3; remove it, or set 'sample: random' or 'sample: sobol'\n"
            "--vary controller.gains.l1=0:1: controller.gains.l1: is a range without a number of values, got '0:1'; add it, such as 0.1:10:20, or draw from the range with 'sample'"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=0:1:3", "--cases", "3"],
        2,
        "--cases 3: cases: has no meaning for a grid, got 3; remove it, or set 'sample: random' or 'sample: sobol'",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "random", "--cases", "0"],
        2,
        "--cases 0: cases: must be at least 1, got 0; give a whole number from 1 up, such as 1000",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "random", "--cases", "-3"],
        2,
        "--cases -3: cases: must be at least 1, got -3; give a whole number from 1 up, such as 1000",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "random", "--cases", "x"],
        2,
        "hilc: invalid value for '--cases': Input should be a valid integer, unable to parse string as an integer; see 'hilc sweep --help'",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "random", "--cases", "1000000000"],
        2,
        "--cases 1000000000: cases: must be at most 100000000, got 1000000000; give a whole number from 1 to 100000000, such as 1000",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "foo", "--cases", "3"],
        2,
        "hilc: invalid value for '--sample': 'foo' is not one of 'grid', 'random', 'sobol'; see 'hilc sweep --help'",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--sample", "sobol", "--cases", "3", "--seed", "-1"],
        2,
        "--seed -1: seed: must be at least 0, got -1; give a whole number from 0 up, such as 0",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1",
            "--sample",
            "sobol",
            "--cases",
            "3",
            "--seed",
            "18446744073709551616",
        ],
        2,
        "--seed 18446744073709551616: seed: must be at most 18446744073709551615, got 18446744073709551616; give a whole number from 0 to 18446744073709551615, such as 0",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--tolerance", "0"],
        2,
        "--tolerance 0: tolerance: must be above 0, got '0'; give a number above 0, such as 0.05 or 5 cm",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--tolerance", "x"],
        2,
        "--tolerance x: tolerance: has the unknown name 'x', got 'x'; give a number above 0, such as 0.05 or 5 cm",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--tolerance", "3s"],
        2,
        "--tolerance 3s: tolerance: has the wrong unit, got '3s'; give a number above 0, such as 0.05 or 5 cm",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--tolerance", "-1"],
        2,
        "--tolerance -1: tolerance: must be above 0, got '-1'; give a number above 0, such as 0.05 or 5 cm",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--metric", "foo"],
        2,
        "--metric foo: metric: is not one of the choices, got 'foo'; give max_position_error_m, mean_position_error_m, rms_position_error_m, final_position_error_m, max_abs_error_x_m, max_abs_error_y_m, max_abs_error_heading_rad, max_wheel_speed_rad_s, saturated_samples, input_change_rms_rad_s, max_position_error_second_half_m, mean_position_error_second_half_m, iterations_to_tolerance or peak_max_position_error_m",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--metric", "max_position_error"],
        2,
        "--metric max_position_error: metric: is not one of the choices, got 'max_position_error'; did you mean 'max_position_error_m'?",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--metric", "max_error"],
        2,
        "--metric max_error: metric: is not one of the choices, got 'max_error'; did you mean 'max_position_error_m'?",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--metric", "iterations_to_tolerance"],
        2,
        "--metric iterations_to_tolerance: metric: needs a tolerance, got 'iterations_to_tolerance'; give it too, such as 'tolerance: 5 cm' or --tolerance '5 cm'",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--workers", "0"],
        2,
        "hilc: invalid value for '--workers': Input should be greater than or equal to 1; see 'hilc sweep --help'",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--workers", "x"],
        2,
        "hilc: invalid value for '--workers': Input should be a valid integer, unable to parse string as an integer; see 'hilc sweep --help'",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--shard", "1"],
        2,
        "hilc: --shard 1: must read K/N, such as 1/3",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--shard", "0/2"],
        2,
        "hilc: --shard 0/2: K must be from 1 to N, such as 1/3",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--shard", "3/2"],
        2,
        "hilc: --shard 3/2: K must be from 1 to N, such as 1/3",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--shard", "1/0"],
        2,
        "hilc: --shard 1/0: K must be from 1 to N, such as 1/3",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--shard", "1/9"],
        2,
        "hilc: --shard 1/9: there are only 2 cases; make fewer shards",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--shard", "a/b"],
        2,
        "hilc: --shard a/b: must read K/N, such as 1/3",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--merge"],
        2,
        "hilc: --merge takes the folders of all shards and no scenario, so that only --out, --force, --json, -q and what is about pictures go with it",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--format", "jpg"],
        2,
        "hilc: invalid value for '--format': 'jpg' is not one of 'png', 'svg', 'pdf', 'parquet'; see 'hilc sweep --help'",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--sed", "3"],
        2,
        "hilc: no such option: --sed; did you mean: --seed",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--out", "path.yaml"],
        2,
        "hilc: --out path.yaml: is the name of a file; give the name of a folder, such as path",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--out", "."],
        1,
        "hilc: .: is the folder you are in; name another with --out",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--out", "path.yaml/x"],
        1,
        "hilc: path.yaml/x: cannot be written: nothing is made below path.yaml, which is no folder",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--set", "iterations=-1"],
        2,
        "--set iterations=-1: iterations: must be at least 0, got -1; give a whole number from 0 up, such as 100",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1:10000",
            "--vary",
            "controller.gains.l2=0:1:10000",
            "--vary",
            "controller.gains.l3=0:1:10000",
        ],
        2,
        "hilc: the grid has 1,000,000,000,000 cases, of which at most 100,000,000 can be run; give fewer values, or draw some with --sample and --cases",
    ),
    (
        ["--vary", "controller.gains.l1=1 2"],
        2,
        "--vary controller.gains.l1=1 2: controller.gains.l1: has '2' where it should end or have an operator, got '1 2'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=1 m"],
        2,
        "--vary controller.gains.l1=1 m: controller.gains.l1: must have no unit, got '1 m'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=0.1;0.2"],
        2,
        "--vary controller.gains.l1=0.1;0.2: controller.gains.l1: has ';', which is no part of it, got '0.1;0.2'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=[0.1,0.2"],
        2,
        "--vary controller.gains.l1=[0.1,0.2: controller.gains.l1: has '[', which is no part of it, got '[0.1'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=[0.1,-0.2]"],
        2,
        "--vary controller.gains.l1=[0.1,-0.2]: controller.gains.l1: must be at least 0, got -0.2; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1=(0.1,0.2)"],
        2,
        (
            "--vary controller.gains.l1=(0.1,0.2): controller.gains.l1: has an opening bracket without a closing one, got '(0.1'; give a number from 0 up, such as 0.5\n"
            "--vary controller.gains.l1=(0.1,0.2): controller.gains.l1: has ')' where it should end or have an operator, got '0.2)'; give a number from 0 up, such as 0.5"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=0.1:0.2:0.3:0.4:0.5"],
        2,
        "--vary controller.gains.l1=0.1:0.2:0.3:0.4:0.5: controller.gains.l1: is no range, got '0.1:0.2:0.3:0.4:0.5'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=0.1:1:3:LOG"],
        2,
        "--vary controller.gains.l1=0.1:1:3:LOG: controller.gains.l1: is no range, got '0.1:1:3:LOG'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=0...5"],
        2,
        "--vary controller.gains.l1=0...5: controller.gains.l1: has '.', which is no part of it, got '0...5'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "controller.gains.l1='0.1,0.2'"],
        2,
        (
            "--vary controller.gains.l1='0.1,0.2': controller.gains.l1: has ''', which is no part of it, got ''0.1'; did you mean '0.1'?\n"
            "--vary controller.gains.l1='0.1,0.2': controller.gains.l1: has ''', which is no part of it, got '0.2''; did you mean '0.2'?"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=-1,-2"],
        2,
        (
            "--vary controller.gains.l1=-1,-2: controller.gains.l1: must be at least 0, got -1; give a number from 0 up, such as 0.5\n"
            "--vary controller.gains.l1=-1,-2: controller.gains.l1: must be at least 0, got -2; give a number from 0 up, such as 0.5"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=-3:-1:3"],
        2,
        (
            "--vary controller.gains.l1=-3:-1:3: controller.gains.l1: must be at least 0, got '-3'; give a number from 0 up, such as 0.5\n"
            "--vary controller.gains.l1=-3:-1:3: controller.gains.l1: must be at least 0, got '-1'; give a number from 0 up, such as 0.5"
        ),
    ),
    (
        ["--vary", "controller.h=1,7", "--vary", "trajectory.segments.0.line.duration=0.7,0.5"],
        2,
        "--vary controller.h=1,7: controller.h: must be at most the trajectory's 5 samples, got 7; give a whole number from 1 to 5",
    ),
    (
        [
            "--vary",
            "trajectory.segments.0.line.duration=0.4,0.8",
            "--set",
            "initial_input=input.csv",
        ],
        2,
        "--vary trajectory.segments.0.line.duration=0.4,0.8: trajectory: has 4 samples in path, but the initial input has 3; set initial_input to zero or feedforward",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=a",
            "--vary",
            "controller.h=1,7",
            "--vary",
            "trajectory.segments.0.line.duration=0.7,0.8",
        ],
        2,
        "--vary controller.gains.l1=a: controller.gains.l1: has the unknown name 'a', got 'a'; give a number from 0 up, such as 0.5",
    ),
    (
        ["--vary", "iterations=1e3:2:3"],
        2,
        "--vary iterations=1e3:2:3: iterations: must rise, got '1e3:2:3'; give the smaller number first, such as 0.1:10:20",
    ),
    (
        [
            "--vary",
            "disturbance.output.bound.0=0,1",
            "--set",
            "disturbance.output={bound:[1,1,1],distribution:truncated-normal,standard_deviation:[0,1,1]}",
        ],
        2,
        "--set disturbance.output={bound:[1,1,1],distribution:truncated-normal,standard_deviation:[0,1,1]}: disturbance.output: is not valid YAML: found unexpected ':'; check quotes, colons, brackets and indentation",
    ),
    (
        [
            "--vary",
            "disturbance.output.bound.0=0,1",
            "--vary",
            "disturbance.output.standard_deviation.0=0,1",
            "--set",
            'disturbance.output={"bound":[0,1,1],"distribution":"truncated-normal","standard_deviation":[0,1,1]}',
        ],
        2,
        "--vary disturbance.output.bound.0=0,1: disturbance.output.standard_deviation.0: must be above 0, got 0.0; give a number above 0 or set this bound to 0",
    ),
    (
        ["--vary", "controller.gains.l1=1:0:3", "--vary", "controller.h=0", "--vary", "foo.x=1"],
        2,
        (
            "--vary controller.gains.l1=1:0:3: controller.gains.l1: must rise, got '1:0:3'; give the smaller number first, such as 0.1:10:20\n"
            "--vary controller.h=0: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200\n"
            "--vary foo.x=1: foo: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--vary", "controller.h=0", "--cases", "3"],
        2,
        (
            "--cases 3: cases: has no meaning for a grid, got 3; remove it, or set 'sample: random' or 'sample: sobol'\n"
            "--vary controller.gains.l1=0:1: controller.gains.l1: is a range without a number of values, got '0:1'; add it, such as 0.1:10:20, or draw from the range with 'sample'\n"
            "--vary controller.h=0: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200"
        ),
    ),
    (
        ["--vary", "controller.gains.l1=0:1:3", "--metric", "iterations_to_tolerance"],
        2,
        "--metric iterations_to_tolerance: metric: needs a tolerance, got 'iterations_to_tolerance'; give it too, such as 'tolerance: 5 cm' or --tolerance '5 cm'",
    ),
    (
        ["--vary", "controller.gains.l1=0,1", "--out", ".."],
        1,
        "hilc: ..: is the folder you are in; name another with --out",
    ),
    (
        ["--vary", "controller.gains.l1=1;2:3:3"],
        2,
        "--vary controller.gains.l1=1;2:3:3: controller.gains.l1: holds '1;2', which has ';', which is no part of it, got '1;2:3:3'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=a;b:3:3"],
        2,
        "--vary controller.gains.l1=a;b:3:3: controller.gains.l1: holds 'a;b', which has ';', which is no part of it, got 'a;b:3:3'; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--minimise", "mean_positon_error", "--cases", "9"],
        2,
        "--minimise mean_positon_error: minimise: is not one of the choices, got 'mean_positon_error'; did you mean 'mean_position_error_m'?",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--minimise", "error", "--cases", "9"],
        2,
        "--minimise error: minimise: is not one of the choices, got 'error'; give max_position_error_m, mean_position_error_m, rms_position_error_m, final_position_error_m, max_abs_error_x_m, max_abs_error_y_m, max_abs_error_heading_rad, max_wheel_speed_rad_s, saturated_samples, input_change_rms_rad_s, max_position_error_second_half_m, mean_position_error_second_half_m, iterations_to_tolerance or peak_max_position_error_m",
    ),
    (
        ["--vary", "controller.gains.l1=0:1", "--minimise", "max_position_error_m"],
        2,
        "--minimise max_position_error_m: minimise: needs the number of cases to try, got 'max_position_error_m'; give it too, such as 'cases: 200' or --cases 200",
    ),
    (
        ["--minimise", "max_position_error_m", "--cases", "9"],
        2,
        "hilc: nothing is varied; give --vary KEY=VALUES, such as --vary controller.gains.l1=0:1:11, or a section 'sweep:' in the scenario",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1",
            "--minimise",
            "iterations_to_tolerance",
            "--cases",
            "9",
        ],
        2,
        "--minimise iterations_to_tolerance: minimise: needs a tolerance, got 'iterations_to_tolerance'; give it too, such as 'tolerance: 5 cm' or --tolerance '5 cm'",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1",
            "--minimise",
            "max_position_error_m",
            "--cases",
            "9",
            "--sample",
            "grid",
            "--metric",
            "rms_position_error_m",
        ],
        2,
        (
            "--metric rms_position_error_m: metric: has no meaning for a search, got 'rms_position_error_m'; remove it: cases are ranked by what is minimised\n"
            "--sample grid: sample: has no meaning for a search, got 'grid'; remove it, or 'minimise'"
        ),
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1",
            "--minimise",
            "max_position_error_m",
            "--cases",
            "9",
            "--shard",
            "1/3",
        ],
        2,
        "hilc: a search has no shards: each case follows from those before it; leave out --shard, or draw the cases with --sample instead of --minimise",
    ),
    (
        ["--minimise", "max_position_error_m", "--merge"],
        2,
        "hilc: --merge takes the folders of all shards and no scenario, so that only --out, --force, --json, -q and what is about pictures go with it",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1",
            "--minimise",
            "max_position_error_m",
            "--cases",
            "10001",
        ],
        2,
        "hilc: the search has 10,001 cases, of which at most 10,000 can be tried; give fewer, or draw them with --sample and --cases",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0:1:log",
            "--minimise",
            "max_position_error_m",
            "--cases",
            "9",
        ],
        2,
        "--vary controller.gains.l1=0:1:log: controller.gains.l1: has no logarithm, got '0:1:log'; start above 0, such as 0.1:10:20:log",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "controller.h",
        ],
        2,
        "--over controller.h: over: names controller.h, which is not varied, got 'controller.h'; give it values with 'vary', or name some of the varied keys: controller.gains.l1, disturbance.seed",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "a b",
        ],
        2,
        "--over a b: over: names a b, which is not varied, got 'a b'; give it values with 'vary', or name some of the varied keys: controller.gains.l1, disturbance.seed",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "disturbance.seed,controller.gains.l1",
        ],
        2,
        "--over disturbance.seed,controller.gains.l1: over: names all varied keys, which leaves nothing to choose, got 'disturbance.seed,controller.gains.l1'; leave out a key that is to be chosen, or 'over'",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "disturbance.seed",
            "--over",
            "disturbance.seed",
        ],
        2,
        "--over disturbance.seed,disturbance.seed: over: names disturbance.seed more than once, got 'disturbance.seed,disturbance.seed'; name it once",
    ),
    (
        ["--vary", "controller.gains.l1=0.1,0.2", "--vary", "disturbance.seed=1..3", "--over", ""],
        2,
        "--over : over: names no key, got ''; name varied keys, such as disturbance.seed",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--robust",
            "mean",
        ],
        2,
        "--robust mean: robust: needs the keys that happen, got 'mean'; name them too, such as 'over: [disturbance.seed]' or --over disturbance.seed",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--happenings",
            "3",
        ],
        2,
        "--happenings 3: happenings: needs the keys that happen, got 3; name them too, such as 'over: [disturbance.seed]' or --over disturbance.seed",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "disturbance.seed",
            "--robust",
            "best",
        ],
        2,
        "hilc: invalid value for '--robust': 'best' is not one of 'worst', 'q95', 'mean'; see 'hilc sweep --help'",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "disturbance.seed",
            "--happenings",
            "0",
        ],
        2,
        "--happenings 0: happenings: must be at least 1, got 0; give a whole number from 1 up, such as 1000",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1,0.2",
            "--vary",
            "robot.wheel_radius=0.1:0.2",
            "--over",
            "robot.wheel_radius",
        ],
        2,
        "--vary robot.wheel_radius=0.1:0.2: robot.wheel_radius: happens, and is a range without a number of values, got '0.1:0.2'; add it, such as 0.1:10:20, or draw from the range with 'happenings: 20'",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1:0.2",
            "--vary",
            "disturbance.seed=1..1000000",
            "--over",
            "disturbance.seed",
            "--sample",
            "random",
            "--cases",
            "1000",
        ],
        2,
        "hilc: 1,000 choices with 1,000,000 happenings are 1,000,000,000 cases, of which at most 100,000,000 can be run; give fewer, or draw some with --cases and --happenings",
    ),
    (
        [
            "--vary",
            "controller.gains.l1=0.1:0.2",
            "--vary",
            "disturbance.seed=1..3",
            "--over",
            "disturbance.seed",
            "--minimise",
            "rms_position_error_m",
            "--cases",
            "10001",
        ],
        2,
        "hilc: the search has 10,001 choices, of which at most 10,000 can be tried; give fewer, or draw them with --sample and --cases",
    ),
    (
        ["--merge", "--over", "disturbance.seed"],
        2,
        "hilc: --merge takes the folders of all shards and no scenario, so that only --out, --force, --json, -q and what is about pictures go with it",
    ),
]

SECTIONS: list[tuple[str, str]] = [
    (
        "sweep: 3",
        "scenario.yaml:8:8: sweep: must be a mapping of keys and values, got 3; write its keys below it",
    ),
    (
        "sweep: [1]",
        "scenario.yaml:8:8: sweep: must be a mapping of keys and values, got a list of 1; write its keys below it",
    ),
    (
        "sweep: {vary: 3}",
        "scenario.yaml:8:15: sweep.vary: must be a mapping of keys and values, got 3; write its keys below it",
    ),
    (
        "sweep: {vary: [1, 2]}",
        "scenario.yaml:8:15: sweep.vary: must be a mapping of keys and values, got a list of 2; write its keys below it",
    ),
    (
        "sweep: {varied: {controller.gains.l1: 1}}",
        "scenario.yaml:8:9: sweep.varied: is an unknown key; did you mean 'vary'?",
    ),
    (
        "sweep: {vary: {}}",
        "hilc: nothing is varied; give --vary KEY=VALUES, such as --vary controller.gains.l1=0:1:11, or a section 'sweep:' in the scenario",
    ),
    (
        "sweep: {}",
        "hilc: nothing is varied; give --vary KEY=VALUES, such as --vary controller.gains.l1=0:1:11, or a section 'sweep:' in the scenario",
    ),
    (
        "sweep: {vary: {controller.gains.l1: {a: 1}}}",
        "scenario.yaml:8:16: sweep.vary.controller.gains.l1: must hold values, not keys; write keys with dots between them, such as controller.gains.l1",
    ),
    (
        "sweep: {vary: {controller: {gains: {l1: [1, 2]}}}}",
        "scenario.yaml:8:16: sweep.vary.controller: must hold values, not keys; write keys with dots between them, such as controller.gains.l1",
    ),
    (
        "sweep: {vary: {controller.gains.l1: []}}",
        "scenario.yaml:8:37: sweep.vary.controller.gains.l1: has no values; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        "sweep: {vary: {controller.gains.l1: [[1]]}}",
        "scenario.yaml:8:37: sweep.vary.controller.gains.l1: must hold single values; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        "sweep: {vary: {controller.gains.l1: [1, -2, x]}}",
        (
            "scenario.yaml:8:37: controller.gains.l1: must be at least 0, got -2; give a number from 0 up, such as 0.5\n"
            "scenario.yaml:8:37: controller.gains.l1: has the unknown name 'x', got 'x'; give a number from 0 up, such as 0.5"
        ),
    ),
    (
        "sweep: {vary: {controller.gains.l1: [1, 1]}}",
        "scenario.yaml:8:37: controller.gains.l1: has the value 1.0 more than once; remove one",
    ),
    (
        "sweep: {vary: {controller.gains.l1: '1:0:3'}}",
        "scenario.yaml:8:37: sweep.vary.controller.gains.l1: must rise, got '1:0:3'; give the smaller number first, such as 0.1:10:20",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}}",
        "scenario.yaml:8:37: sweep.vary.controller.gains.l1: is a range without a number of values, got 0:1; add it, such as 0.1:10:20, or draw from the range with 'sample'",
    ),
    (
        "sweep: {vary: {controller.gains.l9: [1]}}",
        "scenario.yaml:8:37: controller.gains.l9: is an unknown key of law hybrid; known: derivative, l1, l2, l3, lateral",
    ),
    (
        "sweep: {vary: {a..b: [1]}}",
        "scenario.yaml:8:16: sweep.vary.a..b: is no key; give keys with dots between them, such as controller.gains.l1",
    ),
    (
        "sweep: {vary: {'a b': [1]}}",
        "scenario.yaml:8:16: sweep.vary.a b: is no key; give keys with dots between them, such as controller.gains.l1",
    ),
    (
        "sweep: {vary: {'': [1]}}",
        "scenario.yaml:8:16: sweep.vary.: is no key; give keys with dots between them, such as controller.gains.l1",
    ),
    (
        "sweep: {vary: {controller.gains.l1:}}",
        "scenario.yaml:8:35: is not valid YAML: found unexpected ':'; check quotes, colons, brackets and indentation",
    ),
    (
        "sweep: {vary: {controller.gains.l1: ''}}",
        "scenario.yaml:8:37: sweep.vary.controller.gains.l1: has an empty value, got ''; give 0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, sample: some}",
        "scenario.yaml:8:53: sweep.sample: is not one of the choices, got 'some'; give grid, random or sobol",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}, sample: random}",
        "scenario.yaml:8:51: sweep.sample: needs the number of cases to draw, got 'random'; give it too, such as 'cases: 1000' or --cases 1000",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, cases: 3}",
        "scenario.yaml:8:52: sweep.cases: has no meaning for a grid, got 3; remove it, or set 'sample: random' or 'sample: sobol'",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}, sample: sobol, cases: 0}",
        "scenario.yaml:8:65: sweep.cases: must be at least 1, got 0; give a whole number from 1 up, such as 1000",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}, sample: sobol, cases: 2.5}",
        "scenario.yaml:8:65: sweep.cases: must be a whole number, got 2.5; give a whole number from 1 up, such as 1000",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, seed: -1}",
        "scenario.yaml:8:51: sweep.seed: must be at least 0, got -1; give a whole number from 0 up, such as 0",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, tolerance: 0}",
        "scenario.yaml:8:56: sweep.tolerance: must be above 0, got 0; give a number above 0, such as 0.05 or 5 cm",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, tolerance: 3 s}",
        "scenario.yaml:8:56: sweep.tolerance: has the wrong unit, got '3 s'; give a number above 0, such as 0.05 or 5 cm",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, bands: 1}",
        "scenario.yaml:8:52: sweep.bands: must be true or false, got 1; give true or false",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, metric: error}",
        "scenario.yaml:8:53: sweep.metric: is not one of the choices, got 'error'; give max_position_error_m, mean_position_error_m, rms_position_error_m, final_position_error_m, max_abs_error_x_m, max_abs_error_y_m, max_abs_error_heading_rad, max_wheel_speed_rad_s, saturated_samples, input_change_rms_rad_s, max_position_error_second_half_m, mean_position_error_second_half_m, iterations_to_tolerance or peak_max_position_error_m",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, metric: iterations_to_tolerance}",
        "scenario.yaml:8:53: sweep.metric: needs a tolerance, got 'iterations_to_tolerance'; give it too, such as 'tolerance: 5 cm' or --tolerance '5 cm'",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1:3}, tolerence: 1}",
        "scenario.yaml:8:45: sweep.tolerence: is an unknown key; did you mean 'tolerance'?",
    ),
    (
        "sweep: {vary: {name: [a]}}",
        "scenario.yaml:8:22: name: has no effect on the results; vary another key",
    ),
    (
        "sweep: {vary: {record.iterations: [1]}}",
        "scenario.yaml:8:35: record.iterations: has no effect on the results; vary another key",
    ),
    (
        "sweep: {vary: {trajectory: [nosuch.yaml, path.yaml]}}",
        "scenario.yaml:8:28: trajectory: nosuch.yaml: there is no such file; check the path",
    ),
    (
        "sweep: {vary: {trajectory: [{name: x}]}}",
        (
            "scenario.yaml:8:28: trajectory.sample_time: is missing; give it (s)\n"
            "scenario.yaml:8:28: trajectory.segments: is missing; give it"
        ),
    ),
    (
        "sweep: {vary: {trajectory: [path.yaml, 3]}}",
        "scenario.yaml:8:28: trajectory: must be a list of trajectory files; give their paths",
    ),
    (
        "sweep: {vary: {controller.h: [1, 7]}}",
        "scenario.yaml:8:30: controller.h: must be at most the trajectory's 3 samples, got 7; give a whole number from 1 to 3",
    ),
    (
        "sweep:\n  vary:\n    controller.gains.l1: [-1]\n    controller.h: 0\n    foo: 1",
        (
            "scenario.yaml:10:26: controller.gains.l1: must be at least 0, got -1; give a number from 0 up, such as 0.5\n"
            "scenario.yaml:11:19: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200\n"
            "scenario.yaml:12:10: foo: is an unknown key; known: controller, description, disturbance, initial_input, initial_pose, initial_trial, iterations, model, name, record, robot, safety, sweep, trajectory"
        ),
    ),
    (
        "sweep:\n  vary:\n    controller.gains.l1: 1:0:3\n    controller.h: 0\n  sample: random",
        "scenario.yaml:10:26: sweep.vary.controller.gains.l1: must rise, got '1:0:3'; give the smaller number first, such as 0.1:10:20",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0..2000000}}",
        "scenario.yaml:8:37: sweep.vary.controller.gains.l1: has 2000001 values, got '0..2000000'; give at most 1000000, or draw from a range",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0..1, controller.gains.l1: 0..2}}",
        "scenario.yaml:8:43: sweep.vary.controller.gains.l1: is given twice, first in line 8; keep one of them",
    ),
    (
        "sweep: {vary: {controller.b_w: [null, ~]}}",
        "scenario.yaml:8:32: controller.b_w: has the value null more than once; remove one",
    ),
    (
        "sweep: {vary: {controller.gains: [{l1: 1}, {l1: 2}]}}",
        "scenario.yaml:8:34: controller.gains: must hold single values, got a mapping; vary the keys below it",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}, minimise: max_position_error_m}",
        "scenario.yaml:8:53: sweep.minimise: needs the number of cases to try, got 'max_position_error_m'; give it too, such as 'cases: 200' or --cases 200",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}, minimise: peak, sample: sobol, cases: 9}",
        "scenario.yaml:8:53: sweep.minimise: is not one of the choices, got 'peak'; give max_position_error_m, mean_position_error_m, rms_position_error_m, final_position_error_m, max_abs_error_x_m, max_abs_error_y_m, max_abs_error_heading_rad, max_wheel_speed_rad_s, saturated_samples, input_change_rms_rad_s, max_position_error_second_half_m, mean_position_error_second_half_m, iterations_to_tolerance or peak_max_position_error_m",
    ),
    (
        "sweep: {vary: {controller.gains.l1: 0:1}, minimise: rms_position_error_m, sample: grid, cases: 9}",
        "scenario.yaml:8:83: sweep.sample: has no meaning for a search, got 'grid'; remove it, or 'minimise'",
    ),
    (
        "sweep: {vary: {controller.gains.l1: [0.1, 1], disturbance.seed: 1..3}, over: [disturbance.sed]}",
        "scenario.yaml:8:78: sweep.over: names disturbance.sed, which is not varied; give it values with 'vary', or name some of the varied keys: controller.gains.l1, disturbance.seed",
    ),
    (
        "sweep: {vary: {controller.gains.l1: [0.1, 1]}, robust: q95}",
        "scenario.yaml:8:56: sweep.robust: needs the keys that happen, got 'q95'; name them too, such as 'over: [disturbance.seed]' or --over disturbance.seed",
    ),
    (
        "sweep: {vary: {controller.gains.l1: [0.1, 1]}, over: 5}",
        "scenario.yaml:8:54: sweep.over: must be a list, got 5; write [..., ...]",
    ),
]


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        pytest.param(arguments, code, text, id=" ".join(arguments))
        for arguments, code, text in CASES
    ],
)
def test_wrong_sweep_is_explained(
    hilc: Hilc, write: Write, folder: Path, arguments: list[str], code: int, message: str
) -> None:
    write()
    before = listing(folder)
    outcome = hilc("sweep", "scenario.yaml", "--no-plots", *arguments)
    assert outcome == Outcome(code, "", f"{message}\n")
    assert listing(folder) == before


@pytest.mark.parametrize(("section", "message"), SECTIONS)
def test_wrong_section_is_explained_where_it_stands(
    hilc: Hilc, write: Write, folder: Path, section: str, message: str
) -> None:
    write({"scenario.yaml": plus(f"{section}\n")})
    before = listing(folder)
    assert hilc("sweep", "scenario.yaml", "--no-plots") == Outcome(2, "", f"{message}\n")
    assert listing(folder) == before


def test_every_problem_of_a_file_and_of_the_options_is_told(hilc: Hilc, write: Write) -> None:
    write({"scenario.yaml": plus("sweep: {vary: {controller.h: 0, controller.b_w: [-1]}}\n")})
    outcome = hilc("sweep", "scenario.yaml", "--vary", "controller.gains.l1=1:0:3", "--seed", "-1")
    assert outcome.code == 2
    places = [line.split(": ")[0] for line in outcome.err.splitlines()]
    assert sorted(places) == [
        "--seed -1",
        "--vary controller.gains.l1=1:0:3",
        "scenario.yaml:8:30",
        "scenario.yaml:8:49",
    ]


def test_problems_of_a_long_list_stay_readable(hilc: Hilc, write: Write) -> None:
    write()
    values = ",".join(str(-number) for number in range(1, 500))
    outcome = hilc("sweep", "scenario.yaml", "--vary", f"controller.gains.l1={values}")
    assert outcome.code == 2
    assert outcome.err.count("\n") == 100
    assert max(map(len, outcome.err.splitlines())) < 500
