"""The reference pages: each key is there with its default and range, each command and column."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from hilc_cli.cli.app import COMMANDS
from hilc_cli.plants.kinematic_plant import KinematicSpec
from hilc_cli.plants.mujoco_plant import MujocoSpec
from hilc_cli.results.metrics import METRICS
from hilc_cli.results.tables import INPUT_HEADER, SAMPLES_HEADER
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.yaml_input.expressions import UNITS
from hilc_cli.yaml_input.quantities import Quantity

DOCS = Path(__file__).resolve().parent.parent / "docs"
DISTURBED = re.compile(r"disturbance\.(state|output|initial_pose)\.")  # one row for the three
ELSEWHERE = ("controller", "trajectory", "sweep.vary")  # their keys have pages of their own


def table_rows(page: str) -> dict[str, list[str]]:
    """The cells behind each cell that begins a row of a table and names one thing in code."""
    text = (DOCS / page).read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([^`|]+)` \| (.*) \|$", text, re.MULTILINE)
    return {name: [cell.strip() for cell in cells.split("|")] for name, cells in rows}


def keys(model: type[BaseModel], before: str = "") -> Iterator[tuple[str, FieldInfo]]:
    """The dotted keys of a model that hold values, each with its field."""
    for name, field in model.model_fields.items():
        key = before + name
        part = next(models_in(field.annotation), None)
        if part is None or key in ELSEWHERE:
            yield key, field
        elif name == "segments":
            for kind, inner in part.model_fields.items():
                (shape,) = models_in(inner.annotation)
                yield from keys(shape, f"{kind}.")
        else:
            if quantity_of(field) is not None:  # a single value may stand for its keys
                yield key, field
            yield from keys(part, f"{key}.")


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """The models in an annotation such as ``Model | None`` or ``list[Model]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inside in get_args(annotation):
        yield from models_in(inside)


def default_cell(field: FieldInfo) -> str:
    """How a page tells a default: ``required``, ``-`` for none, or the value as YAML has it."""
    default = field.get_default(call_default_factory=True)
    if field.is_required():
        return "required"
    if default is None or isinstance(default, BaseModel) or default in ("", {}):
        return "-"
    if isinstance(default, tuple):
        return f"[{', '.join(f'{value:g}' for value in default)}]"
    if isinstance(default, bool):
        return str(default).lower()
    return f"{default:g}" if isinstance(default, int | float) else str(default)


def quantity_of(field: FieldInfo) -> Quantity | None:
    """The number that a field holds; None if it holds words, several numbers, or a switch."""
    found = [part for part in field.metadata if isinstance(part, Quantity)]
    for inside in get_args(field.annotation):
        found += [
            part for part in getattr(inside, "__metadata__", ()) if isinstance(part, Quantity)
        ]
    return found[0] if found and "tuple" not in str(field.annotation) else None


def range_cell(quantity: Quantity) -> str:
    """How a page tells a range: ``1e-5 to 1000``, ``from 0``, ``whole, from 1 up``, ``any``."""
    if quantity.smallest is not None and quantity.above is not None and quantity.most is not None:
        near = quantity.smallest >= 1e-6  # other ends are nothing that anybody meets
        return f"{short(quantity.smallest)} to {short(quantity.most)}" if near else "above 0"
    found = re.match(r"give a (whole )?number(.*), such as", quantity.remedy)
    assert found
    words = ["whole" if found[1] else "", found[2].strip()]
    return ", ".join(word for word in words if word) or "any"


def short(number: float) -> str:
    """A number as people write it: ``1e-5``, ``1000``, ``1e8``."""
    text = f"{number:.0e}" if number >= 1e4 else f"{number:g}"
    return re.sub(r"e[+]?(-?)0*", r"e\1", text)


@pytest.mark.parametrize(
    ("page", "model"),
    [("scenario.md", ScenarioSpec), ("trajectory.md", TrajectorySpec)],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_each_key_is_on_its_page_with_its_default_and_range(
    page: str, model: type[BaseModel]
) -> None:
    rows = table_rows(page)
    known = {DISTURBED.sub("disturbance.*.", key): field for key, field in keys(model)}
    assert set(known) <= set(rows)
    for key, field in known.items():
        assert rows[key][0] == default_cell(field), key
        quantity = quantity_of(field)
        if quantity is not None:
            assert rows[key][1] == range_cell(quantity), key


def test_each_key_of_the_robot_in_mujoco_is_on_its_page() -> None:
    rows, usual = table_rows("robots.md"), KinematicSpec.model_fields
    own = {
        key: field
        for key, field in keys(MujocoSpec, "robot.")
        if (name := key.split(".")[1]) not in usual or name in MujocoSpec.__annotations__
    }
    del own["robot.plant"]
    assert "robot.body.mass" in own and "robot.friction" in own
    for key, field in own.items():
        assert rows[key][0] == default_cell(field), key
        quantity = quantity_of(field)
        if quantity is not None:
            assert rows[key][1] == range_cell(quantity), key


def test_each_command_is_on_its_page() -> None:
    table = (DOCS / "commands.md").read_text(encoding="utf-8").partition("\n\n`SCENARIO`")[0]
    told = re.findall(r"^\| `hilc (\w+)", table, re.MULTILINE)
    assert sorted(told) == sorted(COMMANDS)


def test_each_column_is_on_its_page() -> None:
    page = (DOCS / "files.md").read_text(encoding="utf-8")
    parts = dict(re.findall(r"^## (\S+)\n(.*?)(?=^## )", page, re.MULTILINE | re.DOTALL))
    rows = re.findall(r"^\| `(\w+)`", parts["iterations.csv"], re.MULTILINE)
    assert rows == ["iteration", *METRICS]
    for file, header in (("samples.csv", SAMPLES_HEADER), ("input.csv", INPUT_HEADER)):
        told = re.findall(r"`(\w+)`", parts[file])
        assert told[: len(header)] == list(header)


def test_each_unit_is_on_its_page() -> None:
    text = " ".join((DOCS / "scenario.md").read_text(encoding="utf-8").split())
    (told,) = re.findall(r"Units are (`deg`.*?), their", text)
    assert sorted(re.findall(r"`(.*?)`", told)) == sorted(UNITS)
