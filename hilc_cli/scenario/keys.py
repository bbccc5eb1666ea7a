"""The keys that a scenario may have, as ``--set`` and ``--vary`` take them, and their units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import get_args, get_origin

from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.yaml_input.model import Model, models_in
from hilc_cli.yaml_input.quantities import Quantity, quantities_in

_WHOLE = frozenset({"trajectory", "sweep"})
"""Sections that may be a single value: the path of a file, or nothing."""


def scenario_keys() -> list[str]:
    """Dotted keys of all values that a scenario may hold, those of all laws among them, in order.

    What is in lists, such as the segments of a trajectory, is left out: those keys have numbers.
    """
    return list(dict.fromkeys(_keys(ScenarioSpec, "")))


def _keys(model: type[Model], above: str) -> Iterator[str]:
    for name, field in model.model_fields.items():
        parts = [] if _holds_many(field.annotation) else models_in(field.annotation)
        if not parts or name in _WHOLE:
            yield f"{above}{name}"
        for part in parts:
            yield from _keys(part, f"{above}{name}.")


def _holds_many(annotation: object) -> bool:
    """Whether values of a kind may be lists or have names of the user's choice."""
    parts = get_args(annotation)
    return get_origin(annotation) in (list, tuple, dict) or any(map(_holds_many, parts))


def unit_of(key: str) -> str:
    """The unit of a dotted key; empty if it has none or none is known."""
    *above, last = key.split(".")
    units = _units()
    if last.isdigit() and above:
        places = units.get(above[-1], ())
        return places[int(last)] if int(last) < len(places) else ""
    places = units.get(last, ())
    return places[0] if len(set(places)) == 1 else ""


@cache
def _units() -> Mapping[str, tuple[str, ...]]:
    """Units of the numbers that fields hold, by the fields' names: a name has the same anywhere."""
    units: dict[str, tuple[str, ...]] = {}
    models: list[type[Model]] = [ScenarioSpec]
    for model in models:
        for name, field in model.model_fields.items():
            found = [part for part in field.metadata if isinstance(part, Quantity)]
            found = found or quantities_in(field.annotation)
            if found:
                units[name] = tuple(each.told_in or each.unit.text for each in found)
            models += (part for part in models_in(field.annotation) if part not in models)
    return units
