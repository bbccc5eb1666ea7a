"""The Python interface: load, run, write, read, plot, without printing."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import hilc_cli as hilc_api
from hilc_cli import HilcError
from hilc_cli.errors import (
    DivergedError,
    ExistingResultsError,
    InvalidInputError,
    UsageError,
)
from hilc_cli.laws.hybrid import HybridController
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.theory.learning import transient
from tests.cli.inputs import SCENARIO, scenario
from tests.conftest import Write

L1 = "controller.gains.l1"

pytestmark = pytest.mark.usefixtures("inputs")


@pytest.fixture
def inputs(write: Write) -> None:
    write()


def l1_of(spec: ScenarioSpec) -> float:
    assert isinstance(spec.controller, HybridController)
    return spec.controller.gains.l1


def test_everything_that_is_exported_is_there() -> None:
    for name in dir(hilc_api):
        assert getattr(hilc_api, name) is not None


def test_name_that_is_not_exported_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="hilc_cli"):
        getattr(hilc_api, "nonsense")  # noqa: B009


def test_overrides_by_dotted_key() -> None:
    overrides = {
        "iterations": 7,
        "controller.gains.l1": "1/4",
        "robot.gravity_center": [1, "2 cm"],
        "controller.b_w": None,
        "record": {"iterations": "all"},
        "trajectory.segments.0.line.length": 2,
    }
    spec = hilc_api.load_scenario("scenario.yaml", overrides).spec
    assert spec.iterations == 7
    assert l1_of(spec) == 0.25
    assert spec.robot.gravity_center == (1.0, 0.02)
    assert spec.controller.b_w is None
    assert spec.record.iterations == "all"
    assert spec.trajectory.reference().x[-1] == 2


def test_overrides_as_on_the_command_line() -> None:
    texts = ["iterations=7", "controller.gains.l1=1/4", "initial_pose={y: 10 cm}", "name='017'"]
    spec = hilc_api.load_scenario("scenario.yaml", texts).spec
    assert (spec.iterations, l1_of(spec)) == (7, 0.25)
    assert spec.initial_pose.y == 0.1
    assert spec.name == "017"


def test_last_override_counts() -> None:
    texts = ["iterations=7", "iterations=8", "controller={gains: {l1: 1}}", "controller.h=2"]
    spec = hilc_api.load_scenario("scenario.yaml", texts).spec
    assert spec.iterations == 8
    assert (l1_of(spec), spec.controller.b_w) == (1, None)
    assert isinstance(spec.controller, HybridController) and spec.controller.h == 2


def test_path_may_be_a_path(folder: Path) -> None:
    assert hilc_api.load_scenario(folder / "scenario.yaml").name == "test"


def test_relative_paths_start_at_the_file_that_holds_them(folder: Path) -> None:
    (folder / "deep").mkdir()
    (folder / "deep/scenario.yaml").write_text(scenario("path.yaml", "../path.yaml"))
    assert hilc_api.load_scenario("deep/scenario.yaml").spec.trajectory.name == "path"


def test_relative_path_of_an_override_starts_at_the_working_folder(folder: Path) -> None:
    (folder / "deep").mkdir()
    (folder / "deep/scenario.yaml").write_text(SCENARIO)
    loaded = hilc_api.load_scenario("deep/scenario.yaml", {"trajectory": "path.yaml"})
    assert loaded.spec.trajectory.name == "path"


def test_inline_trajectory() -> None:
    path = {
        "name": "inline",
        "sample_time": "1/2",
        "start": {"x": 0, "y": 0, "heading": "pi/2"},
        "segments": [{"line": {"length": 1, "duration": 1}}],
    }
    reference = hilc_api.load_scenario("scenario.yaml", {"trajectory": path}).experiment().reference
    assert (reference.name, reference.samples) == ("inline", 2)
    np.testing.assert_allclose(reference.y, [0, 0.5, 1], atol=1e-15)


@pytest.mark.parametrize(
    ("path", "overrides", "error", "code"),
    [
        ("nosuch.yaml", {}, UsageError, 2),
        ("scenario.yaml", {"iterations": -1}, InvalidInputError, 2),
        ("scenario.yaml", {"iterations": float("nan")}, InvalidInputError, 2),
        ("scenario.yaml", {"iterations": object()}, InvalidInputError, 2),
        ("scenario.yaml", {"iterations": b"1"}, InvalidInputError, 2),
        ("scenario.yaml", {"": 1}, InvalidInputError, 2),
        ("scenario.yaml", {"a..b": 1}, InvalidInputError, 2),
        ("scenario.yaml", ["iterations"], InvalidInputError, 2),
        ("n" * 300, {}, UsageError, 2),
    ],
)
def test_failures_are_hilc_errors(
    path: str, overrides: dict[str, object], error: type[HilcError], code: int
) -> None:
    with pytest.raises(error) as caught:
        hilc_api.load_scenario(path, overrides)
    assert isinstance(caught.value, HilcError)
    assert caught.value.exit_code == code
    assert str(caught.value)


def test_problems_can_be_taken_apart() -> None:
    with pytest.raises(InvalidInputError) as caught:
        hilc_api.load_scenario("scenario.yaml", {"iterations": -1, "controller.h": 0})
    assert {problem.path for problem in caught.value.problems} == {"iterations", "controller.h"}


def test_numbers_of_numpy_are_numbers() -> None:
    overrides = {
        "iterations": np.int64(3),
        "controller.gains.l1": np.float64(0.25),
        "robot.gravity_center": np.array([1.0, 2.0]).tolist(),
    }
    spec = hilc_api.load_scenario("scenario.yaml", overrides).spec
    assert (spec.iterations, l1_of(spec)) == (3, 0.25)


def test_run_holds_metrics_and_paths() -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    assert len(run.metrics) == 3
    assert run.metrics["max_position_error_m"].shape == (3,)
    assert run.trials[0].x.shape == (4,)
    assert run.trials[0].left.shape == (3,)
    assert run.learned_input[0].tolist() == run.trials[2].left.tolist()
    assert run.position_error(0)[-1] == pytest.approx(1)
    assert run.diverged_at is None


def test_run_tells_of_each_iteration() -> None:
    told: list[int] = []

    def tell(iteration: int) -> None:
        told.append(iteration)

    hilc_api.run(hilc_api.load_scenario("scenario.yaml"), on_iteration=tell)
    assert told == [0, 1, 2]


def test_nothing_is_printed_or_written(folder: Path, capfd: pytest.CaptureFixture[str]) -> None:
    before = sorted(folder.rglob("*"))
    overrides = {"initial_pose.y": 1, "controller.gains.l2": 1}
    loaded = hilc_api.load_scenario("scenario.yaml", overrides)
    assert loaded.warnings()
    hilc_api.run(loaded).summary()
    assert capfd.readouterr() == ("", "")
    assert sorted(folder.rglob("*")) == before


def test_same_scenario_runs_twice_alike() -> None:
    loaded = hilc_api.load_scenario("scenario.yaml", {"disturbance.state.bound": [0.1, 0.1, 0.1]})
    one, other = hilc_api.run(loaded), hilc_api.run(loaded)
    np.testing.assert_array_equal(one.last.x, other.last.x)


def test_written_run_reads_back(folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    run.write(folder / "out", plots=False)
    read = hilc_api.read_run(folder / "out")
    for number, trial in run.trials.items():
        np.testing.assert_array_equal(read.trials[number].x, trial.x)
        np.testing.assert_array_equal(read.trials[number].left, trial.left)
    for name in ("max_position_error_m", "input_change_rms_rad_s"):
        np.testing.assert_array_equal(read.metrics[name], run.metrics[name])
    assert read.gravity_center == run.gravity_center


def test_gravity_center_reads_back(folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml", {"robot.gravity_center": [1, 2]}))
    run.write(folder / "out", plots=False)
    read = hilc_api.read_run(folder / "out")
    np.testing.assert_array_equal(read.gravity_center_path(0), run.gravity_center_path(0))


def test_write_keeps_the_rules_of_the_command_line(folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    other = hilc_api.run(hilc_api.load_scenario("scenario.yaml", {"iterations": 1}))
    run.write("out", plots=False)
    run.write("out", plots=False)
    with pytest.raises(ExistingResultsError, match="--force"):
        other.write("out", plots=False)
    other.write("out", plots=False, force=True)
    assert len(hilc_api.read_run("out").metrics) == 2


def test_unknown_format_writes_nothing(folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    with pytest.raises(UsageError, match="jpg"):
        run.write("out", formats=["jpg"])
    assert not (folder / "out").exists()


def test_plot_of_a_run_in_memory(folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    drawn = hilc_api.plot([run], "pictures", kinds=["error"], formats=["svg", "png"])
    assert sorted(drawn) == [Path("pictures/error.png"), Path("pictures/error.svg")]
    assert all((folder / path).stat().st_size > 1000 for path in drawn)


def test_comparison_of_runs_in_memory(folder: Path) -> None:
    runs = [
        hilc_api.run(hilc_api.load_scenario("scenario.yaml", {"name": name, "iterations": 3}))
        for name in ("a", "b")
    ]
    comparison = hilc_api.compare(runs)
    assert comparison.table.values("run") == ["a", "b"]
    assert comparison.table.values("iterations") == [3, 3]
    errors = [run.metrics["max_position_error_m"][-1] for run in runs]
    assert comparison.table.values("max_position_error_m") == errors
    files = comparison.write("out", plots=False)
    assert files == [Path("out") / f"comparison.{kind}" for kind in ("csv", "md", "tex")]
    assert comparison.text("csv") == files[0].read_text()
    with pytest.raises(UsageError, match="unknown kind of table 'markdwn'; did you mean 'markdo"):
        comparison.text("markdwn")
    with pytest.raises(UsageError, match="at least two runs"):
        hilc_api.compare(runs[:1])
    with pytest.raises(UsageError, match="unknown picture format 'gif'"):
        comparison.write("new", formats=["gif"])
    assert not (folder / "new").exists()


def test_plot_of_an_unknown_kind_makes_no_folder(folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    with pytest.raises(UsageError, match="did you mean 'error'"):
        hilc_api.plot([run], "pictures", kinds=["eror"])
    assert not (folder / "pictures").exists()


def test_run_that_diverges_at_once_is_an_error(folder: Path) -> None:
    content = "sample,t_s,left_wheel_rad_s,right_wheel_rad_s\n" + "".join(
        f"{k},{k / 10},1e308,-1e308\n" for k in range(3)
    )
    (folder / "input.csv").write_text(content)
    overrides = {"initial_input": "input.csv", "controller.b_w": None}
    with pytest.raises(DivergedError) as caught:
        hilc_api.run(hilc_api.load_scenario("scenario.yaml", overrides))
    assert (caught.value.iteration, caught.value.exit_code) == (0, 3)


def test_scenario_of_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    stdin = io.TextIOWrapper(io.BytesIO(SCENARIO.encode()))
    monkeypatch.setattr("sys.stdin", stdin)
    assert hilc_api.load_scenario("-").name == "test"


def test_scenarios_are_taken_as_they_come(folder: Path) -> None:
    (folder / "deeper").mkdir()
    data = yaml.safe_load(SCENARIO)
    whole = {**data, "trajectory": yaml.safe_load((folder / "path.yaml").read_text())}
    (folder / "whole.yaml").write_text(yaml.safe_dump(whole))
    sources: list[Any] = [hilc_api.load_scenario("scenario.yaml"), "scenario.yaml", data, whole]
    sources += [folder / "scenario.yaml", {**data, "iterations": np.int64(2)}]
    errors = [hilc_api.run(source).metrics["max_position_error_m"] for source in sources]
    for each in errors[1:]:
        np.testing.assert_array_equal(each, errors[0])
    for source in sources[1:4]:
        assert hilc_api.check(source).scenario.name == "test"
        plan = hilc_api.plan_sweep(source, {"controller.gains.l1": [0.1, 0.2]})
        assert plan.checksum() == hilc_api.plan_sweep(sources[0], {L1: [0.1, 0.2]}).checksum()
        hilc_api.check_folder(source, "nowhere")
    assert len(hilc_api.sweep({**data, "sweep": {"vary": {L1: "0.1:0.4:4"}}})) == 4
    assert hilc_api.check("example:feedback-circle").scenario.name == "feedback-circle"
    changed = hilc_api.load_scenario(data, {"iterations": 1})
    assert changed.spec.iterations == 1 and data["iterations"] == 2


def test_problems_of_data_name_the_key() -> None:
    data = {**yaml.safe_load(SCENARIO), "iterations": -4, "modell": {}}
    with pytest.raises(InvalidInputError) as caught:
        hilc_api.run(data)
    assert [str(problem).partition(", got")[0] for problem in caught.value.problems] == [
        "scenario: iterations: must be at least 0",
        "scenario: modell: is an unknown key; did you mean 'model'?",
    ]


def test_runs_are_taken_as_they_come(folder: Path) -> None:
    run = hilc_api.run("scenario.yaml")
    for name in ("runs/a", "runs/b"):
        run.write(name, plots=False)
    table = hilc_api.compare(["runs/a", folder / "runs/b"]).table
    assert table.values("run") == ["a", "b"]
    assert hilc_api.compare([run, "runs/a"]).table.values("run") == ["test", "test (2)"]
    for runs in (run, "runs/a", [run]):
        assert hilc_api.plot(runs, f"p{id(runs)}", kinds=["error"], formats=["svg"])


def test_leaderboard_from_data(folder: Path) -> None:
    case = "scenario.yaml"
    data = {"name": "few", "cases": {"one": case}, "laws": {"paper": {"gains": {"l1": 1}}}}
    result = hilc_api.compare_laws({**data, "after": [1], "b_w": 180}, workers=1)
    assert [entry.law for entry in result.data.entries] == ["paper"]
    assert_short(result, result.data, hilc_api.load_leaderboard(data), result.settings)


def assert_short(*results: object) -> None:
    for result in results:
        lines = repr(result).splitlines()
        assert 1 <= len(lines) <= 6, repr(result)
        assert max(map(len, lines)) <= 100, repr(result)
        assert not re.search(r"array\(|<[\w.]+ object at", repr(result))


def coarse(name: str) -> hilc_api.Scenario:
    return hilc_api.load_scenario(f"example:{name}", {"trajectory.sample_time": "10 ms"})


def test_results_show_themselves_in_a_few_lines() -> None:
    run = hilc_api.run(hilc_api.load_scenario("example:fig8a", {"iterations": 5}))
    run.write("runs/one", plots=False)
    assert_short(run, run.summary(), run.metrics, run.learning, run.last, run.reference)
    assert_short(run.scenario, run.trials, hilc_api.read_run("runs/one"))
    assert_short(hilc_api.check(coarse("fig6c")).forecast, hilc_api.compare([run, run]))
    plan = hilc_api.plan_sweep("scenario.yaml", {L1: "1e-3:1:500:log", "trajectory": ["path.yaml"]})
    sweep = hilc_api.sweep(plan)
    assert_short(plan, sweep, sweep.columns, sweep.values, sweep.summary())
    assert_short(hilc_api.plan_reproduction(["fig3"]))
    assert f"Run 'fig8a': {run.reference.name}" in repr(run)
    assert f"{run.metrics['max_position_error_m'][-1]:.6g}" in repr(run)


def test_check_shows_the_verdict_of_the_command_line_and_whole_sentences(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 200)
    for name, verdict in (("fig8a", "works"), ("fig8c", "cannot work"), ("fig3-circle", "works")):
        found = hilc_api.check(coarse(name))
        first, *lines = repr(found).splitlines()
        assert first == f"Check of {name!r}: {found.verdict}"
        assert found.verdict.startswith(f"{verdict}, ")
        assert max(map(len, lines)) <= 100
        shown = " ".join(" ".join(lines).split())
        told = [*found.failures, *(f"warning: {text}" for text in found.warnings)][:4]
        assert all(text in shown for text in told)
        assert "..." not in shown


def test_names_that_are_not_there_are_told_with_those_that_are() -> None:
    run = hilc_api.run("scenario.yaml")
    sweep = hilc_api.sweep(hilc_api.plan_sweep("scenario.yaml", {L1: [0.1, 0.2]}))
    table = hilc_api.compare([run, run]).table
    asked: list[tuple[Callable[[], object], str]] = [
        (
            lambda: run.metrics["mean_positon_error_m"],
            "there is no metric 'mean_positon_error_m'; did you mean 'mean_position_error_m'? "
            "known: max_position_error_m, ",
        ),
        (
            lambda: run.learning["wheel_radius_m"],
            "there is no figure 'wheel_radius_m'; known: none",
        ),
        (lambda: run.trials[17], "there is no recorded iteration 17; known: 0, 1, 2"),
        (lambda: run.position_error(9), "there is no recorded iteration 9; known: 0, 1, 2"),
        (
            lambda: sweep.columns["diverge"],
            "there is no column 'diverge'; did you mean 'diverged'?",
        ),
        (lambda: sweep.values["l1"], f"there is no varied key 'l1'; known: {L1}"),
        (lambda: table.values("runs"), "there is no column 'runs'; did you mean 'run'? known: run"),
    ]
    for ask, message in asked:
        with pytest.raises(KeyError) as caught:
            ask()
        assert isinstance(caught.value, HilcError)
        assert str(caught.value).startswith(message)
