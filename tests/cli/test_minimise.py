"""``hilc sweep --minimise``: finds what is best, tells it, and goes on after any stop."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.sweeps.plan import Plan
from hilc_cli.variation import Value
from tests.cli import sweeps
from tests.cli.inputs import listing
from tests.cli.processes import outcome_of
from tests.cli.searches import (
    BATCHES,
    FILES,
    L1,
    L2,
    METRIC,
    REFINED,
    SCENARIO,
    SEARCH,
    SWEEP,
    error_after,
    expected,
    tables,
)
from tests.conftest import Hilc, Outcome, Write

DONE = Outcome(0, "", "")


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write(FILES)


def table(folder: Path = sweeps.FOLDER) -> list[dict[str, str]]:
    with (folder / "cases.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize(
    ("gains", "seed"), [("0:20", "0"), ("0:20:7", str(2**64 - 1)), ("1:100:log", "1")]
)
def test_best_gain_of_a_line_is_found(hilc: Hilc, gains: str, seed: str) -> None:
    vary = ("--vary", f"{L1}={gains}", "--minimise", METRIC, "--cases", "40", "--seed", seed)
    outcome = hilc(*SWEEP, *vary, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out, parse_constant=pytest.fail)
    for row in table():
        assert float(row[METRIC]) == pytest.approx(error_after(float(row[L1])), abs=1e-12)
    search = document["search"]
    assert search["as_it_is"]["values"] == {L1: 4}
    assert search["as_it_is"]["metric"] == pytest.approx(error_after(4), rel=1e-12)
    # Nearer to 1 / d_t than any of as many values in equal steps needs to be.
    assert search["best"]["values"][L1] == pytest.approx(10, abs=20 / 39 / 2)
    assert search["best"]["metric"] == min(float(row[METRIC]) for row in table())
    assert search["best"] == document["best"][0]


def test_words_lists_and_whole_numbers(hilc: Hilc) -> None:
    keys = (f"{L1}=19,1,9,12,5", "iterations=1..3", "trajectory=long.yaml,path.yaml")
    vary = [word for key in keys for word in ("--vary", key)]
    outcome = hilc(*SWEEP, *vary, "--minimise", METRIC, "--cases", "24", "--json")
    assert outcome.code == 0
    search = json.loads(outcome.out)["search"]
    assert search["as_it_is"]["values"] == {L1: 4, "iterations": 3, "trajectory": "path"}
    # 9 is nearest to 1 / d_t.
    assert search["best"]["values"] == {L1: 9, "iterations": 3, "trajectory": "path"}
    assert search["best"]["metric"] == pytest.approx(error_after(9, 3), rel=1e-9)
    cases = [(row[L1], row["iterations"], row["trajectory"]) for row in table()]
    assert len(set(cases)) == 24  # of 30: no case is tried twice


def test_all_that_there_is_may_be_tried(hilc: Hilc) -> None:
    assert hilc(*SWEEP, "--vary", f"{L1}=2,6", "--minimise", METRIC, "--cases", "9") == DONE
    assert {row[L1] for row in table()} == {"2.0", "6.0"}


def test_fewest_iterations_to_a_tolerance(hilc: Hilc) -> None:
    """|1 - d_t l1|^i <= 0.05 from i = 1 on for l1 from 9.5 to 10.5, from no i <= 3 on below 6.3."""
    metric = "iterations_to_tolerance"
    options = ("--minimise", metric, "--tolerance", "0.05", "--cases", "40", "--json")
    outcome = hilc(*SWEEP, "--vary", f"{L1}=0:20", *options)
    document = json.loads(outcome.out)
    search = document["search"]
    assert search["as_it_is"]["metric"] is None
    assert (search["best"]["metric"], document["within_tolerance"] < 40) == (1, True)
    assert 9.5 <= search["best"]["values"][L1] <= 10.5


@pytest.mark.slow
def test_best_scenario_runs_to_the_metric(hilc: Hilc) -> None:
    changes = (
        "--set",
        "disturbance.output.bound=[1 cm, 1 cm, 0.1]",
        "--set",
        "iterations=5",
        "--out",
        str(sweeps.FOLDER),
    )
    keys = ("--vary", f"{L1}=0.1:10:log", "--vary", f"{L2}=0:5", "--vary", "controller.h=1..1")
    assert hilc(*SWEEP, *changes, *keys, "--minimise", METRIC, "--cases", "30") == DONE
    text = (sweeps.FOLDER / "best.yaml").read_text()
    best = min(table(), key=lambda row: float(row[METRIC]))
    assert text.startswith(
        f"# Case {best['case']} of a search with hilc sweep, the best of 30: {METRIC} "
        f"{best[METRIC]}\nname: test-best\n"
    )
    outcome = hilc("run", str(sweeps.FOLDER / "best.yaml"), "--json", "--no-plots")
    assert (outcome.code, outcome.err) == (0, "")
    final = json.loads(outcome.out)["final"]
    for name, number in final.items():
        assert number == pytest.approx(float(best[name]), rel=1e-9, abs=1e-12), name


def test_best_scenario_takes_the_input_file_along(hilc: Hilc) -> None:
    header = "sample,t_s,left_wheel_rad_s,right_wheel_rad_s\n"
    Path("input.csv").write_text(f"{header}0,0.0,30,30\n")
    options = ("--set", "initial_input=input.csv", "--minimise", METRIC, "--cases", "14")
    out = ("--out", str(sweeps.FOLDER))
    assert hilc(*SWEEP, "--vary", f"{L1}=0:20", *options, *out) == DONE
    outcome = hilc("run", str(sweeps.FOLDER / "best.yaml"), "--json", "--no-plots")
    found = json.loads(outcome.out)["final"][METRIC]
    assert found == pytest.approx(min(float(row[METRIC]) for row in table()), rel=1e-9)
    # 0.1 s at 30 rad/s with 0.2 m: the first iteration leaves 0.4 m of the metre.
    assert found == pytest.approx(
        min(error_after(float(row[L1]), length=0.4) for row in table()), rel=1e-9
    )


def test_search_is_reproducible(hilc: Hilc) -> None:
    assert hilc(*SEARCH, "--seed", "0") == DONE
    assert tables(sweeps.FOLDER) == expected()
    again = ("sweep", str(sweeps.FOLDER / "scenario.yaml"), "--no-plots", "-q", "--out", "again")
    assert hilc(*again) == DONE
    assert tables(Path("again")) == expected()
    cases = expected()["cases.csv"]
    assert hilc(*SEARCH, "--seed", "1", "--out", "other") == DONE
    assert (Path("other") / "cases.csv").read_bytes() != cases
    # With more cases those are the same that come before the refinement.
    assert hilc(*SEARCH[:-1], "55", "--out", "more") == DONE
    more = (Path("more") / "cases.csv").read_bytes().splitlines()
    first = 1 + 40 - REFINED
    assert more[:first] == cases.splitlines()[:first] != more[: first + 1]


def test_section_says_what_is_minimised(hilc: Hilc) -> None:
    section = f"sweep: {{vary: {{{L1}: 0:20}}, minimise: {METRIC}, cases: 40}}\n"
    Path("section.yaml").write_text(SCENARIO + section)
    assert hilc("sweep", "section.yaml", "--no-plots", "-q") == DONE
    assert tables(sweeps.FOLDER) == expected()
    drawn = ("sweep", "section.yaml", "--no-plots", "-q", "--sample", "random", "--out", "drawn")
    assert hilc(*drawn) == DONE
    assert Path("drawn/best.yaml").read_text().startswith("# Case ")
    assert len(table(Path("drawn"))) == 40
    other = ("sweep", "section.yaml", "--no-plots", "-q", "--minimise", "rms_position_error_m")
    assert hilc(*other, "--out", "other") == DONE
    assert json.loads(Path("other/sweep.json").read_text())["metric"] == "rms_position_error_m"


def test_what_is_printed(hilc: Hilc) -> None:
    outcome = hilc(*(word for word in SEARCH if word != "-q"))
    assert (outcome.code, outcome.err) == (0, "")
    lines = [line.split() for line in outcome.out.splitlines()]
    best = min(table(), key=lambda row: float(row[METRIC]))
    assert ["as", "it", "is", "best,", "case", best["case"]] in lines
    assert [METRIC, "0.216", f"{float(best[METRIC]):.6g}"] in lines
    assert [L1, "4", f"{float(best[L1]):.6g}"] in lines
    assert outcome.out.endswith("Best scenario: runs/test-sweep/best.yaml\n")
    shown = outcome.out
    again = hilc(*(word for word in SEARCH if word != "-q"), "--resume")
    assert again == Outcome(0, shown, "hilc: nothing to resume: runs/test-sweep is complete\n")


@pytest.mark.parametrize(
    ("vary", "hint"),
    [
        (f"{L1}=0:3", "no case is better than the scenario as it is"),
        (
            "iterations=1..5",
            "iterations of the best case is at the end of its range: a wider one may hold a better "
            "value",
        ),
    ],
)
def test_what_might_be_overlooked(hilc: Hilc, vary: str, hint: str) -> None:
    options = ("--minimise", METRIC, "--cases", "12", "--json", "--no-plots")
    outcome = hilc("sweep", "scenario.yaml", "--vary", vary, *options)
    assert (outcome.code, outcome.err) == (0, f"hilc: {hint}\n")


@pytest.mark.slow
def test_lucky_seeds_are_warned_of(hilc: Hilc) -> None:
    noise = ("--set", "disturbance.output.bound=[1 cm, 0, 0]", "--no-plots", "--json")
    options = ("--vary", "disturbance.seed=1..9", "--minimise", METRIC, "--cases", "12")
    outcome = hilc("sweep", "scenario.yaml", *noise, *options)
    assert outcome.code == 0
    assert outcome.err.startswith(
        "hilc: warning: disturbance.seed varies: the search will find lucky disturbances, "
        "not good values; --over disturbance.seed tries each choice with all of them\n"
    )
    gains = ("--vary", f"{L1}=1:19", "--over", "disturbance.seed", "--out", "judged")
    judged = hilc("sweep", "scenario.yaml", *noise, *options, *gains)
    assert (judged.code, judged.err) == (0, "")


def test_nothing_is_found(hilc: Hilc) -> None:
    metric = "iterations_to_tolerance"
    options = ("--minimise", metric, "--tolerance", "1 mm", "--cases", "13")
    command = ("sweep", "scenario.yaml", "--no-plots", "--vary", f"{L1}=0:3", *options)
    outcome = hilc(*command, "--json")
    assert outcome.code == 3
    assert outcome.err == f"hilc: no case has a value of {metric}, so there is no best.yaml\n"
    document = json.loads(outcome.out, parse_constant=pytest.fail)
    assert (document["search"]["best"], document["search"]["scenario"]) == (None, None)
    assert not (sweeps.FOLDER / "best.yaml").exists()
    assert hilc(*command, "--resume").code == 3


def test_cases_that_diverge_are_the_worst(hilc: Hilc) -> None:
    """Without a limit |1 - d_t l1|^500 overflows from l1 = 30 on."""
    options = ("--set", "iterations=500", "--vary", f"{L1}=1:1e4:log", "--minimise", METRIC)
    out = ("--out", str(sweeps.FOLDER))
    outcome = hilc(*SWEEP, *options, "--cases", "30", "--json", *out)
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out, parse_constant=pytest.fail)
    assert 0 < document["diverged"] < 20
    gone = [float(row[L1]) for row in table() if row["diverged"] == "1"]
    assert min(gone) > 19
    assert document["search"]["best"]["metric"] < 1e-9


def stop_at_the_end(hilc: Hilc) -> None:
    """Leaves a search of which all cases are known, but nothing has been written."""
    with pytest.MonkeyPatch.context() as patch:

        def stop(*_: object) -> None:
            raise KeyboardInterrupt

        patch.setattr("hilc_cli.sweeps.search.own_metric", stop)
        assert hilc(*SEARCH).code == 130
    assert sweeps.chunks_kept() == BATCHES


@pytest.mark.parametrize("kept", [0, 1, 4, BATCHES - 1])
def test_resumed_search_is_that_of_one_go(hilc: Hilc, kept: int) -> None:
    stop_at_the_end(hilc)
    journal = sweeps.PART / "journal"
    lines = journal.read_bytes().splitlines(keepends=True)
    assert len(lines) == 2 * BATCHES  # each has an empty one before it
    journal.write_bytes(b"".join([*lines[: 2 * kept], lines[2 * kept + 1][:20]]))
    assert hilc(*SEARCH, "--resume") == DONE
    assert tables(sweeps.FOLDER) == expected()
    assert not sweeps.PART.exists()


@pytest.mark.slow
def test_killed_search_goes_on(tmp_path: Path, hilc: Hilc) -> None:
    sweeps.put_sweep(tmp_path)
    keys = ("--vary", f"{L1}=0.1:10:log", "--vary", f"{L2}=0:5")
    command = ("sweep", "sweep.yaml", *keys, "--minimise", METRIC, "--cases", "40", "--no-plots")
    with sweeps.started(*command, "--workers", "2", cwd=tmp_path) as process:
        sweeps.wait_for_chunks(process, tmp_path / sweeps.PART, 3)
        process.kill()
        outcome_of(process)
    sweeps.wait_for(lambda: sweeps.none_left(tmp_path))
    assert not sweeps.FOLDER.exists()
    assert hilc(*command, "-q", "--resume") == DONE
    killed = tables(sweeps.FOLDER)
    assert hilc(*command, "-q", "--out", "whole") == DONE
    assert tables(Path("whole")) == killed


def test_cases_that_fail_are_the_worst(hilc: Hilc) -> None:
    experiment = Plan.experiment

    def fails(self: Plan, values: Mapping[str, Value]) -> Experiment:
        gain = values.get(L1, 0)
        if isinstance(gain, float) and gain > 12:
            raise UsageError("no such gain")
        return experiment(self, values)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Plan, "experiment", fails)
        outcome = hilc(*SEARCH)
        assert outcome.code == 3
        assert outcome.err.endswith("--resume tries these cases again\n")
        rows = table()
        done = [row for row in rows if row["diverged"]]
        assert max(float(row[L1]) for row in done) <= 12
        assert all(float(row[L1]) > 12 for row in rows if row not in done)
        assert 24 < len(done) < 40  # 24 by chance
        best = min(done, key=lambda row: float(row[METRIC]))
        assert float(best[L1]) == pytest.approx(10, abs=20 / 39 / 2)
        assert hilc(*SEARCH, "--resume").code == 3
        assert table() == rows
        stopped = hilc(*SEARCH, "--fail-fast", "--out", "fast")
        assert stopped.code == 3
        assert stopped.err.splitlines()[-1].endswith("failed: no such gain")
    # What failed may have been known wrongly: the search takes another course from there on.
    assert hilc(*SEARCH, "--resume") == DONE
    assert tables(sweeps.FOLDER) == expected()


def test_optuna_is_an_extra(hilc: Hilc, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = listing(folder)
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "optuna", None)
        outcome = hilc(*SEARCH)
    message = (
        "hilc: --minimise needs the package optuna; pip install '.[tune]' in a checkout of hilc\n"
    )
    assert outcome == Outcome(2, "", message)
    assert listing(folder) == before


def test_pictures_of_a_search(hilc: Hilc) -> None:
    command = [word for word in SEARCH if word != "--no-plots"]
    assert hilc(*command) == DONE
    assert {path.name for path in sweeps.FOLDER.glob("*.png")} == {"curve.png", "search.png"}
    picture = (sweeps.FOLDER / "search.png").read_bytes()
    (sweeps.FOLDER / "search.png").unlink()
    assert hilc("plot", str(sweeps.FOLDER), "--kind", "search").code == 0
    assert (sweeps.FOLDER / "search.png").read_bytes() == picture


def test_search_is_no_shard(hilc: Hilc) -> None:
    stop_at_the_end(hilc)
    outcome = hilc("sweep", "--merge", str(sweeps.PART))
    assert outcome == Outcome(
        2, "", f"hilc: {sweeps.PART}: is a search under way, no shard; finish it with --resume\n"
    )


def test_dry_run(hilc: Hilc, folder: Path) -> None:
    before = listing(folder)
    outcome = hilc(*SEARCH, "--dry-run", "--json")
    document = json.loads(outcome.out)
    assert (outcome.code, document["cases"], document["samples"]) == (0, 40, 40 * 4)
    assert listing(folder) == before
