"""``hilc examples``: list and copy the files that travel with hilc."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options


def examples(
    copy: Annotated[
        Path | None,
        typer.Option(
            "--copy",
            metavar="DIR",
            help="Write them to DIR/scenarios and DIR/trajectories.",
            callback=options.check_is_folder_name,
            show_default=False,
        ),
    ] = None,
    where: Annotated[
        bool, typer.Option("--where", help="Print the folder that holds them.")
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Replace changed files of the same name.")
    ] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """List or copy the examples that come with hilc.

    They are scenarios, trajectories and leaderboards, and programs for robots. Scenarios run as
    example:NAME; scenarios may name trajectories so as well. Programs are to be copied.

    \b
    Examples:
      hilc examples
      hilc examples --copy my-experiments
    """
    from hilc_cli.reporting.terminal import print_json, print_table, print_text, two_columns
    from hilc_cli.shipped_files import (
        KINDS,
        PROGRAMS,
        copy_examples,
        examples,
        examples_folder,
        programs,
    )

    if where:
        folder = str(examples_folder())
        print_json({"folder": folder}) if json else print_text(folder)
        return
    if copy is not None:
        written = copy_examples(copy, force=force)
        if json:
            print_json({"folder": str(copy), "files": [str(path) for path in written]})
        elif not quiet:
            print_text(f"Wrote {len(written)} files to {copy}")
        return
    listed = {
        kind: [(f"example:{path.stem}", description_of(path)) for path in examples(kind)]
        for kind in KINDS
    }
    listed[PROGRAMS] = [(path.name, _first_line(path)) for path in programs()]
    if json:
        print_json(
            {
                kind: [{"name": name, "description": text} for name, text in rows]
                for kind, rows in listed.items()
            }
        )
    elif not quiet:
        for kind, rows in listed.items():
            print_table(two_columns(kind.capitalize(), rows, numbers=False))


def _first_line(program: Path) -> str:
    """What a program says of itself first."""
    text = program.read_text(encoding="utf-8")
    return text.partition('"""')[2].partition("\n")[0]


def description_of(path: Path) -> str:
    """The description in a trajectory or scenario file; empty if it has none.

    Raises:
        HilcError: It cannot be read, or is no YAML.
    """
    from hilc_cli.yaml_input.nodes import MapNode, Scalar  # YAML starts slowly
    from hilc_cli.yaml_input.reading import Inputs

    tree = Inputs().tree(str(path))
    node = tree.entries.get("description") if isinstance(tree, MapNode) else None
    return node.text if isinstance(node, Scalar) else ""
