"""``hilc reproduce``: the paper's figures and claims, with the data of every panel."""

from __future__ import annotations

import sys
from enum import StrEnum
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.cli.session import Session
from hilc_cli.reporting.terminal import print_json, print_text, progress, say_timings

if TYPE_CHECKING:
    from hilc_cli.paper.plan import ReproductionPlan


def complete_figure(incomplete: str) -> list[str]:
    """Names of figures that an argument may go on with."""
    from hilc_cli.paper.contents import FIGURE_NAMES

    return [name for name in FIGURE_NAMES if name.startswith(incomplete)]


Figures = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="FIG",
        help="Figures of the paper, fig3 to fig8. [default: all, and the claims]",
        autocompletion=complete_figure,
        show_default=False,
    ),
]


Bibtex = Annotated[
    bool, typer.Option("--bibtex", help="Print how to cite the paper, and do nothing else.")
]


class ReadingChoice(StrEnum):
    """How the paper may be read."""

    LITERAL = "literal"
    DERIVATIVE = "derivative"
    BOTH = "both"


Readings = Annotated[
    ReadingChoice,
    typer.Option(
        "--reading",
        help="How the paper is read: its law and starts as printed, or with l1 acting on the "
        "error and its derivative (tau = 0.1 s) and two starts taken for misprints.",
    ),
]


def reproduce(
    context: typer.Context,
    figures: Figures = None,
    reading: Readings = ReadingChoice.BOTH,
    out: options.OutputFolder = None,
    force: options.Force = False,
    formats: options.Formats = None,
    dpi: options.Dpi = 300,
    width: options.Width = None,
    font: options.Font = "",
    font_size: options.FontSize = None,
    style: options.Style = None,
    no_title: options.NoTitle = False,
    bibtex: Bibtex = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Reproduce the paper's figures 3 to 8 and judge its claims.

    Writes to runs/reproduce: the figures, the data of every panel, claims.md and claims.csv, and
    index.md that shows it all. Judging the claims takes the runs of all figures.

    The paper is read twice, side by side: as printed (fig3-literal.png), and with a derivative in
    its law, under which other claims hold (fig3-derivative.png). Neither is known to be what its
    authors ran.

    \b
    Examples:
      hilc reproduce
      hilc reproduce fig3 fig5 --reading derivative --out runs/second-reading
      hilc reproduce fig3 fig7 --format svg --out runs/two-figures
      hilc reproduce fig6 --format pdf --width 175mm --font "DejaVu Serif"
      hilc reproduce --bibtex >> thesis.bib
    """
    if bibtex:
        from hilc_cli.paper.citation import BIBTEX

        print_text(BIBTEX.rstrip("\n"))
        return
    from hilc_cli.paper.plan import plan_reproduction
    from hilc_cli.paper.report import document, print_claims
    from hilc_cli.paper.reproducing import check_reproduction, reproduce

    look = options.picture_look(width, font, font_size, style, no_title)
    plan = plan_reproduction(figures or [], reading=reading.value)
    folder = out or Path("runs") / "reproduce"
    chosen = options.picture_formats(formats)
    check_reproduction(plan, folder, force=force)
    session: Session = context.obj
    with progress("reproduce", plan.steps, quiet=quiet, stage=partial(_stage, plan)) as advance:
        done = count(1)

        def on_step() -> None:
            session.go_on()
            advance(next(done))

        result = reproduce(plan, on_step=on_step)
        timings = result.write(
            folder,
            force=force,
            formats=chosen,
            dpi=dpi,
            look=look,
            command=sys.argv,
            on_step=on_step,
        )
    if json:
        print_json(document(result, folder, chosen))
    elif not quiet:
        print_claims(result)
        print_text(f"Written to {folder}; begin with {folder / 'index.md'}")
    if verbose:
        say_timings(result.timings, timings)


def _stage(plan: ReproductionPlan, done: int) -> str:
    """What is going on after so many steps: runs, then claims, then figures."""
    claims = done - plan.runs
    if claims < 0:
        return ": simulating"
    if claims < len(plan.claims) * len(plan.readings):
        # The first claims may wait some seconds for machine code.
        return ": judging claims (the first time, the engine is compiled)"
    return ": drawing"
