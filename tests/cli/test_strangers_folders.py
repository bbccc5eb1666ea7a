"""Folders of strangers: what stands in the place of a file, and what they say that they are called.

Whatever it is, nothing is written outside, nothing hangs, and nothing steers the terminal.
"""

from __future__ import annotations

import csv
import io
import json
import os
import shutil
import signal
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from types import FrameType

import pytest

import hilc_cli as hilc_api
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.sweeps.shards import sweep_shard
from hilc_cli.sweeps.store import FolderStore
from hilc_cli.sweeps.sweeping import sweep
from tests.cli.inputs import INPUT_CSV, SCENARIO, TRAJECTORY, listing, plus
from tests.conftest import Hilc, Outcome
from tests.leaderboards.test_leaderboard_folder import DATA, write as write_leaderboard

VARY = ("controller.gain_matrix=model,unit", "iterations=1,2")
SWEEP = ("sweep", "scenario.yaml", "--vary", VARY[0], "--vary", VARY[1], "--bands", "--no-plots")
RUN = ("run", "scenario.yaml", "--no-plots", "--out", "a")
RESUME = (*SWEEP, "--out", "new", "--resume")
SHARD = (*SWEEP, "--shard", "1/2", "--out", "part", "--resume")
MERGE = ("sweep", "--merge", "part.1-of-2", "part.2-of-2", "--no-plots", "--out", "merged")
COMPARE = ("compare", "a", "b", "--no-plots", "--out", "both")
PLOT, PLOT_BOARD = ("plot", "sweep", "--kind", "curve"), ("plot", "board")
COMPLETE = (*SWEEP, "--out", "sweep", "--resume")
REPRODUCE = ("reproduce", "fig3", "--out", "figures")

INITIAL_INPUT = "initial-input.csv"
IN_PLACE = ("journal", "results.bin", "errors.bin")
READ = ("plan.json", *IN_PLACE, "scenario.yaml", INITIAL_INPUT)
SHARDS = ("part.1-of-2", "part.2-of-2")
RUNS = ("manifest.json", "iterations.csv", "samples.csv", "learning.csv", "scenario.yaml")
PLACES = [
    *((f"a/{name}", COMPARE) for name in RUNS),
    *((f"a/{name}", RUN) for name in (*RUNS[:1], *RUNS[-1:], INITIAL_INPUT, "error.png")),
    *((f"sweep/{name}", PLOT) for name in ("sweep.json", "cases.csv", "curve.png")),
    *((f"sweep/{name}", COMPLETE) for name in ("sweep.json", "bands.csv")),
    *((f"new.part/{name}", RESUME) for name in IN_PLACE),
    *((f"new.part/{name}", (*RESUME[:-1], "--force")) for name in ("plan.json", *IN_PLACE)),
    *((f"part.1-of-2/{name}", SHARD) for name in ("plan.json", *IN_PLACE)),
    *((f"part.1-of-2/{name}", MERGE) for name in READ),
    *((f"board/{name}", PLOT_BOARD) for name in ("manifest.json", "leaderboard.csv")),
    *((f"figures/{name}", REPRODUCE) for name in ("manifest.json", "data")),
    *((place, RUN) for place in ("scenario.yaml", "path.yaml", "input.csv", "a")),
    *((place, RESUME) for place in ("new", "new.part")),
    *((place, command) for place in ("part.1-of-2",) for command in (SHARD, MERGE)),
    ("both", COMPARE),
    ("examples/scenarios", ("examples", "--copy", "examples")),
]
NAMES = [
    *((f"a/manifest.json:{key}", COMPARE) for key in ("name", "trajectory")),
    ("sweep/sweep.json:name", PLOT),
    ("part.1-of-2/plan.json:name", MERGE),
    ("new.part/plan.json:name", RESUME),
    ("board/manifest.json:name", PLOT_BOARD),
    *((f"board/leaderboard.csv:{what}", PLOT_BOARD) for what in ("bend", "exact", "none", "slow")),
]
HOSTILE = (
    *(
        "../../outside/x",
        "/outside/x",
        "..",
        ".-",
        ".s.hilc-043a718b-aaaaaaaa",
        "",
        "-x",
        "=1+1",
        "n" * 101,
        "ok\n",
        "red\x1b[31m",
    ),
    *("[link=http://x]y", "\u202ex", None, ["x"]),
)

PATIENCE = 120
"""Seconds that a command may take on a machine that is busy."""


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder of each kind, as it is made."""
    place = tmp_path_factory.mktemp("kinds")
    texts = {
        "scenario.yaml": plus("initial_input: input.csv\n"),
        "path.yaml": TRAJECTORY,
        "input.csv": INPUT_CSV,
        "plain.yaml": SCENARIO,
    }
    for name, text in texts.items():
        (place / name).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hilc_cli.sweeps.compute._ALONE", float("inf"))
        patch.chdir(place)
        scenario = hilc_api.load_scenario("scenario.yaml")
        for name in "ab":
            hilc_api.run(scenario).write(name, plots=False)
            Path(name, "learning.csv").write_text("iteration,gain\n0,1.0\n1,2.0\n2,3.0\n")
            Path(name, "error.png").write_text("a picture")
        plan = plan_sweep(scenario, VARY, bands=True)
        sweep(plan, work_folder="new.part").write("sweep", plots=False)
        Path("sweep", "curve.png").write_text("a picture")
        for number, name in enumerate(("part.1-of-2", "part.2-of-2"), 1):
            sweep_shard(plan, (number, 2), name)
        write_leaderboard(place / "board", DATA)
        Path("figures", "data").mkdir(parents=True)
        Path("figures", "manifest.json").write_text('{"kind": "hilc reproduce", "figures": ["x"]}')
        Path("examples", "scenarios").mkdir(parents=True)
        Path("both").mkdir()
        Path("new").mkdir()
    return place


@pytest.fixture
def work(kinds: Path, tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of them to work in; beside it a folder that is none of anybody's business."""
    shutil.copytree(kinds, tmp_path / "work")
    (tmp_path / "outside").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.setattr("hilc_cli.sweeps.compute._ALONE", float("inf"))
    return tmp_path / "work"


@pytest.fixture(autouse=True)
def in_time() -> Iterator[None]:
    """What hangs is woken up."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise AssertionError("hangs")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(PATIENCE)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def outside_of(work: Path) -> Path:
    return work.parent / "outside"


def link_to_the_same(place: Path, outside: Path) -> None:
    """The most that one can be led to write to: it has what belongs there."""
    place.rename(outside / "target")
    place.symlink_to(outside / "target")


def second_name(place: Path, outside: Path) -> None:
    os.link(place, outside / "target")


def dangling_link(place: Path, outside: Path) -> None:
    remove(place)
    place.symlink_to(outside / "nowhere")


def pipe(place: Path, outside: Path) -> None:
    remove(place)
    os.mkfifo(place)


def endless(place: Path, outside: Path) -> None:
    remove(place)
    place.symlink_to("/dev/zero")


def other(place: Path, outside: Path) -> None:
    """A folder for a file, or a link to an empty folder for a folder."""
    was_folder = place.is_dir()
    remove(place)
    (outside / "empty").mkdir()
    place.symlink_to(outside / "empty") if was_folder else place.mkdir()


def remove(place: Path) -> None:
    shutil.rmtree(place) if place.is_dir() else place.unlink()


def check_harmless(outcome: Outcome) -> None:
    """One line for what went wrong, and none that a terminal would follow."""
    assert outcome.code in (0, 1, 2, 3), outcome
    assert "Traceback" not in outcome.err, outcome.err
    lines = [line for line in outcome.err.splitlines() if "hilc: go on with: " not in line]
    assert len(lines) == (outcome.code != 0), outcome.err
    assert all(line.startswith(("hilc: ", "scenario.yaml:")) for line in lines), outcome.err
    for text in (outcome.out, outcome.err):
        assert text.replace("\n", "").isprintable(), ascii(text)


KINDS = (link_to_the_same, second_name, dangling_link, pipe, endless, other)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_what_stands_in_the_place_of_a_file(
    kind: Callable[[Path, Path], None], work: Path, hilc: Hilc, kinds: Path
) -> None:
    outside = outside_of(work)
    for place, command in PLACES:
        assert os.path.lexists(kinds / place), place
        if kind is second_name and not place.endswith(IN_PLACE):
            continue  # it is a file like others
        if (place, kind) == ("a", link_to_the_same):
            continue  # a link to a run of the same scenario is followed
        shutil.rmtree(work)
        shutil.rmtree(outside)
        shutil.copytree(kinds, work)
        outside.mkdir()
        os.chdir(work)
        kind(work / place, outside)
        before = listing(outside)
        signal.alarm(PATIENCE)
        outcome = hilc(*command, "-q")
        what = f"{place}: {' '.join(command)}: {outcome}"
        assert listing(outside) == before, what
        assert {entry.name for entry in work.parent.iterdir()} == {"work", "outside"}, what
        check_harmless(outcome)
        if kind is pipe and place.endswith((".json", "cases.csv", "bands.csv", "iterations.csv")):
            assert (outcome.code, "is a named pipe" in outcome.err) == (2, True), what
        if place.endswith(IN_PLACE) and kind in (link_to_the_same, second_name):
            # What is only read may be a link, and what is removed is no longer written to.
            is_harmless = command == MERGE or ("--force" in command and place[-7:] != "journal")
            assert outcome.code == (0 if is_harmless else 2), what


@pytest.mark.parametrize(("place", "command"), NAMES, ids=[place for place, _ in NAMES])
def test_what_a_folder_says_that_it_is_called(
    place: str, command: tuple[str, ...], work: Path, hilc: Hilc
) -> None:
    name, _, what = place.partition(":")
    text = (work / name).read_text()
    before = listing(outside_of(work))
    for hostile in HOSTILE:
        if name.endswith(".csv"):
            if not isinstance(hostile, str):
                continue
            cell = '"' + hostile.replace('"', '""') + '"'
            changed = text.replace(f"{what},", f"{cell},", 1)
            assert changed != text
        else:
            changed = json.dumps({**json.loads(text), what: hostile})
        (work / name).write_text(changed)
        signal.alarm(PATIENCE)
        outcome = hilc(*command)
        assert (outcome.code, outcome.out) == (2, ""), ascii(hostile)
        assert ("is no name" if isinstance(hostile, str) else "is damaged") in outcome.err
        check_harmless(outcome)
    assert listing(outside_of(work)) == before
    assert {entry.name for entry in work.parent.iterdir()} == {"work", "outside"}


def test_shards_are_only_read(work: Path, hilc: Hilc) -> None:
    def shards() -> dict[Path, tuple[int, bytes]]:
        files = (path for name in SHARDS for path in (work / name).iterdir())
        return {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in files}

    before = shards()
    with closing(
        FolderStore(work / "part.1-of-2", read_only=True)
    ):  # somebody else merges them, too
        assert hilc(*MERGE, "-q") == Outcome(0, "", "")
    assert shards() == before
    assert (work / "merged/cases.csv").read_bytes() == (work / "sweep/cases.csv").read_bytes()


def test_numbers_of_a_shard_take_no_memory(work: Path, hilc: Hilc) -> None:
    header = json.loads((work / "part.1-of-2/plan.json").read_text())
    huge = {"low": 0, "high": 10**12, "spacing": "integer", "count": None, "whole": True}
    many = {"low": 0.0, "high": 1.0, "spacing": "linear", "count": 10**12, "whole": True}
    for change in (
        {"last": 10**14},
        {"iterations": 10**14},
        {"cases": 10**14, "sample": "random"},
        {"axes": {**header["axes"], "iterations": huge}},
        {"axes": {**header["axes"], "iterations": many}},
        {"axes": {**header["axes"], "\x1b[31m": {"values": [1]}}},
    ):
        (work / "part.1-of-2/plan.json").write_text(json.dumps({**header, **change}))
        outcome = hilc(*MERGE)
        assert (outcome.code, outcome.out) == (2, ""), change
        check_harmless(outcome)


def test_texts_are_shown_as_they_are_written(work: Path, hilc: Hilc) -> None:
    """A folder's name and the settings of a run are no names: they are made harmless."""
    manifest = json.loads((work / "a/manifest.json").read_text())
    texts = {"law": "=HYPERLINK(1)", "gains": "[red]l1\x1b[2J\n\u202e", "compensation": "$\\frac{$"}
    (work / "a/manifest.json").write_text(json.dumps({**manifest, "settings": texts}))
    odd = work / "+[bold]\x1b]0;x\x07\nrow"
    (work / "b").rename(odd)
    for table in ("terminal", "csv", "markdown", "latex"):
        signal.alarm(PATIENCE)
        where = ("--out", f"out-{table}", *(() if table == "terminal" else ("--no-plots",)))
        outcome = hilc("compare", "a", odd.name, *where, "--table", table)
        assert outcome.code == 0, outcome
        assert outcome.out.replace("\n", "").isprintable(), ascii(outcome.out)
        assert outcome.err.replace("\n", "").isprintable(), ascii(outcome.err)
        assert "[red]l1" in outcome.out or table == "latex"
        assert "[bold]" in outcome.out or table == "terminal"  # where long names are broken
    rows = list(csv.reader(io.StringIO((work / "out-csv/comparison.csv").read_text())))
    assert rows[1][1] == "'=HYPERLINK(1)"
    assert rows[2][0] == "'+[bold]\ufffd]0;x\ufffd\ufffdrow"
    assert all(cell.isprintable() for row in rows for cell in row)
