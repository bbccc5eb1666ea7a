"""``hilc schema``: JSON Schema of what users write, for editors."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

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
    from hilc_cli.reporting.terminal import print_json

    print_json(json_schema(kind.value))


DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema(kind: str) -> dict[str, Any]:
    """The schema of one kind of file.

    Args:
        kind: trajectory, scenario or leaderboard.
    """
    from pydantic import BaseModel  # like the models below, it starts slowly

    from hilc_cli.leaderboards.plan import LeaderboardSpec
    from hilc_cli.scenario.scenario import ScenarioSpec
    from hilc_cli.scenario.trajectory import TrajectorySpec

    models: dict[str, type[BaseModel]] = {
        "trajectory": TrajectorySpec,
        "scenario": ScenarioSpec,
        "leaderboard": LeaderboardSpec,
    }
    schema = models[kind].model_json_schema()
    if kind == "scenario":
        inline = schema["properties"]["trajectory"]
        path = {"type": "string", "description": "path of a trajectory file, or example:NAME"}
        schema["properties"]["trajectory"] = {"anyOf": [path, inline]}
    for part in schema["properties"].values():
        if "patternProperties" in part:
            part["additionalProperties"] = False  # a key that is no name is an error, too
    return {"$schema": DIALECT, **schema, "title": f"hilc {kind}"}
