"""The commands of ``hilc``, in the order of ``hilc --help``."""

from __future__ import annotations

from collections.abc import Collection
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from hilc_cli.cli.options import Verbose, Version

PANELS: dict[str, tuple[str, ...]] = {
    "Simulate": ("new", "check", "run"),
    "Look": ("show", "plot", "report"),
    "Many at once": ("compare", "sweep"),
    "Real robot": ("learn", "drive", "identify"),
    "Paper": ("reproduce",),
    "Files": ("export", "examples", "schema"),
}
"""What the commands are for, and which there are, as ``hilc --help`` lists them.

Each is the function, or the group of commands, of its name in the file of its name.
"""
COMMANDS = tuple(name for names in PANELS.values() for name in names)


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


def make_app(names: Collection[str] = COMMANDS) -> typer.Typer:
    """The command line, with these of its commands: each one takes time to be loaded and parsed."""
    app = typer.Typer(
        name="hilc",
        cls=_InPanels,
        rich_markup_mode=None,  # plain text reads the same in a terminal, a pipe and a log
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 80},
    )
    app.callback(invoke_without_command=True)(hilc)
    for panel, its_names in PANELS.items():
        for name in its_names:
            if name not in names:
                continue
            command = getattr(import_module(f"hilc_cli.cli.{name}"), name)
            if isinstance(command, typer.Typer):
                app.add_typer(command, name=name, rich_help_panel=panel)
            else:
                app.command(rich_help_panel=panel)(command)
    return app


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
