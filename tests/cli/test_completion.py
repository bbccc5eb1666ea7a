"""Completion: what there is for each place, and what a real bash makes of it."""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hilc_cli.cli.completion import join_split_words
from hilc_cli.results.metrics import METRICS
from tests.conftest import Hilc

BIN = Path(sys.executable).parent
Complete = Callable[[str], list[str]]


@pytest.fixture
def complete(hilc: Hilc, monkeypatch: pytest.MonkeyPatch) -> Complete:
    """Completes words that stand in lines, as bash gives them, at the last one."""

    def complete(words: str) -> list[str]:
        parts = words.split("|")
        monkeypatch.setenv("_HILC_COMPLETE", "complete_bash")
        monkeypatch.setenv("COMP_WORDS", "\n".join(parts))
        monkeypatch.setenv("COMP_CWORD", str(len(parts) - 1))
        outcome = hilc()
        assert (outcome.code, outcome.err) == (0, "")
        return outcome.out.split()

    return complete


@pytest.mark.parametrize(
    ("words", "found"),
    [
        # With a colon and an equals sign in COMP_WORDBREAKS, bash puts them in words of their own.
        ("hilc|run|example|:|fig6", [f"fig6{letter}" for letter in "abcdefghi"]),
        ("hilc|check|example|:|norm", ["norm-optimal-arc-and-line"]),
        ("hilc|run|exam", ["example:feedback-circle"]),
        (
            "hilc|compare|--laws|example|:",
            ["leaderboard", "leaderboard-robots", "small-robot-laws"],
        ),
        ("hilc|run|example:fig7", [f"example:fig7{letter}" for letter in "abcd"]),
        ("hilc|sweep|example|:|fig8a|--set|controller.gains.k_t", ["controller.gains.k_theta="]),
        ("hilc|run|x|--set|robot.turn", ["robot.turn_convention="]),
        ("hilc|run|x|--set|=|model.ha", ["model.half_track="]),
        ("hilc|run|x|--set|controller.fe", ["controller.feedback="]),
        ("hilc|run|x|--set=model.ha", ["model.half_track="]),
        ("hilc|check|x|--set|disturbance.st", ["disturbance.state.standard_deviation="]),
        ("hilc|sweep|x|--vary|initial_pose.h", ["initial_pose.heading="]),
        ("hilc|sweep|x|--vary|h|=|1|--vary|controller.weights.p", ["controller.weights.position="]),
        ("hilc|sweep|x|--vary|record.g", []),
        ("hilc|sweep|x|--minimise|peak", ["peak_max_position_error_m"]),
        ("hilc|sweep|x|--metric|iterations", ["iterations_to_tolerance"]),
        ("hilc|run|x|--require|", list(METRICS)),
        ("hilc|reproduce|fig3|--reading|d", ["derivative"]),
        ("hilc|reproduce|--reading|", ["literal", "derivative", "both"]),
        ("hilc|run|x|--set|controller.gains.l1|=", []),
        ("hilc|plot|runs/b", ["runs/b"]),
        ("hilc|compare|runs/a+h|=|", ["runs/a+h=1", "runs/a+h=2", "runs/b"]),
        ("hilc|compare|runs/a+h|=", ["1", "2"]),
        ("hilc|compare|--table|m", ["markdown"]),
        ("hilc|compare|--rows|gains,rms", ["gains,rms_position_error_m"]),
        ("hilc|plot|--font|cmr", ["cmr10"]),
    ],
)
def test_what_there_is_to_go_on_with(
    complete: Complete, folder: Path, words: str, found: list[str]
) -> None:
    for name in ("a+h=1", "a+h=2", "b", "b;reboot", "b$(reboot)", "b\nreboot"):
        (folder / "runs" / name).mkdir(parents=True)
        (folder / "runs" / name / "iterations.csv").touch()
    (folder / "runs/no-results").mkdir()
    completions = complete(words)
    assert set(found) <= set(completions)
    if not words.endswith(("exam", "st")):  # of which there are more
        assert completions == found


def test_keys_are_those_of_the_schema_and_of_all_laws(complete: Complete) -> None:
    keys = complete("hilc|run|x|--set|")
    assert len(keys) == len(set(keys)) > 50
    assert all(key.endswith("=") for key in keys)
    gains = {"l1", "lateral", "derivative", "kp", "ki", "kd", "k_x", "k_y"}
    assert {f"controller.gains.{name}=" for name in gains} <= set(keys)
    assert {"trajectory=", "sweep=", "name=", "controller.law="} <= set(keys)
    assert "controller=" not in keys


def test_split_words_are_joined_and_what_bash_keeps_is_told() -> None:
    words = "hilc\nsweep\nexample\n:\nx\n--set\na\n=\nb"
    environment = {"COMP_WORDS": words, "COMP_CWORD": "8"}
    assert join_split_words(environment) == "a="
    assert environment == {"COMP_WORDS": "hilc\nsweep\nexample:x\n--set\na=b", "COMP_CWORD": "4"}


def test_a_new_word_does_not_go_on_with_the_one_before() -> None:
    environment = {"COMP_WORDS": "hilc\nrun\nexample\n:\n", "COMP_CWORD": "4"}
    assert join_split_words(environment) == ""
    assert environment["COMP_CWORD"] == "3"


def in_bash(words: list[str], breaks: str) -> list[str]:
    """What a real bash is told, after it has split a command line at some characters."""
    script = f"""
COMP_WORDBREAKS={shlex.quote(breaks)}
eval "$(hilc --show-completion bash)"
complete -p hilc > /dev/null || exit 9
COMP_WORDS=({shlex.join(words)})
COMP_CWORD={len(words) - 1}
_hilc_completion hilc
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
    done = subprocess.run(
        ["bash", "--norc", "-c", script],
        # The shell that runs is not asked for its name.
        env={"PATH": f"{BIN}:/usr/bin:/bin", "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("words", "breaks", "found"),
    [
        (["hilc", "run", "example", ":", "fig3-ci"], " \t\n\"'><=;|&(:", ["fig3-circle"]),
        (["hilc", "run", "example:fig3-ci"], " \t\n\"'><;|&(", ["example:fig3-circle"]),
    ],
)
def test_bash_gets_what_it_can_put_behind_the_cursor(
    words: list[str], breaks: str, found: list[str]
) -> None:
    assert in_bash(words, breaks) == found
