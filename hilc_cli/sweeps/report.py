"""What ``hilc sweep`` tells of a sweep, before and after."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from hilc_cli.reporting.terminal import (
    print_json,
    print_table,
    print_text,
    progress,
    say,
    say_notes,
    say_timings,
    two_columns,
)
from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE, MAX_ERROR, MAX_ERROR_SECOND_HALF, PEAK
from hilc_cli.sweeps.choice_report import choices_document, choices_table, shown
from hilc_cli.sweeps.choices import as_sweep_of_choices, best_case, choices_of
from hilc_cli.sweeps.data import BEST, summarise_sweep, tied
from hilc_cli.variation import Range
from hilc_cli.wording import counted, printable

if TYPE_CHECKING:
    from rich.table import Table

    from hilc_cli.sweeps.chunks import Failure
    from hilc_cli.sweeps.data import OwnValues, SweepData, SweepSummary
    from hilc_cli.sweeps.estimate import Estimate
    from hilc_cli.sweeps.plan import Plan
    from hilc_cli.sweeps.sweeping import Sweep


_NOTHING = "-"


def search_table(summary: SweepSummary, as_it_is: OwnValues, row: str, of: str) -> Table:
    """The best case beside the scenario as it is, key by key.

    Args:
        summary: Of the cases; of the choices where keys happen.
        as_it_is: The scenario as it is.
        row: ``case`` or ``choice``.
        of: What is minimised, in words.
    """
    from rich import box
    from rich.table import Table

    best = next(iter(summary.best), None)
    table = Table(
        title=f"Smallest {of}",
        box=box.SIMPLE_HEAD,
        title_justify="left",
        title_style="bold",
    )
    table.add_column("")
    table.add_column("as it is", justify="right")
    table.add_column("best" if best is None else f"best, {row} {best.case}", justify="right")
    of_best = math.nan if best is None else best.metric
    table.add_row(of, _number(as_it_is.metric), _number(of_best))
    for key, value in as_it_is.values.items():
        found = _NOTHING if best is None else shown(best.values[key])
        table.add_row(*map(printable, (key, shown(value), found)))
    return table


def search_document(summary: SweepSummary, as_it_is: OwnValues, folder: Path) -> dict[str, Any]:
    """Returns the best case beside the scenario as it is, for a JSON document."""
    best = next(iter(summary.best), None)
    return {
        "minimise": summary.metric,
        "as_it_is": as_it_is.to_data(),
        "best": None if best is None else asdict(best),
        "scenario": None if best is None else str(folder / BEST),
    }


def _number(number: float) -> str:
    return f"{number:.6g}" if math.isfinite(number) else _NOTHING


SOME_FAILED = NOTHING_FOUND = 3
AGAIN = "the same command with --resume tries these cases again"
SHARDS_AGAIN = "--resume of their shards tries these cases again"
_NO_BETTER = "Best case tried, no better than the scenario as it is"
_MOST_FAILURES = 10
"""The largest number of failures that are named one by one."""


@dataclass(frozen=True, slots=True)
class SweepReport:
    """Tells of a sweep as the user wants to hear it.

    Attributes:
        json: As one JSON document.
        quiet: Nothing but errors.
        verbose: More than usual.
    """

    json: bool
    quiet: bool
    verbose: bool

    def say(self, message: str) -> None:
        """Says something on stderr, unless nothing is to be said."""
        if not self.quiet:
            say(message)

    def compiling(self) -> None:
        """Says why nothing moves for some seconds."""
        self.say("compiling the engine for this machine, once for each kind of experiment")

    def warnings(self, plan: Plan) -> None:
        """Says what was done to what was read, and what is legal but probably not meant."""
        say_notes(plan.scenario.notes, quiet=self.quiet)
        for warning in plan.warnings():
            self.say(f"warning: {warning}")

    def progress(self, plan: Plan, cases: int) -> AbstractContextManager[Callable[[int], None]]:
        """Shows a progress bar over so many cases."""
        return progress(plan.name, cases, quiet=self.quiet)

    def estimate(self, plan: Plan, estimate: Estimate) -> None:
        """Tells what a sweep would cost."""
        if self.json:
            print_json({"name": plan.name, **asdict(estimate)})
            return
        if self.quiet:
            return
        workers = counted(estimate.workers, "worker")
        rows = [
            ("cases", f"{estimate.cases:,}{_crossed(estimate)}"),
            ("samples of all iterations", f"{estimate.samples:,.0f}"),
            (
                "time",
                f"about {_duration(estimate.seconds)} with {workers}",
            ),
            ("memory", f"about {_size(estimate.memory)}"),
            ("disk, until it is done", f"about {_size(estimate.disk)}"),
        ]
        print_table(two_columns(f"{plan.name}, not computed", rows))

    def result(self, result: Sweep, folder: Path, again: str) -> None:
        """How a sweep went, and how to try cases again that have failed.

        Raises:
            typer.Exit: Some cases have failed, or a search has found nothing.
        """
        self._summary(result, result.failures, folder)
        if self.verbose:
            say_timings(result.how.get("timings_s", {}))
        self._failures(result.failures, again)
        _check_found(result)

    def complete(self, folder: Path) -> None:
        """A sweep of which nothing is left to do.

        Raises:
            typer.Exit: It was a search that has found nothing.
        """
        from hilc_cli.sweeps.sweep_folder import read_sweep

        self.say(f"nothing to resume: {folder} is complete")
        data = read_sweep(folder)
        self._summary(data, (), folder)
        _check_found(data)

    def _summary(self, data: SweepData, failures: Sequence[Failure], folder: Path) -> None:
        # Of what happens, the luckiest case is nobody's choice.
        summary, as_it_is = summarise_sweep(data, 0 if data.over else 5), data.as_it_is
        ranked = as_sweep_of_choices(data) if data.over else data
        best = summarise_sweep(ranked)
        if self.json:
            document = {
                "folder": str(folder),
                **asdict(summary),
                "failures": [failure.to_data() for failure in failures],
            }
            if as_it_is is not None:
                document["search"] = search_document(best, as_it_is, folder)
            if data.over:
                document["choices"] = choices_document(data, choices_of(data), folder)
            print_json(document)
        elif not self.quiet:
            title = f"{summary.name}, {summary.cases:,} cases"
            print_table(two_columns(title, summary_rows(summary)))
            if data.over and best.best:
                print_table(choices_table(data, choices_of(data)))
            if as_it_is is not None:
                print_table(search_table(best, as_it_is, ranked.row, measured(ranked)))
            print_text(f"Written to {folder}")
            if best.best and (data.over or as_it_is is not None):
                good = as_it_is is None or found_better(ranked)
                print_text(f"{'Best scenario' if good else _NO_BETTER}: {folder / BEST}")
        for note in sweep_notes(ranked, best):
            self.say(note)

    def shard(
        self, plan: Plan, part: tuple[int, int], failures: Sequence[Failure], folder: Path
    ) -> None:
        """How a shard went.

        Raises:
            typer.Exit: Some cases have failed.
        """
        number, shards = part
        if self.json:
            print_json(
                {
                    "folder": str(folder),
                    "shard": [number, shards],
                    "failures": [failure.to_data() for failure in failures],
                }
            )
        elif not self.quiet:
            print_text(f"Shard {number} of {shards} of {plan.name} is in {folder}")
        self._failures(failures, AGAIN)

    def _failures(self, failures: Sequence[Failure], again: str) -> None:
        for failure in failures[:_MOST_FAILURES]:
            say(str(failure))
        if len(failures) > _MOST_FAILURES:
            say(f"... and {len(failures) - _MOST_FAILURES} more")
        if failures:
            say(again)
            raise typer.Exit(SOME_FAILED)


def measured(data: SweepData) -> str:
    """What cases or choices are ranked by."""
    return f"{data.figure} {data.metric}".strip()


def _check_found(data: SweepData) -> None:
    if data.as_it_is is not None and best_case(data) is None:
        raise typer.Exit(NOTHING_FOUND)


def summary_rows(summary: SweepSummary) -> list[tuple[str, str]]:
    """Returns names and values of the figures of a sweep."""
    metric = summary.metric
    rows = [("diverged", f"{summary.diverged:,}")]
    if summary.failed:
        rows.append(("failed", f"{summary.failed:,}"))
    if summary.within_tolerance is not None:
        rows.append((f"settled within {summary.tolerance:g} m", f"{summary.within_tolerance:,}"))
    if summary.median is not None and summary.worst is not None:
        part = summary.ranked < summary.cases
        of_these = f", of the {summary.ranked:,} that have it" if part else ""
        rows.append((f"median {metric}{of_these}", f"{summary.median:.6g}"))
        rows.append((f"largest {metric}{of_these}", f"{summary.worst:.6g}"))
    for best in summary.best:
        values = ", ".join(f"{key}={shown(value)}" for key, value in best.values.items())
        rows.append((f"case {best.case}: {values}", f"{best.metric:.6g}"))
    return rows


def _crossed(estimate: Estimate) -> str:
    """Of how many choices and happenings the cases are, if some keys happen."""
    if estimate.choices is None or estimate.happenings is None:
        return ""
    choices, every = (f"{number:,}" for number in (estimate.choices, estimate.happenings))
    return f" = {choices} choices x {every} happenings"


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.2g} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def _size(size: float) -> str:
    return f"{size / 1e6:.0f} MB" if size < 1e9 else f"{size / 1e9:.1f} GB"


_HIDING = (MAX_ERROR, PEAK, ITERATIONS_TO_TOLERANCE)
"""Metrics that an initial error may decide alone."""
_NEAR = 0.01  # of the range


def sweep_notes(data: SweepData, summary: SweepSummary) -> list[str]:
    """Ties for the best case; and of a search how good its best case is.

    Args:
        data: The sweep; where keys happen, that of its choices.
        summary: Of the same.
    """
    best = summary.best[0].case if summary.best else None
    notes = [] if best is None or summary.tied < 2 else _tie(data, best)
    if best is None:
        return [f"no {data.row} has a value of {measured(data)}, so there is no {BEST}"]
    if data.as_it_is is None:
        return notes
    if not found_better(data):
        return [*notes, f"no {data.row} is better than the scenario as it is"]
    # Of several best cases it says nothing where one of them lies.
    return notes or _at_ends(data, best)


def found_better(data: SweepData) -> bool:
    """Whether the best case of a search is better than the scenario as it is."""
    best = next(iter(data.ranked()), None)
    if best is None or data.as_it_is is None:
        return False
    # What has no metric is no better than anything.
    return not data.columns[data.metric][best] >= data.as_it_is.metric


def _tie(data: SweepData, best: int) -> list[str]:
    """Says that there are several best cases, and what would tell them apart.

    Those of a search that lie next to each other are the bottom of one hollow, as it should be.
    """
    cases = tied(data)
    if data.as_it_is is not None and all(_is_beside(data, best, int(case)) for case in cases):
        return []
    value = f"{data.columns[data.metric][best]:.6g}"
    where = "" if data.as_it_is is None else f", and the one in {BEST}"
    note = f"{len(cases):,} of {len(data):,} {data.row}s share the best {measured(data)}, {value}; "
    note += f"{data.row} {best} is only one of them{where}"
    later = data.columns[MAX_ERROR_SECOND_HALF][cases]
    if data.metric in _HIDING and not np.allclose(later, later[0], rtol=0.01, equal_nan=True):
        option = "--metric" if data.as_it_is is None else "--minimise"
        note += f": {option} {MAX_ERROR_SECOND_HALF} tells them apart"
    return [note]


def _is_beside(data: SweepData, one: int, other: int) -> bool:
    """Whether two cases are nearer to each other than a search can tell, in all keys."""
    values, others = data.case(one), data.case(other)
    return all(
        abs(axis.place(values[key]) - axis.place(others[key])) < _NEAR
        if isinstance(axis, Range) and axis.low < axis.high
        else values[key] == others[key]
        for key, axis in data.axes.items()
    )


def _at_ends(data: SweepData, best: int) -> list[str]:
    values = data.case(best)
    return [
        f"{key} of the best {data.row} is at the end of its range: a wider one may hold a better "
        "value"
        for key, axis in data.axes.items()
        if isinstance(axis, Range) and _is_at_end(axis, values[key])
    ]


def _is_at_end(axis: Range, value: object) -> bool:
    """Whether a value is hardly farther from an end of the range than a search can tell."""
    assert isinstance(value, int | float)  # of a range
    low, number, high = axis.low, float(value), axis.high
    if axis.spacing == "log":
        low, number, high = math.log(low), math.log(number), math.log(high)
    return min(number - low, high - number) < _NEAR * (high - low)
