"""Sweeps and leaderboards on a page: what they print, and their pictures."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from hilc_cli.comparisons.formats import Cell, Grid
from hilc_cli.comparisons.table import number_text
from hilc_cli.html_reports.chapter import Chapter, Table, comparison, names_and_values, picture
from hilc_cli.leaderboards.comparing import LawComparison
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.picture import leaderboard_figure
from hilc_cli.results.metrics import CASE_COLUMNS, CASE_METRICS
from hilc_cli.results.picture_kinds import SWEEP_PICTURES
from hilc_cli.sweeps.choice_report import shown
from hilc_cli.sweeps.choices import FIGURES, as_sweep_of_choices, choices_of
from hilc_cli.sweeps.data import SweepData, summarise_sweep
from hilc_cli.sweeps.pictures.catalogue import draw_sweep, kinds_for
from hilc_cli.sweeps.report import summary_rows, sweep_notes
from hilc_cli.wording import counted, listed

_BEST_CASES, _BEST_CHOICES = 25, 10
LEADERBOARD_SHOWS = "how near each law comes to the trajectory, and how soon"
_DIGITS = 4


def sweep_chapter(data: SweepData) -> Chapter:
    """A sweep: how it went, its best cases or choices, its pictures."""
    summary = summarise_sweep(data)
    rows = summary_rows(replace(summary, best=[]) if data.over else summary)
    return Chapter(
        kind="sweep",
        title=data.name,
        headline=headline_of(data),
        warnings=notes_of(data),
        tables=[names_and_values("How it went", rows), *best_choices(data), best_cases(data)],
        pictures=[
            picture(SWEEP_PICTURES[kind].shows, partial(draw_sweep, kind, data))
            for kind in kinds_for(data)
        ],
    )


def notes_of(data: SweepData) -> list[str]:
    """What there is to be said of the cases of a sweep, or of its choices."""
    ranked = as_sweep_of_choices(data) if data.over else data
    return sweep_notes(ranked, summarise_sweep(ranked))


def headline_of(data: SweepData) -> str:
    """How many cases a sweep has, and of what; of choices first, if some keys happen."""
    cases = f"{counted(len(data), 'case')}"
    if not data.over:
        return f"{cases} of {listed(data.axes)}"
    choices = choices_of(data)
    return (
        f"{counted(len(choices), 'choice')} of {listed(choices.values)}, each with what may happen "
        f"to {listed(data.over)}: {cases}"
    )


def best_choices(data: SweepData) -> list[Table]:
    """The choices with the smallest figure, if there are any, with what is known of their cases."""
    choices = choices_of(data)
    ranked = choices.ranked()[:_BEST_CHOICES]
    if not data.over or not ranked:
        return []
    rows = tuple(
        (
            Cell(str(number)),
            *(Cell(shown(value)) for value in choices.choice(number).values()),
            *(Cell(_number(data.metric, float(choices.figures[name][number]))) for name in FIGURES),
            Cell(f"{choices.diverged[number]} of {choices.cases[number]}"),
            Cell(str(choices.worst_case[number])),
        )
        for number in ranked
    )
    words = ("Worst", "95 % quantile", "Median", "Mean")
    heads = ("Choice", *choices.values, *words, "Diverged", "Worst case")
    unit = f"[{CASE_COLUMNS[data.metric].unit}]" if CASE_COLUMNS[data.metric].unit else ""
    units = ("", *("" for _ in choices.values), *(unit for _ in words), "", "")
    note = f"All {len(choices):,} choices are in choices.csv." if len(ranked) < len(choices) else ""
    caption = f"Best choices by their {choices.robust} {data.metric}"
    return [Table(caption, (Grid("", (heads, units), (True,) * len(heads), rows),), note)]


def best_cases(
    data: SweepData,
    most: int = _BEST_CASES,
    *,
    by_metric_alone: bool = False,
    rest: str = "cases.csv",
) -> Table:
    """The cases with the smallest metric, with what else is known of them.

    Args:
        data: The sweep.
        most: So many are told.
        by_metric_alone: Leave out the other metrics.
        rest: Where the other cases are.
    """
    cases = data.ranked()[:most]
    others = [name for name in CASE_METRICS if name != data.metric]
    metrics = [data.metric, *([] if by_metric_alone else others)]
    rows = tuple(
        (
            Cell(str(case)),
            *(Cell(shown(value)) for value in data.case(case).values()),
            *(Cell(_number(name, float(data.columns[name][case]))) for name in metrics),
        )
        for case in cases
    )
    heads = ["Case", *data.axes]
    heads += [f"{CASE_COLUMNS[name].words[:1].upper()}{CASE_COLUMNS[name].words[1:]}"
              for name in metrics]  # fmt: skip
    units = [""] * (1 + len(data.axes))
    units += [f"[{CASE_COLUMNS[name].unit}]" if CASE_COLUMNS[name].unit else "" for name in metrics]
    grid = Grid("", (tuple(heads), tuple(units)), (True,) * len(heads), rows)
    more = len(data) - len(cases)
    note = f"The other {more:,} cases are in {rest}." if more else ""
    return Table(f"Best cases by {data.metric}", (grid,), note, is_folded=True)


def _number(name: str, value: float) -> str:
    if not np.isfinite(value):
        return "infinite" if value > 0 else "-"
    return str(int(value)) if CASE_COLUMNS[name].whole else number_text(value, _DIGITS)


def leaderboard_chapter(data: LeaderboardData) -> Chapter:
    """A leaderboard: its tables and its picture."""
    laws = LawComparison(data, "", {})
    *first, entries = laws.printed(everything=True)
    cases = len({entry.case for entry in data.entries})
    return Chapter(
        kind="leaderboard",
        title=data.name,
        headline=f"{len(data.laws)} laws in {cases} cases, {len(data.entries)} runs",
        tables=[*map(comparison, first), comparison(entries, is_folded=True)],
        pictures=[
            picture(
                LEADERBOARD_SHOWS,
                partial(leaderboard_figure, data),
            )
        ],
    )
