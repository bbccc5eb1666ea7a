"""Pipes, closed streams, terminals: what goes where, and when it is decorated."""

from __future__ import annotations

import errno
import json
import os
import pty
import shlex
import signal
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import pytest

from tests.cli.inputs import SCENARIO, TRAJECTORY
from tests.cli.processes import HILC, TIMEOUT, environment, run_hilc, uncovered
from tests.conftest import Outcome

RUN = ("run", "scenario.yaml", "--no-plots")
WARNING = (
    "hilc: warning: controller.gains.l2 and l3 are not used: with an initial error the law is "
    "Eq. 21, which has l1 only; set 'compensation: off' for Eq. 17\n"
)


@pytest.fixture
def inputs(tmp_path: Path) -> Path:
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    return tmp_path


def in_shell(command: str, cwd: Path, changes: Mapping[str, str] | None = None) -> Outcome:
    """Runs a shell command in which ``hilc`` is this program."""
    script = f'hilc() {{ {shlex.join(HILC)} "$@"; }}\n{command}'
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=cwd,
        capture_output=True,
        env=environment(changes),
        timeout=TIMEOUT,
        check=False,
    )
    return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())


def test_summary_goes_to_stdout_alone(inputs: Path) -> None:
    outcome = run_hilc(*RUN, cwd=inputs)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("test: path (1 m), after 2 iterations")
    assert outcome.out.endswith("\nWritten to runs/test\n")
    assert "Position error, maximum" in outcome.out


def test_quiet_prints_nothing(inputs: Path) -> None:
    changes = ("--set", "initial_pose.y=1", "--set", "controller.gains.l2=1")
    assert run_hilc(*RUN, "-q", *changes, cwd=inputs) == Outcome(0, "", "")


def test_warnings_go_to_stderr_and_are_part_of_the_summary(inputs: Path) -> None:
    changes = ("--set", "initial_pose.y=1", "--set", "controller.gains.l2=1")
    outcome = run_hilc(*RUN, *changes, cwd=inputs)
    assert (outcome.code, outcome.err) == (0, WARNING)
    assert outcome.out.splitlines().count(WARNING.removeprefix("hilc: ").rstrip()) == 1
    folder = "runs/test+y=1+l2=1"
    assert outcome.out.endswith(f"\nWritten to {folder}\n")
    manifest = json.loads((inputs / folder / "manifest.json").read_text())
    assert [f"hilc: warning: {text}\n" for text in manifest["warnings"]] == [WARNING]


def test_json_is_one_document_and_nothing_else(inputs: Path) -> None:
    outcome = run_hilc(*RUN, "--json", cwd=inputs)
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out)
    assert document["folder"] == "runs/test"
    assert document["name"] == "test"
    assert document["iterations"] == 2
    assert document["diverged_at"] is None
    assert document["warnings"] == []
    assert document["final"]["saturated_samples"] == 0


def test_json_of_a_failure_leaves_stdout_empty(inputs: Path) -> None:
    outcome = run_hilc("run", "nosuch.yaml", "--json", cwd=inputs)
    assert outcome == Outcome(2, "", "hilc: nosuch.yaml: there is no such file; check the path\n")


def test_scenario_from_standard_input(inputs: Path) -> None:
    outcome = run_hilc("run", "-", "--no-plots", "-q", cwd=inputs, stdin=SCENARIO.encode())
    assert outcome == Outcome(0, "", "")
    assert (inputs / "runs/test/iterations.csv").exists()


def test_problem_in_standard_input_has_a_position(inputs: Path) -> None:
    wrong = SCENARIO.replace("iterations: 2", "iterations: -2").encode()
    assert run_hilc("run", "-", cwd=inputs, stdin=wrong) == Outcome(
        2,
        "",
        "<stdin>:4:13: iterations: must be at least 0, got -2; "
        "give a whole number from 0 up, such as 100\n",
    )


def test_empty_standard_input_is_told(inputs: Path) -> None:
    message = "<stdin>:1:1: is empty; write a mapping of keys and values\n"
    assert run_hilc("run", "-", cwd=inputs) == Outcome(2, "", message)


def test_endless_standard_input_is_told(inputs: Path) -> None:
    assert in_shell("hilc run - < /dev/zero", inputs) == Outcome(
        2, "", "hilc: <stdin>: is larger than 1000000 bytes, the most that is read\n"
    )


# Much at once, help, and what a command prints in several steps.
PIPES = ["schema scenario", "--help", "run scenario.yaml --no-plots"]


@pytest.mark.parametrize("command", [*PIPES, "examples", "run --help"])
def test_reader_that_has_seen_enough_is_no_failure(inputs: Path, command: str) -> None:
    outcome = in_shell(f"hilc {command} | head -1 > /dev/null; exit ${{PIPESTATUS[0]}}", inputs)
    assert outcome == Outcome(0, "", "")


@pytest.mark.parametrize("command", PIPES)
def test_reader_that_is_gone_at_once_is_no_failure(inputs: Path, command: str) -> None:
    # The pipe is closed before anything is written to it.
    program = [*HILC, *shlex.split(command)]
    reading, writing = os.pipe()
    process = subprocess.Popen(
        program, cwd=inputs, stdout=writing, stderr=subprocess.PIPE, env=environment()
    )
    os.close(reading)
    os.close(writing)
    _, err = process.communicate(timeout=TIMEOUT)
    assert (process.returncode, err) == (0, b"")


@pytest.mark.parametrize("command", [*PIPES, "--version"])
def test_closed_stdout_is_no_failure(inputs: Path, command: str) -> None:
    assert in_shell(f"hilc {command} >&-", inputs) == Outcome(0, "", "")


def test_closed_stderr_is_no_failure(inputs: Path) -> None:
    outcome = in_shell(f"hilc {shlex.join(RUN)} -q 2>&-", inputs)
    assert outcome.code == 0
    assert (inputs / "runs/test/iterations.csv").exists()


def test_failure_with_closed_stderr_keeps_its_exit_code(inputs: Path) -> None:
    assert in_shell("hilc run nosuch.yaml 2>&-", inputs) == Outcome(2, "", "")


def test_closed_stdin_is_told(inputs: Path) -> None:
    outcome = in_shell("hilc run - <&-", inputs)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) in [(1, "", 1), (2, "", 1)]
    assert outcome.err.startswith("<stdin>") or "hilc: <stdin>: " in outcome.err


@pytest.mark.parametrize("encoding", ["utf-8:strict", "ascii:strict"])
def test_folder_name_that_stdout_cannot_spell_is_no_failure(inputs: Path, encoding: str) -> None:
    name = os.fsdecode(b"caf\xc3\xa9-\xff")
    outcome = in_shell(
        f"hilc {shlex.join(RUN)} --out $'caf\\xc3\\xa9-\\xff'",
        inputs,
        {"PYTHONIOENCODING": encoding},
    )
    assert (outcome.code, outcome.err) == (0, "")
    assert (inputs / name / "iterations.csv").exists()


def test_no_escape_codes_in_pipes(inputs: Path) -> None:
    for arguments in (RUN, ("run", "--help"), ("run", "nosuch")):
        outcome = run_hilc(*arguments, cwd=inputs, changes={"FORCE_COLOR": "", "COLUMNS": "60"})
        assert "\x1b" not in outcome.out + outcome.err


def on_terminal(
    *arguments: str, cwd: Path, changes: Mapping[str, str] | None = None, both: bool = False
) -> tuple[int, str, str]:
    """Runs with stderr, or stdout as well, on a pseudo-terminal.

    Returns:
        Exit code, what the terminal got, and what the pipe at stdout got.
    """
    terminal, program_end = pty.openpty()
    process = subprocess.Popen(
        [*HILC, *arguments],
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        stdout=program_end if both else subprocess.PIPE,
        stderr=program_end,
        env=environment(changes),
    )
    os.close(program_end)
    shown = b""
    try:
        while True:
            try:
                piece = os.read(terminal, 65536)
            except OSError as error:
                if error.errno != errno.EIO:  # how Linux says that the program has closed it
                    raise
                break
            if not piece:
                break
            shown += piece
        out, _ = process.communicate(timeout=TIMEOUT)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        os.close(terminal)
    return process.returncode, shown.decode(), (out or b"").decode()


def test_progress_bar_is_on_the_terminal_s_stderr(inputs: Path) -> None:
    code, shown, out = on_terminal(*RUN, "--set", "iterations=500", cwd=inputs)
    assert code == 0
    assert "\x1b[" in shown
    assert "test" in shown and "/501" in shown
    assert "\x1b" not in out
    assert out.startswith("test: path (1 m), after 500 iterations")


def test_progress_bar_leaves_the_cursor_visible(inputs: Path) -> None:
    _, shown, _ = on_terminal(*RUN, cwd=inputs)
    assert shown.rfind("\x1b[?25h") > shown.rfind("\x1b[?25l")


@pytest.mark.parametrize("changes", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_no_color_means_no_escape_codes_and_no_bar(
    inputs: Path, changes: Mapping[str, str]
) -> None:
    code, shown, _ = on_terminal(*RUN, cwd=inputs, changes=changes, both=True)
    assert code == 0
    assert "\x1b" not in shown
    assert "/3" not in shown
    assert "Written to runs/test" in shown


def test_quiet_shows_no_bar(inputs: Path) -> None:
    assert on_terminal(*RUN, "-q", cwd=inputs, both=True) == (0, "", "")


def test_failure_on_a_terminal_is_one_line(inputs: Path) -> None:
    code, shown, _ = on_terminal("run", "nosuch.yaml", cwd=inputs, both=True)
    assert (code, shown) == (2, "hilc: nosuch.yaml: there is no such file; check the path\r\n")


def test_module_and_program_are_the_same(inputs: Path) -> None:
    program = Path(sys.executable).parent / "hilc"
    if not program.exists():
        pytest.skip("hilc is not installed beside this Python")
    found = subprocess.run([str(program), "--version"], capture_output=True, check=True)
    assert found.stdout.decode() == run_hilc("--version", cwd=inputs).out


def test_interrupt_on_a_terminal_clears_the_bar(inputs: Path) -> None:
    terminal, program_end = pty.openpty()
    process = subprocess.Popen(
        [*HILC, *RUN, "--set", "iterations=10000000"],
        cwd=inputs,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=program_end,
        env=uncovered(environment()),
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    os.close(program_end)
    try:
        shown = b""
        while b"/10000001" not in shown:  # the bar is there, its start is over
            shown += os.read(terminal, 65536)
        process.send_signal(signal.SIGINT)
        with suppress(OSError):
            while piece := os.read(terminal, 65536):
                shown += piece
        assert process.wait(TIMEOUT) == 130
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        os.close(terminal)
    text = shown.decode()
    assert text.rfind("\x1b[?25h") > text.rfind("\x1b[?25l")
    assert text.endswith("hilc: interrupted; nothing was left half written\r\n")
    assert sorted(path.name for path in inputs.iterdir()) == ["path.yaml", "scenario.yaml"]
