"""The Python interface: load, run, write, read, plot, without printing."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli import HilcError
from hilc_cli.errors import (
    DivergedError,
    ExistingResultsError,
    FileAccessError,
    InvalidInputError,
    UsageError,
)
from hilc_cli.spec.hybrid import HybridController
from hilc_cli.spec.scenario import ScenarioSpec
from tests.cli.inputs import SCENARIO, scenario
from tests.conftest import Write

pytestmark = pytest.mark.usefixtures("inputs")


@pytest.fixture
def inputs(write: Write) -> None:
    write()


def l1_of(spec: ScenarioSpec) -> float:
    assert isinstance(spec.controller, HybridController)
    return spec.controller.gains.l1


def test_everything_that_is_exported_is_there() -> None:
    for name in hilc_api.__all__:
        assert getattr(hilc_api, name) is not None


def test_name_that_is_not_exported_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="hilc_cli"):
        hilc_api.nonsense  # noqa: B018


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
        ("n" * 300, {}, FileAccessError, 1),
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
