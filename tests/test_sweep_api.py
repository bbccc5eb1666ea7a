"""The Python interface to sweeps."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.sweeps.search import value_of
from tests.cli.inputs import plus
from tests.conftest import Hilc, Write

L1 = "controller.gains.l1"
VARY = {L1: np.linspace(0.1, 1, 4), "controller.b_w": [None, 5]}


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write()


def test_sweep_in_memory_is_that_of_the_command(hilc: Hilc, folder: Path) -> None:
    plan = hilc_api.plan_sweep(hilc_api.load_scenario("scenario.yaml"), VARY, tolerance="1 m")
    result = hilc_api.sweep(plan)
    result.write("mine", plots=False)
    texts = ("--vary", f"{L1}=0.1:1:4", "--vary", "controller.b_w=null,5", "--tolerance", "1")
    assert hilc("sweep", "scenario.yaml", *texts, "--no-plots", "-q", "--out", "its").code == 0
    assert (folder / "mine/cases.csv").read_bytes() == (folder / "its/cases.csv").read_bytes()
    read = hilc_api.read_sweep("its")
    for name, column in result.columns.items():
        np.testing.assert_array_equal(read.columns[name], column)
    assert {key: list(column) for key, column in read.values.items()} == {
        key: list(column) for key, column in result.values.items()
    }
    assert (read.name, read.tolerance, read.metric) == ("test", 1, "max_position_error_m")
    assert read.path_size == plan.scenario.experiment().reference.size > 0
    assert [read.case(number) for number in range(len(read))] == plan.cases.values(0, 8)


def test_scenario_with_a_section_is_swept_as_it_is(write: Write) -> None:
    write({"scenario.yaml": plus("sweep: {vary: {controller.gains.l1: [1, 2]}, bands: true}\n")})
    result = hilc_api.sweep(hilc_api.load_scenario("scenario.yaml"))
    assert (len(result), result.case(1)) == (2, {L1: 2})
    assert result.bands is not None
    assert result.bands.cases.tolist() == [2, 2, 2]


def test_another_sweep_is_replaced_by_force_only() -> None:
    scenario = hilc_api.load_scenario("scenario.yaml")
    one, other = (
        hilc_api.sweep(hilc_api.plan_sweep(scenario, {L1: values})) for values in ([1, 2], [3])
    )
    one.write("out", plots=False)
    one.write("out", plots=False)
    with pytest.raises(ExistingResultsError):
        other.write("out", plots=False)
    other.write("out", plots=False, force=True)
    assert len(hilc_api.read_sweep("out")) == 1


def test_summary_ranks_cases_that_completed() -> None:
    scenario = hilc_api.load_scenario("scenario.yaml", {"iterations": 300, "controller.b_w": None})
    summary = hilc_api.sweep(
        hilc_api.plan_sweep(scenario, {L1: [1e4, 0.1, 0.5]}, tolerance=1e-3)
    ).summary()
    assert (summary.cases, summary.diverged, summary.failed) == (3, 1, 0)
    assert {case.case for case in summary.best} == {1, 2}
    assert summary.within_tolerance is not None
    assert summary.within_tolerance <= 2


def test_folder_that_is_no_sweep_is_told(folder: Path) -> None:
    with pytest.raises(UsageError, match="is no sweep folder"):
        hilc_api.read_sweep(folder)
    (folder / "sweep.json").write_text('{"kind": "hilc sweep"}')
    with pytest.raises(UsageError, match=r"sweep\.json: is damaged: name: field required"):
        hilc_api.read_sweep(folder)


def test_interface_loads_when_it_is_used() -> None:
    program = (
        "import sys, hilc_cli as hilc\n"
        "assert 'numpy' not in sys.modules\n"
        "import hilc_cli.sweeps, hilc_cli.sweeps.data, hilc_cli.cli.sweep\n"
        "assert callable(hilc.sweep) and callable(hilc.plan_sweep) and callable(hilc.read_sweep)\n"
        "import hilc_cli.sweeps.sweeping, hilc_cli.sweeps.search\n"
        "assert callable(hilc.sweep)\n"
        "small = hilc.load_scenario('example:fig3-circle', {'iterations': 0})\n"
        "assert len(hilc.run(small).metrics) and hilc.show(small) and repr(hilc.check(small))\n"
        "late = {'matplotlib', 'distributed', 'optuna', 'pandas', 'jinja2'}\n"
        "assert not (late | {'hilc_cli.html_reports'}) & set(sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=False)
    assert (done.returncode, done.stderr.decode()) == (0, "")


@pytest.mark.parametrize(
    ("set_", "separations"),
    [
        ({"robot.half_track": 0.25, "model": {"wheel_separation": 0.62}}, (0.5, 0.62, 0.31)),
        ({"robot.half_track": 0.25}, (0.5, 0.5, 0.25)),
    ],
)
def test_search_tells_keys_by_whatever_name_and_by_default(
    set_: dict[str, object], separations: tuple[float, float, float]
) -> None:
    scenario = hilc_api.load_scenario("scenario.yaml", {**set_, "iterations": 0})
    own = scenario.resolved()
    keys = ("robot.wheel_separation", "model.wheel_separation", "model.half_track")
    told = [value_of(own, key) for key in keys]
    assert told == pytest.approx(separations)
    assert value_of(own, "model.wheel_radius") == own["robot"]["wheel_radius"]
