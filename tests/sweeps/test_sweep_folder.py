"""cases.csv and bands.csv: exact headers, a small golden example, damaged files, Parquet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

import hilc_cli as hilc_api
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.tables import unrun, value_text
from hilc_cli.sweeps.case_table import read_cases, write_cases
from hilc_cli.sweeps.data import Bands, as_numbers
from hilc_cli.sweeps.side_tables import read_bands, write_bands
from hilc_cli.variation import Axis, Choices, Range, Value
from tests.conftest import Hilc, Outcome, Write
from tests.results.test_tables import GOLDEN_ITERATIONS, GOLDEN_SCENARIO, rows as rows_of

METRICS = (
    "max_position_error_m,mean_position_error_m,rms_position_error_m,final_position_error_m,"
    "max_abs_error_x_m,max_abs_error_y_m,max_abs_error_heading_rad,max_wheel_speed_rad_s,"
    "saturated_samples,input_change_rms_rad_s,max_position_error_second_half_m,"
    "mean_position_error_second_half_m,iterations_to_tolerance,peak_max_position_error_m,"
    "diverged"
)
BANDS = (
    "iteration,cases,max_position_error_m_p05,max_position_error_m_p25,max_position_error_m_p50,"
    "max_position_error_m_p75,max_position_error_m_p95"
)


def test_golden_sweep(hilc: Hilc, write: Write, folder: Path) -> None:
    write({"golden.yaml": GOLDEN_SCENARIO})
    arguments = ("--vary", "iterations=0,1", "--vary", "controller.b_w=6,null", "--no-plots", "-q")
    command = ("sweep", "golden.yaml", *arguments, "--tolerance", "0.5", "--bands")
    assert hilc(*command) == Outcome(0, "", "")
    rows = rows_of(folder / "runs/golden-sweep/cases.csv")
    assert ",".join(rows[0]) == f"case,iterations,controller.b_w,{METRICS}"
    assert [row[:3] for row in rows[1:]] == [
        ["0", "0", "6.0"],
        ["1", "0", "null"],
        ["2", "1", "6.0"],
        ["3", "1", "null"],
    ]
    first, limited = GOLDEN_ITERATIONS[0][1:], GOLDEN_ITERATIONS[1][1:]
    # Without the limit the last step is 1.5 m: errors 0, 0.5, 0.5, 0.
    free = [0.5, 0.25, math.sqrt(0.5 / 4), 0, 0.5, 0, 0, 7.5, 0, math.sqrt(87.5 / 3), 0.5, 0.25]
    found = [[float(cell) for cell in row[3:-3]] for row in rows[1:]]
    np.testing.assert_allclose(found, [first, first, limited, free], atol=1e-12)
    assert [float(row[-2]) for row in rows[1:]] == [3, 3, 3, 3]
    assert [row[-3] for row in rows[1:]] == ["", "", "1", "1"]
    assert [row[-1] for row in rows[1:]] == ["0"] * 4
    bands = (folder / "runs/golden-sweep/bands.csv").read_text().splitlines()
    assert bands[0] == BANDS
    assert bands[1:] == ["0,4,3.0,3.0,3.0,3.0,3.0", "1,2,0.5,0.5,0.5,0.5,0.5"]


words = st.text(st.sampled_from('ab,"\n\r 1.'), min_size=1, max_size=4).filter(
    lambda word: not word.replace(".", "").isdecimal()
)
axis_values: st.SearchStrategy[list[Value]] = st.one_of(
    st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=4, unique=True),
    st.lists(st.floats(-1e149, 1e149), min_size=1, max_size=4, unique=True),
    st.lists(st.integers(0, 9) | st.sampled_from([0.5, 1.5]), min_size=1, max_size=4, unique=True),
    # Texts that a table shows alike cannot be told apart.
    st.lists(words, min_size=1, max_size=4, unique_by=unrun),
    st.lists(st.sampled_from([None, 180.0, 1.5]), min_size=1, max_size=3, unique=True),
    st.lists(st.booleans(), min_size=1, max_size=2, unique=True),
)
wholes = {"saturated_samples", "iterations_to_tolerance", "diverged"}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(axis_values, min_size=1, max_size=3), st.data())
def test_cases_read_back_exactly(
    tmp_path: Path, choices: list[list[Value]], data: st.DataObject
) -> None:
    count = data.draw(st.integers(1, 5))
    axes = {f"key,{number}": Choices(tuple(values)) for number, values in enumerate(choices)}
    values = {
        key: [data.draw(st.sampled_from(axis.values)) for _ in range(count)]
        for key, axis in axes.items()
    }
    numbers = st.floats(0, 1e140) | st.just(math.nan)
    whole = st.integers(0, 1).map(float) | st.just(math.nan)
    columns: dict[str, Floats] = {
        name: np.array([data.draw(whole if name in wholes else numbers) for _ in range(count)])
        for name in CASE_COLUMNS
    }
    stored = {key: as_numbers(list(column)) for key, column in values.items()}
    write_cases(tmp_path / "cases.csv", stored, columns)
    found, back = read_cases(tmp_path / "cases.csv", axes)
    assert {key: list(column) for key, column in found.items()} == values
    for name in CASE_COLUMNS:
        np.testing.assert_array_equal(back[name], columns[name])


def columns_of(cases: int) -> dict[str, Floats]:
    return {name: np.arange(cases, dtype=np.float64) for name in CASE_COLUMNS}


def test_equal_words_of_other_kinds_keep_their_texts(tmp_path: Path) -> None:
    words: list[Value] = ["feedback", 1, True, 1.0, False, 0]
    write_cases(tmp_path / "cases.csv", {"a": words}, columns_of(len(words)))
    lines = (tmp_path / "cases.csv").read_text(encoding="utf-8").splitlines()[1:]
    told = [line.split(",")[1] for line in lines]
    assert told == ["feedback", "1", "true", "1.0", "false", "0"]


AXES: Mapping[str, Axis] = {"a": Choices(("x", "y")), "b": Range(0.5, 2.5, "linear", 3)}


@pytest.fixture
def cases(tmp_path: Path) -> Path:
    write_cases(tmp_path / "cases.csv", {"a": ["x", "y"], "b": np.array([0.5, 1.5])}, columns_of(2))
    return tmp_path / "cases.csv"


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("\n1,y", "\n2,y", 3),
        ("\n1,y", "\n1,z", 3),
        ("\n0,x,0.5", "\n0,x,half", 2),
        ("\n0,x,", "\n0,x,1,", 2),
        ("0.0,0\n", "0.0\n", 2),
        ("\n1,", "\n,", 3),
        ("\n1,y", "\n\n1,y", 3),
        (",1.0,", ",one,", 3),
    ],
)
def test_damaged_cases_are_told_by_line(cases: Path, old: str, new: str, line: int) -> None:
    text = cases.read_text()
    assert old in text
    cases.write_text(text.replace(old, new, 1))
    with pytest.raises(UsageError) as caught:
        read_cases(cases, AXES)
    assert str(caught.value).startswith(f"{cases}:{line}: is damaged: ")


@pytest.mark.parametrize("text", ["", "case\n", "iteration,a,b\n"])
def test_table_of_something_else_is_told(cases: Path, text: str) -> None:
    cases.write_text(text)
    with pytest.raises(UsageError, match="is no table of these cases"):
        read_cases(cases, AXES)
    with pytest.raises(UsageError, match="is no such table"):
        read_bands(cases)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "null"),
        (True, "true"),
        (0.1, "0.1"),
        (2**64 - 1, "18446744073709551615"),
        ("cos", "cos"),
        ("a,b", '"a,b"'),
        ('a"b', '"a""b"'),
    ],
)
def test_text_of_a_value(value: Value, text: str) -> None:
    assert value_text(value) == text


def test_bands_read_back_exactly(tmp_path: Path) -> None:
    quantiles = np.array([[0.1, 1 / 3, 2, 1e300, math.inf], [math.nan] * 5])
    write_bands(tmp_path / "bands.csv", Bands(np.array([7.0, 0.0]), quantiles))
    back = read_bands(tmp_path / "bands.csv")
    np.testing.assert_array_equal(back.quantiles, quantiles)
    assert back.cases.tolist() == [7, 0]
    (tmp_path / "bands.csv").write_text(f"{BANDS}\n0,1,1,1,1,1\n")
    with pytest.raises(UsageError, match=r"bands\.csv:2: is damaged"):
        read_bands(tmp_path / "bands.csv")


@pytest.mark.usefixtures("folder")
def test_parquet_holds_what_the_table_holds(write: Write, folder: Path) -> None:
    write()
    vary = {
        "controller.gains.l1": [0.5, 1e4],
        "controller.b_w": [None, 5],
        "disturbance.seed": [1, 2**64 - 1],
        "disturbance.output.repeat": [False, True],
    }
    scenario = hilc_api.load_scenario("scenario.yaml", {"iterations": 200})
    result = hilc_api.sweep(hilc_api.plan_sweep(scenario, vary, tolerance=1e-3))
    assert 0 < result.diverged.sum() < len(result)
    result.write("out", plots=False, formats=["parquet"])
    table = pyarrow.parquet.read_table(folder / "out/cases.parquet")
    rows = rows_of(folder / "out/cases.csv")
    assert table.column_names == rows[0]
    types = {name: str(table.schema.field(name).type) for name in rows[0]}
    assert types.pop("case") == "int64"
    assert [types.pop(key) for key in vary] == ["double", "string", "uint64", "string"]
    assert {name for name, kind in types.items() if kind == "int64"} == wholes
    assert {kind for name, kind in types.items() if name not in wholes} == {"double"}
    columns = zip(*rows[1:], strict=True)
    for column, cells in zip(table.itercolumns(), columns, strict=True):
        assert [_cell(value) for value in column.to_pylist()] == list(cells)
    assert None in table.column("iterations_to_tolerance").to_pylist()


def _cell(value: object) -> str:
    return "" if value is None else value if isinstance(value, str) else repr(value)
