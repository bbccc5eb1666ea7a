"""The commands of ``hilc``, in the order of ``hilc --help``."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperGroup

from hilc_cli.cli.check import check
from hilc_cli.cli.compare import compare
from hilc_cli.cli.drive import drive
from hilc_cli.cli.examples import examples
from hilc_cli.cli.export import export
from hilc_cli.cli.identify import identify
from hilc_cli.cli.learn import learn
from hilc_cli.cli.new import new
from hilc_cli.cli.options import Verbose, Version
from hilc_cli.cli.plot import plot
from hilc_cli.cli.report import report
from hilc_cli.cli.reproduce import reproduce
from hilc_cli.cli.run import run
from hilc_cli.cli.schema import schema
from hilc_cli.cli.show import show
from hilc_cli.cli.sweep import sweep

PANELS: dict[str, tuple[Any, ...]] = {
    "Simulate": (new, check, run),
    "Look": (show, plot, report),
    "Many at once": (compare, sweep),
    "Real robot": (learn, drive, identify),
    "Paper": (reproduce,),
    "Files": (export, examples, schema),
}
"""What the commands are for, and which there are, as ``hilc --help`` lists them."""


class _InPanels(TyperGroup):
    """Lists the commands of each panel below its name, as plain text."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Writes the commands into the help."""
        commands = {name: self.get_command(ctx, name) for name in self.list_commands(ctx)}
        width = max(map(len, commands))
        for panel in PANELS:
            rows = [
                (name.ljust(width), command.get_short_help_str(formatter.width - 6 - width))
                for name, command in commands.items()
                if command is not None and getattr(command, "rich_help_panel", None) == panel
            ]
            with formatter.section(panel):
                formatter.write_dl(rows)


app = typer.Typer(
    name="hilc",
    cls=_InPanels,
    rich_markup_mode=None,  # plain text reads the same in a terminal, a pipe and a log
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
)


@app.callback(invoke_without_command=True)
def hilc(context: typer.Context, verbose: Verbose = False, version: Version = False) -> None:
    """Iterative learning control for differential-drive robots.

    \b
    Example:
      hilc show example:fig3-circle
      hilc check example:fig3-circle
      hilc run example:fig3-circle
      hilc plot runs/fig3-circle --kind error --format svg
      hilc sweep example:fig8a --vary controller.gains.l1=0.05:1:20
      hilc report runs/fig3-circle
      hilc reproduce fig3
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


for panel, commands in PANELS.items():
    for command in commands:
        if isinstance(command, typer.Typer):
            app.add_typer(command, name="learn", rich_help_panel=panel)
        else:
            app.command(rich_help_panel=panel)(command)
