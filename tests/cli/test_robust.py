"""``hilc sweep --over --robust``: the choice that stands most of what may happen.

The robot's wheels are r times as large as the model's, so that each iteration of the line of one
sample leaves the factor 1 - d_t l1 r of the error, and the error after iteration N is
L |1 - d_t l1 r|^N. Over r from 0.8 to 1.2 the worst case is smallest at d_t l1 = 1.
"""

from __future__ import annotations

import csv
import json
import statistics
from collections.abc import Callable
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from tests.cli import sweeps
from tests.cli.inputs import listing
from tests.cli.searches import FILES, ITERATIONS, L1, L2, LENGTH, METRIC, SAMPLE_TIME, SCENARIO
from tests.conftest import Hilc, Outcome, Write

RADIUS = "robot.wheel_radius"
MODEL = "model: {wheel_radius: 0.2, half_track: 0.5}\n"
SWEEP = ("sweep", "scenario.yaml", "--no-plots", "-q")
GAINS, RADII = f"{L1}=6:14:9", f"{RADIUS}=0.16:0.24:5"
GRID = (*SWEEP, "--vary", GAINS, "--vary", RADII, "--over", RADIUS)
SEARCH = ("--vary", f"{L1}=0:20", "--vary", RADII, "--over", RADIUS, "--minimise", METRIC)
DONE = Outcome(0, "", "")


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write({**FILES, "scenario.yaml": SCENARIO + MODEL})


def rows(name: str, folder: Path = sweeps.FOLDER) -> list[dict[str, str]]:
    with (folder / name).open(newline="") as file:
        return list(csv.DictReader(file))


def error(gain: float, radius: float) -> float:
    return LENGTH * abs(1 - SAMPLE_TIME * gain * radius / 0.2) ** ITERATIONS


def test_minimax_is_that_of_theory(hilc: Hilc) -> None:
    assert hilc(*GRID) == DONE
    for case in rows("cases.csv"):
        expected = error(float(case[L1]), float(case[RADIUS]))
        assert float(case[METRIC]) == pytest.approx(expected, abs=1e-12)
    choices = rows("choices.csv")
    assert [float(choice[L1]) for choice in choices] == list(range(6, 15))
    for choice in choices:
        errors = [error(float(choice[L1]), 0.2 * r) for r in (0.8, 0.9, 1, 1.1, 1.2)]
        assert float(choice[f"worst_{METRIC}"]) == pytest.approx(max(errors), abs=1e-12)
        assert float(choice[f"mean_{METRIC}"]) == pytest.approx(statistics.fmean(errors), abs=1e-12)
    best = next(choice for choice in choices if choice["rank"] == "1")
    assert (float(best[L1]), best["cases"], best["diverged"]) == (10, "5", "0")
    assert float(best[f"worst_{METRIC}"]) == pytest.approx(0.2**3, rel=1e-9)


@pytest.mark.parametrize("robust", ["worst", "mean"])
def test_six_lines_of_python_give_the_same(hilc: Hilc, robust: str) -> None:
    keys = ("--vary", f"{L1}=1:19:10", "--vary", f"{L2}=0:5:10", "--vary", RADII)
    over = ("--vary", "iterations=2,3", "--over", f"iterations,{RADIUS}", "--robust", robust)
    assert hilc(*SWEEP, *keys, *over) == DONE
    by_name: dict[str, Callable[[list[float]], float]] = {"worst": max, "mean": statistics.fmean}
    figure = by_name[robust]

    cases: dict[tuple[str, str], list[float]] = {}
    with (sweeps.FOLDER / "cases.csv").open() as file:
        for row in csv.DictReader(file):
            cases.setdefault((row[L1], row[L2]), []).append(float(row[METRIC]))
    best = min(cases, key=lambda choice: figure(cases[choice]))

    (first,) = [choice for choice in rows("choices.csv") if choice["rank"] == "1"]
    assert (first[L1], first[L2]) == best
    assert float(first[f"{robust}_{METRIC}"]) == figure(cases[best])
    assert len(cases) == 100


@pytest.mark.parametrize("sample", ["random", "sobol"])
@pytest.mark.parametrize("happenings", [None, 4])
def test_drawn_choices_meet_the_same_happenings(
    hilc: Hilc, sample: str, happenings: int | None
) -> None:
    drawn = ("--sample", sample, "--cases", "6", "--vary", f"{L1}=6:14")
    radii = ("--vary", RADII, "--over", RADIUS)
    more = () if happenings is None else ("--happenings", str(happenings))
    assert hilc(*SWEEP, *drawn, *radii, *more) == DONE
    cases, every = rows("cases.csv"), happenings or 5
    assert len(cases) == 6 * every
    met = [case[RADIUS] for case in cases]
    assert met == 6 * met[:every] and len(set(met[:every])) == every
    choices = rows("choices.csv")
    assert [choice["cases"] for choice in choices] == 6 * [str(every)]
    for number, choice in enumerate(choices):
        own = cases[every * number : every * (number + 1)]
        assert {case[L1] for case in own} == {choice[L1]}
        assert choice[f"worst_{METRIC}"] == max((case[METRIC] for case in own), key=float)
        assert cases[int(choice["worst_case"])][METRIC] == choice[f"worst_{METRIC}"]


def test_search_finds_the_minimax(hilc: Hilc) -> None:
    outcome = hilc(*SWEEP, *SEARCH, "--cases", "30", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out)
    search, choices = document["search"], document["choices"]
    assert (document["cases"], choices["choices"]) == (150, 30)
    assert search["as_it_is"]["values"] == {L1: 4}
    assert search["as_it_is"]["metric"] == pytest.approx(error(4, 0.16))
    assert search["best"]["values"][L1] == pytest.approx(10, abs=0.01)
    assert choices["best"][0]["worst"] == search["best"]["metric"] == pytest.approx(0.008, rel=0.02)
    refinement = json.loads((sweeps.FOLDER / "sweep.json").read_text())["search"]["refinement"]
    assert refinement == {"method": "Brent's within bounds", "cases": 7, "first_case": 23}


def test_section_says_the_same(hilc: Hilc) -> None:
    assert hilc(*SWEEP, *SEARCH, "--cases", "16", "--happenings", "3", "--robust", "q95") == DONE
    before = {path.name: path.read_bytes() for path in sweeps.FOLDER.glob("*.[cy]*")}
    section = f"sweep: {{vary: {{{L1}: 0:20, {RADIUS}: 0.16:0.24:5}}, over: [{RADIUS}], "
    section += f"minimise: {METRIC}, cases: 16, happenings: 3, robust: q95}}\n"
    Path("section.yaml").write_text(SCENARIO + MODEL + section)
    for file in ("section.yaml", str(sweeps.FOLDER / "scenario.yaml")):
        assert hilc("sweep", file, "--no-plots", "-q", "--force", "--out", "again") == DONE
        again = {path.name: path.read_bytes() for path in Path("again").glob("*.[cy]*")}
        assert again == before and "choices.csv" in again
    text = section.replace(f"[{RADIUS}]", f"'{RADIUS}'").replace(", robust: q95", "")
    Path("text.yaml").write_text(SCENARIO + MODEL + text)
    plan = hilc_api.plan_sweep("text.yaml", robust="mean")
    assert (plan.over, plan.robust, plan.choices, plan.happenings) == ((RADIUS,), "mean", 16, 3)


@pytest.mark.parametrize("kept", [0, 3])
def test_search_that_was_stopped_goes_on(hilc: Hilc, kept: int) -> None:
    search = (*SWEEP, *SEARCH, "--cases", "20")
    assert hilc(*search, "--out", "whole") == DONE
    with pytest.MonkeyPatch.context() as patch:

        def stop(*_: object) -> None:
            raise KeyboardInterrupt

        patch.setattr("hilc_cli.sweeps.search.own_metric", stop)
        assert hilc(*search).code == 130
    journal = sweeps.PART / "journal"
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[: 2 * kept]))
    assert hilc(*search, "--resume") == DONE
    for name in ("cases.csv", "choices.csv", "best.yaml", "scenario.yaml"):
        assert (sweeps.FOLDER / name).read_bytes() == (Path("whole") / name).read_bytes()


def test_shards_of_drawn_choices(hilc: Hilc) -> None:
    """A shard may end in the middle of a choice."""
    drawn = ("--sample", "sobol", "--cases", "7", "--vary", f"{L1}=6:14", "--vary", RADII)
    sweep = (*SWEEP, *drawn, "--over", RADIUS, "--happenings", "3")
    assert hilc(*sweep, "--out", "whole") == DONE
    for number in (1, 2):
        assert hilc(*sweep, "--shard", f"{number}/2") == DONE
    folders = [f"{sweeps.FOLDER}.{number}-of-2" for number in (2, 1)]
    assert hilc("sweep", "--merge", *folders, "--no-plots", "-q") == DONE
    for name in ("cases.csv", "choices.csv", "best.yaml", "scenario.yaml"):
        assert (sweeps.FOLDER / name).read_bytes() == (Path("whole") / name).read_bytes()


def test_divergence_is_told_and_never_best(hilc: Hilc) -> None:
    """|1 - d_t l1 r|^500 is beyond 1e140, where hilc stops, from d_t l1 r = 2.91 on."""
    gains = ("--vary", f"{L1}=15,27,60", "--vary", RADII, "--set", "iterations=500")
    outcome = hilc(
        *SWEEP, *gains, "--over", RADIUS, "--robust", "mean", "--json", "--out", str(sweeps.FOLDER)
    )
    choices = rows("choices.csv")
    counts = [int(choice["diverged"]) for choice in choices]
    assert counts == [0, sum(2.7 * r > 2.91 for r in (0.8, 0.9, 1, 1.1, 1.2)), 5] == [0, 2, 5]
    assert [choice["rank"] for choice in choices] == ["1", "", ""]
    for choice, count in zip(choices, counts, strict=True):
        assert (choice[f"worst_{METRIC}"] == "inf") == (count > 0)
        assert (choice[f"mean_{METRIC}"] == "inf") == (count > 0)
    document = json.loads(outcome.out, parse_constant=pytest.fail)["choices"]
    assert (document["choices"], document["ranked"]) == (3, 1)


def test_nothing_stands_everything(hilc: Hilc) -> None:
    gains = ("--vary", f"{L1}=80:90", "--vary", RADII, "--set", "iterations=500")
    out = ("--over", RADIUS, "--out", str(sweeps.FOLDER), "--minimise", METRIC, "--cases", "3")
    outcome = hilc(*SWEEP[:-1], *gains, *out, "--json")
    assert outcome.code == 3
    problem = f"no choice has a value of worst {METRIC}, so there is no best.yaml"
    assert outcome.err == f"hilc: {problem}\n"
    assert json.loads(outcome.out)["choices"]["best"] == []
    assert not (sweeps.FOLDER / "best.yaml").exists()
    assert {choice[f"worst_{METRIC}"] for choice in rows("choices.csv")} == {"inf"}
    outcome = hilc("run", str(sweeps.FOLDER), "--best")
    assert outcome.err == (
        f"hilc: {sweeps.FOLDER}: no choice has a value of worst {METRIC}, so there is no best one\n"
    )


def test_sizes_that_the_controller_follows_are_no_happenings() -> None:
    said = "robot.half_track may happen, but the controller believes whatever it is"
    vary = {L1: [1, 2], "robot.half_track": [0.4, 0.6]}

    def warned(over: str | None, model: object) -> str:
        scenario = hilc_api.load_scenario("example:fig8a", {"model": model})
        return "\n".join(hilc_api.plan_sweep(scenario, vary, over=over).warnings())

    assert said in warned("robot.half_track", None)
    assert said not in warned(None, None)
    assert said not in warned("robot.half_track", {"half_track": 0.5})


def test_the_luckiest_case_is_nobodys_choice(hilc: Hilc) -> None:
    outcome = hilc(*GRID, "--json")
    document = json.loads(outcome.out)
    assert document["best"] == []
    assert len(document["choices"]["best"]) == 5
    told = repr(hilc_api.read_sweep(document["folder"]))
    assert f"smallest worst {METRIC}" in told and "in case" not in told


def test_what_is_printed(hilc: Hilc) -> None:
    outcome = hilc(*(word for word in GRID if word != "-q"))
    assert (outcome.code, outcome.err) == (0, "")
    assert f"9 choices by their worst {METRIC}, over {RADIUS}" in outcome.out
    lines = [line.split() for line in outcome.out.splitlines()]
    head = ["choice", L1, "worst", "q95", "median", "mean", "diverged", "worst", "case"]
    assert head in lines
    first = lines[lines.index(head) + 2]
    assert first[:3] == ["4", "10", "0.008"] and first[-4:-1] == ["0", "of", "5"]
    assert outcome.out.endswith(f"Best scenario: {sweeps.FOLDER}/best.yaml\n")
    again = hilc(*(word for word in GRID if word != "-q"), "--resume")
    assert again.out == outcome.out


def test_dry_run_tells_choices_and_happenings(hilc: Hilc, folder: Path) -> None:
    before = listing(folder)
    outcome = hilc(*(word for word in GRID if word != "-q"), "--dry-run")
    assert "45 = 9 choices x 5 happenings" in outcome.out
    search = (*SEARCH, "--cases", "40", "--happenings", "6", "--dry-run", "--json")
    document = json.loads(hilc(*SWEEP, *search).out)
    assert (document["cases"], document["choices"], document["happenings"]) == (240, 40, 6)
    assert listing(folder) == before


def test_pictures_are_those_of_the_choices(hilc: Hilc) -> None:
    command = [word for word in GRID if word != "--no-plots"]
    assert hilc(*command) == DONE
    assert {path.name for path in sweeps.FOLDER.glob("*.png")} == {"curve.png", "spread.png"}
    spread = (sweeps.FOLDER / "spread.png").read_bytes()
    (sweeps.FOLDER / "spread.png").unlink()
    assert hilc("plot", str(sweeps.FOLDER), "--kind", "spread").code == 0
    assert (sweeps.FOLDER / "spread.png").read_bytes() == spread
    two = ("--vary", f"{L2}=0,1,2", "--vary", "disturbance.seed=1..3", "--out", "two")
    assert hilc(*command, *two, "--over", "disturbance.seed").code == 0
    assert {path.name for path in Path("two").glob("*.png")} == {
        *("bands.png", "effects.png", "map.png", "spread.png")
    }


@pytest.mark.parametrize("over", [["x"], [L1, RADIUS], [L1, L1], "x", [1]])
@pytest.mark.parametrize("file", ["sweep.json", "plan.json"])
def test_folder_of_a_stranger_may_say_anything(hilc: Hilc, file: str, over: object) -> None:
    shard = ("--shard", "1/2") if file == "plan.json" else ()
    assert hilc(*GRID, *shard) == DONE
    place = sweeps.FOLDER.with_name(f"{sweeps.FOLDER.name}.1-of-2") if shard else sweeps.FOLDER
    document = json.loads((place / file).read_text())
    (place / file).write_text(json.dumps({**document, "over": over}))
    command = ("sweep", "--merge", str(place)) if shard else ("plot", str(place))
    outcome = hilc(*command)
    assert outcome.code == 2 and outcome.err.startswith(f"hilc: {place}/{file}: is damaged: ")
    assert outcome.err.count("\n") == 1


def test_python_takes_the_same() -> None:
    plan = hilc_api.plan_sweep("scenario.yaml", [GAINS, RADII], over=[RADIUS], robust="mean")
    assert repr(plan).splitlines()[-1] == f"  over: {RADIUS}"
    result = hilc_api.sweep(plan, hilc_api.Execution(workers=1))
    table = hilc_api.choices_of(result)
    mean = [statistics.fmean(error(g, 0.2 * r) for r in (0.8, 0.9, 1, 1.1, 1.2))
            for g in range(6, 15)]  # fmt: skip
    assert table.figures["mean"] == pytest.approx(mean, abs=1e-12)
    assert table.choice(table.ranked()[0]) == {L1: 6.0 + mean.index(min(mean))}
    assert "smallest mean max_position_error_m" in repr(table)
    section = {"vary": {L1: "6:14:9", RADIUS: "0.16:0.24:5"}}
    given = {**_data(), "sweep": section}
    same = hilc_api.sweep(given, hilc_api.Execution(workers=1), over=RADIUS, robust="mean")
    assert hilc_api.choices_of(same).rank.tolist() == table.rank.tolist()
    with pytest.raises(hilc_api.HilcError, match="give them to plan_sweep"):
        hilc_api.sweep(plan, over=RADIUS)


def _data() -> dict[str, object]:
    scenario = hilc_api.load_scenario("scenario.yaml")
    return {key: part for key, part in scenario.resolved().items() if key != "sweep"}
