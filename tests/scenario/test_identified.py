"""What one run has identified, taken to another scenario."""

import re
from pathlib import Path

import pytest

import hilc_cli as hilc
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.motor import Motor

HEADER = "iteration,model_wheel_radius_m,model_half_track_m\n"


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a run that believes in other wheels after each iteration."""
    (tmp_path / "run").mkdir()
    (tmp_path / "run/learning.csv").write_text(f"{HEADER}0,0.03,0.09\n1,0.0321,0.0861\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("model", "believed"),
    [
        ({"from": "run"}, (0.0321, 0.0861)),
        ({"from": "run", "wheel_radius": None}, (0.0321, 0.0861)),
        ({"from": None, "wheel_radius": 0.04, "half_track": 0.09}, (0.04, 0.09)),
    ],
)
def test_last_iteration_counts(model: dict[str, object], believed: tuple[float, float]) -> None:
    scenario = hilc.load_scenario("example:small-robot", {"model": model})
    robot = scenario.setting.model
    assert (robot.wheel_radius, robot.half_track) == believed
    resolved = scenario.resolved()["model"]
    assert resolved == {"wheel_radius": believed[0], "half_track": believed[1]}
    assert ("run/learning.csv" in scenario.checksums) == (model["from"] == "run")


COLUMNS = (
    "model_left_per_right_radius,model_left_per_right_radius_standard_error,model_delay_s,"
    "model_lag_s,model_delay_and_lag_standard_error_s,model_friction_rad_s,"
    "model_friction_standard_error_rad_s"
)


@pytest.mark.parametrize(
    ("figures", "radii", "motor"),
    [
        ("1.01,0.001,0.08,0.05,0.002,0.2,0.01", (1.01, 1.0), (0.08, 0.05, 0.2)),
        # What is not clearly more than nothing, or was not measured, is none.
        ("1.001,0.001,0.08,0.001,0.002,0.015,0.01", None, (0.08, 0, 0)),
        ("1.01,,0.08,0.05,,0.2,", None, None),
    ],
)
def test_wheels_and_motors_are_handed_on(
    here: Path,
    figures: str,
    radii: tuple[float, float] | None,
    motor: tuple[float, float, float] | None,
) -> None:
    header = HEADER.strip() + f",{COLUMNS}\n"
    (here / "run/learning.csv").write_text(f"{header}0,0.0321,0.0861,{figures}\n")
    setting = hilc.load_scenario("example:small-robot", {"model": {"from": "run"}}).setting
    assert setting.model.wheel_radius == pytest.approx(0.0321)
    found = setting.drivetrain
    if motor is None:
        assert found is None
        return
    assert found is not None
    left, right = radii or (1.0, 1.0)
    assert found.left_radius / found.right_radius == pytest.approx(left / right)
    assert (found.motor.delay, found.motor.lag, found.motor.dead_zone) == motor


def test_path_starts_from_the_file_that_has_it(here: Path) -> None:
    text = hilc.load_scenario("example:small-robot").resolved_yaml()
    (here / "deeper").mkdir()
    own = re.sub(r"(?m)^model: .*$", "model: {from: ../run}", text)
    (here / "deeper/own.yaml").write_text(own)
    assert hilc.load_scenario("deeper/own.yaml").setting.model.wheel_radius == 0.0321


@pytest.mark.parametrize(
    ("value", "table", "message"),
    [
        ("nowhere", None, "nowhere/learning.csv: there is no such file; check the path"),
        ("run", None, "run: holds no learning.csv; {remedy}"),
        ([1], None, "must be the folder of a run, got a list of 1; {remedy}"),
        ("", None, "must be the folder of a run, got ''; {remedy}"),
        (
            "run",
            "iteration,merge_time_s\n0,1\n",
            "run/learning.csv: tells no wheel radius and half track; {remedy}",
        ),
        ("run", f"{HEADER}0,0.03,x\n", "run/learning.csv:2: is damaged: {number}"),
    ],
)
def test_errors_name_the_place(here: Path, value: object, table: str | None, message: str) -> None:
    path = here / "run/learning.csv"
    path.unlink()
    if table is not None:
        path.write_text(table)
    with pytest.raises(hilc.HilcError) as error:
        hilc.load_scenario("example:small-robot", {"model": {"from": value}})
    expected = message.format(
        remedy="name the folder of a run whose law identifies, such as norm-optimal",
        number="holds something that is no number",
    )
    assert str(error.value) == f"override model: model.from: {expected}"


def test_number_outside_the_range_is_told_at_the_key(here: Path) -> None:
    (here / "run/learning.csv").write_text(f"{HEADER}0,-1,0.08\n")
    with pytest.raises(hilc.HilcError, match=r"override model: model\.wheel_radius: must be"):
        hilc.load_scenario("example:small-robot", {"model": {"from": "run"}})


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("key", ["wheel_radius", "half_track", "wheel_separation"])
def test_numbers_beside_it_are_refused(key: str) -> None:
    with pytest.raises(hilc.HilcError) as error:
        hilc.load_scenario("example:small-robot", {"model": {"from": "run", key: 0.1}})
    assert str(error.value) == (
        f"override model: model.from: tells {key}, which the model has, too; give one of them, "
        "such as 'model: {from: run}' alone"
    )


def test_wheels_and_motors_come_with_it(here: Path) -> None:
    columns = {
        "model_wheel_radius_m": 0.03,
        "model_half_track_m": 0.08,
        "model_left_per_right_radius": 1.1,
        "model_left_per_right_radius_standard_error": 0.01,
        "model_delay_and_lag_standard_error_s": 0.001,
        "model_delay_s": 0.09,
        "model_lag_s": 0.05,
        "model_friction_rad_s": 0.2,
        "model_friction_standard_error_rad_s": 0.01,
    }
    names, values = ",".join(columns), ",".join(map(repr, columns.values()))
    (here / "run/learning.csv").write_text(f"iteration,{names}\n0,{values}\n")
    setting = hilc.load_scenario("example:small-robot", {"model": {"from": "run"}}).setting
    drivetrain = setting.drivetrain
    assert drivetrain is not None
    assert drivetrain.left_radius / drivetrain.right_radius == pytest.approx(1.1)
    assert drivetrain.left_radius + drivetrain.right_radius == pytest.approx(0.06)
    assert setting.model.wheel_radius == pytest.approx(0.03)
    assert drivetrain.motor == Motor(0.09, 0.05, dead_zone=0.2)
    told = {"model": {"from": "run", "motor": {"delay": 0.1}}}
    with pytest.raises(hilc.HilcError, match=r"model\.from: tells motor, which the model has, too"):
        hilc.load_scenario("example:small-robot", told)
    # A run with ideal motors tells none.
    (here / "run/learning.csv").write_text(f"{HEADER}0,0.03,0.09\n")
    drivetrain = hilc.load_scenario("example:small-robot", told).setting.drivetrain
    assert drivetrain == Drivetrain(0.03, 0.03, Motor(0.1))
