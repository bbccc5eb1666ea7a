"""What ``hilc sweep`` replaces, what it goes on with, and what it leaves alone."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.sweeps.store import FolderStore, is_resumable
from hilc_cli.variation import Value
from hilc_cli.workers.crews import TRIES
from tests.cli import sweeps
from tests.cli.inputs import listing
from tests.cli.processes import outcome_of
from tests.conftest import Hilc, Outcome, Write
from tests.sweeps.plans import deadly

KEY = "controller.gains.l1"
VARY = f"{KEY}=0.1:0.8:8"
SWEEP = ("sweep", "scenario.yaml", "--vary", VARY, "--no-plots", "-q")
OTHER = ("sweep", "scenario.yaml", "--vary", f"{KEY}=0.1:0.9:9", "--no-plots", "-q")
SEED = (*SWEEP, "--set", "disturbance.seed=1", "--out", "runs/test-sweep")
DONE = Outcome(0, "", "")
UNFINISHED = (
    "hilc: runs/test-sweep.part: holds results of this sweep; "
    "go on with --resume, or start anew with --force\n"
)
OTHER_PART = (
    "hilc: runs/test-sweep.part: holds results of another sweep or version of hilc; "
    "start anew with --force\n"
)


@pytest.fixture
def failing(write: Write) -> Iterator[pytest.MonkeyPatch]:
    """Cases with a gain between 0.25 and 0.45 fail, which are cases 2 and 3, until it is undone."""
    write()
    whole = Plan.experiment

    def experiment(self: Plan, values: Mapping[str, Value]) -> Experiment:
        gain = values[KEY]
        if isinstance(gain, float) and 0.25 < gain < 0.45:
            raise UsageError(f"no such gain: {gain:.1f}")
        return whole(self, values)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Plan, "experiment", experiment)
        yield patch


def leave_unfinished(hilc: Hilc, *arguments: str) -> None:
    """Stops a sweep after its first chunk."""
    with pytest.MonkeyPatch.context() as patch:

        def stop(self: FolderStore) -> None:
            raise UsageError("stopped")

        patch.setattr(FolderStore, "rows", stop)
        assert hilc(*arguments).code == 2
    assert is_resumable(sweeps.PART)


@pytest.mark.parametrize("again", [SWEEP, OTHER, (*OTHER, "--resume")])
def test_sweep_killed_before_it_had_results_is_in_nobodys_way(
    hilc: Hilc, write: Write, again: tuple[str, ...]
) -> None:
    write()
    leave_unfinished(hilc, *SWEEP)
    (sweeps.PART / "journal").write_bytes(b"")
    assert hilc(*again) == DONE
    assert not sweeps.PART.exists()


def test_same_sweep_is_replaced_and_own_files_stay(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc(*SWEEP) == DONE
    (sweeps.FOLDER / "notes.txt").write_text("mine")
    (sweeps.FOLDER / "more").mkdir()
    (sweeps.FOLDER / "more/notes.txt").write_text("mine as well")
    before = (sweeps.FOLDER / "cases.csv").read_bytes()
    (sweeps.FOLDER / "cases.csv").write_text("damaged")
    assert hilc(*SWEEP) == DONE
    assert (sweeps.FOLDER / "cases.csv").read_bytes() == before
    assert (sweeps.FOLDER / "notes.txt").read_text() == "mine"
    assert (sweeps.FOLDER / "more/notes.txt").read_text() == "mine as well"
    assert [path.name for path in Path("runs").iterdir()] == ["test-sweep"]


@pytest.mark.parametrize("other", [OTHER, SEED, (*SWEEP, "--tolerance", "0.1")])
def test_other_sweep_is_replaced_with_force_only(
    hilc: Hilc, write: Write, other: tuple[str, ...]
) -> None:
    write()
    assert hilc(*SWEEP) == DONE
    (sweeps.FOLDER / "notes.txt").write_text("mine")
    before = listing(Path("runs"))
    message = (
        "hilc: runs/test-sweep: holds the results of another sweep; "
        "choose another folder with --out, or replace it with --force\n"
    )
    assert hilc(*other) == Outcome(1, "", message)
    assert listing(Path("runs")) == before
    assert hilc(*other, "--force") == DONE
    assert listing(Path("runs")) != before
    assert (sweeps.FOLDER / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("extra", [(), ("--force",), ("--resume",)])
def test_foreign_folders_are_left_alone(
    hilc: Hilc, write: Write, folder: Path, extra: tuple[str, ...]
) -> None:
    write()
    for place in (sweeps.FOLDER, sweeps.PART):
        place.mkdir(parents=True)
        (place / "scenario.yaml").write_text("somebody's own")
        before = listing(folder)
        outcome = hilc(*SWEEP, *extra)
        assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
        assert "so it is left as it is; choose another" in outcome.err
        assert listing(folder) == before
        (place / "scenario.yaml").unlink()
        place.rmdir()


def test_shard_into_a_foreign_folder(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    (folder / "own.1-of-2").mkdir()
    (folder / "own.1-of-2/scenario.yaml").write_text("somebody's own")
    outcome = hilc(*SWEEP, "--shard", "1/2", "--out", "own", "--force")
    assert (outcome.code, outcome.err.count("\n")) == (1, 1)
    assert listing(folder / "own.1-of-2") == {"scenario.yaml": b"somebody's own"}


def test_nothing_to_resume(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc(*SWEEP) == DONE
    before = listing(Path("runs"))
    outcome = hilc(*SWEEP[:-1], "--resume")
    assert (outcome.code, outcome.err) == (
        0,
        "hilc: nothing to resume: runs/test-sweep is complete\n",
    )
    assert outcome.out.startswith("test, 8 cases\n")
    document = json.loads(hilc(*SWEEP, "--resume", "--json").out)
    assert (document["folder"], document["cases"]) == ("runs/test-sweep", 8)
    assert listing(Path("runs")) == before


def test_resume_of_a_sweep_that_never_began(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc(*SWEEP, "--resume") == DONE
    assert sweeps.FOLDER.is_dir()


def test_unfinished_sweep_is_resumed_or_begun_anew_only_on_demand(hilc: Hilc, write: Write) -> None:
    write()
    leave_unfinished(hilc, *SWEEP)
    before = listing(sweeps.PART)
    assert hilc(*SWEEP) == Outcome(1, "", UNFINISHED)
    assert hilc(*OTHER) == Outcome(1, "", OTHER_PART)
    assert hilc(*OTHER, "--resume") == Outcome(1, "", OTHER_PART)
    assert listing(sweeps.PART) == before
    assert hilc(*OTHER, "--force") == DONE
    assert not sweeps.PART.exists()


def test_header_of_another_version(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    with monkeypatch.context() as patch:
        patch.setattr("hilc_cli.sweeps.plan.__version__", "0.0.0")
        leave_unfinished(hilc, *SWEEP)
    assert hilc(*SWEEP, "--resume") == Outcome(1, "", OTHER_PART)
    assert hilc(*SWEEP, "--resume", "--force") == DONE


@pytest.mark.parametrize("key", ["checksum", "first", "iterations", "axes", "shard"])
def test_header_without_a_key(hilc: Hilc, write: Write, key: str) -> None:
    write()
    leave_unfinished(hilc, *SWEEP)
    header = json.loads((sweeps.PART / "plan.json").read_text())
    del header[key]
    (sweeps.PART / "plan.json").write_text(json.dumps(header))
    outcome = hilc(*SWEEP, "--resume")
    assert outcome.code in (1, 2) and "Traceback" not in outcome.err
    assert hilc(*SWEEP, "--force") == DONE


def test_own_files_in_the_folder_of_an_unfinished_sweep_stay(hilc: Hilc, write: Write) -> None:
    write()
    leave_unfinished(hilc, *SWEEP)
    (sweeps.PART / "notes.txt").write_text("mine")
    leave_unfinished(hilc, *OTHER, "--force")
    assert (sweeps.PART / "notes.txt").read_text() == "mine"
    assert hilc(*OTHER, "--resume") == DONE
    assert listing(sweeps.PART) == {"notes.txt": b"mine"}


def test_own_files_survive_a_refused_start(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    leave_unfinished(hilc, *SWEEP)
    (sweeps.PART / "notes.txt").write_text("mine")

    def refuse(self: object) -> str:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("hilc_cli.sweeps.plan.Plan.resolved_yaml", refuse)
    assert hilc(*OTHER, "--force").code == 1
    assert (sweeps.PART / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("moment", range(7))
def test_stopped_while_its_folder_is_removed(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch, moment: int
) -> None:
    write()
    assert hilc(*SWEEP, "--bands", "--out", "whole") == DONE
    calls = 0

    def stop(self: Path, missing_ok: bool = False) -> None:
        nonlocal calls
        if self.parent.name == sweeps.PART.name:
            if calls == moment:
                raise KeyboardInterrupt
            calls += 1
        unlink(self, missing_ok=missing_ok)

    unlink = Path.unlink
    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", stop)
        code = hilc(*SWEEP, "--bands").code
    assert code == (0 if moment == 6 else 130)
    outcome = hilc(*SWEEP, "--bands", "--resume")
    assert outcome == DONE
    assert not sweeps.PART.exists()
    assert sweeps.tables(sweeps.FOLDER) == sweeps.tables(Path("whole"))


def test_stopped_before_its_empty_folder_is_removed(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()

    def stop(self: Path) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Path, "rmdir", stop)
        assert hilc(*SWEEP).code == 130
    assert listing(sweeps.PART) == {}
    assert hilc(*SWEEP, "--resume") == DONE
    assert not sweeps.PART.exists()


@pytest.mark.parametrize("extra", ["--resume", "--force"])
def test_two_sweeps_at_once(hilc: Hilc, write: Write, extra: str) -> None:
    write()
    leave_unfinished(hilc, *SWEEP)
    before = listing(sweeps.PART)
    store = FolderStore(sweeps.PART)
    message = (
        "hilc: runs/test-sweep.part: another program is at work on this sweep; "
        "wait until it has ended\n"
    )
    assert hilc(*SWEEP, extra) == Outcome(1, "", message)
    assert listing(sweeps.PART) == before
    store.close()
    assert hilc(*SWEEP, extra) == DONE


def test_two_sweeps_that_start_at_once(tmp_path: Path) -> None:
    sweeps.put_sweep(tmp_path)
    other = ("sweep", "sweep.yaml", "--vary", "disturbance.seed=1..320", "--no-plots")
    with (
        sweeps.started(*sweeps.COMMAND, cwd=tmp_path, script=sweeps.ALONE) as one,
        sweeps.started(*other, cwd=tmp_path, script=sweeps.ALONE) as two,
    ):
        outcomes = [outcome_of(one), outcome_of(two)]
    for outcome in outcomes:
        assert "Traceback" not in outcome.err
    assert sorted(outcome.code for outcome in outcomes) in ([0, 1], [0, 0])
    if outcomes[0].code == 0 and outcomes[1].code == 1:
        assert sweeps.tables(tmp_path / sweeps.FOLDER) == sweeps.expected()


def test_failed_cases(hilc: Hilc, failing: pytest.MonkeyPatch) -> None:
    outcome = hilc(*SWEEP)
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err == (
        "hilc: case 2 failed: no such gain: 0.3\n"
        "hilc: case 3 failed: no such gain: 0.4\n"
        "hilc: the same command with --resume tries these cases again\n"
    )
    rows = (sweeps.FOLDER / "cases.csv").read_text().splitlines()
    columns = rows[0].count(",") - 1
    assert rows[3].endswith("," * columns) and rows[4].endswith("," * columns)
    assert not rows[2].endswith(",,") and not rows[5].endswith(",,")
    manifest = json.loads((sweeps.FOLDER / "sweep.json").read_text())
    assert manifest["failed"] == [
        {"first": 2, "last": 2, "reason": "no such gain: 0.3"},
        {"first": 3, "last": 3, "reason": "no such gain: 0.4"},
    ]
    assert sweeps.PART.exists()
    assert hilc(*SWEEP, "--resume").code == 3
    failing.undo()
    assert hilc(*SWEEP, "--resume") == DONE
    assert not sweeps.PART.exists()
    resumed = (sweeps.FOLDER / "cases.csv").read_bytes()
    assert hilc(*SWEEP, "--out", "whole") == DONE
    assert resumed == Path("whole/cases.csv").read_bytes()


def test_failed_cases_are_tried_again_even_if_only_the_results_are_left(
    hilc: Hilc, failing: pytest.MonkeyPatch
) -> None:
    assert hilc(*SWEEP).code == 3
    shutil.rmtree(sweeps.PART)
    failing.undo()
    assert hilc(*SWEEP, "--resume") == DONE
    assert json.loads((sweeps.FOLDER / "sweep.json").read_text())["failed"] == []


def test_fail_fast(hilc: Hilc, failing: pytest.MonkeyPatch) -> None:
    outcome = hilc(*SWEEP, "--fail-fast")
    assert (outcome.code, outcome.out) == (3, "")
    go_on, failed = outcome.err.splitlines()
    assert go_on.startswith("hilc: go on with: hilc sweep ") and "--fail-fast" in go_on
    assert failed == "hilc: case 2 failed: no such gain: 0.3"
    assert not sweeps.FOLDER.exists()
    failing.undo()
    assert hilc(*sweeps.line_to_go_on(outcome.err)) == DONE
    assert not sweeps.PART.exists()


def test_failed_cases_as_json(hilc: Hilc, failing: pytest.MonkeyPatch) -> None:
    outcome = hilc(*SWEEP, "--json")
    assert outcome.code == 3
    document = json.loads(outcome.out)
    assert [failure["first"] for failure in document["failures"]] == [2, 3]


def test_cases_that_kill_their_worker(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    sixty = ("sweep", "scenario.yaml", "--vary", f"{KEY}=0.01:0.60:60", "--no-plots", "-q")
    assert hilc(*sixty, "--out", "whole") == DONE
    monkeypatch.setattr("hilc_cli.sweeps.compute._ALONE", 0)
    monkeypatch.setattr("hilc_cli.sweeps.compute._MOST_CASES", 24)
    with monkeypatch.context() as patch:
        patch.setattr(
            "hilc_cli.sweeps.planning.plan_sweep", lambda *a, **b: deadly(plan_sweep(*a, **b))
        )
        outcome = hilc(*sixty, "--workers", "2")
    assert outcome == Outcome(
        3,
        "",
        "hilc: cases 24 to 47 failed: the worker process ended with signal 9, "
        f"{TRIES} times\nhilc: the same command with --resume tries these cases again\n",
    )
    rows = (sweeps.FOLDER / "cases.csv").read_text().splitlines()
    whole = Path("whole/cases.csv").read_text().splitlines()
    assert rows[:25] == whole[:25] and rows[49:] == whole[49:]
    assert all(row.endswith(",,,") for row in rows[25:49])
    assert hilc(*sixty, "--resume") == DONE
    assert (sweeps.FOLDER / "cases.csv").read_text().splitlines() == whole


def test_same_tables_keep_the_pictures_that_are_there(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc(*SWEEP) == DONE
    (sweeps.FOLDER / "curve.svg").write_text("drawn before")
    assert hilc(*SWEEP) == DONE
    assert (sweeps.FOLDER / "curve.svg").read_text() == "drawn before"
    assert hilc(*OTHER, "--force") == DONE
    assert not (sweeps.FOLDER / "curve.svg").exists()
