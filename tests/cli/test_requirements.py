"""``--require``: exit 3 unless the last iteration is good enough."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest

from hilc_cli.results.metrics import METRICS
from tests.conftest import Hilc, Outcome, Write

RUN = ("run", "scenario.yaml", "--no-plots", "-q")
# After two updates of the small scenario; the wheels' limit never acts.
MET = ["saturated_samples<=0", "saturated_samples < 1", "max_wheel_speed_rad_s>=0"]
UNMET = ["saturated_samples>0", "saturated_samples<0", "saturated_samples >= 1"]


@pytest.mark.parametrize("text", MET)
def test_requirement_that_is_met(hilc: Hilc, write: Write, text: str) -> None:
    write()
    assert hilc(*RUN, "--require", text) == Outcome(0, "", "")


@pytest.mark.parametrize("text", UNMET)
def test_requirement_that_is_not_met(hilc: Hilc, write: Write, text: str) -> None:
    write()
    outcome = hilc(*RUN, "--require", text)
    assert outcome == Outcome(3, "", f"hilc: not met: {text}, got 0\n")


@pytest.mark.parametrize(
    ("words", "at_zero", "at_one"),  # of no saturated sample
    [(":le:", 0, 0), (" :lt: ", 3, 0), (":ge:", 0, 3), (":gt:", 3, 3)],
)
def test_relation_in_words(hilc: Hilc, write: Write, words: str, at_zero: int, at_one: int) -> None:
    write()
    codes = [hilc(*RUN, f"--require=saturated_samples{words}{bound}").code for bound in "01"]
    assert codes == [at_zero, at_one]


def test_relation_in_words_takes_units_and_needs_no_quotes(hilc: Hilc, write: Write) -> None:
    write()
    text = "max_position_error_m:lt:5mm"
    assert shlex.quote(text) == text
    outcome = hilc(*RUN, "--require", text)
    assert outcome.code == 3 and outcome.err.startswith(f"hilc: not met: {text}, got ")


@pytest.mark.parametrize("name", METRICS)
def test_every_column_is_a_metric(hilc: Hilc, write: Write, name: str) -> None:
    write()
    assert hilc(*RUN, "--require", f"{name}<=1e9").code == 0


def test_all_unmet_requirements_are_told(hilc: Hilc, write: Write) -> None:
    write()
    texts = ["max_position_error_m<=0", "saturated_samples<=0", "rms_position_error_m<=0"]
    outcome = hilc(*RUN, *(f"--require={text}" for text in texts))
    assert outcome.code == 3
    lines = outcome.err.splitlines()
    assert [line.partition(", got")[0] for line in lines] == [
        f"hilc: not met: {texts[0]}",
        f"hilc: not met: {texts[2]}",
    ]


def test_results_are_written_even_if_not_met(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    hilc(*RUN, "--require", "max_position_error_m<=0")
    assert (folder / "runs/test/iterations.csv").exists()


def test_json_tells_what_is_met(hilc: Hilc, write: Write) -> None:
    write()
    texts = ["max_position_error_m<=0", "saturated_samples<=0"]
    outcome = hilc(*RUN, "--json", *(f"--require={text}" for text in texts))
    assert outcome.code == 3
    assert json.loads(outcome.out)["requirements"] == [
        {"text": texts[0], "met": False},
        {"text": texts[1], "met": True},
    ]


def test_wrong_requirement_is_told_before_the_simulation(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    write()
    assert hilc(*RUN, "--set", "iterations=10000000", "--require", "x<=1").code == 2
    assert not (folder / "runs").exists()
