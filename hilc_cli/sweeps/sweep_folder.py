"""The folder of a sweep: its tables, when it may be replaced, and how it is read back."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated

from pydantic import PlainValidator, Strict

from hilc_cli.files import merge_folder
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import CASE_METRICS
from hilc_cli.results.picture_kinds import SWEEP_PICTURES
from hilc_cli.results.reading import Document, Length, Name, damaged, one_of
from hilc_cli.scenario.sweep_section import Robust
from hilc_cli.sweeps.case_table import CASES, read_cases
from hilc_cli.sweeps.data import BEST, OwnValues, SweepData
from hilc_cli.sweeps.side_tables import BANDS, CHOICES, PARQUET, read_bands
from hilc_cli.variation import Axis, axes_from_data

SWEEP_FOLDER = ResultFolder(
    what="sweep",
    kind="hilc sweep",
    other="another sweep",
    tables=frozenset({CASES, BANDS, CHOICES, SCENARIO, INITIAL_INPUT, BEST}),
    pictures=tuple(SWEEP_PICTURES),
    files=frozenset({PARQUET}),
    manifest="sweep.json",
)

Axes = Annotated[dict[str, Axis], PlainValidator(axes_from_data)]
CaseMetric = Annotated[str, one_of(CASE_METRICS)]
Over = Annotated[tuple[str, ...], Strict(False)]
"""Keys that happen, which must be some of the axes."""


class _Manifest(Document):
    """What is read of the manifest of a sweep."""

    name: Name
    axes: Axes
    grid: bool
    tolerance_m: Length | None
    metric: CaseMetric
    path_size_m: Length | None = None
    as_it_is: Annotated[OwnValues, PlainValidator(OwnValues.from_data)] | None = None
    over: Over = ()
    robust: Robust = "worst"


def is_complete(checksum: str, folder: str | Path) -> bool:
    """Whether a folder holds the results of this very sweep, none of whose cases has failed."""
    manifest = SWEEP_FOLDER.look(Path(folder))
    return manifest.get("checksum") == checksum and not manifest.get("failed")


def is_sweep(folder: str | Path) -> bool:
    """Whether a folder holds the results of a sweep."""
    return SWEEP_FOLDER.is_at(folder)


def read_sweep(folder: str | Path) -> SweepData:
    """The results in a sweep folder, from its tables alone.

    Raises:
        HilcError: There is no such folder, or a table is missing or damaged.
    """
    path = Path(folder)
    manifest = SWEEP_FOLDER.read(path, _Manifest)
    axes, beside = manifest.axes, manifest.as_it_is
    if manifest.grid and any(axis.count is None for axis in axes.values()):
        raise damaged(path / SWEEP_FOLDER.manifest, "axes: a range of a grid needs a count")
    if not may_happen(manifest.over, axes):
        raise damaged(path / SWEEP_FOLDER.manifest, "over: should be some of the axes")
    chosen = axes.keys() - set(manifest.over)
    if beside is not None and beside.values.keys() != chosen:
        raise damaged(path / SWEEP_FOLDER.manifest, "as_it_is: has other keys than are chosen")
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
        manifest.path_size_m,
        manifest.over,
        manifest.robust,
    )


def may_happen(over: Sequence[str], axes: Mapping[str, Axis]) -> bool:
    """Whether keys can be those that happen: some of the varied ones, each once, but not all."""
    return len(set(over)) == len(over) and (not over or set(over) < axes.keys())


def plot_sweep(
    data: SweepData | str | Path,
    folder: str | Path,
    *,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    look: Look = USUAL,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws pictures of a sweep.

    Args:
        data: From `read_sweep` or `sweep`, or the folder of a sweep.
        folder: Where to put KIND.FORMAT; made if it is not there.
        kinds: curve, map, effects, best, spread, bands, search; by default those that fit.
        formats: png, svg, pdf.
        dpi: Resolution of png.
        look: How pictures are to look, from `picture_look`.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such kind or format, or the kind does not fit the sweep.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    # Matplotlib starts slowly.
    from hilc_cli.sweeps.pictures.catalogue import save_sweep_figures

    drawn = data if isinstance(data, SweepData) else read_sweep(data)
    return merge_folder(
        Path(folder),
        lambda into: save_sweep_figures(
            drawn, into, kinds=kinds, formats=formats, dpi=dpi, look=look
        ),
        may_replace,
    )
