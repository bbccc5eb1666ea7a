"""The units of a scenario's keys, as their models have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.yaml_input.model import Model, models_in
from hilc_cli.yaml_input.quantities import Quantity, quantities_in


def unit_of(key: str) -> str:
    """The unit of a dotted key; empty if it has none or none is known."""
    *above, last = key.split(".")
    if last.isdigit() and above:
        places = _places(above)
        return places[int(last)] if int(last) < len(places) else ""
    places = _places([*above, last])
    return places[0] if len(set(places)) == 1 else ""


def _places(parts: Sequence[str]) -> tuple[str, ...]:
    """The units of the numbers that a key holds, by its last two parts if they are known."""
    units = _units()
    return units.get(".".join(parts[-2:]), units.get(parts[-1], ()))


@cache
def _units() -> Mapping[str, tuple[str, ...]]:
    """Units of the numbers that fields hold, by the fields' names, and with what is above them.

    A name alone, the first of its kind, serves for keys that are not known to be there.
    """
    units: dict[str, tuple[str, ...]] = {}
    parts: list[tuple[str, type[Model]]] = [("", ScenarioSpec)]
    for above, model in parts:
        for name, field in model.model_fields.items():
            found = [part for part in field.metadata if isinstance(part, Quantity)]
            found = found or quantities_in(field.annotation)
            if found:
                places = tuple(each.told_in or each.unit.text for each in found)
                units[f"{above}.{name}"] = places
                units.setdefault(name, places)
            below = [(name, part) for part in models_in(field.annotation)]
            parts += (part for part in below if part not in parts)
    return units
