"""Wrong command lines: each with the exact message that a person reads, and its exit code."""
# ruff: noqa: E501

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.inputs import listing, put_odd_things
from tests.conftest import Hilc, Outcome, Write

LONG = "n" * 300

OVERRIDES = [
    ("set-no-eq", "iterations", "must read KEY=VALUE, such as controller.gains.l1=0.5"),
    ("set-empty-key", "=3", "must read KEY=VALUE, such as controller.gains.l1=0.5"),
    ("set-dots", "a..b=3", "must read KEY=VALUE, such as controller.gains.l1=0.5"),
    (
        "set-through",
        "iterations.x=3",
        "iterations.x: cannot be set, since iterations is a single value; set that instead",
    ),
    (
        "set-index",
        "trajectory.segments.7.line.length=3",
        "trajectory.segments.7: is no entry of the list; give a number from 0 to 0",
    ),
    (
        "set-index-word",
        "trajectory.segments.first=3",
        "trajectory.segments.first: is no entry of the list; give a number from 0 to 0",
    ),
    (
        "set-index-neg",
        "trajectory.segments.-1.line.length=3",
        "trajectory.segments.-1: is no entry of the list; give a number from 0 to 0",
    ),
    ("set-unknown", "iteration=3", "iteration: is an unknown key; did you mean 'iterations'?"),
    (
        "set-unknown-nested",
        "controller.gain.l1=3",
        "controller.gain: is an unknown key of law hybrid; did you mean 'controller.gains.l1'?",
    ),
    (
        "set-yaml",
        "iterations=[1",
        "iterations: is not valid YAML: did not find expected ',' or ']'; check quotes, colons, brackets and indentation",
    ),
    (
        "set-yaml2",
        "iterations=a: b: c",
        "iterations: is not valid YAML: mapping values are not allowed in this context; check quotes, colons, brackets and indentation",
    ),
    (
        "set-value",
        "controller.gains.l1=-1",
        "controller.gains.l1: must be at least 0, got -1; give a number from 0 up, such as 0.5",
    ),
    (
        "set-list",
        "robot.gravity_center=[1,a]",
        "robot.gravity_center.1: has the unknown name 'a', got 'a'; give a number, such as 1.5 or 20 cm",
    ),
    (
        "set-tag",
        "name=!!python/object:os.system ls",
        "name: has the tag tag:yaml.org,2002:python/object:os.system; leave tags out",
    ),
    ("set-dup", "robot={a: 1, a: 2}", "robot: is given twice, first in line 1; keep one of them"),
    (
        "set-traj-missing",
        "trajectory=nosuch.yaml",
        "trajectory: nosuch.yaml: there is no such file; check the path",
    ),
    (
        "set-h",
        "controller.h=7",
        "controller.h: must be at most the trajectory's 3 samples, got 7; give a whole number from 1 to 3",
    ),
    (
        "trajectory-by-name",
        "trajectory=cardioid",
        "trajectory: cardioid: there is no such file; did you mean 'example:cardioid'?",
    ),
]
REQUIREMENTS = [
    (
        "req-form",
        "max_position_error_m",
        "must read METRIC:le:VALUE, such as max_position_error_m:le:0.01, or in quotes 'METRIC<=VALUE'; le, lt, ge, gt stand for <=, <, >=, >",
    ),
    (
        "req-eq",
        "max_position_error_m==0",
        "must read METRIC:le:VALUE, such as max_position_error_m:le:0.01, or in quotes 'METRIC<=VALUE'; le, lt, ge, gt stand for <=, <, >=, >",
    ),
    (
        "req-metric",
        "max_position_error<=0.1",
        "'max_position_error' is no metric; did you mean 'max_position_error_m'?",
    ),
    (
        "req-metric-far",
        "qqq<=0.1",
        "'qqq' is no metric; known: final_position_error_m, input_change_rms_rad_s, max_abs_error_heading_rad, max_abs_error_x_m, max_abs_error_y_m, max_position_error_m, max_position_error_second_half_m, max_wheel_speed_rad_s, mean_position_error_m, mean_position_error_second_half_m, rms_position_error_m, saturated_samples",
    ),
    (
        "req-number",
        "max_position_error_m<=small",
        "the bound has the unknown name 'small'; give a number such as 0.01",
    ),
    (
        "req-nan",
        "max_position_error_m<=1e999",
        "the bound must be finite; give a number such as 0.01",
    ),
    (
        "req-empty",
        "max_position_error_m<=",
        "must read METRIC:le:VALUE, such as max_position_error_m:le:0.01, or in quotes 'METRIC<=VALUE'; le, lt, ge, gt stand for <=, <, >=, >",
    ),
    (
        "req-unit",
        "max_position_error_m<=3 s",
        "the bound has the wrong unit; give a number such as 0.01",
    ),
    (
        "req-reversed",
        "0.1>=max_position_error_m",
        "must read METRIC:le:VALUE, such as max_position_error_m:le:0.01, or in quotes 'METRIC<=VALUE'; le, lt, ge, gt stand for <=, <, >=, >",
    ),
]
USAGE: list[tuple[str, list[str], str]] = [
    *(
        (name, ["run", "scenario.yaml", "--set", text], f"--set {text}: {told}")
        for name, text, told in OVERRIDES
    ),
    *(
        (name, ["run", "scenario.yaml", "--require", text], f"hilc: --require {text}: {told}")
        for name, text, told in REQUIREMENTS
    ),
    (
        "set-two",
        ["run", "scenario.yaml", "--set", "iterations=-1", "--set", "controller.h=0"],
        (
            "--set controller.h=0: controller.h: must be at least 1, got 0; give a whole number from 1 up, such as 200\n"
            "--set iterations=-1: iterations: must be at least 0, got -1; give a whole number from 0 up, such as 100"
        ),
    ),
    (
        "set-two-noeq",
        ["run", "scenario.yaml", "--set", "iterations", "--set", "h"],
        (
            "--set iterations: must read KEY=VALUE, such as controller.gains.l1=0.5\n"
            "--set h: must read KEY=VALUE, such as controller.gains.l1=0.5"
        ),
    ),
    (
        "set-traj-inline",
        ["run", "scenario.yaml", "--set", "trajectory.sample_time=0.2"],
        "path.yaml:5:33: trajectory.segments.0.line.duration: takes 0.3 s, which is 1.5 samples of 0.2 s, got '0.3 s'; give a whole number of samples, such as 0.2 s",
    ),
    (
        "unknown-option",
        ["run", "scenario.yaml", "--foo"],
        "hilc: no such option: --foo; see 'hilc run --help'",
    ),
    (
        "near-option",
        ["run", "scenario.yaml", "--no-plot"],
        "hilc: no such option: --no-plot; did you mean: --no-plots",
    ),
    (
        "option-that-is-near-a-key-with-keys",
        ["run", "scenario.yaml", "--output", "x"],
        "hilc: no such option: --output; did you mean: --out",
    ),
    (
        "key-as-option",
        ["run", "scenario.yaml", "--iterations", "70"],
        "hilc: no such option: --iterations; did you mean: --set iterations=70",
    ),
    (
        "key-as-option-with-its-value",
        ["sweep", "scenario.yaml", "--L2=a b"],
        "hilc: no such option: --L2; did you mean: --set 'controller.gains.l2=a b'",
    ),
    (
        "dotted-key-as-option",
        ["check", "scenario.yaml", "--state.bound"],
        "hilc: no such option: --state.bound; did you mean: --set disturbance.state.bound=...",
    ),
    (
        "ambiguous-key-as-option",
        ["check", "scenario.yaml", "--half-track", "0.3", "--json"],
        "hilc: no such option: --half-track; did you mean: --set robot.half_track=0.3 or --set model.half_track=0.3",
    ),
    (
        "key-as-option-of-a-command-without-set",
        ["schema", "scenario", "--iterations", "3"],
        "hilc: no such option: --iterations; see 'hilc schema --help'",
    ),
    (
        "gain-that-is-not-there-as-option",
        ["run", "scenario.yaml", "--l9", "0.3"],
        "hilc: no such option: --l9; see 'hilc run --help'",
    ),
    (
        "name-of-an-example",
        ["run", "fig5-spiral"],
        "hilc: fig5-spiral: there is no such file; did you mean 'example:fig5-spiral'?",
    ),
    (
        "path-of-an-example",
        ["check", "scenarios/Gain-Map.yaml"],
        "hilc: scenarios/Gain-Map.yaml: there is no such file; did you mean 'example:gain-map'?",
    ),
    (
        "no-example-of-this-name",
        ["run", "fig5b"],
        "hilc: fig5b: there is no such file; check the path",
    ),
    (
        "no-example-of-this-number",
        ["run", "example:fig5b"],
        "hilc: example:fig5b: there is no such example; known: fig5-arc-and-line, fig5-cardioid, fig5-spiral",
    ),
    (
        "several-examples-fit-as-well",
        ["run", "example:fig7x"],
        "hilc: example:fig7x: there is no such example; known: fig7a, fig7b, fig7c, fig7d",
    ),
    (
        "no-figure-of-this-number",
        ["reproduce", "fig1"],
        "hilc: fig1: is no figure of the paper's results; known: fig3, fig4, fig5, fig6, fig7, fig8",
    ),
    (
        "no-such-reading",
        ["reproduce", "fig3", "--reading", "derived"],
        "hilc: invalid value for '--reading': 'derived' is not one of 'literal', 'derivative', 'both'; see 'hilc reproduce --help'",
    ),
    (
        "unknown-command",
        ["rum", "scenario.yaml"],
        "hilc: no such command 'rum'. Did you mean 'run'?; see 'hilc --help'",
    ),
    (
        "unknown-command-far",
        ["qqq", "scenario.yaml"],
        "hilc: no such command 'qqq'; see 'hilc --help'",
    ),
    (
        "format",
        ["run", "scenario.yaml", "--format", "jpg"],
        "hilc: invalid value for '--format': 'jpg' is not one of 'png', 'svg', 'pdf'; see 'hilc run --help'",
    ),
    ("missing", ["run"], "hilc: missing argument 'SCENARIO'; see 'hilc run --help'"),
    (
        "extra",
        ["run", "scenario.yaml", "b.yaml"],
        "hilc: got unexpected extra argument(s) (b.yaml); see 'hilc run --help'",
    ),
    (
        "option-value",
        ["run", "scenario.yaml", "--out"],
        "hilc: option '--out' requires an argument; see 'hilc run --help'",
    ),
    (
        "plot-nothing",
        ["plot"],
        "hilc: there are no results in runs to draw; name the folder of a run",
    ),
    (
        "plot-kind",
        ["plot", ".", "--kind", "err"],
        "hilc: invalid value for '--kind': 'err' is not one of 'path-change', 'final-path', 'error-along-path', 'error', 'wheel-speeds', 'summary', 'learning', 'animation', 'curve', 'map', 'effects', 'best', 'spread', 'bands', 'search'; see 'hilc plot --help'",
    ),
    (
        "plot-nofolder",
        ["plot", "nosuch"],
        "hilc: nosuch: holds neither a run nor a sweep nor a leaderboard; give a folder that hilc has written",
    ),
    (
        "plot-nonrun",
        ["plot", "."],
        "hilc: .: holds neither a run nor a sweep nor a leaderboard; give a folder that hilc has written",
    ),
    (
        "plot-file",
        ["plot", "scenario.yaml"],
        "hilc: scenario.yaml: holds neither a run nor a sweep nor a leaderboard; give a folder that hilc has written",
    ),
    (
        "plot-iter",
        ["plot", ".", "--iterations", "a"],
        "hilc: --iterations a: must be whole numbers such as 0,1,5..10,100",
    ),
    (
        "plot-iter-neg",
        ["plot", ".", "--iterations", "-1"],
        "hilc: --iterations -1: must be whole numbers such as 0,1,5..10,100",
    ),
    (
        "plot-iter-back",
        ["plot", ".", "--iterations", "5..1"],
        "hilc: --iterations 5..1: '5..1' is no range from low to high",
    ),
    (
        "plot-iter-backwards",
        ["plot", ".", "--iterations", "9..5"],
        "hilc: --iterations 9..5: '9..5' is no range from low to high",
    ),
    (
        "plot-iter-empty",
        ["plot", ".", "--iterations", ""],
        "hilc: --iterations : must be whole numbers such as 0,1,5..10,100",
    ),
    (
        "schema",
        ["schema", "foo"],
        "hilc: invalid value for 'kind': 'foo' is not one of 'trajectory', 'scenario', 'leaderboard'; see 'hilc schema --help'",
    ),
    (
        "schema-missing",
        ["schema"],
        "hilc: missing argument 'kind'. Choose from: trajectory, scenario, leaderboard; see 'hilc schema --help'",
    ),
    (
        "examples-extra",
        ["examples", "foo"],
        "hilc: got unexpected extra argument(s) (foo); see 'hilc examples --help'",
    ),
    (
        "file-missing",
        ["run", "nosuch.yaml"],
        "hilc: nosuch.yaml: there is no such file; check the path",
    ),
    ("file-folder", ["run", "."], "hilc: .: is a folder; give the scenario in it, scenario.yaml"),
    ("file-other-folder", ["run", "/"], "hilc: /: is a folder; give a regular file"),
    ("file-fifo", ["run", "fifo"], "hilc: fifo: is a named pipe; give a regular file"),
    ("file-dev", ["run", "/dev/zero"], "hilc: /dev/zero: is a device; give a regular file"),
    (
        "file-loop",
        ["run", "loop"],
        "hilc: loop: cannot be read: too many levels of symbolic links",
    ),
    (
        "file-below-file",
        ["run", "scenario.yaml/x"],
        "hilc: scenario.yaml/x: there is no such file; check the path",
    ),
    (
        "file-empty-name",
        ["run", ""],
        "hilc: .: is a folder; give the scenario in it, scenario.yaml",
    ),
    ("file-long-name", ["run", LONG], f"hilc: {LONG}: cannot be read: file name too long"),
    (
        "file-big",
        ["run", "big.yaml"],
        "hilc: big.yaml: is larger than 1000000 bytes, the most that is read; shorten it",
    ),
    (
        "file-dangling",
        ["run", "dangling"],
        "hilc: dangling: there is no such file; check the path",
    ),
    (
        "example-unknown",
        ["run", "example:fig3-circel"],
        "hilc: example:fig3-circel: there is no such example; did you mean 'fig3-circle'?",
    ),
    (
        "example-far",
        ["run", "example:qqq"],
        "hilc: example:qqq: there is no such example; known: corridor, feedback-circle, fig3-arc-and-line, fig3-cardioid, fig3-circle, fig3-spiral, fig4-compensated, fig4-uncompensated, fig5-arc-and-line, fig5-cardioid, fig5-spiral, fig6a, fig6b, fig6c, fig6d, fig6e, fig6f, fig6g, fig6h, fig6i, fig7a, fig7b, fig7c, fig7d, fig8a, fig8b, fig8c, figure-eight, gain-map, gain-map-no-limit, lateral-circle, mujoco-circle, norm-optimal-arc-and-line, parking, pd-arc-and-line, pid-figure-eight, real-robot, rounded-square, slalom, small-robot, timed-lap, turn-in-place",
    ),
    (
        "example-none",
        ["run", "example:"],
        "hilc: example:: there is no such example; known: corridor, feedback-circle, fig3-arc-and-line, fig3-cardioid, fig3-circle, fig3-spiral, fig4-compensated, fig4-uncompensated, fig5-arc-and-line, fig5-cardioid, fig5-spiral, fig6a, fig6b, fig6c, fig6d, fig6e, fig6f, fig6g, fig6h, fig6i, fig7a, fig7b, fig7c, fig7d, fig8a, fig8b, fig8c, figure-eight, gain-map, gain-map-no-limit, lateral-circle, mujoco-circle, norm-optimal-arc-and-line, parking, pd-arc-and-line, pid-figure-eight, real-robot, rounded-square, slalom, small-robot, timed-lap, turn-in-place",
    ),
    (
        "out-yaml",
        ["run", "scenario.yaml", "--out", "path.yaml"],
        "hilc: --out path.yaml: is the name of a file; give the name of a folder, such as path",
    ),
    (
        "out-picture",
        ["plot", "full", "--out", "a/error.SVG"],
        "hilc: --out a/error.SVG: is the name of a file; give the name of a folder, such as error, and --format svg where pictures are drawn",
    ),
    (
        "out-check",
        ["check", "scenario.yaml", "--plot", "--out", "t.png"],
        "hilc: --out t.png: is the name of a file; give the name of a folder, such as t, and --format png where pictures are drawn",
    ),
    (
        "out-compare",
        ["compare", "a", "b", "--out", "table.tex"],
        "hilc: --out table.tex: is the name of a file; give the name of a folder, such as table",
    ),
    (
        "out-sweep",
        ["sweep", "scenario.yaml", "--vary", "iterations=1,2", "--out=cases.csv"],
        "hilc: --out cases.csv: is the name of a file; give the name of a folder, such as cases",
    ),
    (
        "out-reproduce",
        ["reproduce", "fig3", "--out", "paper.html"],
        "hilc: --out paper.html: is the name of a file; give the name of a folder, such as paper",
    ),
    (
        "copy-file",
        ["examples", "--copy", "all.zip"],
        "hilc: --copy all.zip: is the name of a file; give the name of a folder, such as all",
    ),
    *(
        (
            f"{command[0]}-of-{name[:4]}",
            [*command, name],
            f"hilc: {name}: cannot be read: {why}",
        )
        for name, why in (
            ("loop", "too many levels of symbolic links"),
            (LONG, "file name too long"),
        )
        for command in (["plot"], ["compare", "full"], ["compare", "--laws"], ["sweep", "--merge"])
    ),
    (
        "json-twice",
        ["run", "scenario.yaml", "--json=yes"],
        "hilc: option '--json' does not take a value; see 'hilc run --help'",
    ),
    ("nothing-force", ["--force"], "hilc: no such option: --force; see 'hilc --help'"),
]
"""Exit code 2."""
REFUSED: list[tuple[str, list[str], str]] = [
    (
        "out-file",
        ["run", "scenario.yaml", "--out", "fifo"],
        "hilc: fifo: is no folder; choose another with --out",
    ),
    (
        "out-nonrun",
        ["run", "scenario.yaml", "--out", "full"],
        "hilc: full: exists and is no run folder, so it is left as it is; choose another with --out",
    ),
    (
        "out-nonrun-force",
        ["run", "scenario.yaml", "--out", "full", "--force"],
        "hilc: full: exists and is no run folder, so it is left as it is; choose another with --out",
    ),
    (
        "out-dot",
        ["run", "scenario.yaml", "--out", "."],
        "hilc: .: is the folder you are in; name another with --out",
    ),
    (
        "out-below-file",
        ["run", "scenario.yaml", "--out", "path.yaml/x"],
        "hilc: path.yaml/x: cannot be written: nothing is made below path.yaml, which is no folder",
    ),
    *(
        (
            f"{command[0]}-below-{link}",
            [*command, "--out", f"{link}/x"],
            f"hilc: {link}/x: cannot be written: nothing is made below {link}, a link to nothing",
        )
        for link in ("dangling", "loop")
        for command in (
            ["run", "scenario.yaml"],
            ["check", "scenario.yaml", "--plot"],
            ["sweep", "scenario.yaml", "--vary", "iterations=1,2"],
            ["reproduce"],
            ["compare", "full", "full/"],
        )
    ),
    (
        "sweep-out-long",
        ["sweep", "scenario.yaml", "--vary", "iterations=1,2", "--out", "n" * 252],
        f"hilc: {'n' * 252}: cannot be written: file name too long",
    ),
    (
        "out-dangling",
        ["run", "scenario.yaml", "--out", "dangling"],
        "hilc: dangling: is no folder; choose another with --out",
    ),
    (
        "out-empty",
        ["run", "scenario.yaml", "--out", ""],
        "hilc: .: is the folder you are in; name another with --out",
    ),
    (
        "out-long",
        ["run", "scenario.yaml", "--out", LONG],
        f"hilc: {LONG}: cannot be written: file name too long",
    ),
]
"""Exit code 1."""


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        pytest.param(arguments, code, text, id=name)
        for code, cases in ((2, USAGE), (1, REFUSED))
        for name, arguments, text in cases
    ],
)
def test_wrong_command_line_is_explained(
    hilc: Hilc, write: Write, folder: Path, arguments: list[str], code: int, message: str
) -> None:
    write({"big.yaml": "a" * 1_000_001})
    put_odd_things(folder)
    before = listing(folder)
    assert hilc(*arguments) == Outcome(code, "", f"{message}\n")
    assert listing(folder) == before


@pytest.mark.parametrize("value", ["1", "5000", "a"])
def test_resolution_out_of_range_is_explained(hilc: Hilc, folder: Path, value: str) -> None:
    outcome = hilc("plot", ".", "--dpi", value)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert outcome.err.startswith("hilc: invalid value for '--dpi': ")
    assert outcome.err.endswith("; see 'hilc plot --help'\n")


def test_message_about_a_long_override_stays_readable(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc("run", "scenario.yaml", "--set", f"iterations={'9' * 5000}")
    assert outcome.code == 2
    assert "iterations: has 5000 digits, got '" in outcome.err
    assert len(outcome.err) < 400


def test_message_about_an_override_of_several_lines_is_one_line(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc("run", "scenario.yaml", "--set", "iterations=a\n\x1b[31mb")
    assert (outcome.code, outcome.err.count("\n")) == (2, 1)
    assert outcome.err.removesuffix("\n").isprintable()


@pytest.mark.parametrize("text", ["max_position_error_m<=5 cm", "max_position_error_m <= 5e-2"])
def test_bound_of_a_requirement_may_have_the_unit_of_its_metric(
    hilc: Hilc, write: Write, text: str
) -> None:
    write()
    outcome = hilc("run", "scenario.yaml", "--no-plots", "-q", "--require", text)
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err.startswith(f"hilc: not met: {text}, got ")
