"""``--shard`` and ``--merge``: which parts fit together, and what is said of those that do not."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest

from hilc_cli.sweeps.store import FolderStore
from tests.cli import sweeps
from tests.cli.inputs import listing, plus
from tests.conftest import Hilc, Outcome, Write

KEY = "controller.gains.l1"
SWEEP = ("sweep", "scenario.yaml", "--vary", f"{KEY}=0.1:0.8:8", "--bands", "--no-plots", "-q")
MERGE = ("sweep", "--merge", "--no-plots", "-q")
DONE = Outcome(0, "", "")


@pytest.fixture
def shards(hilc: Hilc, write: Write) -> list[str]:
    """The folders of three shards."""
    write()
    return make_shards(hilc)


def make_shards(hilc: Hilc, *, count: int = 3, more: tuple[str, ...] = ()) -> list[str]:
    for number in range(1, count + 1):
        assert hilc(*SWEEP, *more, "--shard", f"{number}/{count}") == DONE
    return [f"runs/test-sweep.{number}-of-{count}" for number in range(1, count + 1)]


@pytest.mark.parametrize(
    ("shard", "message"),
    [
        ("0/3", "--shard 0/3: K must be from 1 to N, such as 1/3"),
        ("4/3", "--shard 4/3: K must be from 1 to N, such as 1/3"),
        ("1/0", "--shard 1/0: K must be from 1 to N, such as 1/3"),
        ("1/9", "--shard 1/9: there are only 8 cases; make fewer shards"),
        ("1", "--shard 1: must read K/N, such as 1/3"),
        ("1/", "--shard 1/: must read K/N, such as 1/3"),
        ("/3", "--shard /3: must read K/N, such as 1/3"),
        ("-1/3", "--shard -1/3: must read K/N, such as 1/3"),
        ("1/3/3", "--shard 1/3/3: must read K/N, such as 1/3"),
        ("1.0/3", "--shard 1.0/3: must read K/N, such as 1/3"),
        ("\N{SUPERSCRIPT ONE}/3", "--shard \N{SUPERSCRIPT ONE}/3: must read K/N, such as 1/3"),
    ],
)
def test_bad_shard(hilc: Hilc, write: Write, shard: str, message: str) -> None:
    write()
    assert hilc(*SWEEP, "--shard", shard) == Outcome(2, "", f"hilc: {message}\n")
    assert not Path("runs").exists()


def test_any_order_gives_the_sweep(hilc: Hilc, shards: list[str]) -> None:
    assert hilc(*SWEEP) == DONE
    whole = sweeps.tables(sweeps.FOLDER)
    before = [listing(Path(shard)) for shard in shards]
    for number, order in enumerate(itertools.permutations(shards)):
        assert hilc(*MERGE, *order, "--out", f"merged-{number}") == DONE
        assert sweeps.tables(Path(f"merged-{number}")) == whole
    assert [listing(Path(shard)) for shard in shards] == before
    assert hilc(*MERGE, *shards) == DONE  # the same sweep: it may be replaced


@pytest.mark.parametrize(
    ("kept", "missing"),
    [((0, 1), "cases 5 to 7"), ((1, 2), "cases 0 to 1"), ((0, 2), "cases 2 to 4")],
)
def test_missing_shard(hilc: Hilc, shards: list[str], kept: tuple[int, int], missing: str) -> None:
    message = f"hilc: no shard holds {missing}; give all shards of the sweep\n"
    assert hilc(*MERGE, *(shards[number] for number in kept)) == Outcome(2, "", message)
    assert not sweeps.FOLDER.exists()


def test_overlapping_shards(hilc: Hilc, shards: list[str]) -> None:
    halves = make_shards(hilc, count=2)
    outcome = hilc(*MERGE, halves[0], *shards[1:])
    message = f"hilc: {shards[1]}: holds cases that another shard holds too\n"
    assert outcome == Outcome(2, "", message)


@pytest.mark.parametrize("again", ["runs/test-sweep.2-of-3", "runs/../runs/test-sweep.2-of-3/"])
def test_shard_given_twice(hilc: Hilc, shards: list[str], again: str) -> None:
    outcome = hilc(*MERGE, *shards, again)
    message = f"hilc: {shards[1]}: is given more than once; give each shard once\n"
    assert outcome == Outcome(2, "", message)


@pytest.mark.parametrize(
    "more", [("--set", "disturbance.seed=1"), ("--tolerance", "0.1"), ("--vary", "iterations=1,2")]
)
def test_shard_of_another_sweep(hilc: Hilc, shards: list[str], more: tuple[str, ...]) -> None:
    assert hilc(*SWEEP, *more, "--shard", "3/3", "--out", "other") == DONE
    outcome = hilc(*MERGE, *shards[:2], "other.3-of-3")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert "other.3-of-3: is a shard of another sweep than" in outcome.err


def test_unfinished_shard(hilc: Hilc, shards: list[str]) -> None:
    (Path(shards[1]) / "journal").write_bytes(b"")
    message = f"hilc: {shards[1]}: lacks cases 2 to 4; finish it with --resume\n"
    assert hilc(*MERGE, *shards) == Outcome(2, "", message)
    assert hilc(*SWEEP, "--shard", "2/3", "--resume") == DONE
    assert hilc(*MERGE, *shards) == DONE


def test_shard_under_way(hilc: Hilc, shards: list[str]) -> None:
    store = FolderStore(Path(shards[0]))
    outcome = hilc(*MERGE, *shards)
    store.close()
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err == (
        f"hilc: {shards[0]}: another program is at work on this sweep; wait until it has ended\n"
    )


@pytest.mark.parametrize("folder_name", ["runs", "nowhere", "scenario.yaml"])
def test_no_shard(hilc: Hilc, shards: list[str], folder: Path, folder_name: str) -> None:
    before = listing(folder)
    outcome = hilc(*MERGE, *shards[:2], folder_name)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert outcome.err.startswith(f"hilc: {folder_name}: is no folder of a sweep in progress")
    assert listing(folder) == before


def test_finished_shard_is_not_computed_again(hilc: Hilc, shards: list[str]) -> None:
    before = listing(Path(shards[0]))
    assert hilc(*SWEEP, "--shard", "1/3", "--resume") == DONE
    assert listing(Path(shards[0])) == before
    assert hilc(*SWEEP, "--shard", "1/3").code == 1
    assert hilc(*SWEEP, "--shard", "1/3", "--force") == DONE


def test_folder_of_another_shard(hilc: Hilc, shards: list[str]) -> None:
    Path(shards[0]).rename("other.1-of-2")
    outcome = hilc(*SWEEP, "--shard", "1/2", "--resume", "--out", "other")
    assert (outcome.code, outcome.err.count("\n")) == (1, 1)


def test_initial_input_file(hilc: Hilc, write: Write) -> None:
    write({"scenario.yaml": plus("initial_input: input.csv\n")})
    shards = make_shards(hilc)
    assert hilc(*SWEEP) == DONE
    whole = sweeps.tables(sweeps.FOLDER)
    given = (sweeps.FOLDER / "initial-input.csv").read_bytes()
    assert hilc(*MERGE, *shards, "--out", "merged") == DONE
    assert sweeps.tables(Path("merged")) == whole
    assert (Path("merged") / "initial-input.csv").read_bytes() == given
    again = ("sweep", "merged/scenario.yaml", "--no-plots", "-q", "--out", "again")
    assert hilc(*again) == DONE
    assert sweeps.tables(Path("again")) == whole


def test_other_initial_input_is_another_sweep(hilc: Hilc, write: Write) -> None:
    write({"scenario.yaml": plus("initial_input: input.csv\n")})
    shards = make_shards(hilc)
    table = Path("input.csv").read_text()
    Path("input.csv").write_text(table.replace("1,0.1,1,2", "1,0.1,1,3"))
    assert hilc(*SWEEP, "--shard", "3/3", "--out", "other") == DONE
    outcome = hilc(*MERGE, *shards[:2], "other.3-of-3")
    assert outcome.code == 2 and "is a shard of another sweep" in outcome.err


def test_merge_as_json(hilc: Hilc, shards: list[str]) -> None:
    outcome = hilc("sweep", "--merge", *shards, "--no-plots", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out)
    assert document["folder"] == str(sweeps.FOLDER)
    assert (document["cases"], document["failures"]) == (8, [])


def test_shard_as_json(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc(*SWEEP, "--shard", "2/3", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    assert json.loads(outcome.out)["shard"] == [2, 3]


def test_merge_into_the_folder_of_another_sweep(hilc: Hilc, shards: list[str]) -> None:
    other = ("sweep", "scenario.yaml", "--vary", "controller.h=1,2", "--no-plots", "-q")
    assert hilc(*other) == DONE
    outcome = hilc(*MERGE, *shards)
    assert (outcome.code, outcome.err.count("\n")) == (1, 1)
    assert hilc(*MERGE, *shards, "--force") == DONE
