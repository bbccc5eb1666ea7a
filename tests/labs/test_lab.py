"""Labs: plans out, logs in, and a folder that changes as a whole or not at all."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.errors import ExistingResultsError, HilcError, UsageError
from hilc_cli.labs.lab import Lab
from hilc_cli.labs.lock import locked
from hilc_cli.logs.log import RefusedTrialError
from hilc_cli.plants.kinematic import Robot, feedforward
from tests.labs.robots import LAW, SAMPLE_TIME, driven, files_of, scenario, write_log

START = (0.2, -0.1, 0.3)


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    return Lab.start(scenario(), tmp_path / "lab")


def add_pass(lab: Lab, **how: object) -> None:
    times, poses = driven(lab.plan, **how)  # type: ignore[arg-type]
    lab.add(poses, times)


def test_the_first_plan_is_that_of_the_reference(lab: Lab) -> None:
    reference = lab.scenario.spec.reference
    left, right = feedforward(reference, Robot(0.033, 0.08, "rep103"))
    np.testing.assert_allclose(lab.plan.left, left, atol=1e-12)
    np.testing.assert_allclose(lab.plan.right, right, atol=1e-12)
    lines = lab.plan_file.read_text().splitlines()
    assert lines[0] == "sample,t_s,left_wheel_rad_s,right_wheel_rad_s,x_m,y_m,heading_rad"
    assert lines[1].startswith("0,0.0,")
    # The last row tells the wheels to stop, where and when they are to stand.
    n = reference.samples
    assert lines[-1].split(",")[:4] == [str(n), repr(n * SAMPLE_TIME), "0.0", "0.0"]


def test_the_scenario_says_what_the_first_plan_is(tmp_path: Path) -> None:
    zero = Lab.start(scenario(initial_input="zero"), tmp_path / "zero")
    assert not zero.plan.left.any()
    assert "initial_input: zero" in (tmp_path / "zero" / "scenario.yaml").read_text()
    usual = Lab.start(scenario(), tmp_path / "usual")
    assert usual.plan.left.any()
    assert "initial_input: feedforward" in (tmp_path / "usual" / "scenario.yaml").read_text()


def test_no_plan_without_a_limit(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="nothing limits the speed of the wheels"):
        Lab.start(scenario(safety={"wheel_acceleration": 20.0}), tmp_path / "lab")
    assert not (tmp_path / "lab").exists()
    limited = scenario(safety=None, controller={**LAW, "b_w": 6.0})
    Lab.start(limited, tmp_path / "lab")


def test_learning_brings_a_robot_that_is_not_as_believed_to_its_path(lab: Lab) -> None:
    for _ in range(6):
        add_pass(lab)
    errors = lab.run.metrics["max_position_error_m"]
    assert errors[0] > 0.015
    assert errors[-1] < 0.1 * errors[0]


def test_a_start_that_is_off_is_taken_out(tmp_path: Path) -> None:
    on, off = (Lab.start(scenario(), tmp_path / name) for name in ("on", "off"))
    add_pass(on)
    x, y, heading = START
    add_pass(off, start=(x + 0.02, y - 0.01, heading + 0.03))
    report = off.trials[0].report
    assert report.start_pose == pytest.approx((x + 0.02, y - 0.01, heading + 0.03), abs=1e-5)
    assert report.moved_to_start
    for name in ("x", "y", "heading"):
        one, other = (getattr(each.run.trials[0], name) for each in (on, off))
        np.testing.assert_allclose(one, other, atol=2e-5)
    np.testing.assert_allclose(off.plan.left, on.plan.left, atol=2e-3)


def test_a_lab_that_is_read_again_goes_on_alike(lab: Lab, tmp_path: Path) -> None:
    other = Lab.start(scenario(), tmp_path / "other")
    for seed in range(3):
        times, poses = driven(lab.plan, noise=0.001, seed=seed)
        lab.add(poses, times)
        other = Lab(other.folder)
        other.add(poses, times)
    assert files_of(lab.folder) == files_of(other.folder)
    np.testing.assert_array_equal(Lab(lab.folder).plan.left, lab.plan.left)


def test_undo_leaves_what_was_there_before(lab: Lab) -> None:
    add_pass(lab)
    before = files_of(lab.folder)
    times, poses = driven(lab.plan, noise=0.001)
    lab.add(poses, times)
    after = files_of(lab.folder)
    lab.undo()
    assert files_of(lab.folder) == before
    lab.add(poses, times)
    assert files_of(lab.folder) == after
    lab.undo()
    lab.undo()
    with pytest.raises(UsageError, match="has no trial that could be dropped"):
        lab.undo()


def test_a_log_file_is_added_like_its_numbers(lab: Lab, tmp_path: Path) -> None:
    times, poses = driven(lab.plan)
    log = write_log(tmp_path / "log.csv", times, poses)
    seen = lab.add_log(log, dry_run=True)
    assert (len(lab.trials), len(seen.trials)) == (0, 1)
    assert not (lab.folder / "trials" / "000").exists()
    lab.add_log(log, plots=False)
    assert lab.trials[0].report.log == "log.csv"
    kept = hilc.read_run(lab.folder)
    assert kept.metrics["max_position_error_m"][0] == lab.run.metrics["max_position_error_m"][0]
    assert len(lab.run.trials[0].x) == lab.scenario.spec.reference.samples + 1
    # What is kept of the log is a log itself, which gives the same trial.
    again = Lab.start(scenario(), tmp_path / "again")
    again.add_log(lab.folder / "trials" / "000" / "log.csv", plots=False)
    np.testing.assert_allclose(again.plan.left, lab.plan.left, atol=1e-9)


def test_the_same_log_is_no_second_trial(lab: Lab, tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.csv", *driven(lab.plan))
    lab.add_log(log, plots=False)
    with pytest.raises(UsageError, match=r"is trial 0 of .* already"):
        lab.add_log(log, plots=False)


def test_what_is_no_trial_leaves_the_lab_as_it_is(lab: Lab) -> None:
    add_pass(lab)
    before = files_of(lab.folder)
    times, poses = driven(lab.plan)
    still = np.tile(START, (len(times), 1))
    half = len(times) // 2
    mirrored = START + (poses - START) * np.array([1.0, -5.0, -1.0])
    wrong = {
        "stands still": (still, times),
        "is cut off": (poses[:half], times[:half]),
        "starts at": (poses + np.array([1.0, 0.0, 0.0]), times),
        "starts with a heading": (poses + np.array([0.0, 0.0, 1.0]), times),
        "drives another path": (mirrored, times),
    }
    for reason, (seen, when) in wrong.items():
        with pytest.raises(RefusedTrialError, match=reason):
            lab.add(seen, when)
        assert files_of(lab.folder) == before


def test_changes_from_plan_to_plan_are_limited(tmp_path: Path) -> None:
    limits = {"wheel_speed": 6.67, "max_change": 0.05}
    lab = Lab.start(scenario(safety=limits), tmp_path / "lab")
    first = lab.plan
    add_pass(lab)
    change = np.abs([lab.plan.left - first.left, lab.plan.right - first.right]).max()
    assert change == pytest.approx(0.05)


def test_a_lab_that_has_changed_meanwhile_is_left_alone(lab: Lab) -> None:
    other = Lab(lab.folder)
    add_pass(lab)
    before = files_of(lab.folder)
    with pytest.raises(ExistingResultsError, match="has changed since it was read"):
        add_pass(other, noise=0.001)
    with locked(lab.folder), pytest.raises(ExistingResultsError, match="another hilc is at work"):
        add_pass(lab)
    assert files_of(lab.folder) == before


def test_a_new_lab_replaces_nothing(lab: Lab, tmp_path: Path) -> None:
    with pytest.raises(ExistingResultsError, match="is a lab already"):
        Lab.start(scenario(), lab.folder)
    with pytest.raises(ExistingResultsError, match="is no run folder, so it is left as it is"):
        hilc.run(scenario(iterations=1)).write(lab.folder, force=True)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "note.txt").write_text("mine")
    with pytest.raises(ExistingResultsError, match="is no lab folder, so it is left as it is"):
        Lab.start(scenario(), tmp_path / "mine")


def test_own_files_in_a_lab_stay(lab: Lab) -> None:
    (lab.folder / "note.txt").write_text("tyres at 1.8 bar")
    add_pass(lab)
    assert (lab.folder / "note.txt").read_text() == "tyres at 1.8 bar"


def test_a_lab_is_read_like_a_run(lab: Lab, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="has no trial yet; add the first with 'hilc learn add'"):
        hilc.read_run(lab.folder)
    add_pass(lab)
    add_pass(lab)
    run = hilc.read_run(lab.folder)
    assert len(run.metrics) == 2 and sorted(run.trials) == [0, 1]
    assert run.plan is not None
    np.testing.assert_array_equal(run.plan.left, lab.plan.left)
    drawn = hilc.plot(lab.folder, tmp_path / "pictures", kinds=["error", "final-path"])
    assert [file.name for file in drawn] == ["error.png", "final-path.png"]
    assert repr(lab).startswith("Lab ") and "2 trials" in repr(lab)


DAMAGES = {
    "trials/000/trial.csv": ("trial.csv: is damaged: it is not what report.json says", None),
    "trials/000/plan.csv": ("plan.csv: is damaged: it is not what report.json says", None),
    "trials/000/log.csv": ("log.csv: is damaged: it is not what report.json says", None),
    "trials/000/report.json": ("report.json: is damaged: is no JSON", "{"),
    "manifest.json": ("is no lab folder: it has no manifest.json of hilc lab", "{}"),
    "scenario.yaml": ("scenario.yaml:1:1: name: is missing", "robot: 1"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damage_is_told(lab: Lab, name: str) -> None:
    add_pass(lab)
    message, content = DAMAGES[name]
    file = lab.folder / name
    file.write_text(file.read_text()[:-20] + "\n" if content is None else content)
    with pytest.raises(HilcError, match=re.escape(message)):
        Lab(lab.folder)


def test_trials_that_are_missing_or_more_are_told(lab: Lab) -> None:
    add_pass(lab)
    manifest = lab.folder / "manifest.json"
    data = json.loads(manifest.read_text())
    for trials, message in ((0, "there are more of them"), (2, "there is no such file")):
        manifest.write_text(json.dumps({**data, "trials": trials}))
        with pytest.raises(HilcError, match=message):
            Lab(lab.folder)


def test_a_strangers_lab_imports_nothing(lab: Lab, monkeypatch: pytest.MonkeyPatch) -> None:
    (lab.folder.parent / "stranger.py").write_text("raise SystemExit('imported')")
    monkeypatch.syspath_prepend(str(lab.folder.parent))
    file = lab.folder / "scenario.yaml"
    file.write_text(file.read_text().replace("law: norm-optimal", "law: stranger:Law"))
    with pytest.raises(HilcError, match="--trust"):
        Lab(lab.folder)


def test_arrays_that_do_not_fit_are_told(lab: Lab) -> None:
    times, poses = driven(lab.plan)
    wrong = [
        ({"poses": poses.T, "times": times}, r"poses must have shape \(m, 3\)"),
        ({"poses": poses, "times": times[:-1]}, r"times shape \(m,\)"),
        ({"poses": poses * math.nan, "times": times}, "must be finite"),
        ({"poses": poses, "times": times, "sent": poses[:, :2]}, "belong together"),
        (
            {"poses": poses, "times": times, "sent": poses, "sent_times": times},
            r"shape \(c, 2\)",
        ),
    ]
    for arguments, message in wrong:
        with pytest.raises(UsageError, match=message):
            lab.add(**arguments)  # type: ignore[arg-type]


def test_positions_without_headings_are_enough(lab: Lab) -> None:
    times, poses = driven(lab.plan)
    lab.add(poses[:, :2], times)
    assert lab.run.metrics["max_abs_error_heading_rad"][0] < 0.3
