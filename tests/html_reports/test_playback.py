"""What is played is where the robot was, as near as the eye sees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hilc_cli.html_reports import playback as module
from hilc_cli.html_reports.playback import playback
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.run import RunData
from tests.made_up_runs import MakeRun, circle

SEEN = 1 / 1500


def along(line: Mapping[str, Any], what: str, samples: int) -> Floats:
    """A line at every sample, as the page sees it between those that were kept."""
    found: Floats = np.interp(np.arange(samples + 1), line["at"], line[what])
    return found


def fine_circle() -> Reference:
    return circle(samples=2000)


def with_slow_wheels(run: RunData) -> RunData:
    """The run with wheel speeds that are no noise."""
    wave = 75 * np.sin(np.linspace(0, 6, run.reference.samples))
    trials = {i: replace(trial, left=wave, right=-wave) for i, trial in run.trials.items()}
    return replace(run, trials=trials)


def test_paths_errors_and_speeds_are_those_of_the_run(make_run: MakeRun) -> None:
    run = with_slow_wheels(make_run(reference=fine_circle(), factors=(0.2, 0.5, 0.999)))
    document = playback(run).document
    x_min, x_max, y_min, y_max = document["view"]
    side, samples = max(x_max - x_min, y_max - y_min), run.reference.samples
    assert [each["number"] for each in document["iterations"]] == [0, 1, 2]
    for each in document["iterations"]:
        trial, pose = run.trials[each["number"]], each["pose"]
        for what, values in (("x", trial.x), ("y", trial.y)):
            found = along(pose, what, samples) * document["step"]
            assert np.abs(found - values).max() <= 1.1 * SEEN * side
        turned = along(pose, "heading", samples) * document["stepTurn"]
        assert np.abs(turned - trial.heading).max() <= 0.011
        errors = run.position_error(trial.iteration)
        assert np.abs(along(each["error"], "value", samples) - errors).max() <= (
            1.1 * SEEN * errors.max()
        )
        speeds = np.append(trial.left, trial.left[-1])
        found = (
            document["speedZero"] + along(each["speed"], "left", samples) * document["speedStep"]
        )
        assert np.abs(found - speeds).max() <= 1.1 * SEEN * 150


def test_few_points_are_enough_and_it_is_said(make_run: MakeRun) -> None:
    told = playback(with_slow_wheels(make_run(reference=fine_circle())))
    for each in told.document["iterations"]:
        assert len(each["pose"]["at"]) < 200
    assert told.notes == [
        "Lines have as few points as the eye needs: none is off by more than 0.067 % of its panel."
    ]


def test_noise_gets_no_more_points_than_there_are_to_have(
    make_run: MakeRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MOST_OF_A_LINE", 150)
    run = make_run(reference=fine_circle(), factors=(0.2, 0.9))
    trial = run.trials[1]
    noise = np.random.default_rng(1).uniform(-20, 20, len(trial.left))
    run = replace(run, trials={**run.trials, 1: replace(trial, left=trial.left + noise)})
    told = playback(run)
    assert len(told.document["iterations"][1]["speed"]["at"]) == 150
    assert told.notes[0].startswith("Lines have as few points as the eye needs; the most restless")


def test_many_iterations_are_left_out_but_for_the_ends(make_run: MakeRun) -> None:
    run = make_run(factors=np.linspace(0.2, 0.99, 200).tolist())
    told = playback(run)
    numbers = [each["number"] for each in told.document["iterations"]]
    assert (len(numbers), numbers[0], numbers[-1]) == (60, 0, 199)
    assert max(np.diff(numbers)) <= 4
    assert told.notes[0] == "60 of 200 recorded iterations can be played."


def test_chosen_iterations(make_run: MakeRun) -> None:
    told = playback(make_run(), {1, 3})
    assert [each["number"] for each in told.document["iterations"]] == [1, 3]
    assert told.notes[0] == "2 iterations of 4 can be played: those that were chosen."


def test_path_that_flies_away_leaves_finite_numbers_and_is_told(make_run: MakeRun) -> None:
    told = playback(make_run(factors=(0.5, 1e130), diverged_at=2))
    largest = max(abs(x) for x in told.document["iterations"][1]["pose"]["x"])
    assert largest <= 1e5 * 20_000 * 1.01
    assert told.notes[-1].startswith("1 of 2 paths leave the view")


def test_robot_that_stands_still_without_an_error(make_run: MakeRun) -> None:
    still = Reference("still", 0.1, np.zeros(11), np.zeros(11), np.zeros(11))
    run = make_run(reference=still, factors=(1.0,), speed_limit=None)
    document = playback(run).document
    assert document["iterations"][0]["error"] == {"at": [0, 10], "value": [0.0, 0.0]}
    assert document["robot"] is None
    assert document["limit"] is None


def test_outline_of_the_robot(make_run: MakeRun) -> None:
    run = replace(make_run(), robot=Robot(0.2, 0.518))
    assert playback(run).document["robot"] == {"halfTrack": 0.518, "wheelRadius": 0.2}
