"""What messages say of numbers: the range that is allowed, and a value that fits the very key."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Annotated, Any, get_args

import pytest
from pydantic import BaseModel, TypeAdapter, ValidationError

from hilc_cli.leaderboards.plan import LeaderboardSpec
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.yaml_input.expressions import PLAIN, evaluate
from hilc_cli.yaml_input.model import models_in
from hilc_cli.yaml_input.quantities import PositiveLength, Quantity, such_as


def quantities_in(annotation: Any) -> list[Quantity]:
    if isinstance(annotation, Quantity):
        return [annotation]
    return [quantity for part in get_args(annotation) for quantity in quantities_in(part)]


def fields(model: type[BaseModel], above: str = "") -> Iterator[tuple[str, Quantity, Any]]:
    """All numbers of a model and of those below it: path, quantity and default."""
    for name, field in model.model_fields.items():
        path = f"{above}.{name}".lstrip(".")
        whole = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
        for quantity in quantities_in(whole):
            yield path, quantity, None if field.is_required() else field.get_default()
        for part in models_in(field.annotation):
            yield from fields(part, f"{path}.{part.__name__}")


EVERY = [*fields(ScenarioSpec), *fields(LeaderboardSpec)]


def test_all_numbers_are_found() -> None:
    ends = {path.split(".")[-1] for path, _, _ in EVERY}
    assert {"wheel_radius", "bound", "position", "cutoff", "k_theta", "after"} <= ends


def test_examples_are_what_the_key_takes_and_like_its_default() -> None:
    for path, quantity, default in EVERY:
        texts = quantity.example.partition(",")[0].split(" or ")
        values = [quantity(text) for text in texts]
        assert all(evaluate(text).unit == quantity.unit for text in texts[1:]), path
        if isinstance(default, int | float) and default > 0:
            assert default / 2 <= values[0] <= default * 2, path
            assert max(values) <= 1.1 * min(values), path  # the same with and without a unit


@pytest.mark.parametrize(
    ("quantity", "value", "problem", "remedy"),
    [
        (Quantity(PLAIN, "1", least=0, most=1), 2, "must be at most 1", "from 0 to 1"),
        (Quantity(PLAIN, "1", least=0, most=1), -1, "must be at least 0", "from 0 to 1"),
        (Quantity(PLAIN, "1", above=0, most=5), 0, "must be above 0", "above 0 and up to 5"),
        (Quantity(PLAIN, "1", least=0, most=1e9), -1, "must be at least 0", "from 0 up"),
        (Quantity(PLAIN, "1", least=0, most=1e9), 2e9, "must be at most 1e+09", "from 0 to 1e+09"),
        (Quantity(PLAIN, "1", least=-1e9, most=1e9), "x", "has the unknown name 'x'", ""),
        (Quantity(PLAIN, "1", least=0), "1 m", "must have no unit", "from 0 up"),
    ],
)
def test_remedy_tells_the_range(
    quantity: Quantity, value: object, problem: str, remedy: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(problem)) as error:
        quantity(value)
    ((_, _, told),) = error.value.context["problems"]  # type: ignore[attr-defined]
    assert told == " ".join(f"give a number {remedy}".split()) + ", such as 1"


def test_another_example_changes_nothing_else() -> None:
    small = such_as(PositiveLength, "1 mm")
    assert small("3 cm") == 0.03
    assert small.remedy == "give a number above 0, such as 1 mm"
    with pytest.raises(ValidationError):
        TypeAdapter(Annotated[float, small]).validate_python(0)
