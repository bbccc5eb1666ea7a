"""``hilc schema``: JSON Schema of what users write, for editors."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from hilc_cli.cli.options import Verbose, Version


class SchemaKind(StrEnum):
    """The files that have a schema."""

    TRAJECTORY = "trajectory"
    SCENARIO = "scenario"
    LEADERBOARD = "leaderboard"


def schema(
    kind: Annotated[SchemaKind, typer.Argument(help="Of which file.", show_default=False)],
    verbose: Verbose = False,
    version: Version = False,
) -> None:
    """Print the JSON Schema of YAML files.

    Editors that know it check and complete trajectory, scenario and leaderboard files as they are
    written.

    \b
    Examples:
      hilc schema scenario > hilc-scenario.schema.json
      hilc schema leaderboard > hilc-leaderboard.schema.json
    """
    from hilc_cli.cli.terminal import print_json
    from hilc_cli.spec.schema import json_schema

    print_json(json_schema(kind.value))
