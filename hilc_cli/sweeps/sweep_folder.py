"""The folder of a sweep: what is in it, when it may be replaced, and how it is read back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.metrics import CASE_METRICS
from hilc_cli.results.picture_kinds import SWEEP_PICTURES
from hilc_cli.results.reading import Document, Length, Name, damaged, one_of
from hilc_cli.results.tables import write_input
from hilc_cli.sweeps.data import BEST, OwnValues, SweepData
from hilc_cli.sweeps.tables import read_bands, read_cases, write_bands, write_cases
from hilc_cli.variation.axes import Axis, axes_from_data, axis_to_data

CASES = "cases.csv"
BANDS = "bands.csv"
PARQUET = "cases.parquet"

SWEEP_FOLDER = ResultFolder(
    what="sweep",
    kind="hilc sweep",
    other="another sweep",
    tables=frozenset({CASES, BANDS, SCENARIO, INITIAL_INPUT, BEST}),
    pictures=tuple(SWEEP_PICTURES),
    files=frozenset({PARQUET}),
    manifest="sweep.json",
)

Axes = Annotated[dict[str, Axis], PlainValidator(axes_from_data)]
CaseMetric = Annotated[str, one_of(CASE_METRICS)]


class _Manifest(Document):
    """What is read of the manifest of a sweep."""

    name: Name
    axes: Axes
    grid: bool
    tolerance_m: Length | None
    metric: CaseMetric
    as_it_is: Annotated[OwnValues, PlainValidator(OwnValues.from_data)] | None = None


def write_sweep_folder(
    path: Path,
    data: SweepData,
    manifest: Callable[[], Mapping[str, Any]],
    *,
    checksum: str,
    scenario_yaml: str,
    initial_input: tuple[float, Floats, Floats] | None = None,
    best_yaml: str | None = None,
    force: bool = False,
    draw: Callable[[Path], None] | None = None,
    parquet: bool = False,
    go_on: Callable[[], None] = lambda: None,
) -> None:
    """Writes a sweep folder as a whole.

    Args:
        path: The folder.
        data: The results.
        manifest: Gives what else is to be known of the sweep, asked last.
        checksum: Of all that the results depend on.
        scenario_yaml: The resolved scenario with its sweep.
        initial_input: Sample time, left and right wheel speeds of the input file, if there is one.
        best_yaml: The scenario of the best case, if one was searched for and found.
        force: Replace the folder of another sweep.
        draw: Draws the pictures into the folder that it is given.
        parquet: Write the cases as Parquet as well.
        go_on: Called now and then; may raise to stop.

    Raises:
        ExistingResultsError: The folder holds another sweep, or is no sweep folder.
        UsageError: Parquet is asked for, but what writes it is not installed.
        FileAccessError: It cannot be written.
    """

    def fill(folder: Path) -> None:
        (folder / SCENARIO).write_text(scenario_yaml, encoding="utf-8")
        if initial_input is not None:
            write_input(folder / INITIAL_INPUT, *initial_input)
        if best_yaml is not None:
            (folder / BEST).write_text(best_yaml, encoding="utf-8")
        write_cases(folder / CASES, data.values, data.columns, go_on)
        if data.bands is not None:
            write_bands(folder / BANDS, data.bands)
        if parquet:
            from hilc_cli.sweeps.tables import write_parquet

            write_parquet(folder / PARQUET, data, go_on)
        if draw is not None:
            draw(folder)
        go_on()

    SWEEP_FOLDER.write(
        path,
        fill,
        lambda: {
            "name": data.name,
            "checksum": checksum,
            "axes": {key: axis_to_data(axis) for key, axis in data.axes.items()},
            "grid": data.is_grid,
            "tolerance_m": data.tolerance,
            "metric": data.metric,
            **({} if data.as_it_is is None else {"as_it_is": data.as_it_is.to_data()}),
            **manifest(),
        },
        lambda folder: check_sweep_folder(folder, checksum, force=force),
    )


def check_sweep_folder(path: Path, checksum: str, *, force: bool = False) -> None:
    """Makes sure that a sweep may be written to a folder; to be asked before it is computed.

    Args:
        path: The folder.
        checksum: Of the sweep.
        force: Replace the folder of another sweep.

    Raises:
        ExistingResultsError: The folder holds another sweep, or is no sweep folder.
    """
    SWEEP_FOLDER.check(path, lambda there: there.get("checksum") == checksum, force=force)


def read_sweep_folder(path: Path) -> SweepData:
    """The results in a sweep folder.

    Raises:
        HilcError: It is no such folder, or a file is missing or damaged.
    """
    manifest = SWEEP_FOLDER.read(path, _Manifest)
    axes, beside = manifest.axes, manifest.as_it_is
    if manifest.grid and any(axis.count is None for axis in axes.values()):
        raise damaged(path / SWEEP_FOLDER.manifest, "axes: a range of a grid needs a count")
    if beside is not None and beside.values.keys() != axes.keys():
        raise damaged(path / SWEEP_FOLDER.manifest, "as_it_is: has other keys than the axes")
    values, columns = read_cases(path / CASES, axes, is_grid=manifest.grid)
    bands = read_bands(path / BANDS) if (path / BANDS).exists() else None
    return SweepData(
        manifest.name,
        axes,
        manifest.grid,
        values,
        columns,
        manifest.tolerance_m,
        manifest.metric,
        bands,
        beside,
    )
