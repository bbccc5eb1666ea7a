"""JSON Schema of the files that users write."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from hilc_cli.spec.leaderboard import LeaderboardSpec
from hilc_cli.spec.scenario import ScenarioSpec
from hilc_cli.spec.trajectory import TrajectorySpec

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_MODELS: dict[str, type[BaseModel]] = {
    "trajectory": TrajectorySpec,
    "scenario": ScenarioSpec,
    "leaderboard": LeaderboardSpec,
}


def json_schema(kind: str) -> dict[str, Any]:
    """The schema of one kind of file.

    Args:
        kind: trajectory, scenario or leaderboard.
    """
    schema = _MODELS[kind].model_json_schema()
    if kind == "scenario":
        inline = schema["properties"]["trajectory"]
        path = {"type": "string", "description": "path of a trajectory file, or example:NAME"}
        schema["properties"]["trajectory"] = {"anyOf": [path, inline]}
    for part in schema["properties"].values():
        if "patternProperties" in part:
            part["additionalProperties"] = False  # a key that is no name is an error, too
    return {"$schema": DIALECT, **schema, "title": f"hilc {kind}"}
