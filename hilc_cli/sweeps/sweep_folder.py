"""The folder of a sweep: what is in it, when it may be replaced, and how it is read back."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.files import write_folder
from hilc_cli.names import name_from
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import (
    PICTURE_FORMATS,
    SWEEP_PICTURE_KINDS,
    check_replaceable,
    keep_pictures,
    read_manifest,
)
from hilc_cli.results.tables import write_input
from hilc_cli.runs.run_folder import INITIAL_INPUT, SCENARIO
from hilc_cli.sweeps.data import BEST, AsItIs, SweepData
from hilc_cli.sweeps.tables import read_bands, read_cases, write_bands, write_cases
from hilc_cli.variation.axes import axes_from_data, axis_to_data

KIND = "hilc sweep"
MANIFEST = "sweep.json"
CASES = "cases.csv"
BANDS = "bands.csv"
PARQUET = "cases.parquet"
_PICTURES = {f"{kind}.{suffix}" for kind in SWEEP_PICTURE_KINDS for suffix in PICTURE_FORMATS}
_TABLES = frozenset({CASES, BANDS, SCENARIO, INITIAL_INPUT, BEST})
_OWN = _TABLES | {MANIFEST, PARQUET} | _PICTURES


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
        keep_pictures(path, folder, _TABLES, _PICTURES)
        go_on()
        files = sorted([*(file.name for file in folder.iterdir()), MANIFEST])
        document = {
            "kind": KIND,
            "name": data.name,
            "checksum": checksum,
            "axes": {key: axis_to_data(axis) for key, axis in data.axes.items()},
            "grid": data.is_grid,
            "tolerance_m": data.tolerance,
            "metric": data.metric,
            **({} if data.as_it_is is None else {"as_it_is": data.as_it_is.to_data()}),
            **manifest(),
            "files": files,
        }
        text = json.dumps(document, indent=2)
        (folder / MANIFEST).write_text(text + "\n", encoding="utf-8")

    def may_replace(folder: Path) -> bool:
        check_sweep_folder(folder, checksum, force=force)
        return True

    write_folder(path, fill, may_replace, keeps=lambda name: name not in _OWN)


def check_sweep_folder(path: Path, checksum: str, *, force: bool = False) -> None:
    """Whether a sweep may be written to a folder; to be asked before a long computation.

    Args:
        path: The folder.
        checksum: Of the sweep.
        force: Replace the folder of another sweep.

    Raises:
        ExistingResultsError: The folder holds another sweep, or is no sweep folder.
    """
    check_replaceable(
        path,
        "sweep",
        "another sweep",
        is_own=lambda: bool(read_sweep_manifest(path)),
        is_same=lambda: force or read_sweep_manifest(path).get("checksum") == checksum,
    )


def read_sweep_manifest(path: Path) -> dict[str, Any]:
    """What a sweep folder says of itself; empty if it is none."""
    return read_manifest(path / MANIFEST, KIND)


def read_sweep_folder(path: Path) -> SweepData:
    """The results in a sweep folder.

    Raises:
        HilcError: It is no such folder, or a table is missing or damaged.
    """
    manifest = read_sweep_manifest(path)
    if not manifest:
        raise UsageError(f"{path}: is no sweep folder: it has no {MANIFEST} of hilc sweep")
    try:
        axes = axes_from_data(manifest["axes"])
        is_grid, tolerance = bool(manifest["grid"]), manifest["tolerance_m"]
        metric = str(manifest["metric"])
        name = name_from(manifest["name"], f"{path / MANIFEST}: name")
        as_it_is = AsItIs.from_data(manifest["as_it_is"]) if "as_it_is" in manifest else None
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UsageError(f"{path / MANIFEST}: is damaged: {error}") from None
    values, columns = read_cases(path / CASES, axes)
    bands = read_bands(path / BANDS) if (path / BANDS).exists() else None
    return SweepData(name, axes, is_grid, values, columns, tolerance, metric, bands, as_it_is)
