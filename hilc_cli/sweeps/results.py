"""The results of a sweep, with what it takes to write them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hilc_cli.reference.sampled import Floats
from hilc_cli.sweeps.chunks import Failure
from hilc_cli.sweeps.data import AsItIs, SweepData
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.sampler import SAMPLER
from hilc_cli.sweeps.summary import SweepSummary, summarise_sweep
from hilc_cli.sweeps.sweep_folder import write_sweep_folder
from hilc_cli.sweeps.varied import TRAJECTORY, parts
from hilc_cli.variation.axes import Value
from hilc_cli.yaml_input.tree import to_yaml

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
            from hilc_cli.sweeps.pictures.catalogue import save_sweep_figures

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


_SUFFIX, _LONGEST_NAME = "-best", 100


def beside_cases(plan: Plan, data: SweepData, metric: float) -> dict[str, Any]:
    """The fields that a `Sweep` has of a search only.

    Args:
        plan: The search.
        data: Its cases.
        metric: What it minimises, of the scenario as it is.
    """
    own = plan.varied.scenario.resolved()
    values = {key: value_of(own, key) for key in plan.axes}
    return {"as_it_is": AsItIs(values, metric), "best_yaml": _best_yaml(plan, data, metric)}


def how_searched(plan: Plan) -> dict[str, Any]:
    """What the manifest tells of how a search was done."""
    return {
        "minimise": plan.spec.minimise,
        "seed": plan.spec.seed,
        "sampler": SAMPLER,
        "optuna": version("optuna"),
    }


def _best_yaml(plan: Plan, data: SweepData, as_it_is: float) -> str | None:
    """The scenario of the best case as a file, if any case has the metric."""
    best = next(iter(data.ranked()), None)
    if best is None:
        return None
    scenario = plan.varied.case(data.case(best)).resolved()
    scenario["name"] = plan.name[: _LONGEST_NAME - len(_SUFFIX)] + _SUFFIX
    metric = float(data.columns[data.metric][best])
    title = f"# Case {best} of a search with hilc sweep, the best of {len(data)}: "
    title += f"{data.metric} {metric!r}\n"
    if metric >= as_it_is:
        title += f"# No better than the scenario as it is, which has {as_it_is!r}.\n"
    return f"{title}{to_yaml(scenario)}"


def value_of(resolved: Mapping[str, Any], key: str) -> Value:
    """What a resolved scenario has at a dotted key; None for what is no single value.

    Args:
        resolved: The scenario; of the names that a platform's width goes by it has one.
        key: The key, with whichever of them.
    """
    if key == TRAJECTORY:
        return str(resolved[TRAJECTORY]["name"])
    platform, _, field = key.partition(".")
    if field == "wheel_separation":
        return 2 * float(resolved[platform]["half_track"])
    found: Any = resolved
    for part in parts(key):
        is_there = part in found if isinstance(found, Mapping) else _is_place(part, found)
        if not is_there:
            return None
        found = found[part]
    return found if isinstance(found, bool | int | float | str) else None


def _is_place(part: str | int, data: Any) -> bool:
    return isinstance(data, list) and isinstance(part, int) and part < len(data)
