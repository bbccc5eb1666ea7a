"""One page for a browser of runs, labs, sweeps and leaderboards: everything is in the file itself.

Names and texts of a folder may be anybody's. They are put into the page as text by Jinja2, which
escapes them, and the page tells the browser to run no program but its own, by its checksum, and to
ask for nothing.
"""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import base64
import hashlib
import math
import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from hilc_cli.errors import ExistingResultsError, MissingFileError, UsageError
from hilc_cli.files import is_there, open_to_read, write_file, writing
from hilc_cli.html_reports.chapter import Chapter
from hilc_cli.html_reports.of_runs import comparison_chapter, run_chapter
from hilc_cli.html_reports.of_tables import leaderboard_chapter, sweep_chapter
from hilc_cli.html_reports.templates import own_file, template
from hilc_cli.leaderboards.comparing import LawComparison
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.folder import is_leaderboard, read_leaderboard
from hilc_cli.results.run import RunData
from hilc_cli.runs.run_folder import ITERATIONS, LAB_FOLDER
from hilc_cli.runs.running import as_runs
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.sweep_folder import is_sweep, read_sweep
from hilc_cli.version import __version__
from hilc_cli.wording import listed

_ENDINGS = (".html", ".htm")
_MOST_WHOLE = 4
"""With more results than that, each run has few pictures."""
_MARK = '<meta name="hilc-report" content="{}">'
_HEAD = 1000  # bytes in which the mark is


Place = Path | str
"""The folder of a result; of one that is in memory only, what it is called among the others."""

ResultSource = RunData | SweepData | LeaderboardData | LawComparison | str | Path
"""A result of which a page can tell, or its folder."""


@dataclass(frozen=True, slots=True, eq=False)
class Results:
    """What a page is about.

    Attributes:
        folders: Where it was read, in the order in which it is told.
        runs: Runs and labs, by folder.
        sweeps: Likewise.
        leaderboards: Likewise.
    """

    folders: tuple[Place, ...]
    runs: Mapping[Place, RunData]
    sweeps: Mapping[Place, SweepData]
    leaderboards: Mapping[Place, LeaderboardData]

    def __repr__(self) -> str:
        return f"Results of {listed(self.folders)}"

    @property
    def recorded(self) -> set[int]:
        """The iterations that any run has recorded."""
        return {number for run in self.runs.values() for number in run.trials}


def read_results(sources: Sequence[ResultSource]) -> Results:
    """Reads runs, labs, sweeps and leaderboards; no code of theirs is run.

    Args:
        sources: Their folders; what is in memory already is taken as it is.

    Raises:
        UsageError: A folder holds no such results, or something else is given.
        HilcError: It is damaged.
    """
    runs: dict[Place, RunData | None] = {}
    sweeps: dict[Place, SweepData] = {}
    leaderboards: dict[Place, LeaderboardData] = {}
    places: dict[Place, None] = {}
    for number, source in enumerate(sources, 1):
        place = Path(source) if isinstance(source, str | Path) else f"result {number}"
        places[place] = None
        if isinstance(source, RunData):
            runs[place] = source
        elif isinstance(source, SweepData):
            sweeps[place] = source
        elif isinstance(source, LeaderboardData | LawComparison):
            leaderboards[place] = source.data if isinstance(source, LawComparison) else source
        elif not isinstance(place, Path):
            raise UsageError(
                "a report is of runs, sweeps, leaderboards and their folders; "
                f"got {type(source).__name__}"
            )
        elif is_sweep(place):
            sweeps[place] = read_sweep(place)
        elif is_leaderboard(place):
            leaderboards[place] = read_leaderboard(place)
        else:
            runs[place] = None
    if not places:
        raise UsageError("there is nothing to report; give at least one folder with results")
    for place in runs:
        if not isinstance(place, Path):
            continue
        if not is_there(place / ITERATIONS) and not LAB_FOLDER.is_at(place):
            raise UsageError(
                f"{place}: holds no run, lab, sweep or leaderboard; give a folder that hilc has "
                "written"
            )
    read = as_runs([place if run is None else run for place, run in runs.items()])
    return Results(tuple(places), dict(zip(runs, read, strict=True)), sweeps, leaderboards)


def report(
    results: Results | ResultSource | Sequence[ResultSource],
    file: str | Path,
    *,
    title: str = "",
    iterations: Collection[int] | None = None,
    force: bool = False,
) -> Path:
    """Writes results as one page for a browser; nothing is simulated.

    Args:
        results: One or several runs, sweeps and leaderboards, or folders of them and of labs, or
            what `read_results` made of these. Several runs are compared.
        file: The page, such as ``report.html``.
        title: What stands above it; by default the names of the results.
        iterations: Recorded iterations of runs that are shown; all by default.
        force: Whether another file that stands there may be replaced. A report of the same results
            is replaced in any case.

    Returns:
        The file.

    Raises:
        UsageError: A folder holds no such results, an iteration is not recorded, or the name is
            none of a page.
        ExistingResultsError: Another file stands there.
        FileAccessError: It cannot be written.
        HilcError: A folder is damaged.
    """
    file = Path(file)
    check_report_file(file, force=force)
    if not isinstance(results, Results):
        alone = isinstance(results, ResultSource) or not isinstance(results, Sequence)
        results = read_results([results] if alone else results)  # type: ignore[list-item, arg-type]
    if iterations is not None:
        _check_recorded(iterations, results.recorded)
    chapters = _chapters(results, iterations)
    title = title or listed((each.title for each in chapters if each.kind != "comparison"), 3)
    mark = _mark(chapters)
    if not force and mark not in _begin_of(file):
        _check_free(file)
    content = _page(chapters, title, mark)
    with writing(file):
        file.parent.mkdir(parents=True, exist_ok=True)
    write_file(file, lambda draft: _write(draft, content))
    return file


def is_page(file: str | Path) -> bool:
    """Whether a path is called like a page."""
    return Path(file).suffix.lower() in _ENDINGS


def check_report_file(file: Path, *, force: bool = False) -> None:
    """Makes sure that a report may be written, before minutes are spent on it.

    Raises:
        UsageError: Its name is none of a page, or that of a folder.
        ExistingResultsError: Something else than a report stands there.
    """
    if not is_page(file):
        raise UsageError(f"--out {file}: is no name of a page; give one such as report.html")
    if file.is_dir():
        raise UsageError(f"--out {file}: is a folder; give the name of a file, such as report.html")
    if not force and _MARK.partition("{")[0] not in _begin_of(file):
        _check_free(file)


def _write(path: Path, content: str) -> None:
    path.write_text(content, encoding="utf-8", newline="\n")


def _check_free(file: Path) -> None:
    """Makes sure that nothing of somebody's own is replaced.

    Raises:
        ExistingResultsError: Something stands there.
    """
    if os.path.lexists(file):
        raise ExistingResultsError(
            f"{file}: exists and is no report of the same results; "
            "choose another file with --out, or replace it with --force"
        )


def _begin_of(file: Path) -> str:
    """The first bytes of a file; empty if there is none."""
    if not os.path.lexists(file):
        return ""
    try:
        descriptor = open_to_read(file)
    except MissingFileError:
        return ""
    with os.fdopen(descriptor, "rb") as stream:
        return (stream.read(_HEAD) or b"").decode("utf-8", "replace")


def _mark(chapters: Sequence[Chapter]) -> str:
    """The line by which a report of the same results is known."""
    names = "\0".join(f"{chapter.kind} {chapter.title}" for chapter in chapters)
    return _MARK.format(hashlib.sha256(names.encode("utf-8", "surrogatepass")).hexdigest())


def _chapters(results: Results, iterations: Collection[int] | None) -> list[Chapter]:
    """Tells results in their order; several runs side by side before anything else."""
    runs = list(results.runs.values())
    in_short = len(results.folders) > _MOST_WHOLE
    chapters = [comparison_chapter(runs)] if len(runs) > 1 else []
    for folder in results.folders:
        if folder in results.sweeps:
            chapters.append(sweep_chapter(results.sweeps[folder]))
        elif folder in results.leaderboards:
            chapters.append(leaderboard_chapter(results.leaderboards[folder]))
        else:
            run = results.runs[folder]
            # A run without any of them is shown as it is.
            shown = None if iterations is None else set(iterations) & set(run.trials) or None
            share = 1 / math.sqrt(len(runs))
            chapters.append(
                run_chapter(
                    run,
                    folder if isinstance(folder, Path) else None,
                    shown,
                    share=share,
                    in_short=in_short,
                )
            )
    return chapters


def _check_recorded(iterations: Collection[int], recorded: Collection[int]) -> None:
    missing = sorted(set(iterations) - set(recorded))
    if missing:
        known = listed(sorted(recorded), 40) or "none"
        raise UsageError(f"iterations {listed(missing)} not recorded; recorded: {known}")


def _page(chapters: Sequence[Chapter], title: str, mark: str) -> str:
    """The whole page as text."""
    from markupsafe import Markup

    style, program = own_file("page.css"), own_file("player.js")
    return template("report.html.j2").render(
        title=title,
        chapters=chapters,
        mark=Markup(mark),
        style=Markup(style),
        program=Markup(program),
        style_checksum=_checksum(style),
        program_checksum=_checksum(program),
        version=__version__,
    )


def _checksum(text: str) -> str:
    """By which the browser knows a program or a style of the page's own."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")
