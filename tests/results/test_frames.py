"""Data frames have the columns of the CSV files, and the numbers as they are."""

from __future__ import annotations

import csv
import re
import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import MissingPackageError, UnknownNameError, UsageError
from hilc_cli.identification.believed import believed_of
from hilc_cli.identification.identifying import identified
from hilc_cli.paper.claim_texts import write_claims_csv
from tests.conftest import Write
from tests.identification.test_identifying import TRUE, log_of, wheels_of
from tests.labs.robots import driven, scenario
from tests.leaderboards.test_leaderboard_folder import DATA, write as write_leaderboard
from tests.made_up_runs import MakeRun
from tests.paper.test_claim_texts import JUDGED

L1, LAW = "controller.gains.l1", "controller.gain_heading"


def same(frame: Any, file: Path) -> None:
    """Whether a data frame is the table in a file: names, order, types and numbers to the bit."""
    header, *rows = csv.reader(file.read_text(encoding="utf-8").splitlines())
    assert list(frame.columns) == header
    assert len(frame) == len(rows) > 0
    for name, cells in zip(header, zip(*rows, strict=True), strict=True):
        column = frame[name]
        if column.dtype.kind in "iuf":
            assert (column.dtype.kind != "f") == all(re.fullmatch(r"-?\d+", c) for c in cells), name
            numbers = [float(cell or "nan") for cell in cells]
            np.testing.assert_array_equal(column.astype(float), numbers, name)
        else:
            assert ["" if pd.isna(each) else str(each) for each in column] == list(cells), name


def test_tables_of_a_run(folder: Path) -> None:
    given = scenario(iterations=2, record={"gravity_center": True})
    given["robot"] = {**given["robot"], "gravity_center": [0.03, 0.01]}
    run = hilc_api.run(given)
    run.write("run", plots=False)
    same(run.to_pandas(), folder / "run/iterations.csv")
    tables = ("iterations", "samples", "input", "plan", "learning", "gravity-center")
    assert {f"{name}.csv" for name in tables} == {file.name for file in folder.glob("run/*.csv")}
    again = hilc_api.read_run("run")
    for name in tables:
        same(run.to_pandas(name), folder / f"run/{name}.csv")
        same(again.to_pandas(name), folder / f"run/{name}.csv")


def test_tables_of_a_lab(folder: Path) -> None:
    lab = hilc_api.Lab.start(scenario(), "lab")
    times, poses = driven(lab.plan)
    lab.add(poses, times)
    for name in ("iterations", "samples", "learning"):
        same(lab.to_pandas(name), folder / f"lab/{name}.csv")
        same(lab.state.to_pandas(name), folder / f"lab/{name}.csv")


def test_tables_of_a_sweep(write: Write, folder: Path) -> None:
    write()
    vary = {L1: "0.1:5:3", LAW: ["measured", "reference"], "iterations": [1, 3]}
    plan = hilc_api.plan_sweep("scenario.yaml", vary, tolerance=0.5, bands=True)
    sweep = hilc_api.sweep(plan, hilc_api.Execution(workers=1))
    sweep.write("sweep", plots=False)
    for each in (sweep, hilc_api.read_sweep("sweep")):
        same(each.to_pandas(), folder / "sweep/cases.csv")
        same(each.to_pandas("bands"), folder / "sweep/bands.csv")


def test_tables_of_a_sweep_with_choices(write: Write, folder: Path) -> None:
    write()
    vary = ["controller.gains.l1=0.1,0.5", "robot.wheel_radius=0.1,0.2"]
    plan = hilc_api.plan_sweep("scenario.yaml", vary, over="robot.wheel_radius", robust="worst")
    sweep = hilc_api.sweep(plan, hilc_api.Execution(workers=1))
    sweep.write("sweep", plots=False)
    same(sweep.to_pandas("choices"), folder / "sweep/choices.csv")


def test_tables_of_comparisons(make_run: MakeRun, folder: Path) -> None:
    comparison = hilc_api.compare([make_run("a"), make_run("b", factors=(0.3, 0.99))])
    comparison.write("compared", plots=False)
    same(comparison.to_pandas(), folder / "compared/comparison.csv")
    write_leaderboard(folder / "laws", DATA)
    same(DATA.to_pandas(), folder / "laws/leaderboard.csv")
    same(hilc_api.LawComparison(DATA, "", {}).to_pandas(), folder / "laws/leaderboard.csv")


def test_table_of_a_path(folder: Path) -> None:
    for source in (scenario(), "example:figure-eight"):
        path = hilc_api.show(source)
        path.write_csv("path.csv")
        same(path.to_pandas(), folder / "path.csv")


def test_table_of_a_check(folder: Path) -> None:
    overrides = {"trajectory.sample_time": "20 ms", "iterations": 3}
    given = hilc_api.load_scenario("example:fig3-circle", overrides)
    for simulate in (False, True):
        check = hilc_api.check(given, simulate=simulate)
        check.plot(f"check{simulate}")
        same(check.to_pandas(), folder / f"check{simulate}/transient.csv")
    with pytest.raises(UsageError, match="no errors are predicted of law norm-optimal"):
        hilc_api.check(scenario()).to_pandas()


def test_table_of_claims(folder: Path) -> None:
    plan = hilc_api.plan_reproduction(reading="literal", overrides={"iterations": 0})
    result = hilc_api.Reproduction(plan, {}, JUDGED, datetime.now(UTC), {})
    write_claims_csv(folder / "claims.csv", JUDGED)
    same(result.to_pandas(), folder / "claims.csv")


def test_table_of_an_identification() -> None:
    found = identified([log_of(TRUE, wheels_of())], believed_of(["model.wheel_radius=0.1"]))
    frame = found.to_pandas().set_index("quantity")
    assert list(frame.index) == list(found.estimates)
    row, each = frame.loc["left_wheel_radius_m"], found.estimates["left_wheel_radius_m"]
    assert (row["value"], row["standard_error"], row["unit"]) == (each.value, each.error, "m")
    assert (row["believed"], row["known"]) == (0.1, True)


def test_tables_that_are_not_there_are_told_with_those_that_are(make_run: MakeRun) -> None:
    with pytest.raises(UnknownNameError, match="no table 'sample'; did you mean 'samples'"):
        make_run().to_pandas("sample")
    with pytest.raises(UnknownNameError, match="no table 'plan'; known: iterations, samples"):
        make_run().to_pandas("plan")


def test_without_pandas_the_remedy_is_told(
    make_run: MakeRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingPackageError) as caught:
        make_run().to_pandas()
    assert str(caught.value) == (
        "to_pandas() needs the package pandas; pip install '.[notebooks]' in a checkout of hilc"
    )
