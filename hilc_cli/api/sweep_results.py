"""The results of a sweep, with what it takes to write them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.sweep import SweepData
from hilc_cli.results.sweep_folder import write_sweep_folder
from hilc_cli.results.sweep_summary import SweepSummary, summarise_sweep
from hilc_cli.sweeping.chunks import Failure

LIBRARIES = ("numba", "numpy", "pydantic", "pyyaml", "scipy")
"""That take part in a sweep."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sweep(SweepData):
    """The results of a sweep, and how they came to be.

    Attributes:
        failures: Cases that could not be simulated, and why.
        checksum: Of all that the results depend on.
        scenario_yaml: The resolved scenario with its sweep.
        initial_input: Sample time, left and right wheel speeds of the input file, if there is one.
        how: What the manifest tells of the computation.
        best_yaml: The scenario of the best case as a file, if one was searched for and found.
    """

    failures: tuple[Failure, ...] = field(kw_only=True)
    checksum: str = field(kw_only=True)
    scenario_yaml: str = field(kw_only=True)
    initial_input: tuple[float, Floats, Floats] | None = field(kw_only=True)
    how: Mapping[str, Any] = field(kw_only=True)
    best_yaml: str | None = field(default=None, kw_only=True)

    def summary(self) -> SweepSummary:
        """The few figures that tell how the sweep went."""
        return summarise_sweep(self)

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        plots: bool = True,
        command: Sequence[str] = (),
        go_on: Callable[[], None] = lambda: None,
    ) -> None:
        """Writes the sweep folder: tables, resolved scenario, manifest and pictures.

        Args:
            folder: The very folder that is written; it is there as a whole or not at all.
            force: Replace the folder of another sweep.
            formats: Of the pictures: png, svg, pdf; parquet for the table of the cases.
            plots: Whether to draw pictures.
            command: Command line to note in the manifest.
            go_on: Called now and then; may raise to stop.

        Raises:
            ExistingResultsError: The folder holds another sweep, or is no sweep folder.
            FileAccessError: It cannot be written.
            UsageError: There is no such format, or what writes it is not installed.
        """
        pictures = [name for name in formats if name != "parquet"]

        def draw(into: Path) -> None:
            # Matplotlib starts slowly.
            from hilc_cli.figures.sweep.catalogue import save_sweep_figures

            save_sweep_figures(self, into, formats=pictures or ["png"])

        def manifest() -> Mapping[str, Any]:
            return {
                **self.how,
                "cases": len(self),
                "diverged": int(self.diverged.sum()),
                "failed": [
                    {"first": f.chunk.first, "last": f.chunk.last - 1, "reason": f.reason}
                    for f in self.failures
                ],
                "command": list(command),
            }

        write_sweep_folder(
            Path(folder),
            self,
            manifest,
            checksum=self.checksum,
            scenario_yaml=self.scenario_yaml,
            initial_input=self.initial_input,
            best_yaml=self.best_yaml,
            force=force,
            draw=draw if plots else None,
            parquet="parquet" in formats,
            go_on=go_on,
        )


def as_fields(data: SweepData) -> dict[str, Any]:
    """The fields of results, to be taken over by a `Sweep`."""
    return {f.name: getattr(data, f.name) for f in fields(data)}
