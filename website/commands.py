"""A page for each command, made from what the command line itself knows."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import typer.main
from typer.core import TyperGroup, TyperOption

from hilc_cli.cli.app import PANELS, app
from website.rst import code, contents, heading, literal, page, prose

FOLDER = "docs/reference/commands"


def write_pages(folder: Path) -> str:
    """Writes a page for each command, and one that lists them, whose name is returned."""
    panels = by_panel()
    for commands in panels.values():
        for name, command in commands.items():
            page(folder, f"{FOLDER}/{name}.rst", _page(name, command))
    return page(folder, f"{FOLDER}.rst", _overview(panels))


def by_panel() -> dict[str, dict[str, Any]]:
    """Returns the commands by name and by what they are for, in the order of ``hilc --help``."""
    group = typer.main.get_command(app)
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


def _page(name: str, command: Any) -> Iterator[str]:
    """Returns the lines of a command's page, its own commands included."""
    yield from heading(f"hilc {name}", "=")
    yield from _described(f"hilc {name}", command)
    if isinstance(command, TyperGroup):
        for part, inner in command.commands.items():
            yield from heading(f"hilc {name} {part}", "-")
            yield from _described(f"hilc {name} {part}", inner)


def _described(name: str, command: Any) -> Iterator[str]:
    context = command.make_context(name, [], resilient_parsing=True)
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
