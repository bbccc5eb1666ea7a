"""Folders of leaderboards: what is written is read back, and damage is told."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.errors import HilcError
from hilc_cli.leaderboards.comparing import LawComparison
from hilc_cli.leaderboards.entries import Entry, LeaderboardData
from hilc_cli.leaderboards.folder import read_leaderboard
from tests.leaderboards.test_contests import ENTRY, FAST

LOST = replace(FAST, law="lost", max_m=(0.1, math.inf), peak_m=math.inf, diverged_at=3)
DATA = LeaderboardData("test", (1, 8), 0.01, (ENTRY, FAST, LOST))


def write(folder: Path, data: LeaderboardData) -> None:
    LawComparison(data, "", {}).write(folder, plots=False)


numbers = st.floats(0, 1e140)
errors = numbers | st.just(math.inf)
pairs = st.tuples(errors, errors)
whole = st.none() | st.integers(0, 10**9)
entries = st.builds(
    Entry,
    *map(st.just, ("bend", "exact", "none")),
    st.from_regex(r"[A-Za-z0-9_][A-Za-z0-9._-]{0,20}", fullmatch=True),
    *[pairs] * 3,
    *(whole, st.none() | st.floats(0, 1), whole, st.none() | errors, numbers, st.none() | numbers),
    *(whole, st.floats(0, 1e9)),
)


@settings(max_examples=20)
@given(st.lists(entries, min_size=1, max_size=3, unique_by=lambda entry: entry.law))
def test_any_entries_are_read_back_as_they_were(found: list[Entry]) -> None:
    with TemporaryDirectory() as place:
        folder = Path(place) / "board"
        write(folder, LeaderboardData("any", (2, 3), 0.1, tuple(found)))
        read = read_leaderboard(folder)
    assert (read.name, read.after, read.tolerance) == ("any", (2, 3), 0.1)
    assert list(read.entries) == found


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("slow,3.0", "slow,three", "leaderboard.csv:2: is damaged"),
        ("slow,3.0,", "slow,", "leaderboard.csv:2: is damaged"),
        ("lost,0.1", "lost,", "leaderboard.csv:4: is damaged"),
        (",2,0.75,", ",2.5,0.75,", "leaderboard.csv:3: is damaged"),
        ("lost,0.1", "slow,0.1", "leaderboard.csv: is damaged: it has not each law once"),
        ("_after_8_m", "_after_9_m", "leaderboard.csv: is no table of these runs; its first"),
    ],
)
def test_damaged_table(tmp_path: Path, old: str, new: str, message: str) -> None:
    write(tmp_path / "board", DATA)
    table = tmp_path / "board/leaderboard.csv"
    text = table.read_text()
    assert old in text
    table.write_text(text.replace(old, new))
    with pytest.raises(HilcError, match=message):
        read_leaderboard(tmp_path / "board")


def test_table_without_runs_and_without_anything(tmp_path: Path) -> None:
    write(tmp_path / "board", DATA)
    table = tmp_path / "board/leaderboard.csv"
    table.write_text(table.read_text().splitlines()[0] + "\n")
    with pytest.raises(HilcError, match="has no runs"):
        read_leaderboard(tmp_path / "board")
    table.unlink()
    with pytest.raises(HilcError, match=r"leaderboard\.csv: there is no such file"):
        read_leaderboard(tmp_path / "board")


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("after", None, "manifest.json: is damaged: after: field required"),
        ("after", [], "manifest.json: is damaged: after: "),
        ("after", 3, "manifest.json: is damaged"),
        ("tolerance_m", "wide", "manifest.json: is damaged"),
        ("kind", "hilc run", "is no leaderboard folder: it has no manifest.json of hilc compare"),
    ],
)
def test_damaged_manifest(tmp_path: Path, key: str, value: object, message: str) -> None:
    write(tmp_path / "board", DATA)
    manifest = tmp_path / "board/manifest.json"
    document = json.loads(manifest.read_text())
    if value is None:
        del document[key]
    else:
        document[key] = value
    manifest.write_text(json.dumps(document))
    with pytest.raises(HilcError, match=message):
        read_leaderboard(tmp_path / "board")
