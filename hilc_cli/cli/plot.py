"""``hilc plot``: draw pictures of runs, of a sweep or of a leaderboard from their tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_picture, complete_results
from hilc_cli.errors import UsageError
from hilc_cli.reporting.terminal import print_json, print_text, say
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.wording import printable

Runs = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="RUN",
        help="Run folders, or the folder of one sweep or leaderboard. "
        "[default: the newest in runs/]",
        autocompletion=complete_results,
        show_default=False,
    ),
]
Kinds = Annotated[
    list[options.PictureKind] | None,
    typer.Option(
        "--kind",
        metavar="KIND",
        autocompletion=complete_picture,
        help=f"What to draw; repeatable. Of runs: {', '.join(RUN_PICTURES)}; of one run as a GIF, "
        f"only if asked for: {', '.join(MOVING_PICTURES)}; of a sweep: "
        f"{', '.join(SWEEP_PICTURES)}; a leaderboard has one picture. [default: all there are]",
    ),
]


def plot(
    runs: Runs = None,
    kind: Kinds = None,
    formats: options.Formats = None,
    iterations: options.Iterations = None,
    dpi: options.Dpi = 150,
    width: options.Width = None,
    font: options.Font = "",
    font_size: options.FontSize = None,
    style: options.Style = None,
    no_title: options.NoTitle = False,
    out: options.OutputFolder = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Draw pictures of runs, a sweep or a leaderboard.

    One run, sweep or leaderboard is drawn into its own folder, without a name the newest in runs/
    that has such pictures; several runs are laid over each other and drawn into --out, by default
    runs/A-vs-B. All is drawn from tables; nothing is simulated.

    \b
    Examples:
      hilc plot
      hilc plot runs/fig3-circle --kind error --format svg
      hilc plot runs/fig3-circle --kind animation
      hilc plot runs/fig7a runs/fig7b --out limit --iterations 0,1,10,100
      hilc plot runs/fig8a-sweep --format pdf --width 8.5cm --font "DejaVu Serif"
      hilc plot runs/leaderboard --format svg --format pdf
    """
    from hilc_cli.cli.default_folders import RUNS, newest_results
    from hilc_cli.leaderboards.comparing import plot_leaderboard
    from hilc_cli.leaderboards.folder import is_leaderboard, read_leaderboard
    from hilc_cli.sweeps.sweep_folder import is_sweep, plot_sweep, read_sweep

    kinds = [str(name) for name in kind or []]
    if formats and kinds and all(name in MOVING_PICTURES for name in kinds):
        raise UsageError(f"--format: {kinds[0]} is always a GIF; leave --format out")
    if not runs:
        runs = [newest_results(RUNS, kinds)]
        if not quiet:
            say(f"no run is named: drawing the newest, {runs[0]}")
    drawing: dict[str, Any] = {"formats": options.picture_formats(formats), "dpi": dpi}
    drawing["look"] = options.picture_look(width, font, font_size, style, no_title)
    # Pictures in the folder of what they show are made from what stands beside them.
    drawing["may_replace"] = lambda file: force or out is None
    if any(map(is_sweep, runs)):
        if len(runs) > 1 or iterations is not None:
            raise UsageError("a sweep is drawn on its own, and without --iterations")
        folder = out or runs[0]
        pictures = plot_sweep(read_sweep(runs[0]), folder, kinds=kinds, **drawing)
    # Among runs, those that a pattern such as runs/* finds, too, are left out.
    elif all(map(is_leaderboard, runs)):
        if len(runs) > 1 or iterations is not None or kinds:
            raise UsageError("a leaderboard is drawn alone, without --iterations and --kind")
        folder = out or runs[0]
        pictures = plot_leaderboard(read_leaderboard(runs[0]), folder, **drawing)
    else:
        folder, pictures = _plot_runs(runs, kinds, iterations, out, drawing, force=force)
    if json:
        print_json({"folder": str(folder), "files": [str(picture) for picture in pictures]})
    elif not quiet:
        print_text("\n".join(printable(str(picture)) for picture in pictures))


def _plot_runs(
    folders: list[Path],
    kinds: Sequence[str],
    iterations: str | None,
    out: Path | None,
    drawing: dict[str, Any],
    *,
    force: bool,
) -> tuple[Path, list[Path]]:
    from hilc_cli.cli.default_folders import (
        check_shared_folder,
        shared_folder,
        without_comparisons,
    )
    from hilc_cli.files import is_there
    from hilc_cli.runs.run_folder import ITERATIONS
    from hilc_cli.runs.running import as_runs, plot

    if iterations is not None:
        options.whole_numbers("--iterations", iterations)  # before anything is read
    if len(folders) > 1:
        folders = without_comparisons(folders) or folders
    elif not is_there(folders[0] / ITERATIONS):
        raise UsageError(
            f"{folders[0]}: holds neither a run nor a sweep nor a leaderboard; "
            "give a folder that hilc has written"
        )
    runs = as_runs(folders)
    recorded = {iteration for run in runs for iteration in run.trials}
    chosen = options.chosen_iterations(iterations, recorded)
    folder = out or (folders[0] if len(folders) == 1 else shared_folder(folders))
    if len(folders) > 1:
        check_shared_folder(folder)
        drawing["may_replace"] = lambda file: force
    return folder, plot(runs, folder, kinds=kinds, iterations=chosen, **drawing)
