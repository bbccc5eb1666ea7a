"""The commands of ``hilc``, in the order of ``hilc --help``."""

from __future__ import annotations

import typer

from hilc_cli.cli.check import check
from hilc_cli.cli.compare import compare
from hilc_cli.cli.drive import drive
from hilc_cli.cli.examples import examples
from hilc_cli.cli.export import export
from hilc_cli.cli.identify import identify
from hilc_cli.cli.learn import learn
from hilc_cli.cli.options import Version
from hilc_cli.cli.plot import plot
from hilc_cli.cli.report import report
from hilc_cli.cli.reproduce import reproduce
from hilc_cli.cli.run import run
from hilc_cli.cli.schema import schema
from hilc_cli.cli.show import show
from hilc_cli.cli.sweep import sweep

app = typer.Typer(
    name="hilc",
    rich_markup_mode=None,  # plain text reads the same in a terminal, a pipe and a log
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
)


@app.callback(invoke_without_command=True)
def hilc(context: typer.Context, version: Version = False) -> None:
    """Iterative learning control for differential-drive robots.

    \b
    Example:
      hilc show example:fig3-circle
      hilc check example:fig3-circle
      hilc run example:fig3-circle
      hilc plot runs/fig3-circle --kind error --format svg
      hilc sweep example:fig8a --vary controller.gains.l1=0.05:1:20
      hilc reproduce fig3
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


app.command()(run)
app.command()(show)
app.command()(check)
app.command()(plot)
app.command()(compare)
app.command()(report)
app.command()(sweep)
app.add_typer(learn, name="learn")
app.command()(drive)
app.command()(identify)
app.command()(export)
app.command()(reproduce)
app.command()(examples)
app.command()(schema)
