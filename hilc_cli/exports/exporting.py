"""Writes a run or a lab in the formats of other programs."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from hilc_cli.errors import UsageError
from hilc_cli.exports.bags import write_bag
from hilc_cli.exports.motions import Motion, motion_of_plan, motion_of_reference, motion_of_trial
from hilc_cli.exports.text_files import write_csv, write_tum
from hilc_cli.results.folder import ResultFolder
from hilc_cli.results.run import RunData
from hilc_cli.runs.running import RunSource, as_run
from hilc_cli.version import __version__

FORMATS = ("tum", "csv", "mcap")

EXPORT_FOLDER = ResultFolder(
    what="export", kind="hilc export", other="another run", manifest="export.json"
)


def export(
    run: RunSource,
    folder: str | Path,
    formats: Sequence[str] = FORMATS,
    *,
    iterations: Collection[int] | None = None,
    force: bool = False,
    command: Sequence[str] = (),
) -> list[Path]:
    """Writes iterations of a run, its trajectory and its plan.

    Args:
        run: From `run` or `read_run`, or the folder of a run or a lab.
        folder: Where to; formats and iterations that it has already stay.
        formats: tum, csv, mcap.
        iterations: Recorded ones; None: the last.
        force: Whether the export of another run may be replaced.
        command: Command line to note in the manifest.

    Returns:
        The files.

    Raises:
        UsageError: There is no such format, or an iteration was not recorded.
        ExistingResultsError: Something else stands in the folder.
        FileAccessError: It cannot be written.
    """
    for name in formats:
        if name not in FORMATS:
            raise UsageError(f"there is no format {name!r}; known: {', '.join(FORMATS)}")
    run = as_run(run)
    wanted = [run.last.iteration] if iterations is None else sorted(iterations)
    driven = [motion_of_trial(run, iteration) for iteration in wanted]
    reference, plan = motion_of_reference(run.reference), motion_of_plan(run)
    place = Path(folder)

    def fill(into: Path) -> None:
        for motion in [reference, *driven, *([] if plan is None else [plan])]:
            _write(motion, into, formats, run, is_plan=motion is plan)

    def check(there: Path) -> None:
        EXPORT_FOLDER.check(there, lambda manifest: manifest.get("run") == run.name, force=force)

    check(place)
    manifest = {"run": run.name, "versions": {"hilc": __version__}, "command": list(command)}
    return EXPORT_FOLDER.write(place, fill, lambda: manifest, check)


def _write(
    motion: Motion, into: Path, formats: Sequence[str], run: RunData, *, is_plan: bool
) -> None:
    if "tum" in formats:
        write_tum(motion, into)
    if "csv" in formats:
        write_csv(motion, into)
    if "mcap" in formats:
        write_bag(motion, into, run.robot, is_plan=is_plan)
