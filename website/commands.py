"""A page for each command, made from what the command line itself knows."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer.main
from typer.core import TyperGroup, TyperOption

from hilc_cli.cli.app import PANELS, make_app
from website.rst import code, contents, heading, literal, page, prose

FOLDER = "docs/reference/commands"


def write_pages(folder: Path) -> str:
    """Writes a page for each command, and one that lists them, whose name is returned."""
    panels = by_panel()
    for commands in panels.values():
        for name, command in commands.items():
            page(folder, f"{FOLDER}/{name}.rst", _page(_context(name, command, None)))
    return page(folder, f"{FOLDER}.rst", _overview(panels))


def by_panel() -> dict[str, dict[str, Any]]:
    """Returns the commands by name and by what they are for, in the order of ``hilc --help``."""
    group = typer.main.get_command(make_app())
    assert isinstance(group, TyperGroup)
    return {
        panel: {
            name: command
            for name, command in group.commands.items()
            if getattr(command, "rich_help_panel", None) == panel
        }
        for panel in PANELS
    }


def _overview(panels: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    yield from heading("Commands, option by option", "=")
    yield "Made from ``hilc COMMAND --help``; :doc:`/docs/commands` says what the commands share.\n"
    for panel, commands in panels.items():
        yield f"**{panel}**\n"
        for name, command in commands.items():
            told = literal(command.get_short_help_str(200))
            yield f"- :doc:`hilc {name} <commands/{name}>`: {told}"
        yield ""
    yield from contents(f"commands/{name}" for commands in panels.values() for name in commands)


def _context(name: str, command: Any, parent: Any) -> Any:
    """What a command is asked for, below that of another or of ``hilc`` itself.

    From there it has what all commands share: a command remembers the first option for help that it
    was asked with.
    """
    if parent is None:
        group = typer.main.get_command(make_app())
        parent = group.make_context("hilc", [], resilient_parsing=True)
    return command.make_context(name, [], parent=parent, resilient_parsing=True)


def _page(context: Any) -> Iterator[str]:
    """Returns the lines of a command's page, its own commands included."""
    yield from heading(context.command_path, "=")
    yield from _described(context)
    if isinstance(context.command, TyperGroup):
        for part, inner in context.command.commands.items():
            below = _context(part, inner, context)
            yield from heading(below.command_path, "-")
            yield from _described(below)


def _described(context: Any) -> Iterator[str]:
    command, name = context.command, context.command_path
    yield from code(command.get_usage(context).removeprefix("Usage: "), "text")
    yield from _help(inspect.cleandoc(command.help or ""))
    yield f".. program:: {name}\n"
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if record is None:
            continue
        spelled, told = record
        if isinstance(parameter, TyperOption):
            yield f".. option:: {spelled.replace(' / ', ', ')}\n"
            yield f"   {prose(told)}\n"
        else:
            yield f"``{spelled}``\n   {prose(told)}\n"


def _help(text: str) -> Iterator[str]:
    """Returns the paragraphs of a help text; those whose lines are kept are code."""
    for paragraph in text.split("\n\n"):
        lines = paragraph.splitlines()
        if lines and lines[0] == "\b":
            title, *rest = lines[1:]
            yield f"{literal(title)}\n"
            yield from code(inspect.cleandoc("\n" + "\n".join(rest)), "sh")
        else:
            yield f"{prose(' '.join(lines))}\n"
