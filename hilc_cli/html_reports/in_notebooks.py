"""Results in a notebook: each is a part of a page, with one picture and the tables that tell most.

The part brings its style along, of which every rule begins with its class, and its picture as an
image of its own, whose ids nobody else sees: any number of them may stand in one notebook.
"""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from hilc_cli.checks.checking import Check
from hilc_cli.checks.picture import figure_of
from hilc_cli.checks.report.whole import rows_in_brief
from hilc_cli.comparisons.comparing import Comparison
from hilc_cli.comparisons.formats import Cell, Grid
from hilc_cli.comparisons.picture import comparison_figure
from hilc_cli.html_reports.chapter import (
    NARROW,
    Chapter,
    Picture,
    Table,
    comparison,
    names_and_values,
    picture,
)
from hilc_cli.html_reports.of_tables import (
    LEADERBOARD_SHOWS,
    best_cases,
    best_choices,
    headline_of,
    notes_of,
)
from hilc_cli.html_reports.templates import own_file, template
from hilc_cli.identification.identifying import Identification
from hilc_cli.identification.report import HEADER, estimate_row, sentences
from hilc_cli.labs.lab import Lab
from hilc_cli.labs.report import TRIALS_HEADER, next_rows, trial_row, warnings_of
from hilc_cli.labs.state import LabState
from hilc_cli.leaderboards.comparing import LawComparison
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.picture import leaderboard_figure
from hilc_cli.paper.claim_texts import count_texts, readings_of
from hilc_cli.paper.reproducing import Reproduction
from hilc_cli.paths.picture import path_figure
from hilc_cli.paths.report import total_rows
from hilc_cli.paths.showing import ShownPath, show
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.picture_kinds import RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.results.run import RunData
from hilc_cli.results.summary import summarise
from hilc_cli.runs.pictures.catalogue import draw
from hilc_cli.runs.report import learned_rows, summary_rows
from hilc_cli.sweeps.data import SweepData, summarise_sweep
from hilc_cli.sweeps.pictures.catalogue import draw_sweep, kinds_for
from hilc_cli.sweeps.report import summary_rows as sweep_rows
from hilc_cli.wording import counted, listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_LETTERS = 250_000
"""Of a picture in lines; a notebook keeps every result that it has shown."""
_MOST_TOLD = 6  # warnings
_BEST_CASES = 5
_MOST_BESIDE = 4  # columns of a table that has room beside a picture
_RUN_PICTURE = "path-change"


def as_html(result: Any) -> str:
    """A result as a part of a page.

    Args:
        result: One of those in `_CHAPTERS`.
    """
    make = next(make for kind, make in _CHAPTERS.items() if isinstance(result, kind))
    return _part(make(result))


def _part(chapter: Chapter) -> str:
    from markupsafe import Markup

    more = len(chapter.warnings) - _MOST_TOLD
    return template("notebook.html.j2").render(
        chapter=chapter,
        warnings=chapter.warnings[:_MOST_TOLD],
        more=counted(more, "more warning") if more > 0 else "",
        across=any(len(g.at_right) > _MOST_BESIDE for t in chapter.tables for g in t.grids),
        style=Markup(own_file("notebook.css")),
    )


def _drawn(caption: str, make: Callable[[Look], Figure], look: Look = NARROW) -> list[Picture]:
    return [picture(caption, make, _MOST_LETTERS, look)]


def _grid(caption: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    """A table of texts; a column in which one begins with a letter holds words."""
    columns = zip(*rows, strict=True) if rows else [()] * len(header)
    at_right = tuple(not any(text[:1].isalpha() for text in column) for column in columns)
    cells = tuple(tuple(map(Cell, row)) for row in rows)
    return Table(caption, (Grid("", (tuple(header),), at_right, cells),))


def _of_run(run: RunData) -> Chapter:
    if not run.trials:
        return Chapter("run", run.name, "No iteration completed.", run.warnings)
    summary = summarise(run)
    return Chapter(
        kind="run",
        title=run.name,
        headline=summary.headline,
        warnings=run.warnings,
        tables=[
            names_and_values(
                f"After iteration {summary.iterations}",
                summary_rows(replace(summary, learning={}), run.speed_limit),
            ),
            *_learned(run),
        ],
        pictures=_drawn(RUN_PICTURES[_RUN_PICTURE].shows, partial(draw, _RUN_PICTURE, [run], None)),
    )


def _learned(run: RunData) -> list[Table]:
    """What the law has learned, for who asks for it; nothing of a law that tells nothing."""
    rows = learned_rows(run.learning.last()) if run.learning.names else []
    if not rows:
        return []
    told = [(name.removeprefix("Learned: "), text) for name, text in rows]
    return [replace(names_and_values("What the law has learned", told), is_folded=True)]


def _of_sweep(data: SweepData) -> Chapter:
    summary = summarise_sweep(data, best=0)  # which have a table of their own
    kinds, look = kinds_for(data)[:1], NARROW if len(data.axes) <= 2 else USUAL
    return Chapter(
        kind="sweep",
        title=data.name,
        headline=headline_of(data),
        warnings=notes_of(data),
        tables=[
            names_and_values("How it went", sweep_rows(summary)),
            *best_choices(data),
            replace(
                best_cases(data, _BEST_CASES, by_metric_alone=True, rest="to_pandas()"),
                is_folded=False,
            ),
        ],
        pictures=[
            each
            for kind in kinds
            for each in _drawn(SWEEP_PICTURES[kind].shows, partial(draw_sweep, kind, data), look)
        ],
    )


def _of_comparison(result: Comparison) -> Chapter:
    return Chapter(
        kind="",  # which the title tells
        title=result.table.title,
        tables=[comparison(result.table)],
        pictures=_drawn("errors and last paths", partial(comparison_figure, result.runs)),
    )


def _of_laws(result: LawComparison | LeaderboardData) -> Chapter:
    data = result.data if isinstance(result, LawComparison) else result
    laws = result if isinstance(result, LawComparison) else LawComparison(data, "", {})
    return Chapter(
        kind="leaderboard",
        title=data.name,
        headline=f"{counted(len(data.laws), 'law')}, {counted(len(data.entries), 'run')}",
        tables=[comparison(table) for table in laws.laws.values()],
        pictures=_drawn(LEADERBOARD_SHOWS, partial(leaderboard_figure, data)),
    )


def _of_path(path: ShownPath) -> Chapter:
    return Chapter(
        kind="path",
        title=path.title,
        headline=path.demand.in_short,
        warnings=path.warnings,
        tables=[names_and_values("In numbers", total_rows(path))],
        pictures=_drawn("the path and what it asks for", partial(path_figure, path), USUAL),
    )


def _of_check(check: Check) -> Chapter:
    def shown(look: Look) -> Figure:
        return figure_of(check, look) or path_figure(show(check.scenario), look)

    known = check.forecast is not None
    caption = "the predicted error by iteration" if known else "the path"
    return Chapter(
        kind="check",
        title=check.scenario.name,
        headline=f"Verdict: {check.verdict}",
        warnings=check.warnings,
        errors=check.failures,
        tables=[names_and_values("What was checked", rows_in_brief(check))],
        pictures=_drawn(caption, shown, NARROW if known else USUAL),
    )


def _of_identification(found: Identification) -> Chapter:
    rows = [estimate_row(each) for each in found.estimates.values()]
    told = [("", text) for text in sentences(found)]
    unknown = [("", text) for text in found.unknown]
    return Chapter(
        kind="identification",
        title="Robot",
        headline=f"Identified from {found.length:.3g} m driven in {found.duration:.3g} s",
        warnings=found.warnings,
        tables=[
            _grid("Estimates", HEADER, rows),
            names_and_values("What else is told", told),
            *([names_and_values("Could not be known", unknown)] if unknown else []),
        ],
    )


def _of_lab(lab: Lab | LabState) -> Chapter:
    state, file = (lab.state, lab.plan_file) if isinstance(lab, Lab) else (lab, None)
    run = state.run
    trials = range(len(state.trials))
    tables = [names_and_values("Next", next_rows(state, file))]
    if not trials:
        drawn = _drawn("the planned path", partial(path_figure, show(state.scenario)), USUAL)
        headline = "No trial yet: the first plan is to be driven."
    else:
        drawn = _drawn(RUN_PICTURES[_RUN_PICTURE].shows, partial(draw, _RUN_PICTURE, [run], None))
        headline = summarise(run).headline
        heads = [f"{name} [{unit}]" if unit else name for name, unit in TRIALS_HEADER]
        rows = [trial_row(state, number) for number in trials]
        tables = [
            _grid("Trials", heads, rows),
            *tables,
            *_learned(run),
        ]
    return Chapter(
        kind=f"lab, {counted(len(trials), 'trial')}",
        title=run.name,
        headline=headline,
        warnings=warnings_of(state),
        tables=tables,
        pictures=drawn,
    )


def _of_reproduction(result: Reproduction) -> Chapter:
    figure, reading = result.plan.figures[0], result.plan.readings[0]
    readings = [each.name for each in readings_of(result.judged)] if result.judged else []
    claims = [
        (claim.name, *(found[each].verdict.value for each in readings), claim.sentence)
        for claim, found in result.judged
    ]
    return Chapter(
        kind="reproduction",
        title=listed(each.name for each in result.plan.figures),
        headline=". ".join(count_texts(result.judged)) if result.judged else "",
        tables=[_grid("Claims", ("Claim", *readings, "What the paper says"), claims)]
        if claims
        else [],
        pictures=_drawn(
            f"{figure.name}, {reading.name} reading",
            lambda look: result.sheet(figure, reading, look)[0],
            USUAL,
        ),
    )


_CHAPTERS: dict[type, Callable[[Any], Chapter]] = {
    RunData: _of_run,
    SweepData: _of_sweep,
    Comparison: _of_comparison,
    LawComparison: _of_laws,
    LeaderboardData: _of_laws,
    ShownPath: _of_path,
    Check: _of_check,
    Identification: _of_identification,
    Lab: _of_lab,
    LabState: _of_lab,
    Reproduction: _of_reproduction,
}
"""What tells of each kind of result. A new kind is a line here, and inherits `InNotebooks`."""
