"""Whatever takes a scenario, a run or a result takes it in each of its forms, alike."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import hilc_cli as hilc_api
from hilc_cli.errors import HilcError, InvalidInputError, UsageError
from hilc_cli.shipped_files import resolve_example
from tests.cli.inputs import SCENARIO, TRAJECTORY
from tests.conftest import Write
from tests.labs.robots import scenario
from tests.leaderboards.test_leaderboard_folder import DATA, write as write_leaderboard
from tests.made_up_runs import MakeRun

ONE = hilc_api.Execution(workers=1)
EXAMPLE = "example:turn-in-place"


def in_each_form(folder: Path) -> dict[str, Any]:
    """The same scenario by its name, as a file in several ways, as data, and read."""
    data = yaml.safe_load(resolve_example(EXAMPLE).read_text(encoding="utf-8"))
    data["trajectory"] = EXAMPLE
    saved = hilc_api.load_scenario(EXAMPLE)
    (folder / "saved.yaml").write_text(saved.resolved_yaml(), encoding="utf-8")
    return {
        "name": EXAMPLE,
        "file": "saved.yaml",
        "path": folder / "saved.yaml",
        "data": data,
        "scenario": saved,
    }


def equal(first: Any, second: Any) -> None:
    """Whether two tables are the same, to the bit."""
    assert list(first.columns) == list(second.columns)
    for name in first.columns:
        np.testing.assert_array_equal(first[name].to_numpy(), second[name].to_numpy(), name)


@pytest.mark.parametrize(
    "table",
    [
        lambda source: hilc_api.run(source).to_pandas("samples"),
        lambda source: hilc_api.show(source).to_pandas(),
        lambda source: hilc_api.sweep(
            hilc_api.plan_sweep(source, {"robot.wheel_radius": [0.03, 0.04]}), ONE
        ).to_pandas(),
        lambda source: hilc_api.Lab.start(source, "lab", trust=False).run.reference.poses,
    ],
    ids=["run", "show", "sweep", "lab"],
)
def test_all_forms_of_a_scenario_give_the_same(table: Callable[[Any], Any], folder: Path) -> None:
    results = []
    for name, source in in_each_form(folder).items():
        (folder / name).mkdir()
        with pytest.MonkeyPatch.context() as patched:
            if name != "file":
                patched.chdir(folder / name)
            results.append(table(source))
        if (folder / "lab").exists():
            (folder / "lab").rename(folder / "lab-of-file")
    first, *others = results
    assert len(others) == 4
    for other in others:
        if isinstance(first, np.ndarray):
            np.testing.assert_array_equal(first, other)
        else:
            equal(first, other)


def test_all_forms_of_a_scenario_are_checked_alike(folder: Path) -> None:
    forms = in_each_form(folder)
    told = {repr(hilc_api.check(source)) for source in forms.values()}
    assert len(told) == 1
    for source in forms.values():
        hilc_api.check_folder(source, "free")
        assert hilc_api.load_scenario(source).resolved() == forms["scenario"].resolved()


def test_a_sweep_of_a_scenario_with_a_section_in_each_form(write: Write) -> None:
    section = "sweep: {vary: {controller.gains.l1: [0.1, 0.5]}}\n"
    write({"scenario.yaml": SCENARIO + section})
    data = {**yaml.safe_load(SCENARIO), **yaml.safe_load(section)}
    read = hilc_api.load_scenario("scenario.yaml")
    first = hilc_api.sweep("scenario.yaml", ONE).to_pandas()
    for source in (data, read, hilc_api.plan_sweep(read)):
        equal(first, hilc_api.sweep(source, ONE).to_pandas())
    for form in ("scenario.yaml", data):
        assert hilc_api.sweep_shard(form, (1, 2), "part", ONE, force=True) == []


def test_a_wrong_key_is_told_alike_of_a_file_and_of_data(write: Write) -> None:
    write({"scenario.yaml": SCENARIO.replace("wheel_radius", "wheel_radus")})
    data = {**yaml.safe_load(SCENARIO), "trajectory": yaml.safe_load(TRAJECTORY)}
    data["robot"]["wheel_radus"] = data["robot"].pop("wheel_radius")
    problems = []
    for source in ("scenario.yaml", data):
        with pytest.raises(InvalidInputError) as caught:
            hilc_api.run(source)
        problems.append([(each.path, each.message) for each in caught.value.problems])
    assert problems[0] == problems[1]
    assert ("robot.wheel_radus", "is an unknown key; did you mean 'wheel_radius'?") in problems[0]


@pytest.mark.parametrize(
    "call",
    [
        hilc_api.run,
        hilc_api.check,
        hilc_api.load_scenario,
        hilc_api.plan_sweep,
        hilc_api.sweep,
        lambda source: hilc_api.Lab.start(source, "lab"),
        lambda source: hilc_api.check_folder(source, "x"),
        lambda source: hilc_api.sweep_shard(source, (1, 2), "x"),
    ],
)
@pytest.mark.parametrize("wrong", [3, None, ["example:fig3-circle"], b"example:fig3-circle"])
def test_what_is_no_scenario_is_told(call: Callable[[Any], object], wrong: object) -> None:
    told = f"a scenario is a file, example:NAME, a dictionary.*got {type(wrong).__name__}"
    with pytest.raises(UsageError, match=told):
        call(wrong)


@pytest.mark.parametrize(
    "call",
    [
        lambda: hilc_api.run({1: 2}),  # type: ignore[dict-item]
        lambda: hilc_api.run({"name": "a", 1: 2}),  # type: ignore[dict-item]
        lambda: hilc_api.load_scenario("example:fig3-circle", overrides={1: 3}),  # type: ignore[dict-item]
        lambda: hilc_api.load_case("runs/none", "3"),  # type: ignore[arg-type]
    ],
)
def test_keys_and_numbers_of_another_kind_are_told(call: Callable[[], object]) -> None:
    with pytest.raises(hilc_api.HilcError, match=r"unknown key|must be a"):
        call()


def test_a_run_is_no_scenario(make_run: MakeRun) -> None:
    with pytest.raises(UsageError, match="got RunData"):
        hilc_api.run(make_run())  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"a scenario or trajectory is a file.*got RunData"):
        hilc_api.show(make_run())  # type: ignore[arg-type]
    with pytest.raises(UsageError, match=r"a leaderboard is a file.*got RunData"):
        hilc_api.compare_laws(make_run())  # type: ignore[arg-type]


def test_overrides_of_what_has_been_read_are_refused(folder: Path) -> None:
    read = hilc_api.load_scenario(scenario())
    for call in (
        lambda: hilc_api.load_scenario(read, {"iterations": 2}),
        lambda: hilc_api.show(read, {"iterations": 2}),
        lambda: hilc_api.show(read.spec.trajectory, ["timing.speed=0.1"]),
        lambda: hilc_api.Lab.start(read, folder / "lab", {"iterations": 2}),
    ):
        with pytest.raises(UsageError, match=r"bend: has been read already.*give them to load_sc"):
            call()
    assert hilc_api.load_scenario(read) is read
    assert not (folder / "lab").exists()


def test_runs_and_their_folders_are_taken_alike(folder: Path) -> None:
    run = hilc_api.run(scenario(iterations=1))
    run.write("run", plots=False)
    forms: tuple[hilc_api.RunData | str | Path, ...] = (run, "run", Path("run"))
    for number, source in enumerate(forms):
        hilc_api.plot(source, f"{number}", kinds=["error"], formats=["svg"])
        hilc_api.plot([source], f"{number}/list", kinds=["error"], formats=["svg"])
        hilc_api.export(source, f"{number}/exported", ["csv"])
        equal(hilc_api.compare([source, run]).to_pandas(), hilc_api.compare([run, run]).to_pandas())
    of_first = {file.relative_to("0"): file.read_bytes() for file in Path("0").rglob("*.*")
                if file.name != "export.json" and file.is_file()}  # fmt: skip
    assert len(of_first) > 3
    for other in "12":
        for name, content in of_first.items():
            assert (Path(other) / name).read_bytes() == content, (other, name)


def test_results_and_their_folders_are_reported_and_drawn_alike(
    make_run: MakeRun, write: Write, folder: Path
) -> None:
    write()
    sweep = hilc_api.sweep(hilc_api.plan_sweep("scenario.yaml", {"iterations": [1, 2]}), ONE)
    sweep.write("sweep", plots=False)
    write_leaderboard(folder / "laws", DATA)
    laws = hilc_api.LawComparison(DATA, "", {})
    hilc_api.report([laws, sweep], "memory.html")
    hilc_api.report(["laws", Path("sweep")], "folders.html")
    assert Path("memory.html").read_bytes() == Path("folders.html").read_bytes()
    run = make_run("r")
    assert b"The last path" in hilc_api.report(run, "run.html").read_bytes()
    drawn = [hilc_api.plot_sweep(sweep, "s", formats=["svg"])]
    drawn += [hilc_api.plot_sweep("sweep", "sf", formats=["svg"])]
    drawn += [hilc_api.plot_leaderboard(laws, "l", formats=["svg"])]
    drawn += [hilc_api.plot_leaderboard(DATA, "ld", formats=["svg"])]
    drawn += [hilc_api.plot_leaderboard(folder / "laws", "lf", formats=["svg"])]
    contents = [[file.read_bytes() for file in files] for files in drawn]
    assert contents[0] == contents[1]
    assert contents[2] == contents[3] == contents[4]


@pytest.mark.parametrize(
    "call",
    [
        lambda wrong: hilc_api.plot(wrong, "x"),
        lambda wrong: hilc_api.plot([wrong], "x"),
        lambda wrong: hilc_api.compare([wrong, wrong]),
        lambda wrong: hilc_api.export(wrong, "x"),
        lambda wrong: hilc_api.report(wrong, "x.html"),
        lambda wrong: hilc_api.report([wrong], "x.html"),
    ],
)
@pytest.mark.parametrize("wrong", [3, None, hilc_api.load_scenario(EXAMPLE)])
def test_what_is_no_result_is_told(
    call: Callable[[Any], object], wrong: object, folder: Path
) -> None:
    with pytest.raises(HilcError, match=f"(a run is what|a report is of) .*{type(wrong).__name__}"):
        call(wrong)
    assert not list(folder.iterdir())
