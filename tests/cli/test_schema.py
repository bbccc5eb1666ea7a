"""The JSON Schemas: sound by themselves, and true of the files that travel with hilc."""

from __future__ import annotations

import functools
import json
import re
from pathlib import Path
from typing import Any

import pytest

from hilc_cli.cli import schema as schema_command
from hilc_cli.shipped_files import LEADERBOARDS, examples
from hilc_cli.yaml_input.nodes import Source, to_data
from hilc_cli.yaml_input.tree import parse_yaml
from tests.conftest import Hilc

json_schema = functools.cache(schema_command.json_schema)
KINDS = ["trajectory", "scenario", "leaderboard"]
FILES = [
    *(pytest.param("scenario", path, id=path.name) for path in examples()),
    *(pytest.param("trajectory", path, id=path.name) for path in examples("trajectories")),
    *(pytest.param("leaderboard", path, id=path.name) for path in examples(LEADERBOARDS)),
]
_TYPES: dict[str, Any] = {
    "object": dict,
    "array": list | tuple,
    "string": str,
    "boolean": bool,
    "null": type(None),
}
# The keywords that `fits` knows, and those that only describe.
_CHECKED = {
    *("$ref", "anyOf", "oneOf", "type", "enum", "const", "properties", "required", "items"),
    *("additionalProperties", "prefixItems", "minItems", "maxItems", "minimum", "maximum"),
    *("exclusiveMinimum", "pattern", "maxLength", "maxProperties", "propertyNames"),
    *("patternProperties", "minProperties"),
}
_DESCRIBING = {"$schema", "$defs", "title", "description", "default"}


def fits(data: object, schema: dict[str, Any], root: dict[str, Any]) -> bool:
    """Whether data is valid; as much of JSON Schema as these schemas use."""
    assert set(schema) <= _CHECKED | _DESCRIBING, "teach this check the new keyword"
    if "$ref" in schema and not fits(data, root["$defs"][schema["$ref"].split("/")[-1]], root):
        return False
    if "anyOf" in schema and not any(fits(data, each, root) for each in schema["anyOf"]):
        return False
    if "oneOf" in schema and sum(fits(data, each, root) for each in schema["oneOf"]) != 1:
        return False
    if "enum" in schema and data not in schema["enum"]:
        return False
    if "const" in schema and data != schema["const"]:
        return False
    if not _has_type(data, schema.get("type")):
        return False
    if isinstance(data, str):
        return bool(re.search(schema.get("pattern", ""), data)) and len(data) <= schema.get(
            "maxLength", len(data)
        )
    if isinstance(data, bool):
        return True
    if isinstance(data, int | float):
        return schema.get("minimum", data) <= data <= schema.get(
            "maximum", data
        ) and not data <= schema.get("exclusiveMinimum", data - 1)
    if isinstance(data, list):
        first = schema.get("prefixItems", [])
        items = [*first, *[schema.get("items", {})] * (len(data) - len(first))]
        return schema.get("minItems", 0) <= len(data) <= schema.get("maxItems", len(data)) and all(
            fits(item, each, root) for item, each in zip(data, items, strict=False)
        )
    if isinstance(data, dict):
        properties = schema.get("properties", {})
        closed = schema.get("additionalProperties") is False
        by_pattern = schema.get("patternProperties", {}).items()
        matched = {key for key in data for pattern, _ in by_pattern if re.search(pattern, key)}
        return (
            schema.get("minProperties", 0) <= len(data) <= schema.get("maxProperties", len(data))
            and all(fits(key, schema.get("propertyNames", {}), root) for key in data)
            and all(
                fits(value, each, root)
                for key, value in data.items()
                for pattern, each in by_pattern
                if re.search(pattern, key)
            )
            and set(schema.get("required", [])) <= set(data)
            and not (closed and set(data) - set(properties) - matched)
            and all(fits(value, properties.get(key, {}), root) for key, value in data.items())
        )
    return True


def _has_type(data: object, name: str | None) -> bool:
    if name is None:
        return True
    if name in ("number", "integer"):
        number = isinstance(data, int | float) and not isinstance(data, bool)
        return number and (name == "number" or data == int(data))  # type: ignore[call-overload]
    return isinstance(data, _TYPES[name])


def data_of(path: Path) -> dict[str, Any]:
    data = to_data(parse_yaml(path.read_bytes(), Source(path.name, path.parent)))
    assert isinstance(data, dict)
    return data


@pytest.mark.parametrize("kind", KINDS)
def test_command_prints_the_schema(hilc: Hilc, kind: str) -> None:
    outcome = hilc("schema", kind)
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out)
    assert document == json_schema(kind)
    assert document["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert document["type"] == "object"
    assert document["additionalProperties"] is False


@pytest.mark.parametrize("kind", KINDS)
def test_every_reference_leads_somewhere(kind: str) -> None:
    schema = json_schema(kind)
    for reference in re.findall(r'"\$ref": "([^"]*)"', json.dumps(schema)):
        assert reference.removeprefix("#/$defs/") in schema["$defs"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_model_refuses_unknown_keys(kind: str) -> None:
    for name, model in json_schema(kind)["$defs"].items():
        if model.get("type") == "object":
            of_others = name.startswith("Installed")  # whose keys are known when it is imported
            assert model["additionalProperties"] is of_others, name


@pytest.mark.parametrize(("kind", "path"), FILES)
def test_shipped_file_is_valid(kind: str, path: Path) -> None:
    schema = json_schema(kind)
    assert fits(data_of(path), schema, schema)


BREAKAGES = [
    ("name", None),
    ("name", "a/b"),
    ("iterations", -1),
    ("iterations", 1.5),
    ("robot", {"wheel_radius": 0.2, "half_trck": 0.5, "turn_convention": "paper"}),
    ("robot", {"wheel_radius": 0, "half_track": 0.5, "turn_convention": "paper"}),
    ("robot", {"wheel_radius": 0.2, "half_track": 0.5}),
    ("robot", {"wheel_radius": 0.2, "half_track": 0.5, "turn_convention": "left"}),
    ("controller", {"gains": {"l2": 1}}),
    ("controller", {"gains": {"l1": 1}, "law": "pid"}),
    ("controller", {"gains": {"l1": 1}, "law": "no-such-law"}),
    ("controller", {"law": "not a module:Law"}),
    ("controller", {"gains": {"l1": 1}, "gain_matrix": [[1, 2], [3, 4]]}),
    ("record", {"iterations": "some"}),
    ("disturbance", {"state": {"bound": [0, 0]}}),
    ("trajectory", 3),
    ("typo", 3),
]


@pytest.mark.parametrize(("key", "value"), BREAKAGES)
def test_wrong_scenario_is_not_valid(key: str, value: object) -> None:
    schema = json_schema("scenario")
    data = data_of(next(path for path in examples() if path.stem == "fig3-circle"))
    assert fits(data, schema, schema)
    data[key] = value
    assert not fits(data, schema, schema)


LEADERBOARD_BREAKAGES: list[tuple[str, object]] = [
    ("name", None),
    ("lawss", {}),
    ("laws", {}),
    ("laws", {"my law": {"law": "feedback"}}),
    ("laws", {"paper": {"gains": {"l1": 1, "l5": 1}}}),
    ("laws", {"paper": {"law": "feedbak"}}),
    ("laws", {"pid": {"law": "pid", "gains": {"kp": -1}}}),
    ("cases", {"circle": 3}),
    ("beliefs", {"wrong": {"wheel_radius": 0}}),
    ("beliefs", {"wrong": {"radius": 1}}),
    ("disturbances", {"noise": {"output": {"bound": [1, 1]}}}),
    ("initial_input", "input.csv"),
    ("after", []),
    ("tolerance", 0),
]


@pytest.mark.parametrize(("key", "value"), LEADERBOARD_BREAKAGES)
def test_wrong_leaderboard_is_not_valid(key: str, value: object) -> None:
    schema = json_schema("leaderboard")
    path = next(examples(LEADERBOARDS))
    data = data_of(path)
    assert fits(data, schema, schema)
    data[key] = value
    assert not fits(data, schema, schema)
