"""The run folder: what is in it, when it is replaced, and what survives."""

from __future__ import annotations

import gc
import hashlib
import json
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.results.trial import Trial
from tests.cli.inputs import SCENARIO, TABLES, listing, plus, replaced, scenario
from tests.conftest import Hilc, Outcome, Write

QUIET = ("--no-plots", "-q")
OTHER = ("--set", "iterations=3", "--out", "runs/test")
PICTURES = ["error-along-path", "error", "final-path", "path-change", "summary", "wheel-speeds"]


@pytest.fixture
def done(hilc: Hilc, write: Write, folder: Path) -> Path:
    """The folder of a finished run."""
    write()
    assert hilc("run", "scenario.yaml", *QUIET) == Outcome(0, "", "")
    return folder / "runs" / "test"


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def last_iteration(folder: Path) -> int:
    return int((folder / "iterations.csv").read_text().splitlines()[-1].partition(",")[0])


def test_files_of_a_run(done: Path) -> None:
    assert names(done) == [
        "input.csv",
        "iterations.csv",
        "manifest.json",
        "plan.csv",
        "samples.csv",
        "scenario.yaml",
    ]


def test_pictures_in_the_formats_asked_for(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    outcome = hilc("run", "scenario.yaml", "-q", "--format", "svg", "--format", "png")
    assert outcome == Outcome(0, "", "")
    pictures = [name for name in names(folder / "runs/test") if name.endswith(("svg", "png"))]
    assert pictures == [f"{kind}.{form}" for kind in PICTURES for form in ("png", "svg")]


def test_pictures_are_png_by_default(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    assert hilc("run", "scenario.yaml", "-q") == Outcome(0, "", "")
    for kind in PICTURES:
        content = (folder / "runs/test" / f"{kind}.png").read_bytes()
        assert content.startswith(b"\x89PNG\r\n\x1a\n")


def test_manifest_tells_how_the_results_came_to_be(done: Path) -> None:
    manifest = json.loads((done / "manifest.json").read_text())
    assert manifest["kind"] == "hilc run"
    assert manifest["versions"]["hilc"] == hilc_api.__version__
    assert set(manifest["versions"]) >= {"hilc", "python", "numpy"}
    assert manifest["command"][1:] == ["run", "scenario.yaml", *QUIET]
    assert manifest["seed"] == 0
    assert set(manifest["inputs_sha256"]) == {"scenario.yaml", "path.yaml"}
    assert manifest["inputs_sha256"] == {
        name: hashlib.sha256(Path(name).read_bytes()).hexdigest()
        for name in ("scenario.yaml", "path.yaml")
    }
    assert manifest["timings_s"]["simulation"] > 0
    assert manifest["started"].startswith("20")
    assert manifest["files"] == names(done)


def test_nothing_of_the_manifest_is_in_the_tables(done: Path) -> None:
    for name in TABLES:
        text = (done / name).read_text()
        assert str(done.parents[1]) not in text
        assert hilc_api.__version__ not in text.partition("\n")[0]


@pytest.mark.parametrize(
    ("key", "written"),
    [
        *(("yardsticks", value) for value in ({"a_m": {"true": "x"}}, {"a_m": 3}, [1], None)),
        *(("speed_limit_rad_s", value) for value in (-1, "fast", True, 1e300, 10**400)),
        *(("gravity_center_m", value) for value in ([1], [1, None], "ab")),
        *(("diverged_at", value) for value in (-1, 0.5, "never", 10**400)),
        *(("robot", value) for value in (1, {"wheel_radius_m": 0.2})),
        ("settings", {"law": 1}),
        ("settings", []),
        ("settings", None),
        *(("name", value) for value in ("", "../x", None, "a\n", "\ud800")),
        ("warnings", [1]),
        *(("readings_off_m", value) for value in ("x", None, -1)),
    ],
)
def test_damaged_manifest_is_told_by_its_key(done: Path, key: str, written: object) -> None:
    manifest = json.loads((done / "manifest.json").read_text())
    (done / "manifest.json").write_text(json.dumps(manifest | {key: written}))
    with pytest.raises(UsageError) as caught:
        hilc_api.read_run(done)
    where = "" if written == "\ud800" else key
    assert str(caught.value).startswith(f"{done}/manifest.json: is damaged: {where}")


def test_noise_of_the_manifest_is_read(done: Path) -> None:
    manifest = json.loads((done / "manifest.json").read_text())
    assert manifest["readings_off_m"] == 0
    (done / "manifest.json").write_text(json.dumps(manifest | {"readings_off_m": 0.005}))
    assert hilc_api.read_run(done).readings_off_m == 0.005


def test_plan_and_platform_are_read_back(done: Path, folder: Path) -> None:
    made, read = hilc_api.run(folder / "scenario.yaml"), hilc_api.read_run(done)
    assert read.robot == made.robot == made.scenario.experiment().robot
    assert read.plan is not None and made.plan is not None
    for name in ("left", "right", "poses"):
        np.testing.assert_array_equal(getattr(read.plan, name), getattr(made.plan, name))
    for asked, again in zip(made.reference_input or (), read.reference_input or (), strict=True):
        np.testing.assert_array_equal(asked, again)
    lines = (done / "plan.csv").read_text().splitlines(keepends=True)
    k, t, _, rest = lines[2].split(",", 3)
    blank = f"{k},{t},,{rest}"
    damages = {
        "it has": lines[:-1],
        "wheel speeds must stand": [*lines[:2], blank, *lines[3:]],
    }
    for problem, rows in damages.items():
        (done / "plan.csv").write_text("".join(rows))
        with pytest.raises(UsageError, match=f"plan.csv: is damaged: {problem}"):
            hilc_api.read_run(done)
    (done / "plan.csv").unlink()
    assert hilc_api.read_run(done).plan is None


def test_second_run_gives_the_same_bytes(hilc: Hilc, done: Path) -> None:
    before = {name: (done / name).read_bytes() for name in (*TABLES, "scenario.yaml")}
    assert hilc("run", "scenario.yaml", *QUIET) == Outcome(0, "", "")
    assert {name: (done / name).read_bytes() for name in before} == before


def test_results_of_the_same_scenario_are_replaced(hilc: Hilc, done: Path) -> None:
    (done / "samples.csv").write_text("damaged")
    assert hilc("run", "scenario.yaml", *QUIET).code == 0
    assert (done / "samples.csv").read_text().startswith("iteration,sample,")


def test_scenario_that_only_looks_different_is_the_same(
    hilc: Hilc, write: Write, done: Path
) -> None:
    written = replaced(SCENARIO, "half_track: 0.5", "wheel_separation: 100 cm")
    write({"scenario.yaml": written})
    assert hilc("run", "scenario.yaml", *QUIET) == Outcome(0, "", "")


def test_results_of_another_scenario_are_kept(hilc: Hilc, done: Path) -> None:
    before = listing(done)
    outcome = hilc("run", "scenario.yaml", *OTHER, *QUIET)
    assert outcome == Outcome(
        1,
        "",
        "hilc: runs/test: holds the results of another scenario; "
        "choose another folder with --out, or replace it with --force\n",
    )
    assert listing(done) == before


def test_force_replaces_results_of_another_scenario(hilc: Hilc, done: Path) -> None:
    outcome = hilc("run", "scenario.yaml", *OTHER, "--force", *QUIET)
    assert outcome == Outcome(0, "", "")
    assert last_iteration(done) == 3


def test_other_initial_input_of_the_same_name_is_another_scenario(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    write({"scenario.yaml": plus("initial_input: input.csv\n")})
    assert hilc("run", "scenario.yaml", *QUIET).code == 0
    assert hilc("run", "scenario.yaml", *QUIET).code == 0
    csv = folder / "input.csv"
    csv.write_text(csv.read_text().replace("0.2,1,2", "0.2,1,3"))
    outcome = hilc("run", "scenario.yaml", *QUIET)
    assert outcome.code == 1
    assert "holds the results of another scenario" in outcome.err


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_folder_that_is_no_run_folder_is_never_touched(
    hilc: Hilc, write: Write, folder: Path, force: tuple[str, ...]
) -> None:
    write()
    (folder / "notes").mkdir()
    (folder / "notes" / "thesis.txt").write_text("three years")
    (folder / "notes" / "scenario.yaml").write_text(SCENARIO)
    before = listing(folder)
    outcome = hilc("run", "scenario.yaml", "--out", "notes", *QUIET, *force)
    assert outcome == Outcome(
        1,
        "",
        "hilc: notes: exists and is no run folder, so it is left as it is; "
        "choose another with --out\n",
    )
    assert listing(folder) == before


@pytest.mark.parametrize("content", ["{}", "[]", "not json", '{"kind": "other"}', "[" * 100_000])
def test_folder_with_another_manifest_is_no_run_folder(
    hilc: Hilc, write: Write, folder: Path, content: str
) -> None:
    write()
    (folder / "other").mkdir()
    (folder / "other" / "manifest.json").write_text(content)
    assert hilc("run", "scenario.yaml", "--out", "other", "--force", *QUIET).code == 1
    assert listing(folder / "other") == {"manifest.json": content.encode()}


@pytest.mark.parametrize("damage", ['"files": 5', '"files": [1, {}]', '"files": null'])
def test_run_folder_with_a_damaged_manifest_can_be_replaced(
    hilc: Hilc, done: Path, damage: str
) -> None:
    (done / "manifest.json").write_text(f'{{"kind": "hilc run", {damage}}}')
    assert hilc("run", "scenario.yaml", *QUIET) == Outcome(0, "", "")


def test_empty_folder_is_taken(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    (folder / "empty").mkdir()
    assert hilc("run", "scenario.yaml", "--out", "empty", *QUIET) == Outcome(0, "", "")
    assert "iterations.csv" in names(folder / "empty")


def test_missing_folders_on_the_way_are_made(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    assert hilc("run", "scenario.yaml", "--out", "a/b/c", *QUIET) == Outcome(0, "", "")
    assert names(folder / "a/b") == ["c"]


def test_out_is_the_very_folder(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    hilc("run", "scenario.yaml", "--out", "here/", *QUIET)
    assert "samples.csv" in names(folder / "here")
    assert not (folder / "runs").exists()


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_file_in_the_way_is_kept(
    hilc: Hilc, write: Write, folder: Path, force: tuple[str, ...]
) -> None:
    write({"out": "precious"})
    outcome = hilc("run", "scenario.yaml", "--out", "out", *QUIET, *force)
    assert outcome == Outcome(1, "", "hilc: out: is no folder; choose another with --out\n")
    assert (folder / "out").read_text() == "precious"


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_foreign_files_survive_a_replacement(
    hilc: Hilc, done: Path, force: tuple[str, ...]
) -> None:
    (done / "notes.txt").write_text("look at iteration 2")
    (done / "notes.txt").chmod(0o640)
    (done / "deeper" / "still").mkdir(parents=True)
    (done / "deeper" / "still" / "more.txt").write_text("more")
    (done / "link").symlink_to("notes.txt")
    (done / "nowhere").symlink_to("nothing")
    changes = OTHER if force else ()
    assert hilc("run", "scenario.yaml", *QUIET, *changes, *force) == Outcome(0, "", "")
    assert (done / "notes.txt").read_text() == "look at iteration 2"
    assert stat.S_IMODE((done / "notes.txt").stat().st_mode) == 0o640
    assert (done / "deeper" / "still" / "more.txt").read_text() == "more"
    assert (done / "link").readlink() == Path("notes.txt")
    assert (done / "nowhere").readlink() == Path("nothing")


def test_pictures_of_the_run_before_do_not_survive(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    hilc("run", "scenario.yaml", "-q")
    assert hilc("run", "scenario.yaml", *OTHER, "--force", *QUIET).code == 0
    assert not [name for name in names(folder / "runs/test") if name.endswith(".png")]


def test_pictures_redrawn_by_plot_do_not_survive_either(hilc: Hilc, done: Path) -> None:
    # They would show the results of the run before beside the tables of this one.
    assert hilc("plot", "runs/test", "--kind", "error", "--format", "svg", "-q").code == 0
    assert hilc("run", "scenario.yaml", *OTHER, "--force", *QUIET).code == 0
    assert "error.svg" not in names(done)


def test_optional_tables_of_the_run_before_do_not_survive(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    extra = "record: {gravity_center: true}\ninitial_input: input.csv\n"
    write({"scenario.yaml": plus(extra)})
    assert hilc("run", "scenario.yaml", *QUIET).code == 0
    assert {"gravity-center.csv", "initial-input.csv"} < set(names(folder / "runs/test"))
    write()
    assert hilc("run", "scenario.yaml", "--force", *QUIET).code == 0
    assert not {"gravity-center.csv", "initial-input.csv"} & set(names(folder / "runs/test"))


def test_no_drafts_are_left_behind(hilc: Hilc, done: Path, folder: Path) -> None:
    hilc("run", "scenario.yaml", *QUIET)
    hilc("run", "scenario.yaml", *OTHER, *QUIET)
    hilc("run", "scenario.yaml", *OTHER, "--force", *QUIET)
    hilc("plot", "runs/test", "--kind", "error", "-q")
    assert names(folder / "runs") == ["test"]
    assert not [name for name in names(done) if name.startswith(".")]


def test_link_to_a_run_folder_is_followed(hilc: Hilc, done: Path, folder: Path) -> None:
    (folder / "disk").mkdir()
    done.rename(folder / "disk" / "test")
    done.symlink_to(folder / "disk" / "test")
    assert hilc("run", "scenario.yaml", *OTHER, "--force", *QUIET).code == 0
    assert names(folder / "runs") == ["test"], "a draft was left behind"
    assert done.is_symlink()
    assert last_iteration(folder / "disk" / "test") == 3


@pytest.fixture(params=[0o022, 0o027, 0o077, 0o002])
def umask(request: pytest.FixtureRequest) -> Iterator[int]:
    mask: int = request.param
    before = os.umask(mask)
    yield mask
    os.umask(before)


def test_permissions_are_those_of_the_umask(
    umask: int, hilc: Hilc, write: Write, folder: Path
) -> None:
    write()
    # All pictures are written by one function, which one umask shows.
    assert hilc("run", "scenario.yaml", "-q", *(QUIET if umask != 0o027 else ())).code == 0
    run = folder / "runs" / "test"
    assert stat.S_IMODE(run.stat().st_mode) == 0o777 & ~umask
    modes = {path.name: stat.S_IMODE(path.stat().st_mode) for path in run.iterdir()}
    assert modes == dict.fromkeys(modes, 0o666 & ~umask)


def test_permissions_of_redrawn_and_copied_files_are_those_of_the_umask(
    umask: int, hilc: Hilc, done: Path, folder: Path
) -> None:
    assert hilc("plot", "runs/test", "--kind", "error", "-q").code == 0
    assert stat.S_IMODE((done / "error.png").stat().st_mode) == 0o666 & ~umask
    assert hilc("examples", "--copy", "mine", "-q").code == 0
    assert stat.S_IMODE((folder / "mine").stat().st_mode) == 0o777 & ~umask
    copied = folder / "mine" / "scenarios" / "fig6a.yaml"
    assert stat.S_IMODE(copied.stat().st_mode) == 0o666 & ~umask


RECORDS = [
    ("auto", 30, {*range(5), 30}),
    ("auto", 3, {0, 1, 2, 3}),
    ("all", 30, set(range(31))),
    ("[]", 5, {0, 5}),
    ("[2, 4]", 5, {0, 2, 4, 5}),
    ("[4, 2, 2]", 5, {0, 2, 4, 5}),
    ("[0, 5]", 5, {0, 5}),
    ("[1]", 0, None),
]


@pytest.mark.parametrize(("record", "iterations", "expected"), RECORDS)
def test_recorded_iterations(
    hilc: Hilc,
    write: Write,
    folder: Path,
    record: str,
    iterations: int,
    expected: set[int] | None,
) -> None:
    write()
    changes = (f"record.iterations={record}", f"iterations={iterations}")
    options = (*QUIET, "--out", "runs/test", *(f"--set={change}" for change in changes))
    outcome = hilc("run", "scenario.yaml", *options)
    if expected is None:
        assert outcome.code == 2
        return
    assert outcome.code == 0
    lines = (folder / "runs/test/samples.csv").read_text().splitlines()[1:]
    recorded = [int(line.partition(",")[0]) for line in lines]
    assert recorded == sorted(recorded)
    assert expected <= set(recorded)
    if record != "auto":
        assert expected == set(recorded)
    assert len(lines) == 4 * len(set(recorded))


def test_automatic_record_of_many_iterations_stays_small(write: Write) -> None:
    write()
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml", {"iterations": 2000}))
    assert 10 < len(run.trials) <= 25
    assert {0, 1, 2, 3, 2000} <= set(run.trials)


def test_diverged_run_keeps_its_finite_iterations(hilc: Hilc, folder: Path) -> None:
    outcome = hilc(
        *("run", "example:fig6c", *QUIET, "--set", "controller.b_w=null"),
        *("--set", "controller.gains.l1=1e9", "--set", "iterations=100", "--out", "runs/fig6c"),
    )
    manifest = json.loads((folder / "runs/fig6c/manifest.json").read_text())
    at = manifest["diverged_at"]
    assert outcome == Outcome(
        3,
        "",
        f"hilc: the simulation diverged to non-finite values in iteration {at}; "
        "the iterations before it are in runs/fig6c\n",
    )
    assert 1 <= at <= 100
    run = folder / "runs/fig6c"
    assert last_iteration(run) == at - 1
    for name in TABLES:
        assert not {"inf", "nan"} & set((run / name).read_text().replace("\n", ",").split(","))
    read = hilc_api.read_run(run)
    assert read.diverged_at == at
    assert max(read.trials) == at - 1


def test_diverged_run_is_drawn(hilc: Hilc, write: Write, folder: Path) -> None:
    write({"scenario.yaml": scenario("b_w: 180", "b_w: null").replace("l1: 0.5", "l1: 1e9")})
    outcome = hilc("run", "scenario.yaml", "--set", "iterations=100", "--out", "runs/test")
    assert outcome.code == 3
    assert outcome.err.count("\n") == 1
    assert {f"{kind}.png" for kind in PICTURES} < set(names(folder / "runs/test"))
    assert hilc("plot", "runs/test", "--kind", "summary", "-q") == Outcome(0, "", "")


def test_run_that_diverges_at_once_writes_nothing(hilc: Hilc, write: Write, folder: Path) -> None:
    csv = (
        "sample,t_s,left_wheel_rad_s,right_wheel_rad_s\n"
        "0,0.0,1e308,-1e308\n1,0.1,1e308,-1e308\n2,0.2,1e308,1e308\n"
    )
    content = plus("initial_input: input.csv\n").replace("b_w: 180", "b_w: null")
    write({"scenario.yaml": content, "input.csv": csv})
    outcome = hilc("run", "scenario.yaml", *QUIET)
    assert outcome == Outcome(
        3, "", "hilc: the simulation diverged to non-finite values in iteration 0\n"
    )
    assert not (folder / "runs").exists()


def test_shortest_run_of_the_shortest_path(hilc: Hilc, write: Write, folder: Path) -> None:
    path = "name: p\nsample_time: 1\nstart: {x: 0, y: 0, heading: 0}\n"
    write({"path.yaml": path + "segments:\n  - line: {length: 1, duration: 1}\n"})
    outcome = hilc("run", "scenario.yaml", "--set", "iterations=0", "--out", "runs/test")
    assert (outcome.code, outcome.err) == (0, "")
    assert len((folder / "runs/test/samples.csv").read_text().splitlines()) == 3
    assert hilc("plot", "runs/test", "--kind", "summary", "-q") == Outcome(0, "", "")


def test_thousands_of_iterations_hold_few_paths(write: Write) -> None:
    write()
    scenario = hilc_api.load_scenario("scenario.yaml", {"iterations": 4_000})
    alive: list[int] = []
    sizes: list[int] = []

    def count(iteration: int) -> None:
        if iteration in (50, 2_000, 4_000):
            alive.append(sum(type(thing) is Trial for thing in gc.get_objects()))
            sizes.append(len(gc.get_objects()))

    before = sum(type(thing) is Trial for thing in gc.get_objects())
    run = hilc_api.run(scenario, on_iteration=count)
    assert len(run.metrics) == 4_001
    # What is recorded, however long the run (see test_recording.py), and the running one.
    assert max(alive) - before <= 28
    assert sizes[2] < sizes[0] + 2_000  # nothing else piles up either


def test_metrics_of_many_iterations_take_eight_bytes_a_number(write: Write) -> None:
    write()
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml", {"iterations": 1000}))
    size = sum(sys.getsizeof(column) for column in run.metrics._columns.values())
    assert size < 1001 * 10 * 8 * 1.3


def test_read_run_gives_back_what_was_written(done: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    read = hilc_api.read_run(done)
    assert read.name == "test"
    assert read.reference.name == "path"
    assert read.speed_limit == 180
    assert list(read.trials) == list(run.trials)
    for number, trial in run.trials.items():
        for field in ("x", "y", "heading", "left", "right"):
            np.testing.assert_array_equal(
                getattr(read.trials[number], field), getattr(trial, field), strict=True
            )
        assert read.trials[number].saturated_samples == trial.saturated_samples
    for field in ("x", "y", "heading"):
        np.testing.assert_array_equal(
            getattr(read.reference, field), getattr(run.reference, field), strict=True
        )
    assert list(map(dict, read.metrics.rows())) == list(map(dict, run.metrics.rows()))


def test_tables_alone_are_a_run(done: Path) -> None:
    (done / "manifest.json").unlink()
    (done / "scenario.yaml").unlink()
    (done / "input.csv").unlink()
    read = hilc_api.read_run(done)
    assert (read.name, read.speed_limit, read.diverged_at) == ("test", None, None)


DAMAGES = [
    ("iterations.csv", "iteration,", "iterations,", "iterations.csv: is no such table"),
    ("iterations.csv", "\n1,", "\n7,", "iterations.csv:3: is damaged: iteration 1 should stand"),
    ("iterations.csv", "\n1,", "\n1,oops,", "iterations.csv:3: is damaged: 13 cells should"),
    ("samples.csv", "sample,", "samples,", "samples.csv: is no such table"),
    ("samples.csv", "\n0,1,", "\n0,2,", "samples.csv: is damaged: its samples are not in order"),
    ("samples.csv", "\n0,1,", "\n0,oops,", "samples.csv: is damaged: "),
    ("samples.csv", "\n0,1,", "\n0,1,1,", "samples.csv: is damaged: "),
    ("samples.csv", "\n2,", "\n9,", "samples.csv: is damaged: it has iterations that iterations"),
    ("samples.csv", "\n0,1,", "\nnan,1,", "samples.csv:3: is damaged: numbers must be finite"),
    ("samples.csv", "\n0,1,", "\n0,1,nan\n0,1,", "samples.csv: is damaged: "),
]


@pytest.mark.parametrize(("name", "old", "new", "message"), DAMAGES)
def test_damaged_table_is_told(
    hilc: Hilc, done: Path, name: str, old: str, new: str, message: str
) -> None:
    table = done / name
    table.write_text(table.read_text().replace(old, new))
    outcome = hilc("plot", "runs/test")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert outcome.err.startswith(f"hilc: runs/test/{message}")


@pytest.mark.parametrize("name", ["iterations.csv", "samples.csv"])
@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"\n", b"a\n1\n"])
def test_table_with_other_content_is_told(
    hilc: Hilc, done: Path, name: str, content: bytes
) -> None:
    (done / name).write_bytes(content)
    outcome = hilc("plot", "runs/test")
    assert (outcome.code, outcome.err.count("\n")) == (2, 1)
    assert outcome.err.startswith(f"hilc: runs/test/{name}: is no such table; its first line must")


@pytest.mark.parametrize("name", ["iterations.csv", "samples.csv"])
def test_table_without_rows_is_told(hilc: Hilc, done: Path, name: str) -> None:
    header = (done / name).read_text().partition("\n")[0]
    (done / name).write_text(header + "\n")
    outcome = hilc("plot", "runs/test")
    assert (outcome.code, outcome.err.count("\n")) == (2, 1)
    assert outcome.err.startswith(f"hilc: runs/test/{'samples.csv'}: ") or name in outcome.err


@pytest.mark.parametrize("cut", [1, 20, 200])
def test_table_that_was_cut_off_is_told(hilc: Hilc, done: Path, cut: int) -> None:
    content = (done / "samples.csv").read_bytes()
    (done / "samples.csv").write_bytes(content[: -cut - 2])
    outcome = hilc("plot", "runs/test")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert outcome.err.startswith("hilc: runs/test/samples.csv: is damaged: ")


def test_missing_table_is_told(hilc: Hilc, done: Path) -> None:
    (done / "samples.csv").unlink()
    outcome = hilc("plot", "runs/test")
    assert outcome == Outcome(
        2, "", "hilc: runs/test/samples.csv: there is no such file; check the path\n"
    )


def test_check_before_a_long_simulation(write: Write, folder: Path) -> None:
    write({"out": "precious"})
    scenario = hilc_api.load_scenario("scenario.yaml")
    hilc_api.check_folder(scenario, "new")
    with pytest.raises(ExistingResultsError):
        hilc_api.check_folder(scenario, "out")


def test_folder_that_is_none_cannot_be_read(folder: Path) -> None:
    with pytest.raises(UsageError, match=r"^nowhere: is no run folder"):
        hilc_api.read_run("nowhere")


def test_same_tables_keep_the_pictures_that_are_there(hilc: Hilc, done: Path, write: Write) -> None:
    own = {"error.svg": b"drawn by plot", "final-path.pdf": b"too", "summary.png": b"third"}
    for name, content in own.items():
        (done / name).write_bytes(content)
    (done / "learning.png").symlink_to("../../path.yaml")
    with (done / "error.pdf").open("wb") as sparse:
        sparse.truncate(10**12)
    assert hilc("run", "scenario.yaml", *QUIET) == Outcome(0, "", "")
    assert {name: (done / name).read_bytes() for name in own} == own
    assert not (done / "error.pdf").exists(), "nothing of that size is a picture"
    assert not (done / "learning.png").exists(), "a link is no picture"
    assert json.loads((done / "manifest.json").read_text())["files"] == names(done)
    # Those of the formats that are drawn are new, the others stay.
    assert hilc("run", "scenario.yaml", "-q") == Outcome(0, "", "")
    assert (done / "summary.png").read_bytes().startswith(b"\x89PNG")
    assert (done / "error.svg").read_bytes() == own["error.svg"]
    # The same scenario and other tables, such as those of another version: nothing stays.
    table = (done / "samples.csv").read_text()
    (done / "samples.csv").write_text(table.replace(",0.0,", ",0.125,", 1))
    assert hilc("run", "scenario.yaml", *QUIET) == Outcome(0, "", "")
    assert (done / "samples.csv").read_text() == table
    assert not [name for name in names(done) if name.endswith((".png", ".svg", ".pdf"))]
